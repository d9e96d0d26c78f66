"""Where errors are bounded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from manufactured.case import Case
from study.bound.trajectory import Refined, SmoothedInTime, Trajectory
from study.fem.mesh import FAMILIES
from study.solve.tableau import SCHEMES
from study.statements.shared.base import Setting

QUICK = ("advance-recede", "yield-on-a-part", "hexagon")
"""Cases whose bounds the quick study computes, one with each scheme: memory, law (3.3), three faces."""
CHECKED, CHECKED_LEVEL = "advance-recede", 32
"""The case with check values, and the level at which the enclosure is announced to be tight."""


@dataclass(frozen=True)
class BoundSetting(Setting):
    """One row of ``bounds.csv``; ``case`` may be the name of a problem whose solution is unknown.

    Attributes:
        scheme: name of the time scheme of u_h.
        by: where ũ comes from.
    """

    scheme: str
    by: Trajectory

    @property
    def trajectory(self) -> str:
        """Its name, which is that of the statement."""
        return self.by.name


def eligible(case: Case) -> bool:
    """Whether the bound can be given: in the plane, with f_0 ∈ L²(Ω)², tensors smooth in every cell."""
    return case.solution.body.dim == 2 and case.regularity.force_in_L2 and not case.regularity.kink


def quick_bounds(cases: Sequence[Case]) -> list[BoundSetting]:
    """A scheme for each of the quick cases, and enclosures on two levels with a solution that is known and without."""
    chosen = [case for case in cases if case.name in QUICK]
    found = []
    for turn, case in enumerate(chosen):
        families = _families(case)
        family = families[turn % len(families)]
        found.append(BoundSetting(case.name, family, 8, SCHEMES[turn].name, SmoothedInTime()))
    if chosen:
        enclosed = ((chosen[0].name, _families(chosen[0])[0]), ("bracket", "graded"))
        found += [
            BoundSetting(name, family, level, "midpoint", Refined(0, 2))
            for name, family in enclosed
            for level in (4, 8)
        ]
    return found


def full_bounds(cases: Sequence[Case]) -> list[BoundSetting]:
    """Every case with every scheme, families in turn; enclosures on two levels; the problems without a solution."""
    found = []
    for turn, case in enumerate(filter(eligible, cases)):
        families = _families(case)
        own = families[turn % len(families)]
        for place, scheme in enumerate(SCHEMES):
            found.append(
                BoundSetting(case.name, families[(turn + place) % len(families)], 8, scheme.name, SmoothedInTime())
            )
        found.append(BoundSetting(case.name, own, 16, "midpoint", SmoothedInTime()))
        if case.name != CHECKED:
            found += [BoundSetting(case.name, own, level, "midpoint", Refined(1, 2)) for level in (4, 8)]
    if any(case.name == CHECKED for case in cases):
        found += [BoundSetting(CHECKED, "shaken", n, "midpoint", Refined(1, 4)) for n in (8, 16, CHECKED_LEVEL)]
        found += [BoundSetting("ramp", "unstructured", n, "midpoint", Refined(2, 2)) for n in (4, 8, 16)]
        found += [BoundSetting("bracket", "graded", n, "midpoint", Refined(1, 2)) for n in (4, 8, 16)]
    return found


def _families(case: Case) -> list[str]:
    return [family.name for family in FAMILIES if family.serves(case.solution.body)]

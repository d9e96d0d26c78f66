"""Which bounds a run computes."""

from __future__ import annotations

from collections.abc import Sequence

from manufactured.case import Case
from study.bound.enclosure import Better, Itself
from study.fem.mesh import FAMILIES
from study.solve.tableau import SCHEMES
from study.statements.enclosure.claims import CHECKED, CHECKED_LEVEL
from study.statements.enclosure.jobs import BoundJob

QUICK = ("advance-recede", "yield-on-a-part", "hexagon")
"""Cases whose bounds the quick study computes, one with each scheme: memory, law (3.3), three faces."""


def eligible(case: Case) -> bool:
    """Whether the bound can be given: in the plane, with f_0 ∈ L²(Ω)², tensors smooth in every cell."""
    return case.solution.body.dim == 2 and case.regularity.force_in_L2 and not case.regularity.kink


def quick_bounds(cases: Sequence[Case]) -> list[BoundJob]:
    """A scheme for each of the quick cases, and enclosures on two levels with a solution that is known and without."""
    chosen = [case for case in cases if case.name in QUICK]
    jobs = []
    for turn, case in enumerate(chosen):
        families = _families(case)
        family = families[turn % len(families)]
        jobs.append(BoundJob(case.name, family, SCHEMES[turn].name, 8, Itself()))
    if chosen:
        enclosed = ((chosen[0].name, _families(chosen[0])[0]), ("bracket", "graded"))
        jobs += [
            BoundJob(name, family, "midpoint", level, Better(0, 2)) for name, family in enclosed for level in (4, 8)
        ]
    return jobs


def full_bounds(cases: Sequence[Case]) -> list[BoundJob]:
    """Every case with every scheme, families in turn; enclosures on two levels; the problems without a solution."""
    jobs = []
    for turn, case in enumerate(filter(eligible, cases)):
        families = _families(case)
        for place, scheme in enumerate(SCHEMES):
            jobs.append(BoundJob(case.name, families[(turn + place) % len(families)], scheme.name, 8, Itself()))
        jobs.append(BoundJob(case.name, families[turn % len(families)], "midpoint", 16, Itself()))
        if case.name != CHECKED:
            jobs += [
                BoundJob(case.name, families[turn % len(families)], "midpoint", level, Better(1, 2)) for level in (4, 8)
            ]
    if any(case.name == CHECKED for case in cases):
        jobs += [BoundJob(CHECKED, "shaken", "midpoint", level, Better(1, 4)) for level in (8, 16, CHECKED_LEVEL)]
        jobs += [BoundJob("ramp", "unstructured", "midpoint", level, Better(2, 2)) for level in (4, 8, 16)]
        jobs += [BoundJob("bracket", "graded", "midpoint", level, Better(1, 2)) for level in (4, 8, 16)]
    return jobs


def _families(case: Case) -> list[str]:
    return [family.name for family in FAMILIES if family.serves(case.solution.body)]

"""Where errors are bounded, and what is measured there: rows of ``bounds.csv``, and the course of each in time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from manufactured.case import Case
from study.bound.enclosing import Enclosure
from study.bound.trajectory import Refined, SmoothedInTime, Trajectory
from study.fem.naming import choose, family_named
from study.ledger.datafiles import CsvFile, DataFile, Row
from study.solve.steps import rate_steps
from study.solve.tableau import SCHEMES
from study.statements.enclosure.bound_rows import COLUMNS, measure, posed
from study.statements.shared import estimates
from study.statements.shared.base import Setting, Statement
from study.statements.shared.places import families
from study.statements.shared.scope import Scope

QUICK = (
    ("advance-recede", "one-diagonal", "backward-euler"),
    ("yield-on-a-part", "criss-cross", "bdf2"),
    ("hexagon", "unstructured", "midpoint"),
)
"""Cases whose bounds the quick study computes, with mesh family and scheme: memory, law (3.3), three faces."""
ROTATION = ("one-diagonal", "criss-cross", "shaken", "unstructured", "graded")
"""The full study bounds the errors of the schemes of a case on meshes of these families in turn."""
ROTATION_STARTS = {
    "rotated": "shaken",
    "natural-front": "criss-cross",
    "rough-trace": "shaken",
    "re-entrant": "graded",
    "softening": "criss-cross",
    "double-well": "shaken",
}
"""Where the rotation starts for cases for which this is not the family that the case names first."""
CHECKED, CHECKED_LEVEL = "advance-recede", 32
"""The case with check values, and the level at which the enclosure is announced to be tight."""
KEY = ("trajectory", "case", "family", "scheme", "level")
BOUNDS = CsvFile("bounds.csv", KEY, COLUMNS)
ENCLOSURES = CsvFile("enclosures.csv", KEY, (*KEY, "time", "error", "distance", "bound"))
TIMES = 96
"""Times that are kept of one computation."""


@dataclass(frozen=True)
class BoundSetting(Setting):
    """One row of ``bounds.csv``: also the name of the scheme of u_h, and where ũ comes from.

    ``case`` may be the name of a problem whose solution is unknown.
    """

    scheme: str
    by: Trajectory

    @property
    def trajectory(self) -> str:
        """Its name, which is that of the statement."""
        return self.by.name

    @property
    def refinements(self) -> int:
        """Of the mesh of u_h for that of ũ."""
        return self.by.refinements if isinstance(self.by, Refined) else 0


def eligible(case: Case) -> bool:
    """Whether the bound can be given: in the plane, with f_0 ∈ L²(Ω)², tensors smooth in every cell."""
    return case.solution.body.dim == 2 and case.regularity.force_in_L2 and not case.regularity.kink


def quick_bounds(cases: Sequence[Case]) -> Iterator[BoundSetting]:
    """A scheme for each of the quick cases, and enclosures on two levels with a solution that is known and without."""
    studied = {case.name for case in cases}
    for name, family, scheme in QUICK:
        if name in studied:
            yield BoundSetting(name, family, 8, scheme, SmoothedInTime())
    if CHECKED in studied:
        yield from by_midpoint(CHECKED, "one-diagonal", (4, 8), Refined(0, 2))
        yield from by_midpoint("bracket", "graded", (4, 8), Refined(0, 2))


def full_bounds(cases: Sequence[Case]) -> Iterator[BoundSetting]:
    """Every case with every scheme, families in turn; enclosures on two levels; the problems without a solution."""
    for case in filter(eligible, cases):
        in_turn = families_in_turn(case)
        for family, scheme in zip(in_turn, SCHEMES, strict=True):
            yield BoundSetting(case.name, family, 8, scheme.name, SmoothedInTime())
        yield from by_midpoint(case.name, in_turn[0], (16,), SmoothedInTime())
        yield from by_midpoint(case.name, in_turn[0], (4, 8) if case.name != CHECKED else (), Refined(1, 2))
    if any(case.name == CHECKED for case in cases):
        yield from by_midpoint(CHECKED, "shaken", (8, 16, CHECKED_LEVEL), Refined(1, 4))
        yield from by_midpoint("ramp", "unstructured", (4, 8, 16), Refined(2, 2))
        yield from by_midpoint("bracket", "graded", (4, 8, 16), Refined(1, 2))


def families_in_turn(case: Case) -> list[str]:
    """Return the names of a mesh family for each scheme: those of ``ROTATION`` that can mesh the body, in turn."""
    serving = [family for family in ROTATION if family in families(case)]
    first = serving.index(ROTATION_STARTS.get(case.name, (case.families or serving)[0]))
    return [serving[(first + turn) % len(serving)] for turn in range(len(SCHEMES))]


def by_midpoint(case: str, family: str, levels: Sequence[int], by: Trajectory) -> list[BoundSetting]:
    """Some levels with the midpoint rule."""
    return [BoundSetting(case, family, level, "midpoint", by) for level in levels]


class Bounds(Statement):
    """What both statements have in common: where and how errors are bounded."""

    file = BOUNDS

    def settings(self, scope: Scope) -> list[BoundSetting]:
        """The cases of the study, and problems without a solution beside them."""
        found = (full_bounds if scope.full else quick_bounds)(scope.resolved())
        return [setting for setting in found if setting.trajectory == self.label]

    def measure(self, setting: BoundSetting) -> dict[str, Any]:
        """A row of ``bounds.csv``, and columns of ``enclosures.csv``."""
        family, scheme = family_named(setting.family), choose("scheme", setting.scheme, SCHEMES)
        row, found = measure(posed(setting.case), family, setting.level, scheme, self.steps(setting), setting.by)
        return {"row": row, "times": over_time(found)}

    def records(self, setting: BoundSetting, found: Mapping[str, Any]) -> Iterator[tuple[DataFile, Row]]:
        """One row, and one for every time."""
        yield BOUNDS, found["row"]
        common = {name: found["row"][name] for name in KEY}
        for values in zip(*found["times"].values(), strict=True):
            yield ENCLOSURES, {**common, **dict(zip(found["times"], values, strict=True))}

    def cost(self, setting: BoundSetting) -> float:
        """By cells of the mesh of ũ and its steps: a knot costs three stress solves of degree 3."""
        shorter = setting.by.shorter if isinstance(setting.by, Refined) else 1
        return 220.0 * setting.level**2 * 4**setting.refinements * self.steps(setting) * shorter

    def memory(self, setting: BoundSetting) -> float:
        return estimates.bound(setting.level, setting.refinements, setting.family)

    def steps(self, setting: BoundSetting) -> int:
        problem = posed(setting.case)
        return rate_steps(problem.data.body.T, setting.level, problem.pace)


def over_time(found: Enclosure) -> dict[str, list[float]]:
    """Columns of ``enclosures.csv``, at no more than TIMES times."""
    chosen = np.unique(np.linspace(0, len(found.times) - 1, TIMES).round().astype(int))
    columns = ("error", "distance", "bound")
    return {
        "time": np.round(found.times[chosen], 9).tolist(),
        **{name: [float(f"{v:.6g}") for v in getattr(found, name)[chosen]] for name in columns},
    }

"""Theorem 4.2 on a stress space of its own: where it is measured, and when the two formulations meet."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any

import pandas as pd

from manufactured.regularity import Regularity
from study.fem.naming import family_named, resolve
from study.ledger.criterion import Criterion, Measured, Observation, Rule
from study.ledger.datafiles import CsvFile, DataFile, Row
from study.ledger.measures import change, largest, order
from study.ledger.verdict import Verdict
from study.ledger.window import Window, at_least, at_most
from study.solve.steps import stress_steps
from study.statements.shared import estimates
from study.statements.shared.base import Setting
from study.statements.shared.scope import Scope
from study.statements.thm_4_2.predicted_orders import predicted
from study.statements.thm_4_2.stress_errors import StressRow, measure_stresses

CASES = (
    "full-contact",
    "fixed-front-on-vertex",
    "fixed-front-off-vertex",
    "advance-recede",
    "travelling-patch",
    "merging-patches",
    "load-w11",
    "anisotropic",
    "heterogeneous",
    "layered",
    "rotated",
    "corner",
    "hexagon",
    "natural-front",
    "re-entrant",
)
"""Plane cases with linear laws, f_0 ∈ L² and stresses that are continuous in time: where the face lands with a
velocity, BDF2 is wrong for a step whatever k is. Without contact there is no pressure to compare; at the junction of Γ1
and Γ3 it is not in L²(Γ3). Left out is rough-trace, too: at its front, r^{5/4} where the contact problem itself makes
r^{3/2}, errors depend on the place of the front in a cell, and multipliers fall with orders of 0.6 to 2.5 from level to
level up to n = 64."""
FAMILIES_OF = {
    "hexagon": ("unstructured",),
    "re-entrant": ("unstructured", "graded"),
    "natural-front": ("one-diagonal",),
}
"""Mesh families other than shaken ones. The error of the pressure at a natural front that rests is that of one cell:
where the front lies in it may not be left to chance, or orders scatter by 1 from seed to seed."""
QUICK = ("advance-recede", "layered", "corner", "natural-front")
FINEST = ("re-entrant",)
"""Cases that are measured on the finest level, too."""

STRESSES = CsvFile("stresses.csv", ("case", "family", "level"), tuple(field.name for field in fields(StressRow)))

JUDGED = 3
"""Orders are taken over the last levels, up to so many."""
PAIR = 2
"""Fewer levels have no order."""
GROWTH = at_most(1.25, "bounded")
STRONGLY = at_most(1e-9)
TIME = at_most(1.0, "by the order 3/2 in k the error in time is then ≤ 0.55 of the error")
RATIO = "‖σ − σ^h‖_Q / that of the best polynomials"
ADMISSIBLE = "σ^hν continuous, P f_2 on Γ2, σ_τ = 0 and σ_ν ≤ 0 on Γ3, strongly"
QUANTITIES = {
    "stress": "‖σ − σ^h‖_Q",
    "strain": "‖ε(u) − ε^h‖_Q for the strains that belong to σ^h",
    "pressure": "‖σ_ν − σ^h_ν‖_{L²(Γ3)}",
    "displacement": "multipliers − u on the edges",
    "primal_stress": "‖σ^h − (Aε(δu^h) + Gε(u^h))‖_Q",
    "primal_displacement": "multipliers − u^h on the edges",
}


@dataclass(frozen=True)
class OwnSpace:
    """Problem 3.2 on composite equilibrated stresses against the exact solution and against Problem 5.1."""

    label: str = "Thm 4.2, own space"
    claim: str = "Problem 3.2 on a conforming stress space of its own and Problem 3.1 meet"
    file: DataFile = STRESSES
    of_every_case: bool = False

    def places(self, full: bool) -> list[Setting]:
        """Where it is measured in the quick or the full study."""
        if not full:
            # Two levels of random meshes give orders that one in twenty misses its window.
            return [Setting(case, "one-diagonal", level) for case in QUICK for level in (8, 16)]
        return [
            Setting(case, family, level)
            for case in CASES
            for family in FAMILIES_OF.get(case, ("shaken",))
            for level in (8, 16, 32, *((64,) if case in FINEST else ()))
        ]

    def settings(self, scope: Scope) -> list[Setting]:
        """The places with a case of the study."""
        return [setting for setting in self.places(scope.full) if setting.case in scope.cases]

    def measure(self, setting: Setting) -> dict[str, Any]:
        """A row of ``stresses.csv``."""
        case, family = resolve(setting.case), family_named(setting.family)
        return asdict(measure_stresses(case, family, setting.level, self.steps(setting)))

    def records(self, setting: Setting, found: Mapping[str, Any]) -> Iterator[tuple[DataFile, Row]]:
        """The row."""
        yield self.file, found

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        """One row for each quantity, case and mesh family."""
        found: list[Verdict] = []
        for (case, family), series in rows.groupby(["case", "family"], sort=False):
            levels = series.sort_values("h", ascending=False).assign(ratio=series["stress"] / series["best"])
            rules = rules_of(resolve(str(case)).regularity, str(family))
            found += [rule.verdict(self, str(case), {str(family): levels}, str(family)) for rule in rules]
        return found

    def cost(self, setting: Setting) -> float:
        """By cells and steps."""
        return 65.0 * setting.level**2 * self.steps(setting)

    def memory(self, setting: Setting) -> float:
        """That of the factor of the multipliers' matrix."""
        return estimates.stress(setting.level)

    def steps(self, setting: Setting) -> int:
        """Of the size of h, shorter where more happens in time."""
        case = resolve(setting.case)
        return stress_steps(case.solution.body.T, setting.level, case.pace)


def rules_of(regularity: Regularity, family: str) -> Iterator[Rule]:
    """What is judged of a solution on a mesh family."""
    for name, orders in predicted(regularity, family).items():
        yield order(f"order-{name}", f"order of {QUANTITIES[name]}", orders.window, name, JUDGED, PAIR)
    by_construction = Criterion("ratio", RATIO, at_least(1), _finest_ratio, ("ratio",))
    yield Observation(by_construction, "the best polynomials are those of a larger space")
    yield change("growth", f"growth of {RATIO}, finest over coarsest", GROWTH, "ratio", PAIR)
    yield largest("admissible", ADMISSIBLE, STRONGLY, "admissibility")
    yield largest("time-share", "time share of ‖σ − σ^h‖_Q", TIME, "time_share")
    in_the_maximum = order("order-sup", "order of max_n ‖σ − σ^h‖_Q", Window(), "stress_sup", JUDGED, PAIR)
    yield Observation(in_the_maximum, "the maximum is where a front lies worst in its cell, by chance on every level")


def _finest_ratio(group: pd.DataFrame) -> Measured:
    ratios = group["ratio"]
    return float(ratios.iloc[-1]), (float(ratios.min()), float(ratios.max()))

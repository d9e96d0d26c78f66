"""Theorem 4.2 on a stress space of its own: when the two formulations meet."""

from __future__ import annotations

from collections.abc import Iterator

import pandas as pd

from manufactured.regularity import Regularity
from study.fem.naming import resolve
from study.ledger.criterion import Criterion, Measured, Observation, Rule
from study.ledger.measures import change, largest, order
from study.ledger.verdict import Verdict
from study.ledger.window import Window, at_least, at_most
from study.statements.thm_4_2.predicted_orders import predicted
from study.statements.thm_4_2.stress_sweep import Stresses

JUDGED = 3
"""Orders are taken over the last levels, up to so many."""
PAIR = 2
"""Fewer levels have no order."""
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


class OwnSpace(Stresses):
    """One row for each quantity, case and mesh family."""

    label = "Thm 4.2, own space"
    claim = "Problem 3.2 on a conforming stress space of its own and Problem 3.1 meet"

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        found: list[Verdict] = []
        for (case, family), series in rows.groupby(["case", "family"], sort=False):
            levels = series.sort_values("h", ascending=False).assign(ratio=series["stress"] / series["best"])
            rules = rules_of(resolve(str(case)).regularity, str(family))
            found += [rule.verdict(self, str(case), {str(family): levels}, str(family)) for rule in rules]
        return found


def rules_of(regularity: Regularity, family: str) -> Iterator[Rule]:
    """What is judged of a solution on a mesh family."""
    for name, orders in predicted(regularity, family).items():
        yield order(f"order-{name}", f"order of {QUANTITIES[name]}", orders.window, name, JUDGED, PAIR)
    by_construction = Criterion("ratio", RATIO, at_least(1), _finest_ratio, ("ratio",))
    yield Observation(by_construction, "the best polynomials are those of a larger space")
    yield change("growth", f"growth of {RATIO}, finest over coarsest", at_most(1.25, "bounded"), "ratio", PAIR)
    yield largest("admissible", ADMISSIBLE, at_most(1e-9), "admissibility")
    yield largest("time-share", "time share of ‖σ − σ^h‖_Q", TIME, "time_share")
    in_the_maximum = order("order-sup", "order of max_n ‖σ − σ^h‖_Q", Window(), "stress_sup", JUDGED, PAIR)
    yield Observation(in_the_maximum, "the maximum is where a front lies worst in its cell, by chance on every level")


def _finest_ratio(group: pd.DataFrame) -> Measured:
    ratios = group["ratio"]
    return float(ratios.iloc[-1]), (float(ratios.min()), float(ratios.max()))

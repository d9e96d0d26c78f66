"""What else the rows of ``rates.csv`` say: of the size in (5.23), of the need for (5.36), and of the axes."""

from __future__ import annotations

import pandas as pd

from study.ledger.criterion import Observation, by_family
from study.ledger.measures import ENOUGH, between_levels, largest
from study.ledger.verdict import Verdict
from study.ledger.window import around, at_least, at_most
from study.statements.prop_5_4.evidence import over
from study.statements.prop_5_4.sweep import RATES
from study.statements.shared.base import Statement

NEAR = around(1, 0.05, "on the finest level")
GRADED = "graded"
ON_EQUAL_MESHES = ["family", "scheme", "level"]
WITH_AXES = (GRADED, "unstructured")
"""Families with meshes that depend on the axes."""
DIFFERENCE = "relative difference of"
AXES = at_most(1e-10)
_CONDITION = "round-off times the condition of the matrices, of order h⁻², in a small difference"
AXES_DISCRETE = at_most(1e-7, _CONDITION)
CHANGES = (
    largest("errors", f"{DIFFERENCE} ‖u − u^h‖_V, ‖u − Π^h u‖_V", AXES, "error", "interpolation_error"),
    largest("discrete-error", f"{DIFFERENCE} ‖Π^h u − u^h‖_V", AXES_DISCRETE, "discrete_error"),
)
"""No lower ends: the twelve digits of two bodies that are kept agree on most meshes, as fresh random ones showed."""


class SizeOfInterpolation(Statement):
    """‖u − Π^h u‖_V over its leading term, from second derivatives of u, for the cases of Proposition 5.4."""

    label = "(5.23)"
    claim = "‖v − Π^h v‖_V ≤ c h |v|_{H²}"
    file = RATES
    rules = (
        over("leading-term", "‖u − Π^h u‖_V / leading term", NEAR, "interpolation_error", "predicted_interpolation"),
    )

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        return super().judge(rows[rows["claim"] == "Prop. 5.4"])


class RegularityNeeded(Statement):
    """The order seen beside the one that the proof of Prop. 5.4 gives for a solution that misses (5.36)."""

    label = "(5.36)"
    claim = "is the regularity that Prop. 5.4 asks for needed?"
    file = RATES

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        found = []
        for case, mine in rows[rows["claim"] == "Prop. 5.3"].groupby("case", sort=False):
            proved = at_least(float(mine["proved_order"].iloc[0]), "the order that the proof gives")
            seen = between_levels("order", "order seen, on uniform meshes", proved, "error", 2, ENOUGH)
            rule = Observation(seen, "the source claims an order for (5.36) alone")
            found.append(rule.verdict(self, str(case), by_family(mine[mine["family"] != GRADED])))
        return found


class Turned(Statement):
    """The largest relative differences of errors between a body and the same in another position, on equal meshes."""

    label = "axes"
    claim = "nothing depends on the axes: a turned body has the errors of the unturned one"
    file = RATES
    rules = CHANGES

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        found = []
        turned = rows[rows["twin"].isin(rows["case"]) & (rows["twin"] != rows["case"])]
        for case, mine in turned.groupby("case", sort=False):
            twin = rows[rows["case"] == mine["twin"].iloc[0]]
            found += [rule.verdict(self, str(case), {"": changes(mine, twin)}) for rule in self.rules]
        return found


def changes(rows: pd.DataFrame, twin: pd.DataFrame) -> pd.DataFrame:
    """|e/e' − 1| of the errors e of a case and e' of its twin, without a column where they share no meshes."""
    names = [name for rule in CHANGES for name in rule.needs]
    chosen = rows[~rows["family"].isin(WITH_AXES)]
    pairs = chosen.merge(twin[[*ON_EQUAL_MESHES, *names]], on=ON_EQUAL_MESHES, suffixes=("", "_twin"))
    return pd.DataFrame({name: abs(pairs[name] / pairs[f"{name}_twin"] - 1) for name in (names if len(pairs) else ())})

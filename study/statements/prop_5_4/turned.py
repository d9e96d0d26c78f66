"""Nothing depends on the axes: errors of a body and of the same in another position."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from study.ledger.datafiles import DataFile
from study.ledger.measures import largest
from study.ledger.verdict import Verdict
from study.ledger.window import at_most
from study.statements.prop_5_4.sweep import RATES
from study.statements.shared.base import NothingMeasured

ON_EQUAL_MESHES = ["family", "scheme", "level"]
WITH_AXES = ("graded", "unstructured")
"""Families with meshes that depend on the axes."""

RULES = (
    largest(
        "errors",
        "relative difference of ‖u − u^h‖_V, ‖u − Π^h u‖_V",
        at_most(1e-10),
        "error",
        "interpolation_error",
    ),
    largest(
        "discrete-error",
        "relative difference of ‖Π^h u − u^h‖_V",
        at_most(1e-7, "round-off times the condition of the matrices, of order h⁻², in a small difference"),
        "discrete_error",
    ),
)


@dataclass(frozen=True)
class Turned(NothingMeasured):
    """The largest relative differences of errors between a case and its twin, on equal meshes."""

    label: str = "axes"
    claim: str = "nothing depends on the axes: a turned body has the errors of the unturned one"
    file: DataFile = RATES

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        found = []
        for case, mine in rows[rows["twin"].isin(rows["case"])].groupby("case", sort=False):
            twin = rows[rows["case"] == mine["twin"].iloc[0]]
            found += [rule.verdict(self, str(case), {"": changes(mine, twin)}) for rule in RULES]
        return found


def changes(rows: pd.DataFrame, twin: pd.DataFrame) -> pd.DataFrame:
    """|e/e' − 1| of the errors e of a case and e' of its twin, without a column where they share no meshes."""
    of_twin = twin[[*ON_EQUAL_MESHES, *(name for rule in RULES for name in rule.needs)]]
    pairs = rows[~rows["family"].isin(WITH_AXES)].merge(of_twin, on=ON_EQUAL_MESHES, suffixes=("", "_twin"))
    names = [name for rule in RULES for name in rule.needs] if len(pairs) else []
    return pd.DataFrame({name: abs(pairs[name] / pairs[f"{name}_twin"] - 1) for name in names})

"""The size of the interpolation error, (5.23): against its leading term, from second derivatives of u."""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from study.ledger.criterion import Criterion, Measured, by_family
from study.ledger.datafiles import DataFile
from study.ledger.measures import exactly
from study.ledger.verdict import Verdict
from study.ledger.window import around
from study.statements.prop_5_4.sweep import RATES
from study.statements.shared.base import NothingMeasured


def _ratio(group: pd.DataFrame) -> Measured:
    last = group.iloc[-1]
    return exactly(last["interpolation_error"] / last["predicted_interpolation"])


RULE = Criterion(
    "leading-term",
    "‖u − Π^h u‖_V / leading term",
    around(1, 0.05, "on the finest level"),
    _ratio,
    ("interpolation_error", "predicted_interpolation"),
)


@dataclass(frozen=True)
class SizeOfInterpolation(NothingMeasured):
    """‖u − Π^h u‖_V over its leading term, for the cases of Proposition 5.4."""

    label: str = "(5.23)"
    claim: str = "‖v − Π^h v‖_V ≤ c h |v|_{H²}"
    file: DataFile = RATES

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        mine = rows[rows["claim"] == "Prop. 5.4"].groupby("case", sort=False)
        return [RULE.verdict(self, str(case), by_family(of_case)) for case, of_case in mine]

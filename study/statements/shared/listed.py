"""Rows of the ledger about which nothing is measured."""

from __future__ import annotations

import math
from dataclasses import dataclass

import pandas as pd

from study.ledger.verdict import REPORTED, Verdict, row
from study.ledger.window import Window
from study.statements.shared.base import LISTED, Statement


@dataclass(frozen=True)
class Listed(Statement):
    """Rows of the ledger about which nothing is measured.

    Attributes:
        rows: (key, place in the source, quantity, what was made of it).
    """

    label: str
    claim: str
    rows: tuple[tuple[str, str, str, str], ...]
    file = LISTED

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        """The rows, whatever was measured."""
        nothing = math.nan, (math.nan, math.nan)
        return [
            row(self, key, quantity, Window(math.nan, math.nan), *nothing, REPORTED, place, expected=expected)
            for key, place, quantity, expected in self.rows
        ]

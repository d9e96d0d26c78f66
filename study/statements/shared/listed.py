"""Rows of the ledger about which nothing is measured."""

from __future__ import annotations

import math
from dataclasses import dataclass

import pandas as pd

from study.ledger.verdict import REPORTED, Verdict
from study.statements.base import Setting


@dataclass(frozen=True)
class Listed:
    """Rows of the ledger about which nothing is measured.

    Attributes:
        rows: (place in the source, quantity, what was made of it).
    """

    label: str
    claim: str
    rows: tuple[tuple[str, str, str], ...]

    def settings(self, full: bool) -> list[Setting]:
        return []

    def measure(self, setting: Setting) -> dict[str, float]:
        raise NotImplementedError(f"{self.label}: nothing is measured")

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        return [
            Verdict(self.label, self.claim, place, quantity, expected, math.nan, math.nan, math.nan, REPORTED)
            for place, quantity, expected in self.rows
        ]

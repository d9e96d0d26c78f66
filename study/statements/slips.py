"""Slips in the text of the source, and how they have to be read."""

from __future__ import annotations

import math
from dataclasses import dataclass

import pandas as pd

from study.statements.base import Setting
from study.verdict import REPORTED, Verdict

SLIPS = (
    ("(5.24)", "right side reads c h |v|_{H²}", "c h² |v|_{H²}: the proof of Prop. 5.4 uses h², and h² is measured"),
    ("Thm 5.2", "assumes (3.3)", "(3.1), (3.2), (3.4) and (3.5): (3.3) is an example of (3.2)"),
    ("after (5.22)", "∂Ω is the intersection of Γ1, Γ2 and Γ3", "their union"),
    ("(5.14)", "𝓛_G ‖u − u^h‖_V ‖u − v^h‖_V", "(𝓛_G/m_A) ‖u − u^h‖_V ‖u − v^h‖_V: ‖·‖_V carries A"),
    (
        "(5.28)",
        "‖u − v^h‖_{L∞(0,T;V)} in the infimum",
        "its square root, as in (5.33): (5.21) takes R^{1/2}",
    ),
    ("(5.43), last line", "right side has ‖u_ν‖_{L¹(0,T;L²(Γ3,i))}", "the norm of L¹(0,T;H²(Γ3,i)), of (5.36)"),
    ("(5.20), (5.21)", "R is taken in L¹(0,T;V)", "in L¹(0,T): R(t; v) is a number"),
)
"""(place, what is printed, how to read it)."""


@dataclass(frozen=True)
class Slips:
    """Nothing to measure: the rows say what the study took the printed text to mean."""

    label: str = "slips"
    claim: str = "slips in the printed text"

    def settings(self, full: bool) -> list[Setting]:
        return []

    def measure(self, setting: Setting) -> dict[str, float]:
        raise NotImplementedError("slips are listed, not measured")

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        return [
            Verdict(self.label, self.claim, place, printed, f"read: {reading}", math.nan, math.nan, math.nan, REPORTED)
            for place, printed, reading in SLIPS
        ]


OPEN = (
    ("Thm 4.2, 4.3", "Problem 3.2 on a conforming stress space of its own against Problem 3.1"),
    ("(4.13), strongly", "σ_τ = 0 and σν = f_2 to round-off, for stresses of that space"),
    ("fully discrete", "an error bound guaranteed without the exact solution, never below the error"),
)
"""(statement, what is not measured)."""


@dataclass(frozen=True)
class NotMeasured:
    """What the ledger should have and does not: a row says so instead of passing."""

    label: str = "not measured"
    claim: str = "needs a stress space of its own, which this study does not have"

    def settings(self, full: bool) -> list[Setting]:
        return []

    def measure(self, setting: Setting) -> dict[str, float]:
        raise NotImplementedError("nothing is measured here")

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        return [
            Verdict(self.label, self.claim, statement, quantity, "", math.nan, math.nan, math.nan, REPORTED)
            for statement, quantity in OPEN
        ]

"""Rows of the ledger, and how much of its tolerance window a row uses.

holds      the whole range lies in the window
fails      a claim of the paper, or of ours, is contradicted: the observed value lies outside the window
undecided  too few levels, or a range that reaches beyond the window; not a pass
missed     a prediction of ours was wrong: its value lies outside the predicted window, which no statement claims
reported   no claim is made about the numbers
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import pandas as pd

from study.ledger.numbered import named
from study.ledger.theorems import is_exact_quotient, is_theorem
from study.ledger.window import SMALL, Window

HOLDS, FAILS, UNDECIDED, REPORTED, MISSED = "holds", "fails", "undecided", "reported", "missed"
VERDICTS = (HOLDS, REPORTED, MISSED, UNDECIDED, FAILS)
"""From best to worst."""
ROW_KEY = ("label", "key", "case", "family")
"""The columns of ``claims.csv`` that tell its rows apart."""
UNCLAIMED = (REPORTED, MISSED)
"""Verdicts of rows about which no statement makes a claim."""
ORDER, SIZE, ONE_SIDED = "two-sided orders", "two-sided sizes", "one-sided bounds"
THEOREM, IDENTITY = "proved relations", "identities"
KINDS = (ORDER, SIZE, ONE_SIDED, THEOREM, IDENTITY)
"""Kinds of evidence, from what bears most on a claim to what fails only if the code is broken."""
CAN_FAIL = (ORDER, SIZE, ONE_SIDED)
"""Kinds of rows that can fail although the code is right."""
EXACT = 1e-6
"""An upper end, or a width, of a window up to which a row is an identity: rounding and solver tolerance, no theory."""
NOWHERE = (-math.inf, math.inf)
"""The range of a quantity that could not be measured."""
BECAUSE = "; undecided, because "
"""Separates the expected value from the reason why a row is undecided, in the column ``expected``."""
Span = tuple[float, float]
Found = tuple[float, Span, str]
"""(observed value, its range, the verdict)."""


class Named(Protocol):
    """A statement: its number and its claim in words."""

    @property
    def label(self) -> str: ...
    @property
    def claim(self) -> str: ...


@dataclass(frozen=True)
class Verdict:
    """One line of ``claims.csv``, known by its label, key, case and family.

    Attributes:
        label: number of the statement.
        statement: what is claimed, in words.
        case: the exact solution it was measured on.
        quantity: what was measured, in words.
        expected: the window, in words.
        observed: the value farthest from the middle of the window over the mesh families.
        low, high: range of the quantity over families and levels.
        verdict: holds, fails, undecided, missed or reported.
        key: short name of the quantity, which never changes.
        family: the mesh family, empty for a row about all of them.
        window_low, window_high: the window. A row that holds with a range that reaches beyond is judged by its
            observed value, or, where that lies outside, in the way that ``expected`` says.
    """

    label: str
    statement: str
    case: str
    quantity: str
    expected: str
    observed: float
    low: float
    high: float
    verdict: str
    key: str
    family: str
    window_low: float
    window_high: float

    @property
    def identity(self) -> tuple[str, str, str, str]:
        """(label, key, case, family), different for every row of a ledger."""
        return self.label, self.key, self.case, self.family


def row(
    of: Named, key: str, quantity: str, window: Window, found: Found, case: str, family: str = "", expected: str = ""
) -> Verdict:
    """Return a row; without ``expected`` it has the text of the window."""
    observed, (low, high), verdict = found
    return Verdict(
        label=of.label,
        statement=of.claim,
        case=case,
        quantity=f"{quantity}, {family} meshes" if family else quantity,
        expected=expected or window.text,
        observed=observed,
        low=low,
        high=high,
        verdict=verdict,
        key=key,
        family=family,
        window_low=window.low,
        window_high=window.high,
    )


def exit_code(verdicts: Sequence[Verdict]) -> int:
    """Return 1 if a row fails, otherwise 3 if a row is undecided or there is none, otherwise 0."""
    found = {verdict.verdict for verdict in verdicts}
    return 1 if FAILS in found else 3 if UNDECIDED in found or not found else 0


def kind(row: pd.Series) -> str:
    """Return the kind of evidence of a row of ``claims.csv``: one of ``KINDS``.

    A row is an identity if its window allows rounding only (an upper end or a width of at most ``EXACT``), or if
    ``theorems`` lists it. Proved relations, which ``theorems`` lists too, have a kind of their own. A window is
    two-sided if both ends are finite and the lower one is not 0 or a tiny part of the upper one. The key or the
    quantity of an order names it.
    """
    label, key = str(row["label"]), str(row["key"])
    low, high = float(row["window_low"]), float(row["window_high"])
    one_sided = math.isinf(low) or math.isinf(high) or 0 <= low < SMALL * high or high == 0
    if high - low <= EXACT or (one_sided and high <= EXACT) or is_exact_quotient(label, key):
        return IDENTITY
    if is_theorem(label, key):
        return THEOREM
    if one_sided:
        return ONE_SIDED
    return ORDER if "order" in f"{key} {row['quantity']}" or "-in-" in key else SIZE


def is_of_the_paper(label: str) -> bool:
    """Return whether a row is about a numbered formula or statement of the paper."""
    return bool(named(label))


def window_share(row: pd.Series) -> float:
    """Return the share of its window that a row of ``claims.csv`` uses; NaN for a row without a window of numbers.

    The share is 1 at an end of the window. It is 0 in the middle of a window with two ends, and at the value 0 if the
    low end is 0 or far below the high end.
    """
    return max((_share(value, row) for value in _judged(row)), default=math.nan)


def worst_value(row: pd.Series) -> float:
    """Return the value of a row that uses most of its window; the observed value without a window."""
    return max(_judged(row), key=lambda value: _share(value, row), default=float(row["observed"]))


def agreement(row: pd.Series) -> str:
    """Return whether the prediction of a reported row was met, wrong or undecided."""
    low, high, observed = (float(row[name]) for name in ("window_low", "window_high", "observed"))
    if math.isnan(observed):
        return "undecided"
    if not low <= observed <= high:
        return "wrong"
    return "met" if low <= row["low"] and row["high"] <= high else "undecided"


def _judged(row: pd.Series) -> list[float]:
    """Return the values that were compared with the window: the ends of the range, or the observed value of a row that
    holds although its range reaches beyond the window."""
    low, high = float(row["window_low"]), float(row["window_high"])
    if not low < high or (low <= 0 and math.isinf(high)):
        return []
    ends, observed = [float(row["low"]), float(row["high"])], float(row["observed"])
    if row["verdict"] != HOLDS or all(low <= value <= high for value in ends):
        return ends
    return [observed] if low <= observed <= high else []


def _share(value: float, row: pd.Series) -> float:
    """Return the share of the window that a value uses."""
    low, high = float(row["window_low"]), float(row["window_high"])
    if math.isinf(high):
        return low / value
    if math.isinf(low) or 0 <= low <= SMALL * high:
        return value / high
    return abs(2 * value - low - high) / (high - low)

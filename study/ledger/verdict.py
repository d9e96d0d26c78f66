"""Checks, which are the rows of the ledger: their verdicts, their kinds, and the share of the window that they use.

The verdicts:

holds      the whole range of the quantity lies in the window
fails      the observed value lies outside the window: it contradicts a claim of the paper or of this study
undecided  there are too few levels, or the range reaches beyond the window; this is not a pass
missed     a prediction of this study was wrong: the value lies outside the predicted window, which no statement claims
reported   nothing is claimed about the value
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
"""The columns of ``claims.csv`` that identify a row."""
UNCLAIMED = (REPORTED, MISSED)
"""Verdicts of rows about which no statement makes a claim."""
ORDER, SIZE, ONE_SIDED = "two-sided orders", "two-sided sizes", "one-sided bounds"
THEOREM, IDENTITY = "proved relations", "identities"
KINDS = (ORDER, SIZE, ONE_SIDED, THEOREM, IDENTITY)
"""Kinds of checks, from the strongest evidence for a claim to checks that fail only if the program is wrong."""
CAN_FAIL = (ORDER, SIZE, ONE_SIDED)
"""Kinds of checks that can fail although the program is correct."""
EXACT = 1e-6
"""A check is an identity if the upper end or the width of its window is at most this number, so that the window allows
only for rounding and the solver's tolerance."""
NOWHERE = (-math.inf, math.inf)
"""The range of a quantity that could not be measured."""
BECAUSE = "; undecided, because "
"""Separates the window from the reason why a check is undecided, in the column ``expected``."""
Span = tuple[float, float]
"""(smallest value, largest value)."""
Found = tuple[float, Span, str]
"""(observed value, its range, the verdict)."""


class Named(Protocol):
    """A statement: its label, such as "Prop. 5.4", and its claim in words."""

    @property
    def label(self) -> str: ...
    @property
    def claim(self) -> str: ...


@dataclass(frozen=True)
class Verdict:
    """One check: a row of ``claims.csv``, identified by label, key, case and family.

    Attributes:
        label: number of the statement.
        statement: the claim in words.
        case: name of the exact solution.
        quantity: the measured quantity in words.
        expected: the window in words.
        observed: the value that is shown: the one of the mesh family that uses most of the window.
        low, high: the range of the quantity over mesh families and levels.
        verdict: holds, fails, undecided, missed or reported.
        key: short name of the quantity, which never changes.
        family: the mesh family; empty for a check about all families.
        window_low, window_high: the ends of the window. If a check holds although its range reaches beyond the window,
            its observed value was judged; if that lies outside as well, ``expected`` says what was judged.
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
        """The tuple (label, key, case, family), which is different for every row of a ledger."""
        return self.label, self.key, self.case, self.family


def row(
    of: Named, key: str, quantity: str, window: Window, found: Found, case: str, family: str = "", expected: str = ""
) -> Verdict:
    """Return a check from its parts.

    Parameters:
        of: the statement.
        key, quantity, window, case, family: as for ``Verdict``.
        found: observed value, range and verdict.
        expected: the expected value in words; by default the text of the window.
    """
    observed, (low, high), verdict = found
    words = f"{quantity}, {family} meshes" if family else quantity
    numbers, ends = (observed, low, high), (window.low, window.high)
    return Verdict(of.label, of.claim, case, words, expected or window.text, *numbers, verdict, key, family, *ends)


def exit_code(verdicts: Sequence[Verdict]) -> int:
    """Return the exit code: 1 if a check fails, otherwise 3 if one is undecided or there are none, otherwise 0."""
    found = {verdict.verdict for verdict in verdicts}
    return 1 if FAILS in found else 3 if UNDECIDED in found or not found else 0


def kind(row: pd.Series) -> str:
    """Return the kind of a check: one of ``KINDS``.

    The kind follows from the window and from the lists of ``study.ledger.theorems``. A check is

    * an identity if its window only allows for rounding (``EXACT``) or if it is listed as an exact quotient;
    * a proved relation if it is listed as a theorem;
    * a one-sided bound if an end of the window is infinite, or the lower end is 0 or negligible next to the upper end;
    * a two-sided order or size otherwise: an order if its key or quantity contains this word.

    Parameters:
        row: a row of ``claims.csv``.
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
    """Return whether a label names a numbered formula or statement of the paper."""
    return bool(named(label))


def window_share(row: pd.Series) -> float:
    """Return the share of its window that a check uses, from a row of ``claims.csv``; NaN without a finite end.

    The share is 1 at an end of the window. It is 0 in the middle of a window with two ends, and at the value 0 if the
    lower end is 0 or negligible next to the upper end.
    """
    return max((_share(value, row) for value in _judged(row)), default=math.nan)


def worst_value(row: pd.Series) -> float:
    """Return the value of a check that uses most of its window; the observed value without a window."""
    return max(_judged(row), key=lambda value: _share(value, row), default=float(row["observed"]))


def agreement(found: Verdict | pd.Series) -> str:
    """Return whether the prediction of a reported or missed check was met, wrong or undecided.

    Parameters:
        found: the check, or its row of ``claims.csv``.
    """
    if found.verdict == MISSED:
        return "wrong"
    inside = found.window_low <= found.low and found.high <= found.window_high
    return "met" if inside and not math.isnan(found.observed) else "undecided"


def _judged(row: pd.Series) -> list[float]:
    """Return the values that were compared with the window.

    These are both ends of the range, or the observed value if the check holds although its range reaches beyond the
    window.
    """
    low, high = float(row["window_low"]), float(row["window_high"])
    if not low < high or (low <= 0 and math.isinf(high)):
        return []
    ends, observed = [float(row["low"]), float(row["high"])], float(row["observed"])
    if row["verdict"] != HOLDS or all(low <= value <= high for value in ends):
        return ends
    return [observed] if low <= observed <= high else []


def _share(value: float, row: pd.Series) -> float:
    low, high = float(row["window_low"]), float(row["window_high"])
    if math.isinf(high):
        return low / value
    if math.isinf(low) or 0 <= low <= SMALL * high:
        return value / high
    return abs(2 * value - low - high) / (high - low)

"""How much of its window a row of the ledger uses, from the text of the window alone.

The share is 0 for a value in the middle of a window with two ends, or at 0 for one with an upper end only, and 1 at an
end. Rows whose window is not one of numbers have no share.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable

import pandas as pd

_N = r"(-?[\d.]+(?:e-?\d+)?(?:/\d+)?(?: %)?)"
_PATTERNS: tuple[tuple[str, Callable[[list[float]], tuple[float, float]]], ...] = (
    (rf"{_N} … {_N}[^,]*, ± {_N}", lambda n: (n[0] - n[2], n[1] + n[2])),
    (rf"{_N} … {_N}[^,]*, − {_N} \+ {_N}", lambda n: (n[0] - n[2], n[1] + n[3])),
    (rf"{_N} … {_N}", lambda n: (n[0], n[1])),
    (rf"within \[{_N}, {_N}\]", lambda n: (n[0], n[1])),
    (rf"{_N} ± {_N}", lambda n: (n[0] - n[1], n[0] + n[1])),
    (rf"{_N}, − {_N} \+ {_N}", lambda n: (n[0] - n[1], n[0] + n[2])),
    (rf"(?:e∞ )?[≤<] {_N},? up to {_N}", lambda n: (-math.inf, n[0] + n[1])),
    (rf"(?:e∞ )?[≤<] {_N}", lambda n: (-math.inf, n[0])),
    (rf"≥ {_N}", lambda n: (n[0], math.inf)),
    (rf"0 up to {_N}", lambda n: (-math.inf, n[0])),
)
CARRIED = ", or carried"
"""Says that another row may stand for this one: then its own window need not be met."""


def bounds(expected: str) -> tuple[float, float] | None:
    """The ends of a window from its text, None if it is not one of numbers.

    Without the wider one that a tolerance of rounding gives, "1.5 … 2, − 0.15 + 0.2" is (1.35, 2.2).
    """
    if CARRIED in expected:
        return None
    for pattern, ends in _PATTERNS:
        match = re.match(pattern, expected)
        if match:
            return ends([_value(number) for number in match.groups()])
    return None


def used(row: pd.Series) -> float:
    """The share of its window that a row of ``claims.csv`` uses; NaN without one.

    Fitted orders are judged by their value, all others by their whole range.
    """
    window = bounds(str(row["expected"]))
    if window is None:
        return math.nan
    low, high = window
    fitted = "least squares" in str(row["expected"])
    ends = (row["observed"], row["observed"]) if fitted else (row["low"], row["high"])
    return max(_share(float(value), low, high) for value in ends)


def worst(row: pd.Series) -> float:
    """The end of a row's range, or its fitted order, that uses most of its window; what was observed without one."""
    window = bounds(str(row["expected"]))
    if window is None or "least squares" in str(row["expected"]):
        return float(row["observed"])
    return max((float(row[name]) for name in ("low", "high")), key=lambda value: _share(value, *window))


def _share(value: float, low: float, high: float) -> float:
    if math.isinf(low):
        return value / high
    if math.isinf(high):
        return low / value
    return abs(2 * value - low - high) / (high - low)


def _value(text: str) -> float:
    number, percent = text.removesuffix(" %"), text.endswith(" %")
    numerator, _, denominator = number.partition("/")
    return float(numerator) / float(denominator or 1) / (100 if percent else 1)

"""How a row of the ledger lies in its window: how much of it it uses, or whether a prediction agrees.

The share is 0 for a value in the middle of a window with two ends, or at 0 for one whose low end asks for no size, and
1 at an end. Rows without a window of numbers have no share.
"""

from __future__ import annotations

import math

import pandas as pd

from study.ledger.verdict import HOLDS
from study.ledger.window import SMALL


def used(row: pd.Series) -> float:
    """The share of its window that a row of ``claims.csv`` uses; not a number without one."""
    return max((_share(value, row) for value in _judged(row)), default=math.nan)


def worst(row: pd.Series) -> float:
    """Of the values by which a row was judged the one that uses most of its window; what was observed without one."""
    return max(_judged(row), key=lambda value: _share(value, row), default=float(row["observed"]))


def agreement(row: pd.Series) -> str:
    """How a row that is only reported meets its prediction: agrees, differs, or undecided."""
    low, high, observed = (float(row[name]) for name in ("window_low", "window_high", "observed"))
    if math.isnan(observed):
        return "undecided"
    if not low <= observed <= high:
        return "differs"
    return "agrees" if low <= row["low"] and row["high"] <= high else "undecided"


def _judged(row: pd.Series) -> list[float]:
    """The values that were compared with the window: the ends of the range, but for a row that holds with a range
    beyond it. Such a row is judged by its observed value, or in another way if that lies outside, too."""
    low, high = float(row["window_low"]), float(row["window_high"])
    if not low < high or (low <= 0 and math.isinf(high)):
        return []
    ends, observed = [float(row["low"]), float(row["high"])], float(row["observed"])
    if row["verdict"] != HOLDS or all(low <= value <= high for value in ends):
        return ends
    return [observed] if low <= observed <= high else []


def _share(value: float, row: pd.Series) -> float:
    """The part of a window; of one whose low end is 0, −∞ or far below its high end that up to its high end."""
    low, high = float(row["window_low"]), float(row["window_high"])
    if math.isinf(high):
        return low / value
    if math.isinf(low) or 0 <= low <= SMALL * high:
        return value / high
    return abs(2 * value - low - high) / (high - low)

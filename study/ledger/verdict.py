"""What a row of the ledger is, and how a measured range meets a window that was fixed before.

holds      the whole range lies in the window
fails      the observed value lies outside
undecided  too few levels, or a range too wide to tell; not a pass
reported   no claim is made, the numbers stand for themselves
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

HOLDS, FAILS, UNDECIDED, REPORTED = "holds", "fails", "undecided", "reported"


@dataclass(frozen=True)
class Verdict:
    """One line of ``claims.csv``.

    Attributes:
        label: number of the statement.
        statement: what is claimed, in words.
        case: the exact solution it was measured on.
        quantity: what was measured.
        expected: the window, as text.
        observed: the value farthest from the middle of the window over the mesh families.
        low, high: range of the quantity over families and levels.
        verdict: holds, fails, undecided or reported.
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


@dataclass(frozen=True)
class Window:
    """[low, high] for a quantity, with the reason as text."""

    low: float
    high: float
    text: str

    def judge(self, observed: list[float], ranges: list[tuple[float, float]]) -> tuple[float, float, float, str]:
        """(worst observed, low, high, verdict) of values with their ranges."""
        # Without a positive lower end, only large values are bad.
        middle = (self.low + self.high) / 2
        distances = [abs(v - middle) if self.low > 0 else v for v in observed]
        worst = observed[int(np.argmax(np.nan_to_num(distances, nan=np.inf)))]
        low, high = min(r[0] for r in ranges), max(r[1] for r in ranges)
        if not all(self.low <= value <= self.high for value in observed):
            return worst, low, high, FAILS
        return worst, low, high, HOLDS if self.low <= low and high <= self.high else UNDECIDED

"""What a row of the ledger is.

holds      the whole range lies in the window
fails      the observed value lies outside
undecided  too few levels, or a range too wide to tell; not a pass
reported   no claim is made, the numbers stand for themselves
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from study.ledger.window import Window

HOLDS, FAILS, UNDECIDED, REPORTED = "holds", "fails", "undecided", "reported"
VERDICTS = (HOLDS, REPORTED, UNDECIDED, FAILS)
"""From best to worst."""
NOWHERE = (-math.inf, math.inf)
"""The range of what could not be measured."""
BECAUSE = "; undecided, because "
"""What stands in ``expected`` between what is expected and why it cannot be decided."""
Span = tuple[float, float]
Found = tuple[float, Span, str]
"""(observed value, its range, the verdict)."""


class Named(Protocol):
    """What a row takes from its statement: the number and what it says."""

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
        verdict: holds, fails, undecided or reported.
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
    """A row; without ``expected`` the text of the window says what is expected."""
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


def all_pass(verdicts: Sequence[Verdict]) -> bool:
    """Whether there are verdicts and every claim holds; undecided is no pass, and what is reported claims nothing."""
    return bool(verdicts) and all(verdict.verdict in (HOLDS, REPORTED) for verdict in verdicts)

"""Constants of inequalities: they must never be exceeded, and may or may not be the best ones."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from study.ledger.verdict import FAILS, REPORTED, Verdict, Window
from study.statements.base import Statement
from study.statements.tally import Groups, largest

ROUNDING = 1e-9
"""Room for rounding in bounds that hold exactly."""

BOUND = Window(-math.inf, 1 + ROUNDING, "≤ 1")
"""For quotients over a constant that none may exceed."""

SHARP = Window(0.99, 1 + ROUNDING, "≤ 1, and ≥ 0.99 if the constant is the best")
"""For the largest quotients over a constant; samples built to attain the best constant attain it up to rounding."""


@dataclass(frozen=True)
class Constant:
    """The largest quotient over a constant: nothing claims that it is the best one, so one that is not is reported.

    Attributes:
        quantity: the quotient, in words.
        column: where it is.
    """

    quantity: str
    column: str

    def verdict(self, statement: Statement, case: str, groups: Groups) -> Verdict:
        """The row for a case."""
        found = largest(self.quantity, SHARP, self.column).verdict(statement, case, groups)
        below = found.verdict == FAILS and found.high <= SHARP.high
        return replace(found, verdict=REPORTED) if below else found

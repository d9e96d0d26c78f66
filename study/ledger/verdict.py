"""Checks, which are the rows of the ledger: their verdicts, their kinds, and how much of their window they use.

The label of a check names the numbered formulas and statements of the paper that it tests, for example "(3.9)–(3.11),
(4.14), (4.15)" or "Thm 4.1, 5.2". No other place has this information.

A check compares a measured quantity with a tolerance window. The verdicts are:

holds      the whole range of the quantity over meshes lies in the window
fails      the value lies outside the window: it contradicts a claim of the paper or of this study
undecided  there are too few levels, or the range reaches beyond the window; this is not a pass
missed     a prediction of this study was wrong: the value lies outside the predicted window, which no statement claims
reported   nothing is claimed about the value
"""

import re
from dataclasses import dataclass
from enum import StrEnum
from math import inf, isinf, isnan, nan
from typing import Protocol

from pandas import Series

from convergence_orders.orders import FAILS as FAILS
from convergence_orders.orders import HOLDS as HOLDS
from convergence_orders.orders import UNDECIDED as UNDECIDED
from study.ledger.window import Window, is_two_sided, position

NO_ROW = "no row"
NOT_TESTED = "not tested"
"""Labels of rows that give the reason why a formula or statement of the paper has no check that can fail."""

_FORMULA = re.compile(r"\((\d)\.(\d+)\)(?:–\((\d)\.(\d+)\))?")
_STATEMENT = re.compile(r"(Thm|Prop\.|Problem) (\d\.\d(?:, \d\.\d)*)")


def named(text: str) -> set[str]:
    """Return the formulas and statements that the label of a check names, as a set of texts.

    Raises:
        ValueError: a range of formulas begins and ends in different sections.

    >>> sorted(named("Thm 4.1, 5.2, (5.2)–(5.4)"))
    ['(5.2)', '(5.3)', '(5.4)', 'Thm 4.1', 'Thm 5.2']
    """
    found = {f"{kind} {number}" for kind, numbers in _STATEMENT.findall(text) for number in numbers.split(", ")}
    for section, first, last_section, last in _FORMULA.findall(text):
        end = int(last or first)
        if last_section not in ("", section):
            raise ValueError(f"{text!r} has a range over two sections, expected one section: write a range for each")
        found |= {f"({section}.{n})" for n in range(int(first), end + 1)}
    return found


REPORTED = "reported"
MISSED = "missed"
VERDICTS = (HOLDS, REPORTED, MISSED, UNDECIDED, FAILS)
"""The possible verdicts on a check, from best to worst."""
ROW_KEY = ("label", "key", "case", "family")
"""The columns of ``claims.csv`` that identify a row."""
UNCLAIMED = (REPORTED, MISSED)
"""Verdicts on checks for which no statement makes a claim."""
NOWHERE = (-inf, inf)
"""The range (lowest, highest value) of a quantity that could not be measured."""
BECAUSE = "; undecided, because "
"""Separates, in the column ``expected``, the window from the reason why a check is undecided."""
Span = tuple[float, float]
"""The range of a quantity: smallest value, largest value."""
Found = tuple[float, Span, str]
"""The result of a check: observed value, its range over meshes, and the verdict."""


class CheckKind(StrEnum):
    """What a check tests.

    CLAIM: a claim of the paper. CONSEQUENCE: a prediction that follows from the theory of the paper or of this study.
    ACCURACY: errors that are not the subject of a claim, such as errors of time steps or quadrature, are small.
    IDENTITY: a relation that is proved for every mesh, so that it fails only if the program or the proof is wrong.
    """

    CLAIM = "claim"
    CONSEQUENCE = "consequence"
    ACCURACY = "accuracy"
    IDENTITY = "identity"


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
        label: number of the statement, such as "Prop. 5.4".
        statement: the claim in words.
        case: name of the exact solution.
        quantity: the measured quantity in words.
        expected: the tolerance window in words.
        observed: the value that is shown. With several mesh families, it is the value that uses most of the window.
        low, high: the range of the quantity over mesh families and levels.
        verdict: holds; fails; undecided; missed, if a prediction of this study was wrong; reported, if nothing is
            claimed about the value.
        key: short name of the quantity, which never changes.
        family: the mesh family; empty for a check about all families.
        kind: what the check tests: claim, consequence, accuracy or identity; empty if nothing is measured.
        window_low, window_high: the ends of the window. Most checks hold if the whole range from ``low`` to ``high``
            lies in it. Some judge only the observed value, and a few another number, which ``expected`` names.
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
    kind: str
    window_low: float
    window_high: float

    @property
    def identity(self) -> tuple[str, ...]:
        """Label, key, case and family, which together identify a row of the ledger."""
        return self.label, self.key, self.case, self.family


Verdicts = list[Verdict]


def row(
    of: Named,
    key: str,
    quantity: str,
    window: Window,
    found: Found,
    case: str,
    family: str = "",
    expected: str = "",
    kind: str = "",
) -> Verdict:
    """Return the verdict on a check, that is, one row of the ledger, from its parts.

    Parameters:
        of: the statement, with its label and claim.
        key, case, family: as described in ``Verdict``.
        quantity: the measured quantity in words; the mesh family is added to them.
        window: the tolerance window.
        found: observed value, its range (low, high), and the verdict.
        expected: the tolerance window in words; by default the text of ``window``.
        kind: what the check tests, a ``CheckKind``; empty if nothing is measured.
    """
    observed, (low, high), verdict = found
    words = f"{quantity}, {family} meshes" if family else quantity
    return Verdict(
        of.label,
        of.claim,
        case,
        words,
        expected or window.text,
        observed,
        low,
        high,
        verdict,
        key,
        family,
        kind,
        window.low,
        window.high,
    )


def exit_code(verdicts: Verdicts) -> int:
    """Return the exit code of a command that judges.

    It is 1 if a check fails. Otherwise, it is 3 if a check is undecided or there are no checks, and 0 if not.
    """
    found = {verdict.verdict for verdict in verdicts}
    return 1 if FAILS in found else 3 if UNDECIDED in found or not found else 0


def window_share(row: Series) -> float:
    """Return how near a check is to the end of its tolerance window, as a share of the window.

    The result is 1 for a value at an end of the window. It is 0 for a value in the middle of a window with two ends. If
    the lower end is 0 or negligible next to the upper end, it is 0 for the value 0. It is NaN if no end is finite.

    Parameters:
        row: a row of ``claims.csv``.
    """
    return max(_shares(row), default=(nan, nan))[0]


def worst_value(row: Series) -> float:
    """Return the worst value of a check: nearest to an end of its tolerance window, or farthest outside.

    If there is no window, it is the observed value.

    Parameters:
        row: a row of ``claims.csv``.
    """
    return max(_shares(row), default=(nan, row.observed))[1]


def agreement(found: Verdict | Series) -> str:
    """Return whether a prediction, for which no claim is made, was met, wrong or undecided.

    Parameters:
        found: the check with the verdict *reported* or *missed*, or its row of ``claims.csv``.
    """
    if found.verdict == MISSED:
        return "wrong"
    inside = found.window_low <= found.low and found.high <= found.window_high
    return "met" if inside and not isnan(found.observed) else "undecided"


def _shares(row: Series) -> list[tuple[float, float]]:
    """Return the values of a check that were compared with its tolerance window, each after the share that it uses.

    These are both ends of the range. If the check holds although its range reaches beyond the window, it is the
    observed value alone.
    """
    low = row.window_low
    high = row.window_high
    if not low < high or (low <= 0 and isinf(high)):
        return []
    window = Window(low, high)
    judged = [row.low, row.high]
    if row.verdict == HOLDS and not window.contains(*judged):
        judged = [row.observed] if window.contains(row.observed) else []
    positions = [position(value, low, high) for value in judged]
    shares = map(abs, positions) if is_two_sided(low, high) else positions
    return list(zip(shares, judged, strict=True))

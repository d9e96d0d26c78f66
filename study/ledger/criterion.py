"""Criteria: from measurements on the levels of some mesh families to rows of the ledger.

The first part defines criteria, the second part those that most statements use: extreme values, values on the finest
level, observed orders.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import pandas as pd

from study.ledger.orders import Array, RatesError, extrapolated_order, fit, orders, weighted_order
from study.ledger.verdict import (
    BECAUSE,
    FAILS,
    HOLDS,
    MISSED,
    NOWHERE,
    REPORTED,
    UNDECIDED,
    Found,
    Named,
    Span,
    Verdict,
    row,
)
from study.ledger.window import Window, at_most

Groups = dict[str, pd.DataFrame]
"""Mesh family ↦ table of its levels, coarse to fine, with the columns level, h and the quantities."""

Measured = tuple[float, Span]
"""(observed value, its range)."""

Measure = Callable[[pd.DataFrame], Measured | None]
"""Table of the levels of one family ↦ measured value; None if these levels do not decide."""


def by_family(rows: pd.DataFrame) -> Groups:
    """Return the rows of each mesh family, coarse to fine."""
    return {str(name): group.sort_values("h", ascending=False) for name, group in rows.groupby("family", sort=False)}


def by_case(rows: pd.DataFrame) -> Iterator[tuple[str, Groups]]:
    """Yield (case, table per mesh family) from measurements that are listed one number in a row."""
    for case, of_case in rows.groupby("case", sort=False):
        groups = {}
        for family, of_family in of_case.groupby("family", sort=False):
            table = of_family.pivot(index=["level", "h"], columns="quantity", values="value")
            groups[str(family)] = table.reset_index().sort_values("h", ascending=False)
        yield str(case), groups


class Rule(Protocol):
    """A rule gives one row of the ledger for each case."""

    def verdict(self, of: Named, case: str, groups: Groups, family: str = "") -> Verdict: ...


@dataclass(frozen=True)
class Criterion:
    """A quantity that has to lie in a tolerance window.

    Attributes:
        key: short name of the row.
        quantity: its name in words.
        window: the tolerance window.
        measure: computes it from the levels of one family.
        needs: the columns that ``measure`` reads.
        levels: with fewer levels the verdict is undecided.
    """

    key: str
    quantity: str
    window: Window
    measure: Measure
    columns: tuple[str, ...]
    levels: int = 1

    def verdict(self, of: Named, case: str, groups: Groups, family: str = "") -> Verdict:
        """Return the row for a case: undecided if the levels of one family do not decide."""
        complete = [group for group in groups.values() if all(name in group for name in self.columns)]
        enough = [group for group in complete if len(group) >= self.levels]
        found = [value for group in enough if (value := self.measure(group)) is not None]
        decided = bool(found) and len(found) == len(groups)
        judged = self._judge(found) if decided else (math.nan, NOWHERE, UNDECIDED)
        fewest = min(map(len, groups.values()), default=0)
        short = f"{BECAUSE}it takes {self.levels} levels, not {fewest}" if fewest < self.levels else ""
        return row(of, self.key, self.quantity, self.window, judged, case, family, f"{self.window.text}{short}")

    def _judge(self, found: Sequence[Measured]) -> Found:
        values, spans = [value for value, _ in found], [span for _, span in found]
        span = float(np.min([low for low, _ in spans])), float(np.max([high for _, high in spans]))
        inside = self.window.contains(*span)
        verdict = FAILS if not self.window.contains(*values) else HOLDS if inside else UNDECIDED
        return self.window.worst(values), span, verdict


@dataclass(frozen=True)
class Observation:
    """A quantity without a claim, for a reason: reported, or missed if our prediction was wrong.

    The window of its criterion is the prediction, an unbounded one if there is none.
    """

    criterion: Criterion
    reason: str

    def verdict(self, of: Named, case: str, groups: Groups, family: str = "") -> Verdict:
        """Return the row for a case, which says whether the prediction agrees."""
        found = self.criterion.verdict(of, case, groups, family)
        prediction = {HOLDS: "met", FAILS: "wrong", UNDECIDED: "undecided"}[found.verdict]
        if math.isnan(found.observed):
            prediction = "undecided"
        if self.criterion.window == Window():
            return replace(found, expected=f"no claim: {self.reason}", verdict=REPORTED)
        expected = f"predicted {self.criterion.window.text} ({prediction}); no claim, because {self.reason}"
        return replace(found, expected=expected, verdict=MISSED if prediction == "wrong" else REPORTED)


def judge(of: Named, rows: pd.DataFrame, rules: Sequence[Rule]) -> list[Verdict]:
    """Return the rows of all rules on all cases, from measurements that are listed one number in a row."""
    return [rule.verdict(of, case, groups) for case, groups in by_case(rows) for rule in rules]


ENOUGH = 3
"""Levels that an observed order takes at least."""
ROUNDING = 1e-9
"""Room for rounding in bounds that hold exactly."""
BOUND = at_most(1 + ROUNDING, low=-math.inf)
"""Window of quotients that are at most 1."""
SHARP = Window(0.99, 1 + ROUNDING, "≥ 0.99 shows that the constant is the best possible")
"""Window of the largest quotient over a constant, which samples built for the best constant attain up to rounding."""


def largest(key: str, quantity: str, window: Window, *columns: str) -> Criterion:
    """Return the criterion for the largest value of some columns over all levels; NaN if one value is NaN."""
    return Criterion(key, quantity, window, lambda group: greatest(group[list(columns)].to_numpy()), columns)


def largest_quotient(key: str, quantity: str, window: Window, above: str, below: str) -> Criterion:
    """Return the criterion for the largest quotient of two columns over all levels."""

    def measure(group: pd.DataFrame) -> Measured:
        return greatest((group[above] / group[below]).to_numpy())

    return Criterion(key, quantity, window, measure, (above, below))


def every(key: str, quantity: str, window: Window, *columns: str) -> Criterion:
    """Return the criterion for some columns on every level; shows the value farthest from the middle of the window."""

    def measure(group: pd.DataFrame) -> Measured:
        values = group[list(columns)].to_numpy().ravel()
        away = np.nan_to_num(abs(values - (window.low + window.high) / 2), nan=np.inf)
        return among(values[away.argmax()], values)

    return Criterion(key, quantity, window, measure, columns)


def finest(key: str, quantity: str, window: Window, column: str) -> Criterion:
    """Return the criterion for a column on the finest level."""
    return Criterion(key, quantity, window, lambda group: exactly(group[column].iloc[-1]), (column,))


def change(key: str, quantity: str, window: Window, column: str, levels: int = ENOUGH, since: int = 0) -> Criterion:
    """Return the criterion for the quotient of a column on the finest level and on level number ``since``."""

    def measure(group: pd.DataFrame) -> Measured:
        return exactly(group[column].iloc[-1] / group[column].iloc[since])

    return Criterion(key, quantity, window, measure, (column,), levels)


def greatest_ratio(key: str, quantity: str, window: Window, column: str, levels: int) -> Criterion:
    """Return the criterion for the largest ratio of a column on consecutive levels."""

    def measure(group: pd.DataFrame) -> Measured:
        values = group[column].to_numpy()
        return greatest(values[1:] / values[:-1])

    return Criterion(key, quantity, window, measure, (column,), levels)


def consecutive(key: str, quantity: str, window: Window, column: str) -> Criterion:
    """Return the criterion for every observed order from level to level; the finest one is shown."""

    def measure(group: pd.DataFrame) -> Measured:
        found = orders(*_errors(group, column))
        return among(found[-1], found)

    return Criterion(key, quantity, window, or_none(measure), (column,), ENOUGH)


def between_levels(key: str, quantity: str, window: Window, column: str, refinements: int, levels: int) -> Criterion:
    """Return the criterion for the observed order between the finest level and the one some refinements before."""

    def measure(group: pd.DataFrame) -> Measured:
        return exactly(orders(*_errors(group.iloc[[-1 - refinements, -1]], column))[0])

    return Criterion(key, quantity, window, or_none(measure), (column,), levels)


def order(key: str, quantity: str, window: Window, column: str, last: int = 0, levels: int = ENOUGH) -> Criterion:
    """Return the criterion for the observed order of a column, by least squares over all levels or the last ones."""

    def measure(group: pd.DataFrame) -> Measured:
        return exactly(fit(*_errors(group.tail(last) if last else group, column)))

    return Criterion(key, quantity, window, or_none(measure), (column,), levels)


def weighted(
    key: str, quantity: str, window: Window, column: str, power: int, last: int = 0, levels: int = ENOUGH
) -> Criterion:
    """Return the criterion for the observed order by least squares with weights h^−power."""

    def measure(group: pd.DataFrame) -> Measured:
        return exactly(weighted_order(*_errors(group.tail(last) if last else group, column), power))

    return Criterion(key, quantity, window, or_none(measure), (column,), levels)


def growth(key: str, quantity: str, window: Window, column: str, power: int, levels: int) -> Criterion:
    """Return the criterion for the growth from the coarsest to the finest level, by the same weighted least squares."""

    def measure(group: pd.DataFrame) -> Measured:
        h, values = _errors(group, column)
        return exactly((h[-1] / h[0]) ** weighted_order(h, values, power))

    return Criterion(key, quantity, window, or_none(measure), (column,), levels)


def extrapolated(key: str, quantity: str, window: Window, column: str) -> Criterion:
    """Return the criterion for the observed order extrapolated from the three finest levels."""

    def measure(group: pd.DataFrame) -> Measured:
        return exactly(extrapolated_order(*_errors(group, column)))

    return Criterion(key, quantity, window, or_none(measure), (column,), ENOUGH)


def exactly(value: float) -> Measured:
    """Return a value whose range is the value itself."""
    return float(value), (float(value), float(value))


def among(shown: float, values: Array) -> Measured:
    """Return a value with the range of all values."""
    return float(shown), (float(values.min()), float(values.max()))


def greatest(values: Array) -> Measured:
    """Return the largest value with the range of all values."""
    return among(values.max(), values)


def _errors(group: pd.DataFrame, column: str) -> tuple[Array, Array]:
    return group["h"].to_numpy(), group[column].to_numpy()


def or_none(measure: Measure) -> Measure:
    """Return a measure that gives NaN, so that the verdict fails, where errors have no order."""

    def measured(table: pd.DataFrame) -> Measured | None:
        try:
            return measure(table)
        except RatesError:
            return exactly(math.nan)

    return measured

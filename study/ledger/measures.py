"""Criteria for what is looked at most often: extreme values, values on the finest level, orders of convergence."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from study.ledger.criterion import Criterion, Groups, Measure, Measured
from study.ledger.orders import Array, RatesError, fit, orders, weighted_order
from study.ledger.verdict import FAILS, REPORTED, Named, Verdict
from study.ledger.window import Window, at_most

ENOUGH = 3
"""Fewer levels leave an order undecided."""
ROUNDING = 1e-9
"""Room for rounding in bounds that hold exactly."""
BOUND = at_most(1 + ROUNDING, low=-math.inf)
"""For quotients over a constant that none may exceed."""
SHARP = Window(0.99, 1 + ROUNDING, "≥ 0.99 only if the constant is the best")
"""For the largest quotients over a constant; samples built to attain the best constant attain it up to rounding."""


def largest(key: str, quantity: str, window: Window, *columns: str) -> Criterion:
    """The largest value of some columns over all levels; not a number if one of them is none."""
    return Criterion(key, quantity, window, lambda group: greatest(group[list(columns)].to_numpy()), columns)


def largest_quotient(key: str, quantity: str, window: Window, above: str, below: str) -> Criterion:
    """Return the criterion for the largest quotient of two columns over all levels."""

    def measure(group: pd.DataFrame) -> Measured:
        return greatest((group[above] / group[below]).to_numpy())

    return Criterion(key, quantity, window, measure, (above, below))


def every(key: str, quantity: str, window: Window, *columns: str) -> Criterion:
    """Some columns on every level; what is farthest from the middle of the window is shown."""

    def measure(group: pd.DataFrame) -> Measured:
        values = group[list(columns)].to_numpy().ravel()
        away = np.nan_to_num(abs(values - (window.low + window.high) / 2), nan=np.inf)
        return among(values[away.argmax()], values)

    return Criterion(key, quantity, window, measure, columns)


def finest(key: str, quantity: str, window: Window, column: str) -> Criterion:
    """A column on the finest level."""
    return Criterion(key, quantity, window, lambda group: exactly(group[column].iloc[-1]), (column,))


def change(key: str, quantity: str, window: Window, column: str, levels: int = ENOUGH, since: int = 0) -> Criterion:
    """A column on the finest level over the same on the coarsest, or on the one at another place."""

    def measure(group: pd.DataFrame) -> Measured:
        return exactly(group[column].iloc[-1] / group[column].iloc[since])

    return Criterion(key, quantity, window, measure, (column,), levels)


def greatest_ratio(key: str, quantity: str, window: Window, column: str, levels: int) -> Criterion:
    """The largest ratio of a column on consecutive levels."""

    def measure(group: pd.DataFrame) -> Measured:
        values = group[column].to_numpy()
        return greatest(values[1:] / values[:-1])

    return Criterion(key, quantity, window, measure, (column,), levels)


def consecutive(key: str, quantity: str, window: Window, column: str) -> Criterion:
    """Every order from level to level; the finest one is shown."""

    def measure(group: pd.DataFrame) -> Measured:
        found = orders(*_errors(group, column))
        return among(found[-1], found)

    return Criterion(key, quantity, window, or_none(measure), (column,), ENOUGH)


def between_levels(key: str, quantity: str, window: Window, column: str, refinements: int, levels: int) -> Criterion:
    """The order between the finest level and the one so many refinements before."""

    def measure(group: pd.DataFrame) -> Measured:
        return exactly(orders(*_errors(group.iloc[[-1 - refinements, -1]], column))[0])

    return Criterion(key, quantity, window, or_none(measure), (column,), levels)


def order(key: str, quantity: str, window: Window, column: str, last: int = 0, levels: int = ENOUGH) -> Criterion:
    """The order in h of a column, by least squares over all levels or the last ones; none without positive values."""

    def measure(group: pd.DataFrame) -> Measured:
        return exactly(fit(*_errors(group.tail(last) if last else group, column)).order)

    return Criterion(key, quantity, window, or_none(measure), (column,), levels)


def weighted(
    key: str, quantity: str, window: Window, column: str, power: int, last: int = 0, levels: int = ENOUGH
) -> Criterion:
    """The order in h by least squares with weights h^−power over all levels or the last ones."""

    def measure(group: pd.DataFrame) -> Measured:
        return exactly(weighted_order(*_errors(group.tail(last) if last else group, column), power))

    return Criterion(key, quantity, window, or_none(measure), (column,), levels)


def growth(key: str, quantity: str, window: Window, column: str, power: int, levels: int) -> Criterion:
    """What a column grows by from the coarsest level to the finest, by the same least squares over all levels."""

    def measure(group: pd.DataFrame) -> Measured:
        h, values = _errors(group, column)
        return exactly((h[-1] / h[0]) ** weighted_order(h, values, power))

    return Criterion(key, quantity, window, or_none(measure), (column,), levels)


def fitted(key: str, quantity: str, window: Window, column: str, last: int, spread: Window) -> Criterion:
    """The same over the last levels with its interval at 95 %, which must lie in ``spread``."""

    def measure(group: pd.DataFrame) -> Measured:
        line = fit(*_errors(group.tail(last), column))
        return line.order, (line.low, line.high)

    return Criterion(key, quantity, window, or_none(measure), (column,), ENOUGH, spread)


def exactly(value: float) -> Measured:
    """A value that is its own range."""
    return float(value), (float(value), float(value))


def among(shown: float, values: Array) -> Measured:
    """A value with the range of all."""
    return float(shown), (float(values.min()), float(values.max()))


def greatest(values: Array) -> Measured:
    """The largest value with the range of all."""
    return among(values.max(), values)


def _errors(group: pd.DataFrame, column: str) -> tuple[Array, Array]:
    return group["h"].to_numpy(), group[column].to_numpy()


def or_none(measure: Measure) -> Measure:
    """Not a number where errors have no order, so that the verdict fails."""

    def measured(table: pd.DataFrame) -> Measured | None:
        try:
            return measure(table)
        except RatesError:
            return exactly(math.nan)

    return measured


@dataclass(frozen=True)
class Constant:
    """The largest quotient over a constant: nothing claims that it is the best one, so one that is not is reported."""

    key: str
    quantity: str
    column: str

    def verdict(self, of: Named, case: str, groups: Groups, family: str = "") -> Verdict:
        """The row for a case."""
        found = largest(self.key, self.quantity, SHARP, self.column).verdict(of, case, groups, family)
        below = found.verdict == FAILS and found.high <= SHARP.high
        return replace(found, verdict=REPORTED) if below else found

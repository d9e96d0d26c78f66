"""Criteria: each computes a quantity from measurements and compares it with its tolerance window.

A criterion gives one check, which is one row of the ledger, for each case. The first part of this file defines
criteria. The second part has functions that make frequent ones: extreme values, values on the finest level, observed
orders.
"""

import math
from collections.abc import Callable, Iterator
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
    agreement,
    row,
)
from study.ledger.window import Window, at_most

Groups = dict[str, pd.DataFrame]
"""Mesh family ↦ table of its levels, coarse to fine, with the columns level, h and the measured quantities."""

Measured = tuple[float, Span]
"""A measured quantity: the value that is shown, and the smallest and the largest of all values."""

Measure = Callable[[pd.DataFrame], Measured | None]
"""Function that computes a quantity from the levels of one mesh family; None if these levels do not determine it."""


def by_family(rows: pd.DataFrame) -> Groups:
    """Divide a table by mesh families, and return a dictionary: name of the family ↦ its rows, coarse to fine."""
    return {str(name): group.sort_values("h", ascending=False) for name, group in rows.groupby("family", sort=False)}


def by_case(rows: pd.DataFrame) -> Iterator[tuple[str, Groups]]:
    """Divide a table by cases, and yield each case with its measurements on each mesh family.

    Parameters:
        rows: a table with one number in each row: columns case, family, level, h, quantity, value.

    Yields:
        Pairs (case, tables). The dictionary has for each mesh family a table with one row for each level and one column
        for each quantity.
    """
    for case, of_case in rows.groupby("case", sort=False):
        groups = {}
        for family, of_family in of_case.groupby("family", sort=False):
            table = of_family.pivot(index=["level", "h"], columns="quantity", values="value")
            groups[str(family)] = table.reset_index().sort_values("h", ascending=False)
        yield str(case), groups


class Rule(Protocol):
    """A criterion or an observation: it judges the measurements of a case and returns one check."""

    def verdict(self, of: Named, case: str, groups: Groups, family: str = "") -> Verdict:
        """Judge the measurements of one case, and return the check.

        Parameters:
            of: the statement, with its label and claim.
            case: name of the case.
            groups: mesh family ↦ table of its levels, coarse to fine.
            family: the mesh family, if the check is about one family only.
        """
        ...


@dataclass(frozen=True)
class Criterion:
    """A quantity that must lie in a tolerance window.

    Attributes:
        key: short name of the check.
        quantity: the quantity in words.
        window: the tolerance window.
        measure: function that computes the quantity from the levels of one mesh family.
        columns: the columns of the table that ``measure`` reads.
        levels: the least number of levels; with fewer levels the check is undecided.
    """

    key: str
    quantity: str
    window: Window
    measure: Measure
    columns: tuple[str, ...]
    levels: int = 1

    def verdict(self, of: Named, case: str, groups: Groups, family: str = "") -> Verdict:
        """Judge the measurements of one case, and return the check; the parameters are described in ``Rule.verdict``.

        The check fails if the value of one mesh family lies outside the window. It is undecided if a family has too few
        levels or lacks a column, or if the range of the values on single levels reaches beyond the window. Otherwise it
        holds.
        """
        usable = (group for group in groups.values() if len(group) >= self.levels and {*self.columns} <= {*group})
        measured = [found for group in usable if (found := self.measure(group)) is not None]
        if not measured or len(measured) < len(groups):
            judged: Found = (math.nan, NOWHERE, UNDECIDED)
        else:
            values = [value for value, _ in measured]
            spans = np.array([span for _, span in measured])
            low, high = float(spans[:, 0].min()), float(spans[:, 1].max())
            inside = HOLDS if self.window.contains(low, high) else UNDECIDED
            verdict = inside if self.window.contains(*values) else FAILS
            judged = self.window.worst(values), (low, high), verdict
        fewest = min(map(len, groups.values()), default=0)
        short = f"{BECAUSE}the check needs {self.levels} levels, and has {fewest}" if fewest < self.levels else ""
        return row(of, self.key, self.quantity, self.window, judged, case, family, f"{self.window.text}{short}")


@dataclass(frozen=True)
class Observation:
    """A quantity about which no claim is made, perhaps with a prediction of this study.

    A wrong prediction gives a check with the verdict *missed*, which is no failure.

    Attributes:
        criterion: the quantity. Its window is the prediction; an unbounded window means that there is no prediction.
        reason: why no claim is made.
    """

    criterion: Criterion
    reason: str

    def verdict(self, of: Named, case: str, groups: Groups, family: str = "") -> Verdict:
        """Compare the measurements of one case with the prediction; the parameters are described in ``Rule.verdict``.

        The verdict is *missed* if the prediction is wrong, otherwise *reported*.
        """
        found = self.criterion.verdict(of, case, groups, family)
        if self.criterion.window == Window():
            return replace(found, expected=f"no claim: {self.reason}", verdict=REPORTED)
        missed = found.verdict == FAILS and not math.isnan(found.observed)
        found = replace(found, verdict=MISSED if missed else REPORTED)
        text = f"predicted {self.criterion.window.text} ({agreement(found)}); no claim, because {self.reason}"
        return replace(found, expected=text)


ENOUGH = 3
"""Least number of levels for an observed order."""
ROUNDING = 1e-9
"""Tolerance for rounding errors in bounds that hold exactly."""
BOUND = at_most(1 + ROUNDING, low=-math.inf)
"""Tolerance window of quotients that are at most 1 by theory."""
SHARP = Window(0.99, 1 + ROUNDING, "≥ 0.99 shows that the constant is the best possible")
"""Tolerance window of the largest measured value divided by its proved upper bound, which should be attained."""


def largest(key: str, quantity: str, window: Window, *columns: str) -> Criterion:
    """Return the criterion for the largest value in some columns over all levels; it fails if a value is NaN."""
    return Criterion(key, quantity, window, lambda group: greatest(group[list(columns)].to_numpy()), columns)


def largest_quotient(key: str, quantity: str, window: Window, above: str, below: str) -> Criterion:
    """Return the criterion for the largest quotient over all levels of two columns, ``above`` / ``below``."""
    measure: Measure = lambda group: greatest((group[above] / group[below]).to_numpy())  # noqa: E731
    return Criterion(key, quantity, window, measure, (above, below))


def every(key: str, quantity: str, window: Window, *columns: str) -> Criterion:
    """Return the criterion that all values in some columns lie in the window.

    The value that is farthest from the middle of the window is shown.
    """

    def measure(group: pd.DataFrame) -> Measured:
        values = group[list(columns)].to_numpy().ravel()
        distance = np.nan_to_num(abs(values - (window.low + window.high) / 2), nan=np.inf)
        return among(values[distance.argmax()], values)

    return Criterion(key, quantity, window, measure, columns)


def finest(key: str, quantity: str, window: Window, column: str) -> Criterion:
    """Return the criterion for the value of a column on the finest level."""
    return Criterion(key, quantity, window, lambda group: exactly(group[column].iloc[-1]), (column,))


def change(key: str, quantity: str, window: Window, column: str, levels: int = ENOUGH, since: int = 0) -> Criterion:
    """Return the criterion for the value on the finest level divided by the value on level ``since`` (0: coarsest)."""
    measure: Measure = lambda group: exactly(group[column].iloc[-1] / group[column].iloc[since])  # noqa: E731
    return Criterion(key, quantity, window, measure, (column,), levels)


def greatest_ratio(key: str, quantity: str, window: Window, column: str, levels: int) -> Criterion:
    """Return the criterion for the largest quotient of the values of a column on a level and the next coarser one."""

    def measure(group: pd.DataFrame) -> Measured:
        values = group[column].to_numpy()
        return greatest(values[1:] / values[:-1])

    return Criterion(key, quantity, window, measure, (column,), levels)


def of_errors(
    key: str,
    quantity: str,
    window: Window,
    column: str,
    levels: int,
    evaluate: Callable[[Array, Array], Measured],
    last: int = 0,
) -> Criterion:
    """Return the criterion for a quantity that is computed from mesh sizes and errors, such as an observed order.

    Parameters:
        key, quantity, window: as for ``Criterion``.
        column: the column of the errors.
        levels: the least number of levels.
        evaluate: function of the mesh sizes and the errors, both (levels,), coarse to fine.
        last: number of finest levels that are used; 0 for all.
    """

    def measure(group: pd.DataFrame) -> Measured:
        used = group.tail(last) if last else group
        return evaluate(used["h"].to_numpy(), used[column].to_numpy())

    return Criterion(key, quantity, window, or_none(measure), (column,), levels)


def consecutive(key: str, quantity: str, window: Window, column: str) -> Criterion:
    """Return the criterion that all observed orders between consecutive levels lie in the window.

    The order between the two finest levels is shown.
    """
    return of_errors(key, quantity, window, column, ENOUGH, lambda h, e: among((found := orders(h, e))[-1], found))


def between_levels(key: str, quantity: str, window: Window, column: str, refinements: int, levels: int) -> Criterion:
    """Return the criterion for the observed order between the finest level and a coarser one.

    Parameters:
        key, quantity, window: as for ``Criterion``.
        column: the column of the errors.
        refinements: number of refinements between the two levels.
        levels: the least number of levels.
    """
    pair = [-1 - refinements, -1]
    return of_errors(key, quantity, window, column, levels, lambda h, e: exactly(orders(h[pair], e[pair])[0]))


def order(key: str, quantity: str, window: Window, column: str, last: int = 0, levels: int = ENOUGH) -> Criterion:
    """Return the criterion for the observed order of a column of errors, by least squares.

    Only the ``last`` finest levels are used; 0 stands for all levels.
    """
    return of_errors(key, quantity, window, column, levels, lambda h, e: exactly(fit(h, e)), last)


def weighted(
    key: str, quantity: str, window: Window, column: str, power: int, last: int = 0, levels: int = ENOUGH
) -> Criterion:
    """Return the criterion for the observed order of a column of errors, by least squares with weights h^−``power``.

    Only the ``last`` finest levels are used; 0 stands for all levels.
    """
    return of_errors(key, quantity, window, column, levels, lambda h, e: exactly(weighted_order(h, e, power)), last)


def growth(key: str, quantity: str, window: Window, column: str, power: int, levels: int) -> Criterion:
    """Return the criterion for the growth of a quantity from the coarsest to the finest level.

    The growth is (h_finest/h_coarsest)^p with the observed order p by least squares with weights h^−``power``.
    """

    def evaluate(h: Array, values: Array) -> Measured:
        return exactly((h[-1] / h[0]) ** weighted_order(h, values, power))

    return of_errors(key, quantity, window, column, levels, evaluate)


def extrapolated(key: str, quantity: str, window: Window, column: str) -> Criterion:
    """Return the criterion for the order of a column of errors, extrapolated to h → 0 from three levels."""
    return of_errors(key, quantity, window, column, ENOUGH, lambda h, e: exactly(extrapolated_order(h, e)))


def exactly(value: float) -> Measured:
    """Return a pair for a single measured value: the value, and its range (value, value)."""
    return among(value, np.array([value]))


def among(shown: float, values: Array) -> Measured:
    """Return a pair for several measured values: the value to be shown, and the range of all values."""
    return float(shown), (float(values.min()), float(values.max()))


def greatest(values: Array) -> Measured:
    """Return a pair for several measured values: the largest one, and the range of all values."""
    return among(values.max(), values)


def or_none(measure: Measure) -> Measure:
    """Return a function like ``measure`` that returns NaN if the errors have no order, so that the check fails.

    Errors have no order if one of them is zero or not finite.
    """

    def measured(table: pd.DataFrame) -> Measured | None:
        try:
            return measure(table)
        except RatesError:
            return exactly(math.nan)

    return measured

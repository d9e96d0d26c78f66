"""From rows of measurements to rows of the ledger."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import pandas as pd

from study.ledger.orders import RatesError, fit
from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED, Verdict, Window
from study.statements.base import Setting, Statement

Groups = dict[str, pd.DataFrame]
"""For every mesh family its levels, coarse to fine: columns level, h and the quantities."""

Measured = tuple[float, tuple[float, float]]
"""(observed value, its range)."""

Measure = Callable[[pd.DataFrame], Measured | None]
"""The levels of one family ↦ what was found, None if these levels cannot tell."""

ENOUGH = 3
"""Fewer levels leave an order undecided."""


def by_case(rows: pd.DataFrame) -> Iterator[tuple[str, Groups]]:
    """The measurements of each case as one table per mesh family."""
    for case, of_case in rows.groupby("case", sort=False):
        groups = {}
        for family, of_family in of_case.groupby("family", sort=False):
            table = of_family.pivot(index=["level", "h"], columns="quantity", values="value")
            groups[str(family)] = table.reset_index().sort_values("h", ascending=False)
        yield str(case), groups


class Line(Protocol):
    """What becomes one row of the ledger for every case."""

    def verdict(self, statement: Statement, case: str, groups: Groups) -> Verdict: ...


@dataclass(frozen=True)
class Criterion:
    """A quantity that has to lie in a window.

    Attributes:
        quantity: what is looked at, in words.
        window: where it must lie.
        measure: how it comes from the levels of one family.
        needs: the columns that it reads.
        levels: with fewer of them it is undecided.
    """

    quantity: str
    window: Window
    measure: Measure
    needs: tuple[str, ...]
    levels: int = 1

    def verdict(self, statement: Statement, case: str, groups: Groups) -> Verdict:
        """The row for a case."""
        head = statement.label, statement.claim, case, self.quantity, self.window.text
        values = [self._of(group) for group in groups.values()]
        found = [value for value in values if value is not None]
        if not found or len(found) < len(values):
            return Verdict(*head, math.nan, -math.inf, math.inf, UNDECIDED)
        return Verdict(*head, *self.window.judge([value for value, _ in found], [span for _, span in found]))

    def _of(self, group: pd.DataFrame) -> Measured | None:
        enough = len(group) >= self.levels and set(self.needs) <= set(group)
        return self.measure(group) if enough else None


@dataclass(frozen=True)
class Observation:
    """A quantity about which no claim is made.

    Attributes:
        criterion: the quantity, with the prediction as its window.
        reason: why none is made.
    """

    criterion: Criterion
    reason: str

    def verdict(self, statement: Statement, case: str, groups: Groups) -> Verdict:
        """The row for a case, which says whether the prediction agrees."""
        found = self.criterion.verdict(statement, case, groups)
        agreement = {HOLDS: "agrees", FAILS: "differs", UNDECIDED: "undecided"}[found.verdict]
        expected = f"predicted {found.expected}, no claim as {self.reason}: {agreement}"
        return replace(found, expected=expected, verdict=REPORTED)


def judge(statement: Statement, rows: pd.DataFrame, lines: Sequence[Line]) -> list[Verdict]:
    """Every line on every case."""
    return [line.verdict(statement, case, groups) for case, groups in by_case(rows) for line in lines]


def largest(quantity: str, window: Window, *columns: str) -> Criterion:
    """The largest value of some columns over all levels."""

    def measure(group: pd.DataFrame) -> Measured:
        values = group[list(columns)].to_numpy()
        return float(values.max()), (float(values.min()), float(values.max()))

    return Criterion(quantity, window, measure, columns)


def every(quantity: str, window: Window, *columns: str) -> Criterion:
    """Some columns on every level; what is farthest from the middle of the window is shown."""

    def measure(group: pd.DataFrame) -> Measured:
        values = group[list(columns)].to_numpy().ravel()
        away = np.nan_to_num(abs(values - (window.low + window.high) / 2), nan=np.inf)
        return float(values[away.argmax()]), (float(values.min()), float(values.max()))

    return Criterion(quantity, window, measure, columns)


def finest(quantity: str, window: Window, column: str) -> Criterion:
    """A column on the finest level."""

    def measure(group: pd.DataFrame) -> Measured:
        value = float(group[column].iloc[-1])
        return value, (value, value)

    return Criterion(quantity, window, measure, (column,))


def change(quantity: str, window: Window, column: str) -> Criterion:
    """A column on the finest level over the same on the coarsest."""

    def measure(group: pd.DataFrame) -> Measured:
        value = float(group[column].iloc[-1] / group[column].iloc[0])
        return value, (value, value)

    return Criterion(quantity, window, measure, (column,), ENOUGH)


def order(quantity: str, window: Window, column: str) -> Criterion:
    """The order in h of a column, by least squares over all levels; not a number without positive values."""

    def measure(group: pd.DataFrame) -> Measured:
        try:
            value = fit(group["h"].to_numpy(), group[column].to_numpy()).order
        except RatesError:
            value = math.nan
        return value, (value, value)

    return Criterion(quantity, window, measure, (column,), ENOUGH)


def grid(cases: Sequence[str], families: Sequence[str], levels: Sequence[int]) -> list[Setting]:
    """Every case on every family and level."""
    return [Setting(case, family, n) for case in cases for family in families for n in levels]


def with_h(h: float, values: Mapping[str, float]) -> dict[str, float]:
    """What ``Statement.measure`` returns."""
    return {"h": h, **{name: float(value) for name, value in values.items()}}

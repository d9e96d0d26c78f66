"""Checks of observed orders: of the columns of tables, in the command, in Python programs and in tests."""

import math
from collections.abc import Mapping
from dataclasses import replace
from itertools import chain
from typing import Any

from numpy.typing import ArrayLike

from .columns import Options, Series, series_of
from .orders import HOLDS, OrderError, OrderResult, observed_orders, real_numbers
from .tables import from_columns

Wish = float | Mapping[Any, float] | None
"""A number for all columns, or name of a column ↦ number."""
Results = dict[str, OrderResult]
"""Name of a column ↦ observed orders and verdict."""
Judged = list[tuple[Series, list[OrderResult]]]
"""List of pairs: a series of meshes, and the observed orders of its columns of errors."""


def names_of(series: Series, name: str) -> tuple[str, ...]:
    """Return the four names by which an expectation of a column is looked up, in this order.

    They are the name of the column with the label of the series in brackets, the name alone, the label alone, and the
    empty text, which stands for all columns. The label, such as "degree 2", distinguishes several series in one table;
    it may be empty.

    Parameters:
        series: the series.
        name: the name of the column.
    """
    return f"{name} ({series.label})" if series.label else name, name, series.label, ""


def judge(tables: list[Series], **wishes: Wish) -> Judged:
    """Compute the observed orders of every column of errors, and compare them with the expected orders.

    An expectation is looked up by the names in the order of ``names_of``: by the name of the column with the label of
    the series, such as "L2 (degree 2)", then by the name alone, then by the label alone.

    Parameters:
        tables: the series of meshes.
        wishes: ``expected``, ``at_least``, ``max_error``, ``tolerance`` and ``floor``, as in ``observed_orders``.

    Raises:
        OrderError: something is expected of a column that does not exist or was left out.
    """
    columns = [names_of(series, name) for series in tables for name in series.errors]
    known = {*chain(*columns)} - {""}
    by_name: dict[str, dict[str, Any]] = {}
    for kind, wish in wishes.items():
        named = wish if isinstance(wish, Mapping) else {"": wish}
        by_name[kind] = {str(name): number for name, number in named.items()}
        for name in by_name[kind]:
            if isinstance(wish, Mapping) and name not in known:
                every = ", ".join(full for full, *_ in columns)
                ignored = ", ".join(f"{left_out} ({role})" for left_out, role in tables[0].ignored.items())
                left_out = f"; left out, unless you give --columns: {ignored}" if ignored else ""
                raise OrderError(f"an order is expected of {name}, but the columns of errors are {every}{left_out}")
    judged = []
    for series in tables:
        results = []
        for name, errors in series.errors.items():
            keys = names_of(series, name)
            own: dict[str, Any] = {}
            for kind, numbers in by_name.items():
                own[kind] = next((numbers[key] for key in keys if key in numbers), None)
            result = observed_orders(series.h, errors, name=keys[0], **own)
            results.append(replace(result, sentence=result.sentence + series.remarks[name]))
        judged.append((series, results))
    return judged


def check_orders(
    h: ArrayLike | str | None, errors: Any, expected: Wish = None,
    columns: str = "", dim: int | None = None, **wishes: Wish,
) -> Results:  # fmt: skip
    """Compute and judge the observed orders of several columns of errors.

    The same columns are judged as by the command for a table with these columns: columns of orders, numbers of cells,
    times and words are left out, and a column such as the degree divides the rows into series.

    Parameters:
        h: mesh sizes, (levels,), or the name of their column in ``errors``; by default it is recognised by its name.
        errors: a dictionary or a DataFrame, name of a column ↦ errors, (levels,); or a Series, which is one column.
        expected: expected order: one number for all columns, or name of a column ↦ number.
        columns: names of the columns of errors, separated by commas; by default they are recognised.
        dim: dimension of the meshes, if their sizes are numbers of cells or unknowns.
        wishes: ``at_least``, ``max_error``, ``tolerance`` and ``floor``, as in ``observed_orders``; each is one number
            for all columns, or name of a column ↦ number.

    Returns:
        Name of a column ↦ observed orders and verdict.

    Raises:
        OrderError: ``errors`` has no names, ``h`` or a name in ``expected`` or ``at_least`` is no column, or a column
            has no orders, as described in ``observed_orders``.
    """
    if hasattr(errors, "to_frame"):
        errors = errors.to_frame()
    if not hasattr(errors, "keys"):
        raise OrderError("errors must be a dictionary or a DataFrame, name ↦ errors; for one list use observed_orders")
    table = {str(name): errors[name] for name in errors}
    size = h if isinstance(h, str) else None
    if not (h is None or size):
        size = "mesh size" if "h" in table else "h"
        table = {size: h} | table
    cells = {name: _cells(column, name) for name, column in table.items()}
    if not cells:
        raise OrderError("there are no errors: give one for each mesh")
    series = series_of([from_columns("Python", cells)], Options(dim, size, columns=columns))
    judged = judge(series, expected=expected, **wishes)
    return {result.name: result for _, results in judged for result in results}


def _cells(column: Any, name: str) -> list[str]:
    """Return the entries of a column as text."""
    if hasattr(column, "__len__") and any(isinstance(entry, str) for entry in column):
        # pandas writes NaN into the empty cells of a column of words.
        return ["" if isinstance(entry, float) and math.isnan(entry) else str(entry) for entry in column]
    return [repr(value) for value in real_numbers(column, name).tolist()]


def assert_order(h: ArrayLike, errors: ArrayLike, expected: float | None = None, **wishes: Any) -> OrderResult:
    """Assert, in a test, that errors have the expected order of convergence, and return the observed orders.

    Parameters:
        h, errors: mesh sizes and errors, (levels,).
        expected: expected order.
        wishes: ``at_least``, ``max_error``, ``tolerance``, ``floor`` and ``name``, as in ``observed_orders``; without
            ``expected``, one of the first two is needed.

    Raises:
        AssertionError: the errors do not have the expected order; the message describes the observed orders.
        OrderError: no order is expected, or the errors have no orders, as described in ``observed_orders``.
    """
    result = observed_orders(h, errors, expected, **wishes)
    if not result.expectation.judges:
        raise OrderError("assert_order got no order, expected one: give expected=P or at_least=P")
    assert result.verdict == HOLDS, f"{result.name}: {result.conclusion}".removeprefix(": ")
    return result

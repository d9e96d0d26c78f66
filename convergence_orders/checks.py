"""Checks of observed orders in a Python program or a test."""

from typing import Any

from numpy.typing import ArrayLike

from .columns import Options, series_of
from .judging import Wish, judge
from .orders import HOLDS, TOLERANCE, OrderError, OrderResult, observed_orders, real_numbers
from .tables import Table


def check_orders(h: ArrayLike | str, errors: Any, expected: Wish = None, at_least: Wish = None,
                 tolerance: float = TOLERANCE, floor: float = 0.0, max_error: Wish = None,
                 columns: str = "", dim: int | None = None) -> dict[str, OrderResult]:  # fmt: skip
    """Compute and judge the observed orders of several columns of errors.

    The same columns are judged as by the command for a table with these columns: columns of orders, numbers of cells,
    times and words are left out, and a column such as the degree divides the rows into series.

    Parameters:
        h: mesh sizes, (levels,), or the name of their column in ``errors``.
        errors: a dictionary or a DataFrame, name of a column ↦ errors, (levels,); or a Series, which is one column.
        expected: expected order: one number for all columns, or name of a column ↦ number.
        at_least: smallest accepted order: one number for all columns, or name of a column ↦ number.
        tolerance: accepted difference from ``expected``.
        floor: the largest accepted limit of the errors; by default, errors must tend to 0.
        max_error: largest accepted error on the finest mesh: one number, or name of a column ↦ number.
        columns: names of the columns of errors, separated by commas; by default they are recognised.
        dim: dimension of the meshes, if their sizes are numbers of cells or unknowns.

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
    if isinstance(h, str) and h not in table:
        raise OrderError(f"there is no column {h} of mesh sizes; there are {', '.join(table)}")
    size = h if isinstance(h, str) else "h" if "h" not in table else "mesh size"
    if not isinstance(h, str):
        table = {size: h} | table
    cells = {name: _cells(column, name) for name, column in table.items()}
    for name, column in cells.items():
        if len(column) != len(cells[size]):
            raise OrderError(f"{name} has {len(column)} entries for {len(cells[size])} sizes: give one for each mesh")
    rows = [list(row) for row in zip(*cells.values(), strict=True)]
    given = Table("Python", list(cells), rows, list(range(1, len(rows) + 1)))
    tables = series_of([given], Options(dim, size, columns=columns))
    options = {"tolerance": tolerance, "floor": floor}
    judged = judge(tables, options, expected=expected, at_least=at_least, max_error=max_error)
    return {result.name: result for _, results in judged for result in results}


def _cells(column: Any, name: str) -> list[str]:
    """Return the entries of a column as text."""
    if not any(isinstance(entry, str) for entry in (column if hasattr(column, "__len__") else ())):
        return [repr(value) for value in real_numbers(column, name).tolist()]
    return [str(entry) for entry in column]


def assert_order(h: ArrayLike, errors: ArrayLike, expected: float | None = None, at_least: float | None = None,
                 tolerance: float = TOLERANCE, name: str = "", **options: Any) -> OrderResult:  # fmt: skip
    """Assert, in a test, that errors have the expected order of convergence, and return the observed orders.

    Parameters:
        h, errors: mesh sizes and errors, (levels,).
        expected, at_least: expected order, or smallest accepted order; one of them or ``max_error`` is needed.
        tolerance: accepted difference from ``expected``.
        name: name of the errors, for messages.
        options: ``floor`` and ``max_error``, as in ``observed_orders``.

    Raises:
        AssertionError: the errors do not have the expected order; the message describes the observed orders.
        OrderError: no order is expected, or the errors have no orders, as described in ``observed_orders``.
    """
    result = observed_orders(h, errors, expected, at_least, tolerance, name, **options)
    if not result.expectation.judges:
        raise OrderError("assert_order got no order, expected one: give expected=P or at_least=P")
    assert result.verdict == HOLDS, f"{name}: {result.conclusion}".removeprefix(": ")
    return result

"""Computes observed orders of convergence from arrays or tables, and judges them against an expected order.

The order p of errors e on meshes of size h is the exponent in e = C h^p.
"""

from collections.abc import Mapping
from typing import Any

from numpy.typing import ArrayLike

from .sequences import TOLERANCE, OrderError, OrderResult, observed_orders

__all__ = ["OrderError", "OrderResult", "assert_order", "check_orders", "observed_orders"]
Wish = float | Mapping[Any, float] | None


def check_orders(h: ArrayLike | str, errors: Any, expected: Wish = None, at_least: Wish = None,
                 tolerance: float = TOLERANCE) -> dict[str, OrderResult]:  # fmt: skip
    """Compute and judge the observed orders of several columns of errors.

    Parameters:
        h: mesh sizes, (levels,), or the name of their column in ``errors``.
        errors: a dictionary or a DataFrame, name of a column ↦ errors, (levels,); or a Series, which is one column.
        expected: expected order: one number for all columns, or name of a column ↦ number.
        at_least: smallest accepted order: one number for all columns, or name of a column ↦ number.
        tolerance: accepted difference from ``expected``.

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
    columns = {str(name): errors[name] for name in errors}
    if isinstance(h, str) and h not in columns:
        raise OrderError(f"there is no column {h} of mesh sizes; there are {', '.join(columns)}")
    sizes = columns.pop(h) if isinstance(h, str) else h
    wishes = (wish if isinstance(wish, Mapping) else dict.fromkeys(columns, wish) for wish in (expected, at_least))
    two_sided, one_sided = ({str(name): order for name, order in wish.items()} for wish in wishes)
    if unknown := [name for name in (*two_sided, *one_sided) if name not in columns]:
        raise OrderError(f"an order is expected of {unknown[0]}, but the columns of errors are {', '.join(columns)}")
    return {
        name: observed_orders(sizes, column, two_sided.get(name), one_sided.get(name), tolerance, name)
        for name, column in columns.items()
    }


def assert_order(h: ArrayLike, errors: ArrayLike, expected: float | None = None, at_least: float | None = None,
                 tolerance: float = TOLERANCE, name: str = "") -> OrderResult:  # fmt: skip
    """Assert, in a test, that errors have the expected order of convergence, and return the observed orders.

    Parameters:
        h, errors: mesh sizes and errors, (levels,).
        expected, at_least: expected order, or smallest accepted order; one of them is needed.
        tolerance: accepted difference from ``expected``.
        name: name of the errors, for messages.

    Raises:
        AssertionError: the errors do not have the expected order; the message describes the observed orders.
        OrderError: no order is expected, or the errors have no orders, as described in ``observed_orders``.
    """
    if expected is None and at_least is None:
        raise OrderError("assert_order got no order, expected one: give expected=P or at_least=P")
    result = observed_orders(h, errors, expected, at_least, tolerance, name)
    assert result.verdict == "holds", f"{name}: {result.conclusion}".removeprefix(": ")
    return result

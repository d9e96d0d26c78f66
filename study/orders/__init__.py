"""Observed orders of convergence: of arrays, of tables, with a verdict against an expected order."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import ArrayLike

from .sequences import TOLERANCE, OrderError, OrderResult, observed_orders

__all__ = ["OrderError", "OrderResult", "assert_order", "check_orders", "observed_orders"]
Wish = float | Mapping[str, float] | None


def check_orders(h: ArrayLike | str, errors: Any, expected: Wish = None, at_least: Wish = None,
                 tolerance: float = TOLERANCE) -> dict[str, OrderResult]:  # fmt: skip
    """Return the observed orders and verdicts of several columns of errors.

    Parameters:
        h: mesh sizes, (levels,), or the name of their column if ``errors`` is a DataFrame.
        errors: a dictionary or a DataFrame, name ↦ (levels,).
        expected, at_least: one number for all columns, or name ↦ number.

    Raises:
        OrderError: as ``observed_orders``, or ``errors`` has no names, or an order is expected of a column that does
            not exist.
    """
    if not hasattr(errors, "keys"):
        raise OrderError("errors must be a dictionary or a DataFrame, name ↦ errors; for one list use observed_orders")
    columns = {str(name): errors[name] for name in errors}
    sizes = columns.pop(h) if isinstance(h, str) else h
    two_sided, one_sided = (
        wish if isinstance(wish, Mapping) else {} if wish is None else dict.fromkeys(columns, wish)
        for wish in (expected, at_least)
    )
    if unknown := [name for name in (*two_sided, *one_sided) if name not in columns]:
        raise OrderError(f"an order is expected of {unknown[0]}, but the columns of errors are {', '.join(columns)}")
    return {
        name: observed_orders(sizes, column, two_sided.get(name), one_sided.get(name), tolerance, name)
        for name, column in columns.items()
    }


def assert_order(h: ArrayLike, errors: ArrayLike, expected: float | None = None, at_least: float | None = None,
                 tolerance: float = TOLERANCE, name: str = "") -> OrderResult:  # fmt: skip
    """Return the result if the errors have the expected order.

    Raises:
        AssertionError: the verdict is not *holds*; the message describes the observed orders.
        OrderError: as ``observed_orders``, or no expectation was given.
    """
    if expected is None and at_least is None:
        raise OrderError("assert_order needs expected or at_least")
    result = observed_orders(h, errors, expected, at_least, tolerance, name)
    assert result.verdict == "holds", f"{name}: {result.conclusion}".removeprefix(": ")
    return result

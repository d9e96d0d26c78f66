"""Observed orders of convergence: of arrays, of tables, with a verdict against an expected order."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import ArrayLike

from study.orders.errors import OrderError
from study.orders.sequences import TOLERANCE, Sequence, observed_orders

__all__ = ["OrderError", "Sequence", "assert_order", "check_orders", "observed_orders"]


def check_orders(
    h: ArrayLike | str,
    errors: Any,
    expected: float | Mapping[str, float] | None = None,
    at_least: float | Mapping[str, float] | None = None,
    tolerance: float = TOLERANCE,
) -> dict[str, Sequence]:
    """Orders and verdicts of several columns of errors.

    Parameters:
        h: mesh sizes, (levels,), or the name of their column if ``errors`` is a DataFrame.
        errors: a dictionary or a DataFrame, name ↦ (levels,).
        expected, at_least: one number for all columns, or name ↦ number.

    Raises:
        OrderError: as ``observed_orders``.
    """
    columns = {str(name): errors[name] for name in errors}
    sizes = columns.pop(h) if isinstance(h, str) else h

    def of(wanted: float | Mapping[str, float] | None, name: str) -> float | None:
        return wanted.get(name) if isinstance(wanted, Mapping) else wanted

    return {
        name: observed_orders(sizes, column, of(expected, name), of(at_least, name), tolerance, name)
        for name, column in columns.items()
    }


def assert_order(h: ArrayLike, errors: ArrayLike, expected: float | None = None, at_least: float | None = None,
                 tolerance: float = TOLERANCE) -> Sequence:  # fmt: skip
    """The result if the errors have the expected order.

    Raises:
        AssertionError: the verdict is not *holds*; the message says what was seen.
        OrderError: as ``observed_orders``, or no expectation was given.
    """
    if expected is None and at_least is None:
        raise OrderError("assert_order needs expected or at_least")
    found = observed_orders(h, errors, expected, at_least, tolerance)
    wanted = f"at least {at_least:g}" if expected is None else f"{expected:g} ± {tolerance:g}"
    assert found.verdict == "holds", f"{found.verdict}: {found.sentence}; expected order {wanted}"
    return found

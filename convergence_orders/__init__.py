"""Observed orders of convergence: computes them from arrays or tables, and judges them against an expected order.

The order p of errors e on meshes of size h is the exponent in e = C h^p. NumPy is imported when a public name is used:
``observed_orders``, ``check_orders``, ``assert_order``, ``grid_convergence``, ``ConvergenceTable``,
``refine_until_settled``, ``OrderError``, ``OrderResult``, ``GridConvergence``. So the pytest plugin costs nothing in
tests without it.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .judging import assert_order as assert_order
    from .judging import check_orders as check_orders
    from .orders import GridConvergence as GridConvergence
    from .orders import OrderError as OrderError
    from .orders import OrderResult as OrderResult
    from .orders import grid_convergence as grid_convergence
    from .orders import observed_orders as observed_orders
    from .solving import ConvergenceTable as ConvergenceTable
    from .solving import refine_until_settled as refine_until_settled

_HOMES = {
    "ConvergenceTable": "solving",
    "GridConvergence": "orders",
    "OrderError": "orders",
    "OrderResult": "orders",
    "assert_order": "judging",
    "check_orders": "judging",
    "grid_convergence": "orders",
    "observed_orders": "orders",
    "refine_until_settled": "solving",
}
"""Public name ↦ the module that defines it."""


def __getattr__(name: str) -> Any:
    if name in _HOMES:
        return getattr(importlib.import_module(f"{__name__}.{_HOMES[name]}"), name)
    raise AttributeError(f"module {__name__} has no attribute {name}")


def __dir__() -> list[str]:
    return [*globals(), *_HOMES]

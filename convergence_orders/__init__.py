"""Observed orders of convergence: computes them from arrays or tables, and judges them against an expected order.

The order p of errors e on meshes of size h is the exponent in e = C h^p. NumPy is imported when a name is used.
"""

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .checks import assert_order, check_orders
    from .orders import GridConvergence, OrderError, OrderResult, grid_convergence, observed_orders
    from .solving import ConvergenceTable, refine_until_settled

__all__ = [
    "ConvergenceTable",
    "GridConvergence",
    "OrderError",
    "OrderResult",
    "assert_order",
    "check_orders",
    "grid_convergence",
    "observed_orders",
    "refine_until_settled",
]


def __getattr__(name: str) -> Any:
    if name in __all__:
        for module in ("orders", "checks", "solving"):
            home = importlib.import_module(f"{__name__}.{module}")
            if hasattr(home, name):
                return getattr(home, name)
    raise AttributeError(f"module {__name__} has no attribute {name}")

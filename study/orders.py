"""The package ``convergence_orders`` under the name that it had within this project."""

try:
    from convergence_orders import (
        OrderError,
        OrderResult,
        assert_order,
        check_orders,
        grid_convergence,
        observed_orders,
    )
    from convergence_orders.orders import consecutive_orders, extrapolated_order, fitted_order
except ModuleNotFoundError as error:
    if error.name != "convergence_orders":
        raise
    raise ModuleNotFoundError(
        "the package convergence-orders is missing: python -m pip install ./convergence_orders, in a clone of this "
        "repository",
        name="convergence_orders",
    ) from None

__all__ = [
    "OrderError",
    "OrderResult",
    "assert_order",
    "check_orders",
    "consecutive_orders",
    "extrapolated_order",
    "fitted_order",
    "grid_convergence",
    "observed_orders",
]

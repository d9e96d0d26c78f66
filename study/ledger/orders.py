"""Observed orders of convergence of errors on several meshes, and the limit of the errors for h → 0.

In all functions, ``h`` are the mesh sizes and ``error`` the errors, both (levels,), coarse to fine.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from study.orders import sequences
from study.orders.sequences import consecutive_orders, fitted_order

Array = NDArray[np.float64]


class RatesError(ValueError):
    """Raised if a sequence of errors has no order."""


def orders(h: Array, error: Array) -> Array:
    """Return the observed orders log(e_i/e_{i+1}) / log(h_i/h_{i+1}) of consecutive levels, (levels − 1,).

    Raises:
        RatesError: mesh sizes do not decrease, or errors are not positive and finite.
    """
    h, error = np.asarray(h, dtype=float), np.asarray(error, dtype=float)
    if not (np.diff(h) < 0).all():
        raise RatesError(f"mesh sizes must decrease from level to level, got {h.tolist()}")
    if not (np.isfinite(error).all() and (error > 0).all()):
        raise RatesError(f"errors must be positive and finite to have an order, got {error.tolist()}")
    return consecutive_orders(h, error)


def fit(h: Array, error: Array) -> float:
    """Return the observed order over all levels by least squares of log(error) over log(h).

    Raises:
        RatesError: as ``orders``.
    """
    orders(h, error)
    return fitted_order(h, error)[0]


def extrapolated_order(h: Array, error: Array) -> float:
    """Return the observed order for h → 0, extrapolated from the three finest levels.

    If e = C h^p (1 + c h + …), the order between two levels is p + c' (h_i h_{i+1})^½ + …. The second term is
    eliminated from the orders p_1 and p_2 between the three levels. If each mesh size is half of the one before, the
    result is 2 p_2 − p_1.

    Raises:
        RatesError: as ``orders``.
    """
    orders(h, error)
    return sequences.extrapolated_order(h, error)


def weighted_order(h: Array, error: Array, power: float) -> float:
    """Return the observed order by least squares with the weights h^−power.

    The weights are optimal if the variance of log e_i is proportional to h_i^power.

    Raises:
        RatesError: as ``orders``.
    """
    orders(h, error)
    x, y, weights = np.log(h), np.log(error), np.asarray(h, dtype=float) ** -power
    x = x - np.average(x, weights=weights)
    return float((weights * x) @ y / ((weights * x) @ x))


def limit(h: Array, error: Array, order: float) -> float:
    """Return the limit of the errors for h → 0, relative to the geometric mean of the two finest errors.

    The limit is a in e = a + C h^p with the given p. A contact front lies at alternating places in its cell from level
    to level, so errors alternate, too. Therefore two averages are extrapolated: the geometric means of h and e over the
    two finest levels, and over the two levels before.

    Parameters:
        order: the exponent p.
    """
    x, e = (np.exp(np.log(np.asarray(v, dtype=float)[-4:]).reshape(2, 2).mean(axis=1)) for v in (h, error))
    x = x**order
    return float((e[1] * x[0] - e[0] * x[1]) / (x[0] - x[1]) / e[1])

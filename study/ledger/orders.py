"""Observed orders of convergence: consecutive, fitted, extrapolated, and the limit for h → 0."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from study.orders import sequences
from study.orders.sequences import consecutive_orders, fitted_order

Array = NDArray[np.float64]


class RatesError(ValueError):
    """A sequence of errors has no order."""


def orders(h: Array, error: Array) -> Array:
    """Return the observed orders log(e_i/e_{i+1}) / log(h_i/h_{i+1}) of consecutive levels, (levels − 1,).

    Raises:
        RatesError: sizes that do not decrease, or errors that are not positive and finite.
    """
    h, error = np.asarray(h, dtype=float), np.asarray(error, dtype=float)
    if not (np.diff(h) < 0).all():
        raise RatesError(f"mesh sizes must decrease from level to level, got {h.tolist()}")
    if not (np.isfinite(error).all() and (error > 0).all()):
        raise RatesError(f"errors must be positive and finite to have an order, got {error.tolist()}")
    return consecutive_orders(h, error)


def fit(h: Array, error: Array) -> float:
    """Return the observed order by least squares.

    Raises:
        RatesError: as ``orders``.
    """
    orders(h, error)
    return fitted_order(h, error)[0]


def extrapolated_order(h: Array, error: Array) -> float:
    """Return the observed order for h → 0, extrapolated from the three finest levels.

    If e = C h^p (1 + c h + …), the order between two levels is p + c' (h_i h_{i+1})^½ + …, whose second term is
    eliminated from the orders of two consecutive pairs; on halved meshes this is 2 p_2 − p_1.

    Raises:
        RatesError: as ``orders``.
    """
    orders(h, error)
    return sequences.extrapolated_order(h, error)


def weighted_order(h: Array, error: Array, power: float) -> float:
    """The least-squares order with weights h^−power, the best linear one where log e_i has a variance ~ h_i^power.

    Raises:
        RatesError: as ``orders``.
    """
    orders(h, error)
    x, y, weights = np.log(h), np.log(error), np.asarray(h, dtype=float) ** -power
    x = x - np.average(x, weights=weights)
    return float((weights * x) @ y / ((weights * x) @ x))


def limit(h: Array, error: Array, order: float) -> float:
    """e∞ in e = e∞ + C h^p for the given p, over the geometric mean of the two finest errors.

    The place of a front within its cell alternates from level to level. So two points are extrapolated: the
    geometric means (of h and of e) over the two finest levels and over the two before them.
    """
    x, e = (np.exp(np.log(np.asarray(v, dtype=float)[-4:]).reshape(2, 2).mean(axis=1)) for v in (h, error))
    x = x**order
    return float((e[1] * x[0] - e[0] * x[1]) / (x[0] - x[1]) / e[1])

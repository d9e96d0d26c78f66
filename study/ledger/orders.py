"""Observed orders of convergence: consecutive, fitted with an interval, and the limit for h → 0."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from study.orders.sequences import consecutive_orders, fitted_order

Array = NDArray[np.float64]

CONFIDENCE = 0.95


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


@dataclass(frozen=True)
class Fit:
    """The observed order p in log e = log C + p log h by least squares, with its Student interval at 95 %."""

    order: float
    low: float
    high: float


def fit(h: Array, error: Array) -> Fit:
    """Return the observed order by least squares; its interval is infinite for two levels.

    Raises:
        RatesError: as ``orders``.
    """
    orders(h, error)
    return Fit(*fitted_order(h, error))


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

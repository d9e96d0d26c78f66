"""Observed orders of errors, and the quantities that many checks use: quotients and orders.

In the functions ``orders`` to ``limit``, ``h`` are the mesh sizes and ``error`` the errors, both (levels,), coarse to
fine. Each other function returns a function of the table of one mesh family, coarse to fine, with the columns level, h
and the measured numbers.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from pandas import DataFrame

import study.orders
from study.orders import consecutive_orders

Array = NDArray[np.float64]


class RatesError(ValueError):
    """Raised if errors have no order of convergence, for example because one of them is zero."""


def orders(h: Array, error: Array) -> Array:
    """Return the observed orders of errors e on consecutive levels, log(e_i/e_{i+1}) / log(h_i/h_{i+1}), (levels − 1,).

    Raises:
        RatesError: mesh sizes do not decrease, or errors are not positive and finite.
    """
    h = np.asarray(h, dtype=float)
    error = np.asarray(error, dtype=float)
    if not (np.diff(h) < 0).all():
        raise RatesError(f"mesh sizes must decrease from level to level, got {h.tolist()}")
    if not (np.isfinite(error).all() and (error > 0).all()):
        raise RatesError(f"errors must be positive and finite to have an order, got {error.tolist()}")
    return consecutive_orders(h, error)


def fit(h: Array, error: Array, power: float = 0) -> float:
    """Return the observed order over all levels by least squares of log(error) over log(h), with the weights h^−power.

    The weights are optimal if the variance of the logarithm of an error is proportional to h^power.

    Parameters:
        h: the mesh sizes, which must decrease, (levels,).
        error: the errors, (levels,).
        power: the exponent in the weights; 0 for equal weights.

    Raises:
        RatesError: mesh sizes do not decrease, or errors are not positive and finite.
    """
    orders(h, error)
    # NumPy multiplies the residuals by the weights before it squares them.
    weights = np.asarray(h, dtype=float) ** (-power / 2)
    return float(np.polyfit(np.log(h), np.log(error), 1, w=weights)[0])


def extrapolated_order(h: Array, error: Array) -> float:
    """Return the observed order for h → 0, extrapolated from the three finest levels.

    For errors e = C h^p (1 + c h + …), the order between two consecutive levels i and i + 1 is p + c' (h_i h_{i+1})^½ +
    … with a constant c'. The term with c' is eliminated from the orders p_1 and p_2 between the three levels. If each
    mesh size is half of the one before, the result is 2 p_2 − p_1.

    Raises:
        RatesError: mesh sizes do not decrease, or errors are not positive and finite.
    """
    orders(h, error)
    return study.orders.extrapolated_order(h, error)


def limit(h: Array, error: Array, order: float) -> float:
    """Return the limit of the errors for h → 0, relative to the geometric mean of the errors on the two finest levels.

    The limit is the number a in e = a + C h^p for errors e with a given p. The edge of the contact zone lies at
    alternating places in a cell from level to level, so errors alternate, too. Therefore averages are extrapolated: the
    geometric means of h and e over the two finest levels, and over the two levels before.

    Parameters:
        h, error: mesh sizes and errors on at least four levels.
        order: the exponent p.
    """
    x, e = (np.exp(np.log(np.asarray(v, dtype=float)[-4:]).reshape(2, 2).mean(axis=1)) for v in (h, error))
    x = x**order
    return float((e[1] * x[0] - e[0] * x[1]) / (x[0] - x[1]) / e[1])


Value = Callable[[DataFrame], float | Array]
"""Function that computes a quantity, or several values of it, from the levels of one mesh family."""


def finest(column: str) -> Value:
    """Return a function of the table of one mesh family that gives the value of a column on the finest level."""
    return lambda table: table[column].iloc[-1]


def quotients(above: str, below: str) -> Value:
    """Return a function of the table of one mesh family that gives the columns ``above`` / ``below`` on each level."""
    return lambda table: (table[above] / table[below]).to_numpy()


def finest_quotient(above: str, below: str) -> Value:
    """Return a function of the table of one mesh family that gives ``above`` / ``below`` on the finest level.

    Parameters:
        above, below: the names of two columns of the table.
    """
    return lambda table: (table[above] / table[below]).iloc[-1]


def change(column: str, since: int = 0) -> Value:
    """Return a function of the table of one mesh family that compares the values of a column on two levels.

    The function gives the value on the finest level, divided by the value on the level with the index ``since``, which
    is 0 for the coarsest level and −2 for the level before the finest one.
    """
    return lambda table: table[column].iloc[-1] / table[column].iloc[since]


def ratios(column: str) -> Value:
    """Return a function of the table of one mesh family that gives the quotients of consecutive values of a column.

    Each value is divided by the value on the next coarser level, (levels − 1,).
    """
    return lambda table: (table[column] / table[column].shift()).to_numpy()[1:]


def of_errors(column: str, evaluate: Callable[[Array, Array], float | Array], last: int = 0) -> Value:
    """Return a function of the table of one mesh family that gives a quantity of errors, such as an observed order.

    Parameters:
        column: the column of the errors.
        evaluate: function of the mesh sizes and the errors, both (levels,), coarse to fine.
        last: number of finest levels that are used; 0 for all.
    """

    def value(table: DataFrame) -> float | Array:
        used = table.tail(last) if last else table
        return evaluate(used["h"].to_numpy(), used[column].to_numpy())

    return value


def level_by_level(column: str) -> Value:
    """Return a function of the table of one mesh family that gives the observed orders of a column level by level."""
    return of_errors(column, orders)


def over_refinements(column: str, refinements: int) -> Value:
    """Return a function of the table of one mesh family that gives the observed order of a column between two levels.

    They are the finest level, and the level that is ``refinements`` levels coarser.
    """
    pair = [-1 - refinements, -1]
    return of_errors(column, lambda h, e: orders(h[pair], e[pair])[0])


def fitted(column: str, last: int = 0, power: int = 0) -> Value:
    """Return a function of the table of one mesh family that gives the order of a column by least squares (``fit``).

    Parameters:
        column: the column of the errors.
        last: number of finest levels that are used; 0 for all.
        power: the errors on a level with mesh size h have the weight h^−power.
    """
    return of_errors(column, lambda h, e: fit(h, e, power), last)


def extrapolated(column: str) -> Value:
    """Return a function of the table of one mesh family that extrapolates the order of a column to h → 0."""
    return of_errors(column, extrapolated_order)

"""Quantities that many checks use: values on levels, quotients, and observed orders.

Each function returns a function of the table of one mesh family, coarse to fine, with the columns level, h and the
measured numbers.
"""

from collections.abc import Callable

import pandas as pd

from study.ledger.orders import Array, extrapolated_order, fit, orders, weighted_order

Value = Callable[[pd.DataFrame], float | Array]
"""Function that computes a quantity, or several values of it, from the levels of one mesh family."""


def values(*columns: str) -> Value:
    """Return the function that gives all values in some columns."""
    return lambda table: table[list(columns)].to_numpy().ravel()


def finest(column: str) -> Value:
    """Return the function that gives the value of a column on the finest level."""
    return lambda table: float(table[column].iloc[-1])


def quotients(above: str, below: str) -> Value:
    """Return the function that gives the quotients of two columns on all levels."""
    return lambda table: (table[above] / table[below]).to_numpy()


def finest_quotient(above: str, below: str) -> Value:
    """Return the function that gives the quotient of two columns on the finest level."""
    return lambda table: float(table[above].iloc[-1] / table[below].iloc[-1])


def change(column: str, since: int = 0) -> Value:
    """Return the function for the value on the finest level divided by the value on level ``since`` (0: coarsest)."""
    return lambda table: float(table[column].iloc[-1] / table[column].iloc[since])


def ratios(column: str) -> Value:
    """Return the function for the quotients of the values of a column on a level and the next coarser one."""
    return lambda table: table[column].to_numpy()[1:] / table[column].to_numpy()[:-1]


def of_errors(column: str, evaluate: Callable[[Array, Array], float | Array], last: int = 0) -> Value:
    """Return the function for a quantity of mesh sizes and errors, such as an observed order.

    Parameters:
        column: the column of the errors.
        evaluate: function of the mesh sizes and the errors, both (levels,), coarse to fine.
        last: number of finest levels that are used; 0 for all.
    """

    def value(table: pd.DataFrame) -> float | Array:
        used = table.tail(last) if last else table
        return evaluate(used["h"].to_numpy(), used[column].to_numpy())

    return value


def level_by_level(column: str) -> Value:
    """Return the function for the observed orders between consecutive levels."""
    return of_errors(column, orders)


def over_refinements(column: str, refinements: int) -> Value:
    """Return the function for the observed order between the finest level and a coarser one."""
    pair = [-1 - refinements, -1]
    return of_errors(column, lambda h, e: float(orders(h[pair], e[pair])[0]))


def fitted(column: str, last: int = 0, power: int = 0) -> Value:
    """Return the function for the observed order by least squares with the weights h^−``power``."""
    if power:
        return of_errors(column, lambda h, e: weighted_order(h, e, power), last)
    return of_errors(column, fit, last)


def extrapolated(column: str) -> Value:
    """Return the function for the observed order extrapolated to h → 0 from three levels."""
    return of_errors(column, extrapolated_order)

"""Observed orders of convergence of the error on the finest levels of every mesh family."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import pandas as pd

from study.ledger.orders import RatesError, orders


def by_family(rates: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """The rows of each family, from the coarsest level to the finest."""
    for family, rows in rates.groupby("family", sort=False):
        yield str(family), rows.sort_values("level")


def finest_orders(rates: pd.DataFrame, refinements: int) -> dict[str, float]:
    """family ↦ the order of ``error`` over the last so many refinements, or as many as there are.

    A family with a single level, or with errors that have no order, is left out. Over two refinements a fixed front, or
    a jump of the material, has the same place in the cells of both meshes.
    """
    found = {}
    for family, rows in by_family(rates):
        ends = rows.tail(refinements + 1).iloc[[0, -1]]
        if len(rows) > 1:
            try:
                (found[family],) = orders(ends["h"].to_numpy(), ends["error"].to_numpy())
            except RatesError:
                continue
    return {family: float(order) for family, order in found.items()}


def last_orders(rates: pd.DataFrame) -> tuple[list[float], list[float]]:
    """The orders over the last refinement, of all families but graded ones, and of these."""
    found = finest_orders(rates, refinements=1)
    graded = [order for family, order in found.items() if family == "graded"]
    return [order for family, order in found.items() if family != "graded"], graded


def spread(values: Sequence[float]) -> str:
    """The smallest and the largest, or the only one."""
    low, high = (f"{value:.3g}" for value in (min(values), max(values)))
    return low if low == high else f"{low} … {high}"

"""Compares the observed orders of the columns of tables with the orders that are expected of them."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from .columns import Series
from .orders import OrderError, OrderResult, observed_orders

Wish = float | Mapping[Any, float] | None
"""A number for all columns, or name of a column ↦ number."""
Judged = list[tuple[Series, list[OrderResult]]]
"""List of pairs: a series of meshes, and the observed orders of its columns of errors."""


def names_of(series: Series, name: str) -> tuple[str, str, str, str]:
    """Return the names by which an expectation of a column is looked up: with its case, alone, the case, and ""."""
    return f"{name} ({series.label})" if series.label else name, name, series.label, ""


def judge(tables: list[Series], options: Mapping[str, float], **wishes: Wish) -> Judged:
    """Compute the observed orders of every column of errors, and compare them with the expected orders.

    An expectation is looked up by the name of a column and its case, then by the name, then by the case. A part of a
    name will do if only one column contains it.

    Parameters:
        tables: the series of meshes.
        options: ``tolerance`` and ``floor``, as in ``observed_orders``.
        wishes: ``expected``, ``at_least`` and ``max_error``.

    Raises:
        OrderError: something is expected of a column that does not exist or was left out.
    """
    columns = {name for series in tables for name in series.errors}
    known = {key for series in tables for name in series.errors for key in names_of(series, name)}
    ignored = {name: kind for series in tables for name, kind in series.ignored.items()}

    def in_full(part: str) -> str:
        matching = [name for name in columns if part.lower() in name.lower()]
        return matching[0] if part not in known | ignored.keys() and len(matching) == 1 else part

    given: dict[str, dict[str, float]] = {}
    for kind, wish in wishes.items():
        if wish is not None:
            by_name = wish if isinstance(wish, Mapping) else {"": wish}
            given[kind] = {in_full(str(name)): number for name, number in by_name.items()}
    if unknown := {name for wish in given.values() for name in wish} - known:
        left = "".join(
            f"; {name} was left out ({ignored[name]}): name all columns of errors with --columns"
            for name in unknown & ignored.keys()
        )
        names = ", ".join(dict.fromkeys(names_of(series, name)[0] for series in tables for name in series.errors))
        raise OrderError(
            f"an order is expected of {', '.join(sorted(unknown))}, but the columns of errors are {names}{left}"
        )

    def result(series: Series, name: str, errors: list[float]) -> OrderResult:
        keys = names_of(series, name)
        own: dict[str, Any] = {
            kind: next((wish[key] for key in keys if key in wish), None) for kind, wish in given.items()
        }
        found = observed_orders(series.h, errors, name=keys[0], **options, **own)
        remark = series.remarks.get(name, "")
        return replace(found, sentence=f"{found.sentence}; {remark}") if remark else found

    return [(series, [result(series, *column) for column in series.errors.items()]) for series in tables]

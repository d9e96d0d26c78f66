"""Every numbered formula and statement of the source with its rows in the ledger, or the reason why it has none."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby

import pandas as pd

from study.ledger.datafiles import DataError, by_claim, count_verdicts
from study.ledger.numbered import NO_ROW, NOT_TESTED, NUMBERED, named

Entry = tuple[tuple[str, str], ...]
"""(what it says, its rows or the reason) of each statement of the ledger that names a number."""
LISTED = NO_ROW, NOT_TESTED, "slips"


def lines(claims: pd.DataFrame) -> Iterator[tuple[str, str, str]]:
    """(numbers, what they say, rows or reason) in the order of the source, alike neighbours on one line.

    Raises:
        DataError: a number has neither rows nor a reason.
    """
    found = entries(claims)
    if lacking := [number for number in NUMBERED if not found[number]]:
        raise DataError(f"claims.csv has neither rows nor a reason for {', '.join(lacking)}: judge again, or say why")
    for entry, group in groupby(NUMBERED, found.__getitem__):
        says, made = ("; ".join(dict.fromkeys(parts)) for parts in zip(*entry, strict=True))
        yield spanned(list(group)), says, made


def entries(claims: pd.DataFrame) -> dict[str, Entry]:
    """Number ↦ what the ledger has of it."""
    found: dict[str, Entry] = dict.fromkeys(NUMBERED, ())
    for about, says, made in (*of_rows(claims), *of_reasons(claims)):
        for number in about & found.keys():
            found[number] = (*found[number], (says, made))
    return found


def of_rows(claims: pd.DataFrame) -> Iterator[tuple[set[str], str, str]]:
    """(numbers, what is claimed, label and verdicts) of every statement with rows that are not a list of lines."""
    for label, claim, rows in by_claim(claims[~claims["label"].isin(LISTED)]):
        counts = ", ".join(f"{count} {name}" for name, count in count_verdicts(rows).items() if count)
        yield named(label), claim, f"{label}: {counts}"


def of_reasons(claims: pd.DataFrame) -> Iterator[tuple[set[str], str, str]]:
    """(numbers, what they are, why there is no row) of every line that says so."""
    for row in claims[claims["label"].isin((NO_ROW, NOT_TESTED))].to_dict("records"):
        yield named(str(row["case"])), str(row["quantity"]), str(row["expected"])


def spanned(numbers: list[str]) -> str:
    """Neighbours on one line: the first and the last."""
    return numbers[0] if len(numbers) == 1 else f"{numbers[0]}–{numbers[-1]}"

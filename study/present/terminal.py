"""The rate table and the ledger in a terminal's width, for the end of a run; read from the data files."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path

import pandas as pd

from study.ledger.datafiles import SERIES, read_claims, read_rates
from study.ledger.rounding import cell, significant
from study.ledger.verdict import VERDICTS

WIDTH = 110


def rates_text(directory: Path) -> str:
    """One line per case and mesh family for the end of a run, at most 110 columns wide.

    Shown from ``rates.csv``: the finest level n and its error, the orders from level to level (the last
    ones if not all fit), the order of the discrete error between the two finest levels, and the largest
    time share of all levels.
    """
    rates = read_rates(directory)
    schemes = rates["scheme"].nunique() > 1
    head = ("case", "meshes", "n", "error", "disc. order", "time %", "orders level by level")
    caps = (20, 26, 5, 9, 11, 7, 20) if schemes else (28, 13, 5, 9, 11, 7, 25)
    lines: list[str] = []
    for claim, of_claim in rates.groupby("claim", sort=False):
        rows = [_rates_line(series, schemes) for _, series in of_claim.groupby(SERIES, sort=False)]
        lines += [str(claim), *_aligned(head, rows, caps, right=(2, 3, 4, 5)), ""]
    return "\n".join(lines)


def ledger_text(directory: Path) -> str:
    """One line per statement for the end of a run, at most 110 columns wide.

    Shown from ``claims.csv``: how many cases it was looked at and how many rows it has by verdict; then every
    row that does not hold, and the numbers of verdicts.
    """
    claims = read_claims(directory)
    head = ("statement", "", "cases", *VERDICTS)
    rows = [_ledger_line(judged) for _, judged in claims.groupby("label", sort=False)]
    lines = _aligned(head, rows, (26, 44, 5, 5, 8, 9, 5), right=(2, 3, 4, 5, 6))
    failing = claims[~claims["verdict"].isin(["holds", "reported"])]
    lines += ["", *(line for _, row in failing.iterrows() for line in _finding(row))]
    count = _count(claims)
    lines.append(
        f"{len(claims)} rows: {count['holds']} hold, {count['fails']} fail, {count['undecided']} undecided, "
        f"{count['reported']} reported without a claim"
    )
    return "\n".join(lines) + "\n"


def _count(claims: pd.DataFrame) -> dict[str, int]:
    return {verdict: int((claims["verdict"] == verdict).sum()) for verdict in VERDICTS}


def _rates_line(series: pd.DataFrame, schemes: bool) -> tuple[str, ...]:
    finest = series.iloc[-1]
    orders = [f"{order:.2f}" for order in series["order"].dropna()]
    shown = 4 if schemes else 5
    return (
        str(finest["case"]),
        f"{finest['family']}, {finest['scheme']}" if schemes else str(finest["family"]),
        str(finest["level"]),
        significant(finest["error"]),
        "" if pd.isna(finest["discrete_order"]) else f"{finest['discrete_order']:.2f}",
        f"{100 * series['time_share'].max():.2f}",
        " ".join(["…"] * (len(orders) > shown) + orders[-shown:]),
    )


def _ledger_line(judged: pd.DataFrame) -> tuple[str, ...]:
    first = judged.iloc[0]
    counts = [str(number or "") for number in _count(judged).values()]
    return str(first["label"]), str(first["statement"]), str(judged["case"].nunique()), *counts


def _finding(row: pd.Series) -> list[str]:
    """A verdict that is not a pass, with its quantity, folded to the width."""
    interval = f" in [{cell(row['low'])}, {cell(row['high'])}]" if cell(row["low"]) or cell(row["high"]) else ""
    where = f"{row['label']}, {row['case']}" if row["case"] else str(row["label"])
    values = f"expected {cell(row['expected'])}, observed {cell(row['observed']) or 'no number'}{interval}"
    text = f"{row['verdict']}: {where}: {row['quantity']}: {values}"
    return textwrap.wrap(text, WIDTH, subsequent_indent="    ", break_on_hyphens=False)


def _aligned(
    head: Sequence[str], rows: Sequence[Sequence[str]], caps: Sequence[int], right: Sequence[int]
) -> list[str]:
    """Lines of columns two spaces apart, longer cells cut to their cap."""
    cut = [[_shorten(text, cap) for text, cap in zip(row, caps, strict=True)] for row in (head, *rows)]
    widths = [max(map(len, column)) for column in zip(*cut, strict=True)]
    return [
        "  ".join(
            text.rjust(width) if i in right else text.ljust(width)
            for i, (text, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in cut
    ]


def _shorten(text: str, cap: int) -> str:
    return text if len(text) <= cap else text[: cap - 1] + "…"

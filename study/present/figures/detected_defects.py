"""Which row of the ledger caught which deliberate defect, from ``controls.csv``."""

from __future__ import annotations

from string import ascii_uppercase

import pandas as pd
from matplotlib.figure import Figure

from study.present.charts.palette import BLUE, VERMILLION
from study.present.figures.drawing import PAGE, dots, legend, mathtext

NONE = "none"
"""Stands for the measurements without a defect."""


def draw_defects(controls: pd.DataFrame) -> Figure:
    """A line per defect, a column per row of the ledger that has to fail under some defect; a disc where it does.

    From ``defect``, ``what``, ``label``, ``quantity`` and ``caught``; a cross is a defect that no row caught. Columns
    have letters, which are explained below.
    """
    injected = _injected(controls)
    rows = list(dict.fromkeys(map(_row, injected)))
    lines = len(injected), len(rows)
    figure = Figure(figsize=(PAGE, 0.6 + 0.165 * sum(lines)))
    axes, key = figure.subplots(2, height_ratios=lines)
    for line, record in enumerate(injected):
        colour, marker = (BLUE, "o") if record["caught"] == "yes" else (VERMILLION, "X")
        axes.plot(rows.index(_row(record)), line, ls="", marker=marker, ms=5.5, color=colour, zorder=3)
    names = [f"{mathtext(record['defect'])}: {mathtext(record['what'])}" for record in injected]
    axes.set_yticks(range(len(injected)), names)
    axes.set_xticks(range(len(rows)), ascii_uppercase[: len(rows)])
    axes.xaxis.tick_top()
    axes.tick_params(axis="both", length=0)
    axes.set_xlim(-0.6, len(rows) - 0.4)
    axes.set_ylim(len(injected) - 0.4, -0.6)
    axes.grid(True)
    for line, (letter, name) in enumerate(zip(ascii_uppercase, rows, strict=False)):
        key.text(-0.45, line, rf"{letter}  {mathtext(name)}", va="center", fontsize=7.5, in_layout=False)
    key.set(xlim=(0, 1), ylim=(len(rows), -0.5))
    key.axis("off")
    handles = [
        dots("this row of the ledger fails: caught", ms=5.5, color=BLUE),
        dots("no row fails: missed", marker="X", ms=5.5, color=VERMILLION),
    ]
    legend(figure, handles, columns=2, side="upper")
    return figure


def caption_defects(controls: pd.DataFrame) -> str:
    """What to see."""
    injected, baselines = _injected(controls), controls[controls["defect"] == NONE]
    caught = sum(record["caught"] == "yes" for record in injected)
    counts = pd.Series([_row(record) for record in injected]).value_counts()
    return (
        f"{len(injected)} deliberate defects (lines) against the rows of the ledger that have to fail under them "
        f"(columns). What to see: a disc for each of the {caught} of {len(injected)} defects that make a row fail; "
        f"without a defect {int((baselines['verdict'] == 'holds').sum())} of {len(baselines)} settings hold. The row "
        f"“{counts.index[0]}” catches most, {counts.iloc[0]}; {int((counts == 1).sum())} of {len(counts)} rows are "
        "there for a single defect. Other rows that fail, too, are not shown."
    )


def _injected(controls: pd.DataFrame) -> list[dict[str, str]]:
    found: list[dict[str, str]] = controls[controls["defect"] != NONE].to_dict("records")
    return found


def _row(record: dict[str, str]) -> str:
    """The name of the row of the ledger that has to fail."""
    return f"{record['label']}: {record['quantity']}"

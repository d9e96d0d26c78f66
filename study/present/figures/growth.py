"""What a finer mesh costs, from ``benchmarks/growth.csv``."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from study.ledger.datafiles import read_table
from study.present.charts.chart import LogAxis, Style
from study.present.charts.palette import COLOURS, DARK, GREY
from study.present.figures.draw_chart import set_ticks
from study.present.figures.drawing import COLUMN, entry, legend

COLUMNS = ("n", "dofs", "factor_seconds", "step_seconds", "level_seconds", "peak_bytes", "dim", "solver")
PARTS = {
    "level_seconds": ("a level: all steps", "-"),
    "factor_seconds": ("once: factorising or coarsening", "--"),
    "step_seconds": ("one step in time", ":"),
}
LOOKS = [Style(colour, marker) for colour, marker in zip(COLOURS, "os^DvP", strict=True)]
KIB = 1024


def read_growth(directory: Path) -> pd.DataFrame | None:
    """``directory/benchmarks/growth.csv``, which `make bench-growth` writes; None where nobody has measured.

    Raises:
        DataError: it is not what `make bench-growth` writes.
    """
    path = directory / "benchmarks" / "growth.csv"
    return read_table(path, COLUMNS, "make bench-growth").dropna(subset=[*COLUMNS]) if path.is_file() else None


def draw_growth(growth: pd.DataFrame) -> Figure:
    """Above, seconds of a whole level, of a factorisation and of a time step; below, memory per unknown.

    Against ``dofs``, a colour for every ``dim`` and ``solver``; the thin line above has slope 1.
    """
    figure = Figure(figsize=(COLUMN, 4.6))
    above, below = figure.subplots(2, sharex=True, height_ratios=(3, 2))
    handles = []
    for (name, mine), look in zip(_by_solver(growth), LOOKS, strict=False):
        style: dict[str, Any] = {"color": look.colour, "marker": look.marker}
        for column, (_, line) in PARTS.items():
            above.plot(mine["dofs"], mine[column], ls=line, lw=0.9, **style)
        below.plot(mine["dofs"], mine["peak_bytes"] / mine["dofs"] / KIB, **style)
        handles.append(entry(f"{name} ({len(mine)} meshes)", **style))
    seconds = growth[list(PARTS)].to_numpy()
    seconds = seconds[seconds > 0]
    # The line of slope 1 starts above the curves.
    ends = np.array([growth["dofs"].min(), growth["dofs"].max()], dtype=float)
    ratio = float((growth["level_seconds"] / growth["dofs"])[growth["dofs"] == ends[0]].max())
    above.plot(ends, 1.6 * ratio * ends, color=GREY, lw=0.6)
    for axes in (above, below):
        axes.set(xscale="log", yscale="log")
        axes.grid(True)
    above.set(ylim=(seconds.min() / 2, None), ylabel="seconds")
    below.set(xlabel="unknowns", ylabel="KiB per unknown")
    for axis in (below.xaxis, above.yaxis, below.yaxis):
        low, high = axis.get_view_interval()
        set_ticks(axis, LogAxis("", low, high, least=2).ticks())
    above.tick_params(labelbottom=False)
    handles += [entry(name, color=DARK, ls=line) for name, line in PARTS.values()]
    legend(figure, [*handles, entry("slope 1", color=GREY, lw=0.6)], columns=2)
    return figure


def caption_growth(growth: pd.DataFrame) -> str:
    """What to see."""
    seen = []
    for name, mine in _by_solver(growth):
        first, last = mine.iloc[0], mine.iloc[-1]
        text = (
            f"{name}: {last['level_seconds']:.3g} s and {last['peak_bytes'] / KIB**3:.2g} GiB for {last['dofs']:.0f} "
            "unknowns"
        )
        if last["dofs"] > first["dofs"]:
            exponent, _ = np.polyfit(np.log(mine["dofs"]), np.log(mine["level_seconds"]), 1)
            text += f", time growing like unknowns^{exponent:.2f}"
        seen.append(text)
    return (
        "Cost of a level: seconds for all of it, for a factorisation and for a time step, and peak memory per unknown, "
        f"against the number of unknowns; the thin line has slope 1. What to see: {'; '.join(seen)}."
    )


def _by_solver(growth: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    for (dim, solver), mine in growth.groupby(["dim", "solver"], sort=False):
        yield f"{dim}D, {solver}", mine.sort_values("dofs")

"""The enclosure of an error over time, from ``enclosure.csv``."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from study.ledger.rounding import interval
from study.present.figures.canvas import BLACK, BLUE, COLUMN, GREEN, GREY, VERMILLION, legend

COLOURS = (BLUE, VERMILLION, GREEN)


def draw_enclosure(series: pd.DataFrame, title: str) -> Figure:
    """Bands [d − y, d + y] of every level with the bound from u_h alone, and upper and lower ends in relation.

    From ``level``, ``time``, ``distance``, ``bound`` and, where they are known, ``error`` and ``plain``: below, the
    ends over the error, or over d where the error is unknown.
    """
    figure = Figure(figsize=(COLUMN, 4.2))
    above, below = figure.subplots(2, sharex=True, height_ratios=(3, 2))
    known = bool(series["error"].notna().all())
    alone = "plain" in series
    series = series.assign(
        lower=(series["distance"] - series["bound"]).clip(lower=0), upper=series["distance"] + series["bound"]
    )
    floor = series["upper"].min() / 3
    handles: list[Line2D | Patch] = []
    for (level, of_level), colour in zip(series.groupby("level"), COLOURS * len(series), strict=False):
        time = of_level["time"]
        above.fill_between(time, of_level["lower"].clip(lower=floor), of_level["upper"], color=colour, alpha=0.35, lw=0)
        if alone:
            above.plot(time, of_level["plain"], color=colour, lw=0.8, ls=":")
        middle = of_level["error" if known else "distance"]
        above.plot(time, middle, color=colour, lw=0.9)
        for end in ("lower", "upper"):
            below.plot(time, of_level[end] / middle, color=colour, lw=0.9)
        handles.append(Patch(color=colour, alpha=0.35, label=f"n = {level}"))
    above.set_yscale("log")
    above.set_ylim(bottom=floor)
    above.set_ylabel(r"$\|u(t) - u_h(t)\|_V$")
    above.set_title(title)
    below.axhline(1, color=GREY, lw=0.6)
    below.set_ylim(0, 2)
    below.set_ylabel("ends / error" if known else r"ends / $\|\tilde u - u_h\|_V$")
    below.set_xlabel(r"time $t$")
    handles.append(Line2D([], [], color=BLACK, lw=0.9, label="error" if known else r"$\|\tilde u - u_h\|_V$"))
    if alone:
        handles.append(Line2D([], [], color=BLACK, lw=0.8, ls=":", label=r"bound from $u_h$ alone"))
    legend(figure, handles, columns=2)
    return figure


def caption_enclosure(series: pd.DataFrame, title: str) -> str:
    """What to see."""
    parts = []
    for level, mine in series.groupby("level"):
        last = mine.loc[mine["time"].idxmax()]
        low, high = max(last["distance"] - last["bound"], 0.0), last["distance"] + last["bound"]
        parts.append(f"{interval(low, high, 3)} with n = {level}")
    known = bool(series["error"].notna().all())
    line = "the error itself" if known else "the distance to a better displacement"
    inside = series[(series["error"] - series["distance"]).abs() <= series["bound"]]
    seen = f"the error lies in its band at {len(inside)} of {len(series)} times; " if known else ""
    return (
        f"Enclosure of the error ‖u(t) − u_h(t)‖_V over time ({title}): bands are guaranteed, lines are {line}; below, "
        f"the ends of the bands in relation to it. What to see: {seen}at the last time the bands are "
        f"{', '.join(parts)}."
    )

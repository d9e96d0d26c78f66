"""The enclosure of an error over time, from rows of ``enclosures.csv`` or of `study bound`."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import cycle

import pandas as pd

from study.ledger.rounding import interval
from study.present.charts.chart import Band, Chart, Curve, LegendEntry, LinearAxis, LogAxis, Style, Subplot
from study.present.charts.palette import BLACK, COLOURS

HIGHEST = 2.0
"""The largest ratio of an end of the enclosure and the error that is shown."""


def enclosure_charts(series: pd.DataFrame) -> Iterator[tuple[str, Chart]]:
    """For every case and mesh family with an enclosure: the case, and a chart with all levels."""
    enclosed = series[series["trajectory"] == "enclosure"]
    for (case, family), mine in enclosed.groupby(["case", "family"], sort=False):
        yield str(case), enclosure_chart(mine, f"{case}, {family}")


def enclosure_chart(series: pd.DataFrame, title: str) -> Chart:
    """Above, the bands [d − y, d + y] of every level; below, their ends divided by the error.

    From ``level``, ``time``, ``distance`` d, ``bound`` y and, where they are known, ``error`` and ``plain``, the bound
    from u_h alone. Where the error is unknown d takes its place.
    """
    known = bool(series["error"].notna().all())
    ends = series.assign(
        lower=(series["distance"] - series["bound"]).clip(lower=0),
        upper=series["distance"] + series["bound"],
        middle=series["error" if known else "distance"],
    )
    time = LinearAxis.around("time", ends["time"].min(), ends["time"].max(), "t")
    name = "error" if known else "‖ũ − u_h‖_V"
    legend = [[LegendEntry(f"n = {level}", Style(colour, stroke="band")) for level, _, colour in _levels(ends)]]
    legend.append([LegendEntry(name, Style(BLACK))])
    if "plain" in series:
        legend[1].append(LegendEntry("bound from u_h alone", Style(BLACK, stroke="dotted")))
    subplots = [_bands(ends, title, time), _ratios(ends, time, f"ends over {name}")]
    summary = "error over time between its bounds, logarithmic"
    return Chart(summary, subplots, legend, _caption(ends, title, known))


def _bands(ends: pd.DataFrame, title: str, time: LinearAxis) -> Subplot:
    floor = float(ends["upper"].min()) / 3
    highest = ends[["upper", *(name for name in ("plain",) if name in ends)]].max().max()
    y = LogAxis("‖u(t) − u_h(t)‖_V", floor, LogAxis.around("", floor, highest).high)
    bands, curves = [], []
    for _, mine, colour in _levels(ends):
        t = mine["time"].to_numpy()
        bands.append(Band(t, mine["lower"].clip(lower=floor).to_numpy(), mine["upper"].to_numpy(), colour))
        if "plain" in mine:
            curves.append(Curve(t, mine["plain"].to_numpy(), Style(colour, stroke="dotted")))
        curves.append(Curve(t, mine["middle"].to_numpy(), Style(colour)))
    return Subplot(title, time, y, curves, bands)


def _ratios(ends: pd.DataFrame, time: LinearAxis, label: str) -> Subplot:
    curves = [
        Curve(mine["time"].to_numpy(), (mine[end] / mine["middle"]).to_numpy(), Style(colour))
        for _, mine, colour in _levels(ends)
        for end in ("lower", "upper")
    ]
    return Subplot("", time, LinearAxis(label, 0.0, HIGHEST), curves, rules=[1.0])


def _levels(series: pd.DataFrame) -> Iterator[tuple[int, pd.DataFrame, str]]:
    """Each level, its rows and its colour."""
    for (level, mine), colour in zip(series.groupby("level"), cycle(COLOURS), strict=False):
        yield int(level), mine, colour


def _caption(ends: pd.DataFrame, title: str, known: bool) -> str:
    parts = []
    for level, mine in ends.groupby("level"):
        last = mine.loc[mine["time"].idxmax()]
        parts.append(f"{interval(last['lower'], last['upper'], 3)} with n = {level}")
    line = "the error itself" if known else "the distance to a more accurate displacement ũ"
    inside = ends[(ends["error"] - ends["distance"]).abs() <= ends["bound"]]
    seen = f"the error lies in its band at {len(inside)} of {len(ends)} times; " if known else ""
    return (
        f"Enclosure of the error ‖u(t) − u_h(t)‖_V over time ({title}): bands enclose the error, "
        f"lines are {line}; below, the ends of the bands divided by it. What to see: {seen}at the last time the bands "
        f"are {', '.join(parts)}."
    )

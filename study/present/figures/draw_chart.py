"""A chart by Matplotlib: subplots one above the other, or small ones in a grid."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis as MatplotlibAxis
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import FixedFormatter, FixedLocator, LogLocator, NullFormatter

from study.present.charts.chart import Axis, Chart, LegendEntry, SlopeTriangle, Style, Subplot
from study.present.charts.palette import GREY
from study.present.figures.drawing import COLUMN, entry, legend, mathtext

HEIGHTS = {1: (1,), 2: (3, 2)}
"""Of subplots one above the other, in relation to each other."""
STROKES: dict[str, dict[str, Any]] = {
    "solid": {},
    "dashed": {"ls": "--", "lw": 0.7},
    "dotted": {"ls": ":", "lw": 0.9, "alpha": 0.8},
}
SHADE = 0.35
"""Opacity of bands."""
ENTRY = 1.15
"""Inches that an entry of the legend takes above a grid."""


def draw_chart(chart: Chart) -> Figure:
    """Subplots one above the other, as wide as a column of text, with the legend below."""
    count = len(chart.subplots)
    figure = Figure(figsize=(COLUMN, 3.8 + 0.2 * count))
    panels = figure.subplots(count, sharex=True, squeeze=False, height_ratios=HEIGHTS[count])
    for axes, subplot in zip(panels[:, 0], chart.subplots, strict=True):
        _draw_subplot(axes, subplot)
        axes.set_title(subplot.title)
        axes.set_ylabel(mathtext(subplot.y.label))
        axes.label_outer()
    panels[-1, 0].set_xlabel(_label(chart.subplots[-1].x))
    legend(figure, _filled(chart.legend), columns=len(chart.legend))
    return figure


def draw_grid(chart: Chart) -> Figure:
    """Small subplots, row by row, with common labels and the legend above."""
    columns, count = chart.columns, len(chart.subplots)
    rows = math.ceil(count / columns)
    width = max(COLUMN, 0.5 + 1.05 * columns)
    figure = Figure(figsize=(width, 0.8 + (0.15 + 0.9 * (width - 0.5) / columns) * rows))
    panels = figure.subplots(rows, columns, sharey="row", squeeze=False).ravel()
    for i, (axes, subplot) in enumerate(zip(panels, chart.subplots, strict=False)):
        _draw_subplot(axes, subplot, size=2.4)
        axes.set_title(textwrap.fill(subplot.title, 22), fontsize=7, linespacing=0.95)
        axes.tick_params(labelbottom=i + columns >= count)
    for axes in panels[count:]:
        axes.set_visible(False)
    figure.supxlabel(_label(chart.subplots[0].x))
    figure.supylabel(mathtext(chart.subplots[0].y.label))
    handles = [_handle(one) for column in chart.legend for one in column]
    legend(figure, handles, columns=max(2, int(width / ENTRY)), side="upper")
    return figure


def set_ticks(axis: MatplotlibAxis, ticks: list[tuple[float, str]]) -> None:
    """Labelled ticks; on a logarithmic axis with small ones without labels between them."""
    axis.set_major_locator(FixedLocator([value for value, _ in ticks]))
    axis.set_major_formatter(FixedFormatter([mathtext(text) for _, text in ticks]))
    if axis.get_scale() == "log":
        axis.set_minor_locator(LogLocator(subs=tuple(range(2, 10)), numticks=99))
        axis.set_minor_formatter(NullFormatter())


def _draw_subplot(axes: Axes, subplot: Subplot, size: float = 3.6) -> None:
    """What lies inside the axes, with ticks; markers of so many points."""
    axes.set(xscale=subplot.x.scale, yscale=subplot.y.scale)
    axes.set(xlim=(subplot.x.low, subplot.x.high), ylim=(subplot.y.low, subplot.y.high))
    set_ticks(axes.xaxis, subplot.x.ticks())
    set_ticks(axes.yaxis, subplot.y.ticks())
    axes.grid(True)
    for value in subplot.rules:
        axes.axhline(value, color=GREY, lw=0.6)
    for band in subplot.bands:
        axes.fill_between(band.x, band.low, band.high, color=band.colour, alpha=SHADE, lw=0)
    if subplot.triangle:
        _draw_triangle(axes, subplot.triangle)
    for curve in subplot.curves:
        axes.plot(curve.x, curve.y, ms=size, **_line(curve.style))


def _draw_triangle(axes: Axes, triangle: SlopeTriangle) -> None:
    axes.fill(*triangle.corners.T, facecolor="0.93", edgecolor="0.35", lw=0.6, zorder=1.5)
    (x0, y0), (x1, y1), _ = triangle.corners
    where: dict[str, Any] = {"textcoords": "offset points", "fontsize": 7}
    axes.annotate(triangle.beside, (x0, np.sqrt(y0 * y1)), (-2, 0), ha="right", va="center", **where)
    axes.annotate(triangle.above, (np.sqrt(x0 * x1), y1), (0, 1.5), ha="center", va="bottom", **where)


def _line(style: Style) -> dict[str, Any]:
    face = {"mfc": "white"} if style.hollow else {}
    return {"color": style.colour, "marker": style.marker, **face, **STROKES[style.stroke]}


def _filled(columns: Sequence[Sequence[LegendEntry]]) -> list[Artist]:
    """Handles column by column, as Matplotlib takes them, with shorter columns filled up with blanks."""
    longest = max(map(len, columns))
    blank = entry(" ", ls="")
    return [handle for column in columns for handle in [*map(_handle, column), *[blank] * (longest - len(column))]]


def _handle(of: LegendEntry) -> Artist:
    label = mathtext(of.text)
    if of.style.stroke == "band":
        return Patch(color=of.style.colour, alpha=SHADE, label=label)
    return entry(label, **_line(of.style))


def _label(axis: Axis) -> str:
    return mathtext(axis.label) + (f" ${axis.symbol}$" if axis.symbol else "")

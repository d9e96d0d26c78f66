"""Charts as data, drawn by Matplotlib for figures and as SVG on the report page.

Texts are plain Unicode with scripts as in u^h and x_{ij}; each renderer typesets them.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis as MatplotlibAxis
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import FixedFormatter, FixedLocator, LogLocator, MaxNLocator, NullFormatter
from numpy.typing import ArrayLike, NDArray

from study.present.drawing import COLUMN, entry, legend, mathtext
from study.present.palette import GREY, OUTLINE, TRIANGLE, Style

Array = NDArray[np.float64]
MARGIN = 0.06
"""Free space at each end of an axis, as a fraction of the range of the data."""
_MANTISSAS = ((1,), (1, 3), (1, 2, 5), (1, 1.5, 2, 3, 5, 7), (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8, 9))


@dataclass(frozen=True)
class Axis:
    """An axis from ``low`` to ``high``; the label is followed by ``symbol`` in italics.

    A logarithmic axis has at least ``least`` ticks.
    """

    label: str
    low: float
    high: float
    scale: Literal["linear", "log"] = "linear"
    symbol: str = ""
    least: int = 3

    def position(self, value: float) -> float:
        """Return the position of a value, from 0 to 1 on the axis; values without a logarithm are far below 0."""
        if self.scale == "linear":
            return (value - self.low) / (self.high - self.low)
        return math.log10(max(value / self.low, 1e-9)) / math.log10(self.high / self.low)

    def ticks(self) -> list[tuple[float, str]]:
        """Return round values inside the axis with their texts: the coarsest choice that has enough values."""
        if self.scale == "log":
            decades = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)) + 1)
            write = "{:.4g}".format if self.low >= 1e-3 and self.high < 1e4 else _power_of_ten
            for mantissas in _MANTISSAS:
                ticks = [tick for k in decades for m in mantissas if self.low <= (tick := m * 10.0**k) <= self.high]
                if len(ticks) >= self.least:
                    return [(tick, write(tick)) for tick in ticks]
        room = 1e-9 * (self.high - self.low)
        values = MaxNLocator(6, steps=[1, 2, 5, 10]).tick_values(self.low, self.high)
        return [(float(v), f"{v:.4g}") for v in values if self.low - room <= v <= self.high + room]


def linear_axis(label: str, *values: ArrayLike, symbol: str = "") -> Axis:
    """Return an axis around all values with a margin at each end."""
    low, high = _range(values)
    margin = MARGIN * (high - low) or 0.5
    return Axis(label, low - margin, high + margin, symbol=symbol)


def log_axis(label: str, *values: ArrayLike, symbol: str = "", least: int = 3) -> Axis:
    """Return a logarithmic axis around all values with a margin at each end."""
    low, high = _range(values)
    decades = math.log10(high / low)
    margin = 10 ** (MARGIN * decades if decades > 0.01 else 0.5)
    return Axis(label, low / margin, high * margin, "log", symbol, least)


def _range(values: Sequence[ArrayLike]) -> tuple[float, float]:
    together = np.concatenate([np.ravel(np.asarray(each, dtype=float)) for each in values])
    return float(np.nanmin(together)), float(np.nanmax(together))


def _power_of_ten(tick: float) -> str:
    exponent = math.floor(math.log10(tick) + 1e-9)
    mantissa = tick / 10**exponent
    power = f"10^{{{exponent}}}".replace("-", "−")
    return power if abs(mantissa - 1) < 1e-9 else f"{mantissa:.3g}·{power}"


@dataclass(frozen=True, eq=False)
class Curve:
    """A line through points, (n,) each."""

    x: Array
    y: Array
    style: Style


@dataclass(frozen=True, eq=False)
class Band:
    """The area between two curves, (n,) each."""

    x: Array
    low: Array
    high: Array
    colour: str


@dataclass(frozen=True, eq=False)
class SlopeTriangle:
    """A triangle that shows the expected slope.

    Attributes:
        corners: lower left, upper right, and upper left with the right angle, (3, 2).
        beside, above: texts to the left of the left side and above the upper side.
        top: the value of y up to which the axis must reach to show the triangle with its texts.
    """

    corners: Array
    beside: str
    above: str
    top: float


@dataclass(frozen=True, eq=False)
class Subplot:
    """One pair of axes with curves, bands behind the curves, a slope triangle, and horizontal lines at ``rules``."""

    title: str
    x: Axis
    y: Axis
    curves: Sequence[Curve]
    bands: Sequence[Band] = ()
    triangle: SlopeTriangle | None = None
    rules: Sequence[float] = ()


@dataclass(frozen=True)
class LegendEntry:
    """An entry of the legend."""

    text: str
    style: Style


@dataclass(frozen=True, eq=False)
class Chart:
    """Subplots with one legend.

    Attributes:
        summary: one line for readers who cannot see the chart.
        subplots: one above the other or, if ``columns`` is positive, row by row in a grid.
        legend: the columns of the legend.
        caption: describes what to see, with numbers.
    """

    summary: str
    subplots: Sequence[Subplot]
    legend: Sequence[Sequence[LegendEntry]]
    caption: str
    columns: int = 0


HEIGHTS = {1: (1,), 2: (3, 2)}
"""Relative heights of subplots that stand one above the other."""
_STROKES: dict[str, dict[str, Any]] = {
    "solid": {},
    "dashed": {"ls": "--", "lw": 0.7},
    "dotted": {"ls": ":", "lw": 0.9, "alpha": 0.8},
}
_BAND = 0.35
"""Opacity of bands."""


def draw_chart(chart: Chart) -> Figure:
    """Draw a chart with Matplotlib."""
    return _draw_grid(chart) if chart.columns else _draw_column(chart)


def _draw_column(chart: Chart) -> Figure:
    """Draw subplots one above the other, as wide as a column of text, with the legend below."""
    count = len(chart.subplots)
    figure = Figure(figsize=(COLUMN, 3.8 + 0.2 * count))
    panels = figure.subplots(count, sharex=True, squeeze=False, height_ratios=HEIGHTS[count])[:, 0]
    for axes, subplot in zip(panels, chart.subplots, strict=True):
        _draw_subplot(axes, subplot)
        axes.set_title(subplot.title)
        axes.set_ylabel(mathtext(subplot.y.label))
        axes.label_outer()
    panels[-1].set_xlabel(_label(chart.subplots[-1].x))
    # Matplotlib fills a legend column by column, so shorter columns need blank entries.
    longest = max(map(len, chart.legend))
    handles: list[Artist] = []
    for column in chart.legend:
        handles += [*map(_handle, column), *[entry(" ", ls="")] * (longest - len(column))]
    legend(figure, handles, columns=len(chart.legend))
    return figure


def _draw_grid(chart: Chart) -> Figure:
    """Draw small subplots row by row, with common labels and the legend above."""
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
    # An entry of the legend takes about 1.15 inches.
    handles = [_handle(one) for column in chart.legend for one in column]
    legend(figure, handles, columns=max(2, int(width / 1.15)), side="upper")
    return figure


def _draw_subplot(axes: Axes, subplot: Subplot, size: float = 3.6) -> None:
    """Draw the inside of the axes and the ticks, with markers of ``size`` points."""
    axes.set(xscale=subplot.x.scale, yscale=subplot.y.scale)
    axes.set(xlim=(subplot.x.low, subplot.x.high), ylim=(subplot.y.low, subplot.y.high))
    _set_ticks(axes.xaxis, subplot.x)
    _set_ticks(axes.yaxis, subplot.y)
    axes.grid(True)
    for value in subplot.rules:
        axes.axhline(value, color=GREY, lw=0.6)
    for band in subplot.bands:
        axes.fill_between(band.x, band.low, band.high, color=band.colour, alpha=_BAND, lw=0)
    if subplot.triangle:
        triangle = subplot.triangle
        axes.fill(*triangle.corners.T, facecolor=TRIANGLE, edgecolor=OUTLINE, lw=0.6, zorder=1.5)
        (x0, y0), (x1, y1), _ = triangle.corners
        text: dict[str, Any] = {"textcoords": "offset points", "fontsize": 7}
        axes.annotate(triangle.beside, (x0, np.sqrt(y0 * y1)), (-2, 0), ha="right", va="center", **text)
        axes.annotate(triangle.above, (np.sqrt(x0 * x1), y1), (0, 1.5), ha="center", va="bottom", **text)
    for curve in subplot.curves:
        axes.plot(curve.x, curve.y, ms=size, **_line(curve.style))


def _set_ticks(drawn: MatplotlibAxis, axis: Axis) -> None:
    """Set labelled ticks and, on a logarithmic axis, small ticks without labels between them."""
    ticks = axis.ticks()
    drawn.set_major_locator(FixedLocator([value for value, _ in ticks]))
    drawn.set_major_formatter(FixedFormatter([mathtext(text) for _, text in ticks]))
    if axis.scale == "log":
        drawn.set_minor_locator(LogLocator(subs=tuple(range(2, 10)), numticks=99))
        drawn.set_minor_formatter(NullFormatter())


def _line(style: Style) -> dict[str, Any]:
    face = {"mfc": "white"} if style.hollow else {}
    return {"color": style.colour, "marker": style.marker, **face, **_STROKES[style.stroke]}


def _handle(one: LegendEntry) -> Artist:
    if one.style.stroke == "band":
        return Patch(color=one.style.colour, alpha=_BAND, label=mathtext(one.text))
    return entry(mathtext(one.text), **_line(one.style))


def _label(axis: Axis) -> str:
    return mathtext(axis.label) + (f" ${axis.symbol}$" if axis.symbol else "")

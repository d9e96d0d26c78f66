"""The charts of the study with their captions, made from the data files, and the functions that draw charts.

A ``Chart`` is a description of curves, axes and texts. Texts are plain Unicode with scripts written as in u^h and
x_{ij}.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import cycle, starmap
from typing import Any, Literal

import numpy as np
import pandas as pd
from matplotlib import rcParams
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import FixedFormatter, FixedLocator, LogLocator, MaxNLocator, NullFormatter
from numpy.typing import ArrayLike

from manufactured.colours import BLACK, BLUE, DARK, GREEN, GREY, ORANGE, VERMILLION
from study.ledger.check import by_family
from study.ledger.codes import GRADES, Codes
from study.ledger.orders import Array, RatesError, fit, orders
from study.ledger.text import above, below, interval
from study.present.drawing import caption, column_width, entry, is_slide, legend, mathtext, page_width
from study.present.notation import counted
from study.present.palette import COLOURS, OUTLINE, TRIANGLE, Stroke, Style, family_styles

MARGIN = 0.06
"""The free space at each end of an axis, as a fraction of the range of the data."""
MOST_TICKS = 7
"""The approximate largest number of ticks of a logarithmic axis; if there are more candidates, some are left out."""
_MANTISSAS = ((1,), (1, 3), (1, 2, 5), (1, 1.5, 2, 3, 5, 7), (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8, 9))


@dataclass(frozen=True)
class Axis:
    """An axis of a chart.

    Attributes:
        label: its text.
        low, high: the values at its ends.
        scale: linear or logarithmic.
        symbol: a letter in italics after the label, may be empty.
        least: the smallest number of ticks of a logarithmic axis.
    """

    label: str
    low: float
    high: float
    scale: Literal["linear", "log"] = "linear"
    symbol: str = ""
    least: int = 3

    def ticks(self) -> list[tuple[float, str]]:
        """Return the values and texts of the ticks: round numbers, as few as the axis needs."""
        if self.scale == "log":
            decades = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)) + 1)
            write = "{:.4g}".format if self.low >= 1e-3 and self.high < 1e4 else _power_of_ten
            for mantissas in _MANTISSAS:
                ticks = [tick for k in decades for m in mantissas if self.low <= (tick := m * 10.0**k) <= self.high]
                if len(ticks) >= self.least:
                    return [(tick, write(tick)) for tick in ticks[:: math.ceil(len(ticks) / MOST_TICKS)]]
        room = 1e-9 * (self.high - self.low)
        values = MaxNLocator(6, steps=[1, 2, 5, 10]).tick_values(self.low, self.high)
        return [(float(v), f"{v:.4g}") for v in values if self.low - room <= v <= self.high + room]


def linear_axis(label: str, *values: ArrayLike, symbol: str = "") -> Axis:
    """Return a linear axis that contains all values, with a margin at each end."""
    low, high = _range(values)
    margin = MARGIN * (high - low) or 0.5
    return Axis(label, low - margin, high + margin, symbol=symbol)


def log_axis(label: str, *values: ArrayLike, symbol: str = "", least: int = 3) -> Axis:
    """Return a logarithmic axis that contains all values, with a margin at each end."""
    low, high = _range(values)
    decades = math.log10(high / low)
    margin = 10 ** (MARGIN * decades if decades > 0.01 else 0.5)
    return Axis(label, low / margin, high * margin, "log", symbol, least)


def _range(values: Sequence[ArrayLike]) -> tuple[float, float]:
    together = np.concatenate([np.ravel(np.asarray(each, dtype=float)) for each in values])
    return float(np.nanmin(together)), float(np.nanmax(together))


def _power_of_ten(tick: float) -> str:
    """Return a number as a multiple of a power of ten, such as 3·10^{−4}."""
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

    @classmethod
    def of(cls, rows: pd.DataFrame, column: str, style: Style, x: str = "h") -> Curve:
        """Return the line through the values in a column of a table, over the column ``x``."""
        return cls(rows[x].to_numpy(dtype=float), rows[column].to_numpy(dtype=float), style)


@dataclass(frozen=True, eq=False)
class Band:
    """The area between two curves, (n,) each."""

    x: Array
    low: Array
    high: Array
    colour: str


@dataclass(frozen=True, eq=False)
class SlopeTriangle:
    """A right triangle whose hypotenuse has the expected slope of the curves.

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
    """One pair of axes with curves, bands behind them, a slope triangle, and horizontal lines at the values ``rules``.

    The bands, the triangle and the lines may be missing.
    """

    title: str
    x: Axis
    y: Axis
    curves: Sequence[Curve]
    bands: Sequence[Band] = ()
    triangle: SlopeTriangle | None = None
    rules: Sequence[float] = ()


LegendEntry = tuple[str, Style]
"""An entry of the legend: text and style."""


@dataclass(frozen=True, eq=False)
class Chart:
    """Subplots with one common legend.

    Attributes:
        summary: the kind of the chart in a few words, for readers who cannot see it.
        subplots: the pairs of axes.
        legend: the columns of the legend.
        caption: says what is drawn and what to see, with numbers.
        headline: the main result in a sentence, for slides, which have no caption.
        columns: the number of columns of the grid that the subplots fill row by row; if it is 0, the subplots are
            drawn one above the other.
    """

    summary: str
    subplots: Sequence[Subplot]
    legend: Sequence[Sequence[LegendEntry]]
    caption: str
    headline: str = ""
    columns: int = 0


HEIGHTS = {1: (1,), 2: (3, 2)}
"""Number of subplots that are drawn one above the other ↦ their relative heights."""
_STROKES: dict[str, dict[str, Any]] = {
    "solid": {},
    "none": {"ls": ""},
    "dashed": {"ls": "--", "lw": 0.7},
    "dotted": {"ls": ":", "lw": 0.9, "alpha": 0.8},
}
_BAND = 0.35
"""Opacity of bands."""


def draw_chart(chart: Chart) -> Figure:
    """Return the Matplotlib figure of a chart; slides have its headline."""
    figure = _draw_grid(chart) if chart.columns else _draw_column(chart)
    if is_slide() and chart.headline:
        figure.suptitle(textwrap.fill(chart.headline, 64))
    return figure


def _draw_column(chart: Chart) -> Figure:
    """Draw the subplots of a chart one above the other, as wide as a column of text, with the legend below them."""
    count = len(chart.subplots)
    figure = Figure(figsize=(column_width(), 3.8 + 0.2 * count))
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
        handles += [*starmap(_handle, column), *[entry(" ", ls="")] * (longest - len(column))]
    legend(figure, handles, columns=len(chart.legend))
    return figure


def _draw_grid(chart: Chart) -> Figure:
    """Draw the subplots of a chart as small panels in a grid, with common labels and the legend above them."""
    columns, count = chart.columns, len(chart.subplots)
    rows = math.ceil(count / columns)
    width = min(max(column_width(), 0.5 + 1.05 * columns), page_width())
    figure = Figure(figsize=(width, 0.8 + (0.15 + 0.9 * (width - 0.5) / columns) * rows))
    panels = figure.subplots(rows, columns, sharey="row", squeeze=False).ravel()
    for i, (axes, subplot) in enumerate(zip(panels, chart.subplots, strict=False)):
        _draw_subplot(axes, subplot, size=2.4)
        axes.set_title(textwrap.fill(subplot.title, 22), fontsize=rcParams["xtick.labelsize"], linespacing=0.95)
        axes.tick_params(labelbottom=i + columns >= count)
    for axes in panels[count:]:
        axes.set_visible(False)
    figure.supxlabel(_label(chart.subplots[0].x))
    figure.supylabel(mathtext(chart.subplots[0].y.label))
    # An entry of the legend takes about 1.15 inches.
    handles = [_handle(*one) for column in chart.legend for one in column]
    legend(figure, handles, columns=max(2, int(width / 1.15)), side="upper")
    return figure


def _draw_subplot(axes: Axes, subplot: Subplot, size: float = 3.6) -> None:
    """Draw the curves, bands, triangle, lines and ticks of a subplot; markers have a diameter of ``size`` points."""
    axes.set(xscale=subplot.x.scale, yscale=subplot.y.scale)
    axes.set(xlim=(subplot.x.low, subplot.x.high), ylim=(subplot.y.low, subplot.y.high))
    for drawn, axis in ((axes.xaxis, subplot.x), (axes.yaxis, subplot.y)):
        ticks = axis.ticks()
        drawn.set_major_locator(FixedLocator([value for value, _ in ticks]))
        drawn.set_major_formatter(FixedFormatter([mathtext(text) for _, text in ticks]))
        if axis.scale == "log":
            # Small ticks without labels lie between the labelled ones.
            drawn.set_minor_locator(LogLocator(subs=tuple(range(2, 10)), numticks=99))
            drawn.set_minor_formatter(NullFormatter())
    axes.grid(True)
    for value in subplot.rules:
        axes.axhline(value, color=GREY, lw=0.6)
    for band in subplot.bands:
        axes.fill_between(band.x, band.low, band.high, color=band.colour, alpha=_BAND, lw=0)
    if subplot.triangle:
        triangle = subplot.triangle
        axes.fill(*triangle.corners.T, facecolor=TRIANGLE, edgecolor=OUTLINE, lw=0.6, zorder=1.5)
        (x0, y0), (x1, y1), _ = triangle.corners
        text: dict[str, Any] = {"textcoords": "offset points", "fontsize": rcParams["xtick.labelsize"]}
        axes.annotate(triangle.beside, (x0, np.sqrt(y0 * y1)), (-2, 0), ha="right", va="center", **text)
        axes.annotate(triangle.above, (np.sqrt(x0 * x1), y1), (0, 1.5), ha="center", va="bottom", **text)
    for curve in subplot.curves:
        axes.plot(curve.x, curve.y, ms=size, **_line(curve.style))


def _line(style: Style) -> dict[str, Any]:
    """Return the Matplotlib properties of a line."""
    face = {"mfc": "white"} if style.hollow else {}
    return {"color": style.colour, "marker": style.marker, **face, **_STROKES[style.stroke]}


def _handle(text: str, style: Style) -> Artist:
    """Return the Matplotlib artist of a legend entry."""
    if style.stroke == "band":
        return Patch(color=style.colour, alpha=_BAND, label=mathtext(text))
    return entry(mathtext(text), **_line(style))


def _label(axis: Axis) -> str:
    return mathtext(axis.label) + (f" ${axis.symbol}$" if axis.symbol else "")


# The charts of the study.

NEGLIGIBLE = 1e-3
"""In a chart of errors, values below this fraction of the smallest error are not shown, because the vertical axis would
become too long."""
MOST_COLUMNS = 5
"""The largest number of columns of the chart with a subplot for each case."""
HEADING: LegendEntry = ("mesh family", Style(DARK, stroke="none"))
"""Heading of the mesh families in a legend."""
ORDER_ROOM = 0.15
"""Observed orders may be smaller than the proved order by this number, as in the checks of Proposition 5.4."""


def finest_orders(rates: pd.DataFrame, refinements: int) -> dict[str, float]:
    """Return mesh family ↦ observed order of the error between the finest mesh and a coarser mesh.

    If there are two refinements between the meshes, a front or a jump of the material that does not move has the same
    position in the cells of both.

    Parameters:
        rates: rows of ``rates.csv`` of one case. Families with a single level, or with errors that have no order, are
            left out.
        refinements: the number of refinements between the two meshes; less if there are fewer levels.
    """
    found = {}
    for family, rows in by_family(rates).items():
        ends = rows.tail(refinements + 1).iloc[[0, -1]]
        if len(rows) > 1:
            with suppress(RatesError):
                found[family] = float(orders(ends["h"].to_numpy(), ends["error"].to_numpy())[0])
    return found


def last_orders(rates: pd.DataFrame) -> tuple[list[float], list[float]]:
    """Return the observed orders over the last refinement in two lists: graded meshes are in the second list."""
    found = finest_orders(rates, refinements=1)
    graded = [found.pop("graded")] if "graded" in found else []
    return list(found.values()), graded


def spread(values: Sequence[float]) -> str:
    """Return the smallest and the largest value as text, or the only value."""
    low, high = (f"{value:.3g}" for value in (min(values), max(values)))
    return low if low == high else f"{low} … {high}"


def slope_triangle(curves: Sequence[Curve], slope: float, decades: float, small: bool = False) -> SlopeTriangle | None:
    """Return the slope triangle of a chart: above the left end of the curves, where increasing curves leave room.

    Parameters:
        curves: the curves of the chart; both axes are logarithmic.
        slope: the expected slope; NaN if it is unknown.
        decades: the height of the vertical axis in decades.
        small: whether the chart is so small that the slope must be written above the triangle, not to its left.

    Returns:
        The triangle; None if the slope is unknown or if every curve has a single point.
    """
    if math.isnan(slope) or max(len(curve.x) for curve in curves) < 2:
        return None
    left = min(math.log10(curve.x.min()) for curve in curves)
    width = max(math.log10(curve.x.max()) for curve in curves) - left
    start, end = left + 0.09 * width, left + 0.37 * width
    base = -math.inf
    for curve in curves:
        order = np.argsort(curve.x)
        x, y = np.log10(curve.x[order]), np.log10(curve.y[order])
        at = np.concatenate([x[(x > start) & (x < end)], np.clip([start, end], x[0], x[-1])])
        base = max(base, float((np.interp(at, x, y) - slope * (at - start)).max()))
    base += 0.07 * decades
    top = base + slope * (end - start)
    texts = ("", f"{slope:.3g}") if small else (f"{slope:.3g}", "1")
    corners = 10 ** np.array([[start, base], [end, top], [start, top]])
    return SlopeTriangle(corners, *texts, top=float(10 ** (top + (0.16 if small else 0.07) * decades)))


def convergence_chart(rates: pd.DataFrame, order: float) -> Chart:
    """Return the chart of the errors of one case against the mesh size, on all mesh families.

    The curves are the error, the discrete error and the part of the error that is due to time discretisation.

    Parameters:
        rates: the rows of one case in ``rates.csv``.
        order: the expected order, which is the slope of the triangle.
    """
    rates = rates.assign(in_time=rates["time_share"] * rates["error"])
    styles = family_styles(rates["family"])
    errors, parts = _error_curves(rates, styles), []
    for family, rows in by_family(rates).items():
        style = styles[family]
        parts.append(Curve.of(rows, "in_time", Style(style.colour, stroke="dotted")))
        parts.append(Curve.of(rows, "discrete_error", Style(style.colour, style.marker, "dashed", True)))
    values = rates[["error", "discrete_error", "in_time"]].to_numpy()
    values = values[values >= NEGLIGIBLE * rates["error"].min()]
    triangle = slope_triangle(errors, order, math.log10(values.max() / values.min()))
    tops = [triangle.top] if triangle else []
    x, y = log_axis("mesh size", rates["h"], symbol="h"), log_axis("maximum over time in ‖·‖_V", values, tops)
    subplot = Subplot(str(rates["case"].iloc[0]), x, y, [*parts, *errors], triangle=triangle)
    kinds = [
        ("error ‖u − u^h‖_V", Style(DARK, "o")),
        ("discrete error ‖Π^h u − u^h‖_V", Style(DARK, "o", "dashed", hollow=True)),
        ("share of time discretisation", Style(DARK, stroke="dotted")),
    ]

    finest = [rows.iloc[-1] for rows in by_family(rates).values()]
    last, graded = last_orders(rates)
    closer = [row["error"] / row["discrete_error"] for row in finest if row["discrete_error"] > 0]
    seen = []
    if last:
        seen.append(f"on the two finest meshes of a family the order is {spread(last)}, expected {order:.3g}")
    if graded:
        seen.append(f"meshes graded towards the singularity reach the order {spread(graded)}")
    if closer:
        seen.append(f"on the finest meshes u^h is {spread(closer)} times closer to Π^h u than to u")
    share = 100 * rates["time_share"].max()
    seen.append(f"discretisation in time contributes at most {share:.2g} % of the error on any mesh")
    families, summary = ", ".join(rates["family"].unique()), "errors against the mesh size, both logarithmic"
    text = caption("convergence", case=subplot.title, families=families, seen="; ".join(seen), negligible=NEGLIGIBLE)
    return Chart(summary, [subplot], [[*styles.items()], kinds], text)


def _error_curves(rates: pd.DataFrame, styles: Mapping[str, Style]) -> list[Curve]:
    return [Curve.of(rows, "error", styles[family]) for family, rows in by_family(rates).items()]


def overview_chart(rates: pd.DataFrame, expected: Mapping[str, float]) -> Chart:
    """Return the chart of the errors of all cases against the mesh size, with a subplot for each case.

    All subplots have the same horizontal axis; the subplots of one row have the same vertical axis.

    Parameters:
        rates: the rows of these cases in ``rates.csv``.
        expected: case ↦ expected order.
    """
    cases = list(dict.fromkeys(rates["case"]))
    # A number of columns near the square root that leaves few positions of the grid empty.
    nearest = math.ceil(math.sqrt(len(cases)))
    columns = min((min(nearest, MOST_COLUMNS), min(nearest + 1, MOST_COLUMNS)), key=lambda n: -len(cases) % n)
    styles, subplots = family_styles(rates["family"]), []
    x = log_axis("mesh size", rates["h"], symbol="h", least=2)
    for start in range(0, len(cases), columns):
        row = cases[start : start + columns]
        errors = rates.loc[rates["case"].isin(row), "error"]
        decades = math.log10(errors.max() / errors.min())
        curves = {case: _error_curves(rates[rates["case"] == case], styles) for case in row}
        triangles = {case: slope_triangle(curves[case], expected[case], decades, small=True) for case in row}
        y = log_axis("max_t ‖u − u^h‖_V", errors, [one.top for one in triangles.values() if one], least=2)
        subplots += [Subplot(case, x, y, curves[case], triangle=triangles[case]) for case in row]

    differences, on_graded = [], []
    for case, of_case in rates.groupby("case", sort=False):
        last, graded = last_orders(of_case)
        differences += [(order - expected[str(case)], str(case)) for order in last]
        on_graded += graded
    seen = ["single levels show no order"]
    if differences:
        (low, lowest), (high, highest) = min(differences), max(differences)
        seen = [
            "whether the curves run parallel to their triangles; the last order differs from the expected one by "
            f"{low:+.2g} ({lowest}) to {high:+.2g} ({highest})"
        ]
    if on_graded:
        seen.append(f"meshes graded towards a singularity reach the order {spread(on_graded)}")
    text = caption("overview", cases=_all_cases(cases), claim=rates["claim"].iloc[0], seen="; ".join(seen))
    summary = "error of every case against the mesh size, both logarithmic"
    return Chart(summary, subplots, [[*styles.items()]], text, columns=columns)


def order_differences(rates: pd.DataFrame, expected: Mapping[str, float]) -> pd.DataFrame:
    """Return the predicted and observed orders of the error and their differences, a row for each case and mesh family.

    Orders are observed over the last two refinements. Meshes that are graded towards a singularity are left out,
    because the predictions are for quasi-uniform meshes.

    Parameters:
        rates: rows of ``rates.csv``.
        expected: case ↦ predicted order.

    Returns:
        A table with the columns ``family``, ``predicted``, ``observed`` and ``difference``.
    """
    points = [
        (family, expected[str(case)], order)
        for (_, case), rows in rates.groupby(["scheme", "case"], sort=False)
        for family, order in finest_orders(rows, refinements=2).items()
        if family != "graded"
    ]
    table = pd.DataFrame(points, columns=["family", "predicted", "observed"])
    return table.assign(difference=table["observed"] - table["predicted"])


def orders_chart(rates: pd.DataFrame, expected: Mapping[str, float]) -> Chart | None:
    """Return the chart of observed orders of the error against predicted orders, a point for each case and mesh family.

    Parameters:
        rates: rows of ``rates.csv``.
        expected: case ↦ predicted order.

    Returns:
        The chart; None if no case was measured on two levels.
    """
    table = order_differences(rates, expected)
    if table.empty:
        return None
    styles = family_styles(table["family"])
    # Families are drawn next to each other, because their markers would hide each other.
    shifts = dict(zip(styles, 0.012 * (np.arange(len(styles)) - (len(styles) - 1) / 2), strict=True))
    top = max(1.1, float(table[["predicted", "observed"]].to_numpy().max()) + 0.1)
    diagonal = Curve(np.array([0.0, top]), np.array([0.0, top]), Style(GREY))
    dots = {family: Style(style.colour, style.marker, "none") for family, style in styles.items()}
    curves = [
        Curve(rows["predicted"].to_numpy() + shifts[str(family)], rows["observed"].to_numpy(), dots[str(family)])
        for family, rows in table.groupby("family")
    ]
    x, y = Axis("predicted order", 0.0, top), Axis("observed order, last two refinements", 0.0, top)
    low, high, sequences = table["difference"].min(), table["difference"].max(), counted(len(table), "sequence")
    return Chart(
        "observed order of convergence over the last two refinements against the predicted order, a point for each "
        "case and mesh family",
        [Subplot("", x, y, [diagonal, *curves])],
        [[HEADING, *dots.items()], [("observed = predicted", diagonal.style)]],
        caption("orders", cases=_all_cases(set(rates["case"])), low=low, high=high, sequences=sequences),
        f"Over the last two refinements, observed and predicted orders differ by at most {above(max(high, -low), 2)}",
    )


def _all_cases(cases: Collection[str]) -> str:
    return f"{'all ' if len(cases) > 1 else ''}{counted(len(cases), 'case')}"


def collapsed_chart(rates: pd.DataFrame) -> Chart:
    """Return the chart of the errors of all smooth cases, each divided by a constant C, so that the curves coincide.

    C h is the leading term of the interpolation error ‖u − Π^h u‖_V on the finest mesh. C follows from second
    derivatives of u, (5.23), not from the measured errors, so nothing is fitted. The upper subplot shows error/C, the
    lower subplot error/(C h), both against the mesh size h.
    """
    styles = family_styles(rates["family"])
    scaled, relative, last = [], [], dict[str, list[float]]()
    for (_, family), rows in rates.sort_values("level", kind="stable").groupby(["case", "family"], sort=False):
        h, finest = rows["h"].to_numpy(), rows.iloc[-1]
        errors = rows["error"].to_numpy() * finest["h"] / finest["predicted_interpolation"]
        scaled.append(Curve(h, errors, styles[str(family)]))
        relative.append(Curve(h, errors / h, styles[str(family)]))
        last.setdefault(str(family), []).append(float(relative[-1].y[-1]))
    ends, cases = np.array([rates["h"].min(), rates["h"].max()]), rates["case"].unique()
    line = Curve(ends, ends, Style(GREY))
    values = np.concatenate([curve.y for curve in relative])
    x = log_axis("mesh size", ends, symbol="h")
    finest_meshes = ", ".join(f"{min(ratios):.2f} … {max(ratios):.2f} ({family})" for family, ratios in last.items())
    y = log_axis("error / C", ends, *(curve.y for curve in scaled))
    return Chart(
        "errors of all cases over their constants against the mesh size",
        [
            Subplot("", x, y, [line, *scaled]),
            Subplot("", x, linear_axis("error / (C h)", values), relative, rules=(1.0,)),
        ],
        [[HEADING, *styles.items()], [("C h, not fitted", line.style)]],
        caption("collapsed", cases=_all_cases(cases), low=values.min(), high=values.max(), finest=finest_meshes),
        _order_in_words(rates),
    )


def _order_in_words(rates: pd.DataFrame) -> str:
    """Return the orders of the errors of smooth solutions over the last two refinements, and whether they are O(h)."""
    cases = rates.groupby(["scheme", "case"], sort=False)
    found = [order for _, rows in cases for order in finest_orders(rows, refinements=2).values()]
    if not found:
        return ""
    result = "The error is O(h)" if min(found) >= 1 - ORDER_ROOM else "On these meshes the error is not O(h)"
    observed = f"observed orders {below(min(found), 2)} to {above(max(found), 2)}"
    return f"{result}: {observed} in {_all_cases(rates['case'].unique())}, over the last two refinements"


def enclosure_charts(series: pd.DataFrame) -> Iterator[tuple[str, Chart]]:
    """Yield case and chart for each case and mesh family with two-sided bounds of the error in ``enclosures.csv``."""
    enclosed = series[series["trajectory"] == "enclosure"]
    for (case, family), rows in enclosed.groupby(["case", "family"], sort=False):
        yield str(case), enclosure_chart(rows, f"{case}, {family}")


def enclosure_chart(series: pd.DataFrame, title: str) -> Chart:
    """Return the chart of the two-sided bounds (enclosures) of an error over time, with a band for each level.

    The band reaches from d − y to d + y, where d is the distance of u_h from a more accurate displacement ũ and y is
    the bound of the error of ũ. The lower subplot shows the ends of the bands divided by the error or, if the error is
    unknown, by d.

    Parameters:
        series: rows of ``enclosures.csv`` or of ``study bound`` with ``level``, ``time``, ``distance`` d, ``bound`` y,
            ``error``, which is NaN if it is unknown, and possibly ``plain``, a bound from u_h alone.
        title: the title of the upper subplot.
    """
    known = bool(series["error"].notna().all())
    ends = series.assign(
        lower=(series["distance"] - series["bound"]).clip(lower=0),
        upper=series["distance"] + series["bound"],
        middle=series["error" if known else "distance"],
    )
    time, name = linear_axis("time", ends["time"], symbol="t"), "error" if known else "‖ũ − u_h‖_V"
    floor, highest = float(ends["upper"].min()) / 3, [ends[each] for each in ("upper", "plain") if each in ends]
    errors = Axis("‖u(t) − u_h(t)‖_V", floor, log_axis("", floor, *(each.max() for each in highest)).high, "log")
    bands, curves, ratios, levels, last = [], [], [], [], []
    for (level, rows), colour in zip(ends.groupby("level"), cycle(COLOURS), strict=False):
        t, low, high = (rows[column].to_numpy() for column in ("time", "lower", "upper"))
        bands.append(Band(t, low.clip(min=floor), high, colour))
        if "plain" in rows:
            curves.append(Curve.of(rows, "plain", Style(colour, stroke="dotted"), "time"))
        curves.append(middle := Curve.of(rows, "middle", Style(colour), "time"))
        ratios += [Curve(t, end / middle.y, Style(colour)) for end in (low, high)]
        levels.append((f"n = {level}", Style(colour, stroke="band")))
        final = int(np.argmax(t))
        last.append(f"{interval(low[final], high[final], 3)} with n = {level}")
    lines = [(name, Style(BLACK))]
    if "plain" in series:
        lines.append(("bound from u_h alone", Style(BLACK, stroke="dotted")))

    line = "the error itself" if known else "the distance to a more accurate displacement ũ"
    inside = ends[(ends["error"] - ends["distance"]).abs() <= ends["bound"]]
    seen = f"the error lies in its band at {len(inside)} of {len(ends)} times; " if known else ""
    return Chart(
        "error over time between its bounds, logarithmic",
        [
            Subplot(title, time, errors, curves, bands),
            Subplot("", time, Axis(f"ends over {name}", 0.0, 2.0), ratios, rules=[1.0]),
        ],
        [levels, lines],
        caption("enclosure", title=title, line=line, seen=seen, last=", ".join(last)),
    )


def work_chart(statements: pd.DataFrame) -> Chart | None:
    """Return the chart of the contact term of the error estimate against the mesh size, a subplot for each case.

    The curves are the square root of the work of contact, the error, and the excess: the distance between u^h and the
    solution of the linear problem with the exact contact pressure as traction.

    Parameters:
        statements: the content of ``statements.csv``.

    Returns:
        The chart; None if the work of contact was not measured.
    """
    strokes: dict[str, Stroke] = {"work": "solid", "error": "dotted", "excess": "dashed"}
    rows = statements[(statements["label"] == "beyond: work of contact") & statements["quantity"].isin(strokes)]
    if rows.empty:
        return None
    styles, subplots = family_styles(rows["family"]), []
    decades = float(np.log10(rows["value"].max() / rows["value"].min()))
    found: dict[str, list[float]] = {name: [] for name in strokes}
    for case, of_case in rows.groupby("case", sort=False):
        curves = []
        for (family, quantity), unsorted in of_case.groupby(["family", "quantity"], sort=False):
            look = replace(styles[str(family)], stroke=strokes[str(quantity)], hollow=quantity != "work")
            curves.append(curve := Curve.of(unsorted.sort_values("level"), "value", look))
            if family == "one-diagonal" and len(curve.x) > 1:
                found[str(quantity)] += [float(order) for order in orders(curve.x[-3:], curve.y[-3:])]
        # The subplots share axes on which every case must have room.
        triangle = slope_triangle(curves, 1.0, decades)
        y = log_axis("", rows["value"], [triangle.top] if triangle else [])
        x = log_axis("mesh size", rows["h"], symbol="h", least=2)
        subplots.append(Subplot(str(case), x, y, curves, triangle=triangle))
    seen = "single levels show no order"
    if found["work"]:
        seen = (
            f"on the finest meshes with one diagonal the order of the work is {spread(found['work'])}, while the "
            f"error, for which the trains are hardly resolved, has {spread(found['error'])}; on irregular meshes the "
            "work scatters about the same line"
        )
    kinds = [
        ("work ‖R‖^{1/2}", Style(DARK, "o")),
        ("error ‖u − u^h‖_V", Style(DARK, "o", "dotted", hollow=True)),
        ("excess ‖u^h − u^h_{lin}‖_V", Style(DARK, "o", "dashed", hollow=True)),
    ]
    return Chart(
        "work of contact, error and excess against the mesh size, all logarithmic",
        subplots,
        [[*styles.items()], kinds],
        caption("contact-work", seen=seen),
        columns=2,
    )


def rollers_chart(statements: pd.DataFrame) -> Chart | None:
    """Return the chart of the additional error due to the contact condition, for a narrow patch that rolls along Γ3.

    This is the error that contact adds to the error of the linear problem.

    There is a curve for each mesh family; for shaken meshes it shows the mean, with a band for the range. The width of
    the contact patch is twice the mesh size.

    Parameters:
        statements: the content of ``statements.csv``.

    Returns:
        The chart; None if the error was not measured.
    """
    chosen = statements["label"].eq("beyond: rollers") & statements["quantity"].eq("excess")
    rows = statements[chosen & statements["case"].str.fullmatch(r"roller-\d+")]
    if rows.empty:
        return None
    rows = rows.assign(family=rows["family"].where(~rows["family"].str.match("shaken"), "shaken"))
    styles, curves, bands, found = family_styles(rows["family"]), [], [], []
    for family, of_family in rows.groupby("family", sort=False):
        levels, style = of_family.groupby("level"), styles[str(family)]
        table = levels["value"].agg(["mean", "min", "max"]).assign(h=levels["h"].mean())
        h, mean, low, high = table.sort_values("h", ascending=False)[["h", "mean", "min", "max"]].to_numpy().T
        curves.append(Curve(h, mean, style))
        if family == "shaken":
            bands.append(Band(h, low, high, style.colour))
        if len(h) > 1:
            found.append(f"{fit(h, mean):.2f} ({family})")
    triangle = slope_triangle(curves, 0.5, math.log10(rows["value"].max() / rows["value"].min()))
    lowest = min(curves, key=lambda curve: float(curve.y.min()))
    ends = np.array([lowest.x.min(), lowest.x.max()])
    linear = Curve(ends, 0.8 * float((lowest.y / lowest.x).min()) * ends, Style(GREY, stroke="dotted"))
    x = log_axis("mesh size", rows["h"], symbol="h")
    y = log_axis("excess max_t ‖u^h − u^h_{lin}‖_V", rows["value"], linear.y.min(), [triangle.top] if triangle else [])
    seen = f"orders over all levels are {', '.join(found)}" if found else "single levels show no order"
    return Chart(
        "excess of contact over the linear problem against the mesh size, both logarithmic",
        [Subplot("", x, y, [*curves, linear], bands, triangle)],
        [[*styles.items()], [("slope 1", linear.style)]],
        caption("rollers", seen=seen),
    )


def codes_chart(codes: Codes) -> Chart:
    """Return the chart of the results of other people's contact codes.

    Each point is a code with its parameters on one case and mesh family. The upper subplot shows the observed order of
    the error in V, the lower subplot the distance from the solution in K^h, both against the error of the contact
    pressure on the finest mesh.
    """
    tolerance, rounding = 0.15, 1e-11
    rows = codes.series().dropna(subset=["order_in_v", "share", "excess"])
    rows = rows.assign(share=rows["share"].clip(lower=rounding))
    colours = dict(zip(GRADES, (BLUE, GREEN, ORANGE, VERMILLION, GREY), strict=True))
    markers = dict(zip(GRADES, ("o", "s", "D", "X", "h"), strict=True))
    curves: dict[str, list[Curve]] = {"order_in_v": [], "share": []}
    legend = []
    for grade in [grade for grade in GRADES if (rows["class"] == grade).any()]:
        style = Style(colours[grade], markers[grade], hollow=True)
        legend.append((grade, style))
        for column, points in curves.items():
            places = rows.loc[rows["class"] == grade, ["excess", column]].to_numpy()
            points += [Curve(place[:1], place[1:], style) for place in places]
    passing = rows[abs(rows["order_in_v"] - 1) <= tolerance]
    bad = passing[passing["class"].isin(["stagnates", "wrong"])]
    x = log_axis("error of the pressure / that of the solution in K^h", rows["excess"])
    order, share = linear_axis("order in V", rows["order_in_v"]), log_axis("distance / error", rows["share"])
    return Chart(
        "order in V and distance from the right solution against the error of the pressure, for all contact codes",
        [
            Subplot("", x, order, curves["order_in_v"], rules=(1.0,)),
            Subplot("", x, share, curves["share"], rules=(1.0,)),
        ],
        [legend[::2], legend[1::2]],
        caption(
            "codes",
            runs=counted(len(rows), "run"),
            codes=counted(rows["code"].nunique(), "contact code"),
            bad=counted(len(bad), "run"),
            tolerance=tolerance,
            most=bad["excess"].max(),
        ),
    )


def growth_chart(growth: pd.DataFrame) -> Chart:
    """Return the chart of the cost of a solution against the number of unknowns.

    The upper subplot shows seconds, the lower subplot memory per unknown; each dimension and solver has a colour.

    Parameters:
        growth: the content of ``benchmarks/growth.csv``.
    """
    kib = 1024
    growth = growth.dropna(subset="dofs").assign(kib_per_dof=growth["peak_bytes"] / growth["dofs"] / kib)
    parts = {
        "level_seconds": ("a level: all steps", Style(DARK)),
        "factor_seconds": ("once: factorising or coarsening", Style(DARK, stroke="dashed")),
        "step_seconds": ("one step in time", Style(DARK, stroke="dotted")),
    }
    seconds: list[Curve] = []
    memory: list[Curve] = []
    solvers, seen = [], []
    looks = cycle(zip(COLOURS, "os^DvP", strict=True))
    for ((dim, solver), unsorted), (colour, marker) in zip(growth.groupby(["dim", "solver"], sort=False), looks):  # noqa: B905
        rows, style, name = unsorted.sort_values("dofs"), Style(colour, marker), f"{dim}D, {solver}"
        for column, (_, part) in parts.items():
            seconds.append(Curve.of(rows, column, replace(style, stroke=part.stroke), "dofs"))
        memory.append(Curve.of(rows, "kib_per_dof", style, "dofs"))
        solvers.append((f"{name} ({len(rows)} {'mesh' if len(rows) == 1 else 'meshes'})", style))
        last = rows.iloc[-1]
        text = (
            f"{name}: {last['level_seconds']:.3g} s and {last['peak_bytes'] / kib**3:.2g} GiB for {last['dofs']:.0f} "
            "unknowns"
        )
        if last["dofs"] > rows["dofs"].iloc[0]:
            exponent, _ = np.polyfit(np.log(rows["dofs"]), np.log(rows["level_seconds"]), 1)
            text += f", time growing like unknowns^{exponent:.2f}"
        seen.append(text)
    # The line of slope 1 starts above the curves so that it does not cover them.
    ends = np.array([growth["dofs"].min(), growth["dofs"].max()], dtype=float)
    first = growth[growth["dofs"] == ends[0]]
    line = Curve(ends, 1.6 * (first["level_seconds"] / first["dofs"]).max() * ends, Style(GREY))
    positive: list[Array] = [curve.y[curve.y > 0] for curve in [*seconds, line]]
    x = log_axis("unknowns", ends, least=2)
    return Chart(
        "seconds and memory per unknown against the number of unknowns, all logarithmic",
        [
            Subplot("", x, log_axis("seconds", *positive, least=2), [*seconds, line]),
            Subplot("", x, log_axis("KiB per unknown", *(curve.y for curve in memory), least=2), memory),
        ],
        [solvers, [*parts.values(), ("slope 1", line.style)]],
        caption("growth", seen="; ".join(seen)),
    )

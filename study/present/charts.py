"""The charts of the study and their captions, made from the data files. Each figure has a function for its caption."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, cycle, zip_longest
from math import ceil, inf, isnan
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib import rcParams
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import LogFormatterSciNotation, LogLocator, NullFormatter
from matplotlib.tri import Triangulation
from pandas import DataFrame

from manufactured.colours import BLACK, BLUE, DARK, GREEN, GREY, ORANGE, SKY, VERMILLION
from study.ledger.check import by_family
from study.ledger.codes import GRADES, Codes
from study.ledger.controls import INVISIBLE_SHARE
from study.ledger.files import Json
from study.ledger.quantities import Array, fit, orders
from study.ledger.text import interval, outwards
from study.present.drawing import (
    COLOURS,
    OUTLINE,
    TRIANGLE,
    Style,
    column_width,
    dots,
    entry,
    family_styles,
    legend,
    page_width,
)
from study.present.outcome import Orders, finest_orders, order_differences
from study.present.picture import Bools
from study.present.templates import counted

# Axes, ticks, legends and slope triangles.

DASHED: Style = dict(ls="--", lw=0.7)
DOTTED: Style = dict(ls=":", lw=0.9, alpha=0.8)
HOLLOW: Style = {"mfc": "white"}
RANGE: Style = dict(alpha=0.35, lw=0)
RULE: Style = dict(color=GREY, lw=0.6)
MANTISSAS = ((1,), (1, 3), (1, 2, 5), (1, 1.5, 2, 3, 5, 7), (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8, 9))
"""The ticks of a logarithmic axis in a decade: the first choice with enough ticks is taken."""
MESH_SIZE = "mesh size $h$"
Lines = dict[str, tuple[str, Style]]
"""Column of a table ↦ its text in the legend, and the style of its lines."""


def stacked_axes(*heights: int) -> tuple[Figure, list[Axes]]:
    """Return a figure as wide as a column of text, and its axes, which lie one above the other.

    Parameters:
        heights: the relative heights of the axes.
    """
    figure = Figure(figsize=(column_width(), 3.8 + 0.2 * len(heights)))
    panels = list(figure.subplots(len(heights), sharex=True, squeeze=False, height_ratios=heights)[:, 0])
    for axes in panels:
        axes.grid(True)
    return figure, panels


def draw_cases(rows: DataFrame, quantities: Lines, slopes: Orders, columns: int) -> Figure:
    """Draw quantities against the mesh size in a grid of small axes, one for each case.

    The axes in a row of the grid have the same limits.

    Parameters:
        rows: a table with the columns ``case``, ``family``, ``h`` and the quantities.
        quantities: column ↦ its text in the legend, and the style of its lines; a line for each mesh family.
        slopes: case ↦ slope of its triangle.
        columns: the number of columns of the grid.
    """
    cases = rows.case.unique()
    styles = family_styles(rows.family)
    lines = ceil(len(cases) / columns)
    width = min(max(column_width(), 0.5 + 1.05 * columns), page_width())
    figure = Figure(figsize=(width, 0.8 + (0.15 + 0.9 * (width - 0.5) / columns) * lines))
    panels = figure.subplots(lines, columns, sharex=True, sharey="row", squeeze=False).ravel()
    shown = dict(zip(cases, panels, strict=False))
    for i, (case, axes) in enumerate(shown.items()):
        for column, (_, style) in quantities.items():
            plot_families(axes, rows[rows.case == case], column, styles, dict(style, ms=2.4))
        axes.set_title(fill(case, 22), fontsize=rcParams["xtick.labelsize"], linespacing=0.95)
        axes.tick_params(labelbottom=i + columns >= len(cases))
        axes.grid(True)
    # Triangles come last, because axes of a row share their limits.
    for case, axes in shown.items():
        draw_slope(axes, slopes[case], small=True)
    for axes in panels[len(cases) :]:
        axes.set_visible(False)
    label_ticks(shown.values(), least=2)
    figure.supxlabel(MESH_SIZE)
    kinds = [entry(text, color=DARK, marker="o", **style) for text, style in quantities.values() if text]
    legend(figure, [*families(styles)[1:], *kinds], columns=3 if kinds else len(styles), side="upper")
    return figure


def label_ticks(panels: Iterable[Axes], least: int = 3) -> None:
    """Label at least ``least`` ticks of each logarithmic axis, also if the axis is shorter than a decade."""
    for axis in (axis for axes in panels for axis in (axes.xaxis, axes.yaxis)):
        if axis.get_scale() != "log":
            continue
        low, high = axis.get_view_interval()
        for mantissas in MANTISSAS:
            locator = LogLocator(subs=mantissas)
            ticks = np.asarray(locator.tick_values(low, high))
            if np.count_nonzero((low <= ticks) & (ticks <= high)) >= least:
                break
        axis.set_major_locator(locator)
        axis.set_major_formatter(LogFormatterSciNotation(minor_thresholds=(inf, inf)))
        axis.set_minor_formatter(NullFormatter())


def complete(figure: Figure, *columns: Sequence[Artist]) -> Figure:
    """Label the ticks of the axes, add a legend with these columns below the axes, and return the figure."""
    label_ticks(figure.axes)
    # Matplotlib fills a legend column by column, so shorter columns get blank entries.
    lines = zip_longest(*columns, fillvalue=entry(" ", ls=""))
    legend(figure, list(chain(*zip(*lines, strict=True))), columns=len(columns))
    return figure


def families(styles: Mapping[str, Style], **more: Any) -> list[Line2D]:
    """Return the legend entries of mesh families: a heading, then an entry for each family.

    Parameters:
        styles: mesh family ↦ style of its line.
        more: further properties of all lines.
    """
    return [entry("mesh family", ls=""), *(entry(family, **style, **more) for family, style in styles.items())]


def plot_families(axes: Axes, rows: DataFrame, column: str, styles: Mapping[str, Style], more: Style) -> None:
    """Plot a column of a table over the mesh size, both logarithmic, with a line for each mesh family.

    Parameters:
        axes: the axes.
        rows: a table with the columns ``family``, ``h`` and ``column``.
        column: the name of the column that is plotted.
        styles: mesh family ↦ style of its line.
        more: further properties of all lines.
    """
    for family, of_family in by_family(rows).items():
        axes.loglog(of_family.h, of_family[column], **styles[family] | more)


def draw_slope(axes: Axes, slope: float, small: bool = False) -> None:
    """Draw a triangle with a slope above the left end of the increasing lines of axes, where they leave room.

    Nothing is drawn if the slope is NaN, or if every line has a single point.

    Parameters:
        axes: the axes, whose scales are logarithmic; their lines go from large to small mesh sizes.
        slope: the slope.
        small: whether the axes are so small that the slope must be written above the triangle, not to its left.
    """
    curves = [np.log10(line.get_xydata()) for line in axes.get_lines()]
    if isnan(slope) or max(map(len, curves)) < 2:
        return
    decades = np.ptp(np.log10(axes.get_ylim()))
    x = np.concatenate(curves)[:, 0]
    start, end = x.min() + np.ptp(x) * np.array([0.09, 0.37])
    at = np.linspace(start, end, 50)
    heights = [np.interp(at, *curve[::-1].T) - slope * (at - start) for curve in curves]
    base = np.nanmax(heights) + 0.06 * decades
    top = base + slope * (end - start)
    corners = 10 ** np.array([[start, base], [end, top], [start, top]])
    axes.fill(*corners.T, facecolor=TRIANGLE, edgecolor=OUTLINE, lw=0.6, zorder=1.5)
    shown = f"{slope:.3g}"
    text = dict(textcoords="offset points", fontsize=rcParams["xtick.labelsize"])
    beside = (10**start, 10 ** ((base + top) / 2))
    above_it = (10 ** ((start + end) / 2), 10**top)
    if not small:
        axes.annotate(shown, beside, (-2, 0), ha="right", va="center", **text)
    axes.annotate(shown if small else "1", above_it, (0, 1.5), ha="center", va="bottom", **text)
    # The text needs room above the triangle.
    axes.update_datalim([(10**end, 10 ** (top + 0.13 * decades))])
    axes.autoscale_view()


# Observed orders.

ROOM_BELOW = 0.15
"""Observed orders may be smaller than the proved order by this number, as in the checks of Proposition 5.4."""


def last_orders(rates: DataFrame) -> tuple[list[float], list[float]]:
    """Return the observed orders over the last refinement, one for each mesh family, in two lists.

    The second list has the order on graded meshes, if there is one.

    Parameters:
        rates: rows of ``rates.csv`` of one case.
    """
    by_name = finest_orders(rates, refinements=1)
    graded = [by_name.pop("graded")] if "graded" in by_name else []
    return list(by_name.values()), graded


def _all_cases(rates: DataFrame) -> str:
    count = rates.case.nunique()
    return f"{'all ' if count > 1 else ''}{counted(count, 'case')}"


# Errors against the mesh size.

NEGLIGIBLE_VALUE = 1e-3
"""In a chart of errors, values below this fraction of the smallest error are not shown, because the vertical axis would
become too long."""
ERROR_LINES: Lines = {
    "error": (r"error $\|u-u^h\|_V$", {}),
    "discrete_error": (r"discrete error $\|\Pi^hu-u^h\|_V$", DASHED | HOLLOW),
    "in_time": ("share of time discretisation", {"marker": "", **DOTTED}),
}
MOST_COLUMNS = 5
"""The largest number of columns of the figure with axes for each case."""


def draw_convergence(rates: DataFrame, order: float) -> Figure:
    """Draw the errors of one case against the mesh size, on all mesh families.

    The lines are the error ‖u − u^h‖_V, the discrete error ‖Π^h u − u^h‖_V, where Π^h u is the interpolant of u, and
    the part of the error that is due to time discretisation.

    Parameters:
        rates: the rows of one case in ``rates.csv``.
        order: the expected order, which is the slope of the triangle.
    """
    figure, (axes,) = stacked_axes(1)
    styles = family_styles(rates.family)
    lowest = NEGLIGIBLE_VALUE * rates.error.min()
    rates = rates.assign(in_time=rates.time_share * rates.error)
    for column, (_, style) in reversed(ERROR_LINES.items()):
        shown = rates.assign(**{column: rates[column].where(rates[column] >= lowest)})
        plot_families(axes, shown, column, styles, style)
    draw_slope(axes, order)
    axes.set(title=rates.case.iloc[0], xlabel=MESH_SIZE, ylabel=r"maximum over time in $\|\cdot\|_V$")
    kinds = [entry(text, color=DARK, **{"marker": "o"} | style) for text, style in ERROR_LINES.values()]
    return complete(figure, families(styles), kinds)


def values_of_convergence(rates: DataFrame, order: float) -> Json:
    """Return the values in the caption of ``draw_convergence``: name in the template ↦ value."""
    last, graded = last_orders(rates)
    finest = rates.groupby("family").tail(1).query("discrete_error > 0")
    closer = finest.error / finest.discrete_error
    return dict(
        rates=rates,
        order=order,
        last=last,
        graded=graded,
        closer=closer,
        negligible=NEGLIGIBLE_VALUE,
    )


def draw_overview(rates: DataFrame, expected: Orders) -> Figure:
    """Draw the errors of all cases against the mesh size, with axes for each case.

    Parameters:
        rates: the rows of these cases in ``rates.csv``.
        expected: case ↦ expected order.
    """
    columns = min(MOST_COLUMNS, rates.case.nunique())
    figure = draw_cases(rates, {"error": ("", {})}, expected, columns)
    figure.supylabel(r"$\max_t\,\|u-u^h\|_V$")
    return figure


def values_of_overview(rates: DataFrame, expected: Orders) -> Json:
    """Return the values in the caption of ``draw_overview``: name in the template ↦ value."""
    differences = order_differences(rates, expected, refinements=1).set_index("case")["difference"]
    graded = [order for _, rows in rates.groupby("case") for order in last_orders(rows)[1]]
    return dict(rates=rates, cases=_all_cases(rates), differences=differences, graded=graded)


def draw_orders(rates: DataFrame, expected: Orders) -> Figure:
    """Draw observed orders of the error against predicted orders, a point for each case and mesh family.

    Parameters:
        rates: rows of ``rates.csv``.
        expected: case ↦ predicted order.
    """
    table = order_differences(rates, expected)
    styles = family_styles(table.family)
    figure, (axes,) = stacked_axes(1)
    top = max(1.1, table[["predicted", "observed"]].max(axis=None) + 0.1)
    axes.plot([0, top], [0, top], color=GREY)
    for number, (family, style) in enumerate(styles.items()):
        rows = table[table.family == family]
        # Families are drawn next to each other, because their markers would hide each other.
        shift = 0.012 * (number - (len(styles) - 1) / 2)
        axes.plot(rows.predicted + shift, rows.observed, ls="", **style)
    axes.set(xlabel="predicted order, families side by side", xlim=(0, top))
    axes.set(ylabel="observed order, last two refinements", ylim=(0, top))
    return complete(figure, families(styles, ls=""), [entry("observed = predicted", color=GREY)])


def values_of_orders(rates: DataFrame, expected: Orders) -> Json:
    """Return the values in the caption of ``draw_orders``: name in the template ↦ value."""
    differences = order_differences(rates, expected)["difference"]
    ends = outwards(differences.min(), differences.max())
    return dict(cases=_all_cases(rates), sequences=len(differences), ends=ends)


def over_constants(rates: DataFrame) -> DataFrame:
    """Return the rows of ``rates.csv`` with two more columns: ``scaled`` is error / C, ``relative`` is error / (C h).

    C is one constant for each case and mesh family: the leading term of the interpolation error ‖u − Π^h u‖_V on the
    finest mesh, divided by the mesh size of this mesh. It follows from second derivatives of u, (5.23), not from the
    measured errors, so nothing is fitted.
    """
    rates = rates.sort_values("level", kind="stable")
    finest = rates.groupby(["case", "family"], sort=False)[["h", "predicted_interpolation"]].transform("last")
    scaled = rates.error * finest.h / finest.predicted_interpolation
    return rates.assign(scaled=scaled, relative=scaled / rates.h)


def draw_collapsed(rates: DataFrame) -> Figure:
    """Draw the errors of all smooth cases, each divided by its constant C, so that the lines coincide.

    The upper axes show error / C, the lower axes error / (C h), both against the mesh size h. ``over_constants`` says
    what C is.
    """
    styles = family_styles(rates.family)
    figure, (errors, ratios) = stacked_axes(3, 2)
    ends = [rates.h.max(), rates.h.min()]
    errors.loglog(ends, ends, color=GREY)
    ratios.axhline(1, **RULE)
    for (_, family), rows in over_constants(rates).groupby(["case", "family"], sort=False):
        errors.plot(rows.h, rows.scaled, **styles[family])
        ratios.plot(rows.h, rows.relative, **styles[family])
    draw_slope(errors, 1)
    errors.set_ylabel("error / C")
    ratios.set(xlabel=MESH_SIZE, ylabel="error / (C h)")
    return complete(figure, families(styles), [entry("C h, not fitted", color=GREY)])


def values_of_collapsed(rates: DataFrame) -> Json:
    """Return the values in the caption of ``draw_collapsed``: name in the template ↦ value."""
    table = over_constants(rates)
    finest = table.groupby(["case", "family"], sort=False)["relative"].last().groupby("family", sort=False)
    orders = order_in_words(rates)
    return dict(cases=_all_cases(rates), relative=table.relative, finest=finest, orders=orders)


def order_in_words(rates: DataFrame) -> str:
    """Return the orders of the errors of smooth solutions over the last two refinements, and whether they are O(h)."""
    observed = order_differences(rates, dict.fromkeys(rates.case, 1.0))["observed"]
    if observed.empty:
        return ""
    low = observed.min()
    result = "the error is O(h)" if low >= 1 - ROOM_BELOW else "on these meshes the error is not O(h)"
    orders = outwards(low, observed.max())
    return f"{result}: observed orders {orders} in {_all_cases(rates)}, over the last two refinements"


# Bounds of the error.


def enclosed_series(series: DataFrame) -> Iterator[tuple[str, DataFrame, str]]:
    """Yield case, rows and title for each case and mesh family with two-sided bounds in ``enclosures.csv``."""
    enclosed = series[series.trajectory == "enclosure"]
    for (case, family), rows in enclosed.groupby(["case", "family"], sort=False):
        yield case, rows, f"{case}, {family}"


def enclosure_ends(series: DataFrame) -> DataFrame:
    """Return a table of error bounds with two more columns, ``lower`` and ``upper``: the error lies between them.

    Parameters:
        series: a table with ``distance``, the distance of u_h from a more accurate displacement ũ, and ``bound``, the
            bound of the error of ũ. The ends are their difference, at least 0, and their sum.
    """
    lower = (series.distance - series.bound).clip(lower=0)
    return series.assign(lower=lower, upper=series.distance + series.bound)


def draw_enclosure(series: DataFrame, title: str) -> Figure:
    """Draw the two-sided bounds (enclosures) of an error over time, with a band for each level.

    The band reaches from d − y to d + y, where d is the distance of u_h from a more accurate displacement ũ and y is
    the bound of the error of ũ. The lower axes show the ends of the bands divided by the error or, if the error is
    unknown, by d.

    Parameters:
        series: rows of ``enclosures.csv`` or of ``study bound`` with ``level``, ``time``, ``distance`` d, ``bound`` y,
            ``error``, which is NaN if it is unknown, and possibly ``plain``, a bound from u_h alone.
        title: the title of the upper axes.
    """
    known = series.error.notna().all()
    ends = enclosure_ends(series)
    column, name = ("error", "error") if known else ("distance", r"$\|\tilde u-u_h\|_V$")
    figure, (errors, ratios) = stacked_axes(3, 2)
    errors.set_yscale("log")
    lowest = ends.upper.min() / 3
    levels = []
    for (level, rows), colour in zip(ends.groupby("level"), cycle(COLOURS), strict=False):
        time = rows.time
        errors.fill_between(time, rows.lower.clip(lower=lowest), rows.upper, color=colour, **RANGE)
        errors.plot(time, rows[column], color=colour)
        if "plain" in rows:
            errors.plot(time, rows.plain, color=colour, **DOTTED)
        for end in ("lower", "upper"):
            ratios.plot(time, rows[end] / rows[column], color=colour)
        levels.append(Patch(color=colour, **RANGE, label=f"$n={level}$"))
    ratios.axhline(1, **RULE)
    errors.set(title=title, ylabel=r"$\|u(t)-u_h(t)\|_V$", ylim=(lowest, None))
    ratios.set(xlabel="time $t$", ylabel=f"ends over {name}", ylim=(0, 2))
    lines = [entry(name, color=BLACK)]
    if "plain" in series:
        lines.append(entry("bound from $u_h$ alone", color=BLACK, **DOTTED))
    return complete(figure, levels, lines)


def values_of_enclosure(series: DataFrame, title: str) -> Json:
    """Return the values in the caption of ``draw_enclosure``: name in the template ↦ value."""
    known = series.error.notna().all()
    ends = enclosure_ends(series)
    inside = ends[(ends.error - ends.distance).abs() <= ends.bound]
    final = ends.loc[ends.groupby("level")["time"].idxmax()]
    return dict(title=title, interval=interval, known=known, ends=ends, inside=inside, final=final)


@dataclass(frozen=True, eq=False)
class AdaptiveRefinement:
    """The result of an adaptive refinement.

    Attributes:
        name: the name of the problem.
        norm: the error that is bounded, as text.
        mesh: the last mesh.
        edges: coordinates of the ends of the edges on Γ3, (2, 2, edges).
        closed: whether an edge is in contact at the last time, (edges,).
        rows: the content of ``adaptive.csv``, a row for each mesh of the refinement.
        uniform: the content of ``levels.csv``, a row for each uniform mesh; empty if there are none.
    """

    name: str
    norm: str
    mesh: Triangulation
    edges: Array
    closed: Bools
    rows: DataFrame
    uniform: DataFrame


def draw_adapted(result: AdaptiveRefinement) -> Figure:
    """Draw the last adapted mesh, and the bounds of the error against the number of unknowns."""
    figure = Figure(figsize=(page_width(), 0.5 * page_width()))
    rows = result.rows
    mesh, bounds = figure.subplots(1, 2)
    mesh.triplot(result.mesh, color=DARK, lw=0.25)
    handles = []
    for which, colour, text in ((result.closed, VERMILLION, "touches"), (~result.closed, BLUE, "is open")):
        mesh.add_collection(LineCollection(list(result.edges[:, :, which].T), colors=colour, linewidths=2.5, zorder=3))
        handles += [entry(f"CONTACT side {text}", color=colour, lw=2.5)] * bool(result.closed.size)
    mesh.set(aspect="equal", title=f"mesh {rows['mesh'].iloc[-1]}, {rows['cells'].iloc[-1]} cells")
    mesh.axis("off")
    handles += bounds.loglog(rows.dofs, rows.bound, color=BLUE, marker="o", label="adaptive")
    if len(result.uniform):
        uniform = result.uniform
        handles += bounds.plot(uniform.dofs, uniform.plain, color=GREY, marker="s", label="refined everywhere")
    bounds.plot(rows.dofs, rows.error, color=BLUE, ls=":")
    last = rows.iloc[-1]
    x = np.geomspace(rows.dofs.iloc[0], last.dofs, 3)
    y = 0.7 * last.bound * (x / last.dofs) ** -0.5
    bounds.plot(x, y, color=DARK, ls="--", lw=0.8)
    bounds.annotate("slope $-1/2$", (x[1], y[1]), (-5, -5), textcoords="offset points", ha="right", va="top")
    bounds.set(xlabel="unknowns", ylabel="bound of the error")
    legend(figure, handles, len(handles))
    return figure


def values_of_adapted(result: AdaptiveRefinement) -> Json:
    """Return the values in the caption of ``draw_adapted``: name in the template ↦ value."""
    return dict(result=result)


# Contact.

CONTACT_TERMS: Lines = {
    "work": (r"work $\|R\|^{1/2}$", {}),
    "error": (r"error $\|u-u^h\|_V$", DOTTED | HOLLOW),
    "excess": (r"excess $\|u^h-u^h_\mathrm{lin}\|_V$", DASHED | HOLLOW),
}
"""Quantity of ``statements.csv`` ↦ its text in the legend, and the style of its lines."""


def work_rows(statements: DataFrame) -> DataFrame:
    """Return a table for ``draw_work`` from the rows "beyond: work of contact" of ``statements.csv``.

    It has a row for each case, mesh family and level, with the mesh size ``h`` and a column for each measured quantity
    in ``CONTACT_TERMS``: ``work``, ``error`` and ``excess``.
    """
    chosen = statements.label.eq("beyond: work of contact") & statements.quantity.isin(CONTACT_TERMS)
    key = ["case", "family", "level", "h"]
    return statements[chosen].pivot_table("value", key, "quantity", sort=False).reset_index()


def draw_work(rows: DataFrame) -> Figure:
    """Draw the contact term of the error estimate against the mesh size, with axes for each case.

    The lines are the square root of the work of contact, the error, and the excess: the distance between u^h and the
    solution of the linear problem with the exact contact pressure as traction.

    Parameters:
        rows: the table that ``work_rows`` returns.
    """
    return draw_cases(rows, CONTACT_TERMS, dict.fromkeys(rows.case, 1.0), columns=2)


def values_of_work(rows: DataFrame) -> Json:
    """Return the values in the caption of ``draw_work``: name in the template ↦ value."""
    by_term: dict[str, list[float]] = {"work": [], "error": []}
    for _, of_case in rows[rows.family == "one-diagonal"].groupby("case"):
        last = of_case.sort_values("level").tail(3)
        for term, of_term in by_term.items():
            of_term += orders(last.h, last[term]).tolist()
    return by_term


def roller_rows(statements: DataFrame) -> DataFrame:
    """Return the rows of ``statements.csv`` for ``draw_rollers``: those with the excess for the cases of rollers.

    The excess, in the column ``value``, is max_t ‖u^h − u^h_lin‖_V, the error that contact adds to the error of the
    linear problem. The families of all shaken meshes, which have different random seeds, become one mesh family,
    "shaken".
    """
    chosen = statements.label.eq("beyond: rollers") & statements.quantity.eq("excess")
    rows = statements[chosen & statements.case.str.fullmatch(r"roller-\d+")]
    return rows.replace({"family": {"^shaken.*": "shaken"}}, regex=True)


def roller_means(rows: DataFrame) -> Iterator[tuple[str, DataFrame]]:
    """Yield each mesh family with a table that has a row for each level, from coarse to fine.

    The table has the mesh size ``h`` and the ``mean``, ``min`` and ``max`` of the values of ``roller_rows``.
    """
    for family, of_family in rows.groupby("family", sort=False):
        levels = of_family.groupby("level")
        yield family, levels["value"].agg(["mean", "min", "max"]).assign(h=levels["h"].mean())


def draw_rollers(rows: DataFrame) -> Figure:
    """Draw the additional error due to the contact condition, for a narrow patch that rolls along Γ3.

    This is the error that contact adds to the error of the linear problem. There is a line for each mesh family; for
    shaken meshes it shows the mean, with a band for the range. The width of the contact patch is twice the mesh size.

    Parameters:
        rows: the rows that ``roller_rows`` returns.
    """
    styles = family_styles(rows.family)
    lowest = rows.loc[rows.value.idxmin()]
    figure, (axes,) = stacked_axes(1)
    for family, table in roller_means(rows):
        if family == "shaken":
            axes.fill_between(table.h, table["min"], table["max"], color=styles[family]["color"], **RANGE)
        axes.loglog(table.h, table["mean"], **styles[family])
    draw_slope(axes, 0.5)
    ends = rows.loc[rows.family == lowest["family"], "h"].agg(["min", "max"])
    axes.plot(ends, 0.8 * lowest["value"] / lowest["h"] * ends, color=GREY, **DOTTED)
    axes.set(xlabel=MESH_SIZE, ylabel=r"excess $\max_t\,\|u^h-u^h_\mathrm{lin}\|_V$")
    return complete(figure, families(styles), [entry("slope 1", color=GREY, **DOTTED)])


def values_of_rollers(rows: DataFrame) -> Json:
    """Return the values in the caption of ``draw_rollers``: name in the template ↦ value."""
    means = roller_means(rows)
    fits = {family: fit(table.h, table["mean"]) for family, table in means if len(table) > 1}
    return dict(fits=fits)


# Other codes, cost, and deliberate faults.

GRADE_STYLES: dict[str, Style] = {
    grade: dict(color=colour, marker=marker, ls="", **HOLLOW)
    for grade, colour, marker in zip(GRADES, (BLUE, GREEN, ORANGE, VERMILLION, GREY), "osDXh", strict=True)
}


def draw_codes(codes: Codes) -> Figure:
    """Draw the results of other people's contact codes.

    Each point is a code with its parameters on one case and mesh family. The upper axes show the observed order of the
    error in V. The lower axes show the distance from the discrete solution without penetration at the vertices, which
    is the solution in the convex set K^h. The horizontal axis is the error of the contact pressure on the finest mesh.
    """
    rows = _complete(codes)
    figure, (order, share) = stacked_axes(3, 2)
    share.loglog()
    handles = []
    for grade, style in GRADE_STYLES.items():
        points = rows[rows["class"] == grade]
        if len(points):
            order.plot(points.excess, points.order_in_v, **style)
            # Smaller distances are due to rounding.
            share.plot(points.excess, points.share.clip(lower=1e-11), **style)
            handles.append(entry(grade, **dict(style, ls="-")))
    for axes in (order, share):
        axes.axhline(1, **RULE)
    order.set_ylabel("order in V")
    share.set(xlabel="error of the pressure / that of the solution in $K^h$", ylabel="distance / error")
    return complete(figure, handles[::2], handles[1::2])


def _complete(codes: Codes) -> DataFrame:
    return codes.series().dropna(subset=["order_in_v", "share", "excess"])


def values_of_codes(codes: Codes) -> Json:
    """Return the values in the caption of ``draw_codes``: name in the template ↦ value."""
    rows = _complete(codes)
    tolerance = 0.15
    passing = rows[abs(rows.order_in_v - 1) <= tolerance]
    bad = passing[passing["class"].isin(["stagnates", "wrong"])]
    return dict(rows=rows, bad=bad, tolerance=tolerance)


FAULT_SHADES = (
    ("#EEEEEE", "cannot occur"),
    ("#FFFFFF", "by no check"),
    ("#D6E6F2", "by other checks only"),
    (SKY, "by errors, at a larger size"),
    (BLUE, "by errors, at the smallest size"),
)
"""The colours of the matrix of faults, and what notices a fault in a case."""


def draw_faults(matrix: DataFrame) -> Figure:
    """Draw the matrix of deliberate faults, with a row for each fault and a column for each case.

    The shade of a cell says which checks notice the fault in this case.

    Parameters:
        matrix: the table ``faults.csv``.
    """
    sizes = matrix["size"].abs()
    is_smallest = sizes == sizes.groupby([matrix.fault, matrix.case]).transform("min")
    errors = matrix.by_error != ""
    others = matrix.by_others != ""
    # Without a distance nothing is known about the discrete solution.
    visible = ~(matrix.distance < INVISIBLE_SHARE * matrix.error)
    shade = np.select([errors & is_smallest, errors, others], [4, 3, 2], 1)
    cells = matrix.assign(shade=shade, visible=visible * 1.0).groupby(["fault", "case"])[["shade", "visible"]].max()
    equations = matrix.groupby("fault", sort=False)["equation"].first()
    cases = matrix.case.unique()
    table = cells.unstack().reindex(equations.index)
    figure = Figure(figsize=(page_width(), 1.9 + 0.155 * len(equations)))
    axes = figure.subplots()
    axes.pcolormesh(
        table.shade[cases].fillna(0).to_numpy(),
        cmap=ListedColormap([colour for colour, _ in FAULT_SHADES]),
        vmin=-0.5,
        vmax=4.5,
        edgecolors="white",
        linewidth=0.5,
    )
    rows, columns = np.nonzero(table.visible[cases] == 0)
    axes.plot(columns + 0.5, rows + 0.5, ".", color=GREY, markersize=3)
    axes.invert_yaxis()
    axes.set_xticks(np.arange(len(cases)) + 0.5, cases, rotation=90)
    axes.set_yticks(np.arange(len(equations)) + 0.5, equations.index + "   " + equations)
    axes.tick_params(length=0, labelsize="x-small")
    handles = [
        Patch(facecolor=colour, label=text, edgecolor=DARK, linewidth=0.3) for colour, text in FAULT_SHADES[::-1]
    ]
    legend(figure, [*handles, dots("invisible", marker=".", color=GREY)], 3, "upper", wide=True)
    return figure


def values_of_faults(matrix: DataFrame) -> Json:
    """Return the values in the caption of ``draw_faults``: name in the template ↦ value."""
    by_fault = matrix[matrix.by_error != ""].groupby("fault")["case"].nunique()
    never = [fault for fault in matrix.fault.unique() if fault not in by_fault]
    return dict(never=never, fewest=by_fault.min())

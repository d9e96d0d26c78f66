"""Errors against the mesh size, from ``rates.csv`` and the expected orders in ``cases.csv``."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from study.present.figures.canvas import COLUMN, Look, legend, looks
from study.present.figures.logarithmic import Curve, set_ticks, slope_triangle

FLOOR = 1e-3
"""What is smaller than this fraction of the smallest error is not shown: it would flatten the errors."""


ENTRY = 1.15
"""Inches that an entry of the legend takes."""


def draw_case(rates: pd.DataFrame, order: float) -> Figure:
    """One case: error, discrete error and time share of every mesh family, and the expected slope.

    From ``h``, ``error`` (filled), ``discrete_error`` (open, dashed) and ``time_share`` × ``error``
    (dotted); ``order`` is ``expected_order`` of the case.
    """
    figure = Figure(figsize=(COLUMN, 4.0))
    axes = figure.subplots()
    look = looks(rates["family"])
    for family, series in _by_family(rates):
        _draw_error(axes, series, look[family])
        _draw_parts(axes, series, look[family])
    parts = pd.concat([rates["error"], rates["discrete_error"], rates["time_share"] * rates["error"]])
    low = parts[parts >= FLOOR * rates["error"].min()].min()
    height = math.log10(parts.max() / low)
    top = slope_triangle(axes, _curves(rates), order, height)
    _set_limits(axes, rates, low, max(top, parts.max()))
    axes.set_title(str(rates["case"].iloc[0]))
    axes.set_xlabel(r"mesh size $h$")
    axes.set_ylabel(r"maximum over time in $\|\cdot\|_V$")
    set_ticks(axes.xaxis, axes.get_xlim())
    set_ticks(axes.yaxis, axes.get_ylim())
    legend(figure, _side_by_side(_family_handles(look), _kind_handles()), columns=2)
    return figure


def draw_overview(rates: pd.DataFrame, orders: Mapping[str, float]) -> Figure:
    """Small panels, one per case: the error of every mesh family and the expected slope of the case.

    From ``h`` and ``error``; ``orders`` gives ``expected_order`` by case. All panels share the
    horizontal axis and those of one row the vertical one.
    """
    cases = list(dict.fromkeys(rates["case"]))
    columns = _columns(len(cases))
    rows = math.ceil(len(cases) / columns)
    width = max(COLUMN, 0.5 + 1.05 * columns)
    figure = Figure(figsize=(width, 0.8 + (0.15 + 0.9 * (width - 0.5) / columns) * rows))
    panels = figure.subplots(rows, columns, sharey="row", squeeze=False)
    look = looks(rates["family"])
    for row, line in enumerate(panels):
        here = cases[row * columns : (row + 1) * columns]
        shown = rates[rates["case"].isin(here)]
        height = math.log10(shown["error"].max() / shown["error"].min())
        top = max(
            _draw_panel(axes, rates[rates["case"] == case], look, orders[case], height)
            for axes, case in zip(line, here, strict=False)
        )
        for i, axes in enumerate(line):
            _set_limits(axes, rates, shown["error"].min(), max(top, shown["error"].max()))
            set_ticks(axes.xaxis, axes.get_xlim(), least=2)
            set_ticks(axes.yaxis, axes.get_ylim(), least=2)
            axes.tick_params(labelbottom=(row + 1) * columns + i >= len(cases))
            axes.set_visible(i < len(here))
    figure.supxlabel(r"mesh size $h$")
    figure.supylabel(r"$\max_t\,\|u-u^h\|_V$")
    legend(figure, _family_handles(look), columns=max(2, int(width / ENTRY)), side="upper")
    return figure


def caption_case(rates: pd.DataFrame, order: float) -> str:
    """What to see."""
    families = dict(_by_family(rates))
    finest = [series.iloc[-1] for series in families.values()]
    orders, graded = _last_orders(families)
    closer = [row["error"] / row["discrete_error"] for row in finest if row["discrete_error"] > 0]
    seen = []
    if orders:
        seen.append(f"on the two finest meshes of a family the order is {_spread(orders)}, expected {order:.3g}")
    if graded:
        seen.append(f"meshes graded towards the singularity reach the order {_spread(graded)}")
    if closer:
        seen.append(f"on the finest meshes u^h is {_spread(closer)} times closer to Π^h u than to u")
    seen.append(f"time makes at most {100 * rates['time_share'].max():.2g} % of the error on any mesh")
    return (
        f"Convergence of {rates['case'].iloc[0]} on the mesh families {', '.join(families)}: the largest error over "
        "time in the norm of V (filled markers), the discrete error ‖Π^h u − u^h‖_V (open) and what discretisation in "
        f"time contributes (dotted) against the mesh size h; the triangle has the expected order. What to see: "
        f"{'; '.join(seen)}. What is below {FLOOR:g} of the smallest error is not shown."
    )


def caption_overview(rates: pd.DataFrame, orders: Mapping[str, float]) -> str:
    """What to see."""
    found, graded = [], []
    for case, of_case in rates.groupby("case", sort=False):
        mine, on_graded = _last_orders(dict(_by_family(of_case)))
        found += [(value - orders[str(case)], str(case)) for value in mine]
        graded += on_graded
    seen = ["single levels show no order"]
    if found:
        (low, lowest), (high, highest) = min(found), max(found)
        seen = [
            "whether the curves run parallel to their triangles; the last order differs from the expected one by "
            f"{low:+.2g} ({lowest}) to {high:+.2g} ({highest})"
        ]
    if graded:
        seen.append(f"meshes graded towards a singularity reach the order {_spread(graded)}")
    return (
        f"The error max_t ‖u − u^h‖_V of all {rates['case'].nunique()} cases of {rates['claim'].iloc[0]} against the "
        "mesh size h, on every mesh family; the triangles have the expected orders, which are written above them. "
        f"What to see: {'; '.join(seen)}."
    )


def _last_orders(families: Mapping[str, pd.DataFrame]) -> tuple[list[float], list[float]]:
    """log(e_1/e_2)/log(h_1/h_2) on the two finest levels of the families with two: of all but graded, of graded."""
    orders: tuple[list[float], list[float]] = ([], [])
    for family, series in families.items():
        if len(series) > 1:
            (h1, e1), (h2, e2) = series[["h", "error"]].to_numpy()[-2:]
            orders[family == "graded"].append(math.log(e1 / e2) / math.log(h1 / h2))
    return orders


def _spread(values: Sequence[float]) -> str:
    """The smallest and the largest, or the only one."""
    low, high = (f"{value:.3g}" for value in (min(values), max(values)))
    return low if low == high else f"{low} … {high}"


def _columns(panels: int) -> int:
    """A number of columns near the square root, at most 5, that leaves few places empty."""
    nearest = math.ceil(math.sqrt(panels))
    return min((min(nearest, 5), min(nearest + 1, 5)), key=lambda columns: -panels % columns)


def _draw_panel(axes: Axes, rates: pd.DataFrame, look: Mapping[str, Look], order: float, height: float) -> float:
    """One small panel; returns how high its slope triangle reaches."""
    for family, series in _by_family(rates):
        _draw_error(axes, series, look[family], size=2.4)
    axes.set_title(textwrap.fill(str(rates["case"].iloc[0]), 22), fontsize=7, linespacing=0.95)
    return slope_triangle(axes, _curves(rates), order, height, small=True)


def _draw_error(axes: Axes, series: pd.DataFrame, look: Look, size: float = 3.6) -> None:
    axes.loglog(series["h"], series["error"], color=look.colour, marker=look.marker, ms=size, zorder=3)


def _draw_parts(axes: Axes, series: pd.DataFrame, look: Look) -> None:
    """What the solver did, and what of the error is due to time."""
    style: dict[str, Any] = {"color": look.colour, "zorder": 2.5}
    axes.loglog(series["h"], series["discrete_error"], marker=look.marker, mfc="white", ls="--", lw=0.7, **style)
    axes.loglog(series["h"], series["time_share"] * series["error"], ls=":", lw=0.9, alpha=0.8, **style)


def _by_family(rates: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """The rows of each family, from the coarsest level to the finest."""
    for family, series in rates.groupby("family", sort=False):
        yield str(family), series.sort_values("level")


def _curves(rates: pd.DataFrame) -> list[Curve]:
    ordered = [series.sort_values("h") for _, series in _by_family(rates)]
    return [(series["h"].to_numpy(), series["error"].to_numpy()) for series in ordered]


def _set_limits(axes: Axes, rates: pd.DataFrame, low: float, high: float) -> None:
    """Limits with a margin of a few per cent on each side, in decades; half a decade around single values."""
    for set_limits, ends in ((axes.set_xlim, (rates["h"].min(), rates["h"].max())), (axes.set_ylim, (low, high))):
        span = math.log10(ends[1] / ends[0])
        margin = 10 ** (0.06 * span if span > 0.01 else 0.5)
        set_limits(ends[0] / margin, ends[1] * margin)
    axes.grid(True)


def _family_handles(look: Mapping[str, Look]) -> list[Line2D]:
    return [Line2D([], [], color=mine.colour, marker=mine.marker, label=name) for name, mine in look.items()]


def _side_by_side(left: list[Line2D], right: list[Line2D]) -> list[Line2D]:
    """Handles for a legend of two columns, the shorter one filled up with blanks."""
    blanks = [Line2D([], [], ls="", label=" ")] * abs(len(left) - len(right))
    return [*left, *blanks, *right] if len(left) < len(right) else [*left, *right, *blanks]


def _kind_handles() -> list[Line2D]:
    """What filled, open and dotted lines mean, in a grey that no family has."""
    style: dict[str, Any] = {"color": "0.3"}
    return [
        Line2D([], [], marker="o", label=r"error $\|u-u^h\|_V$", **style),
        Line2D([], [], marker="o", mfc="white", ls="--", lw=0.7, label=r"discrete error $\|\Pi^hu-u^h\|_V$", **style),
        Line2D([], [], ls=":", lw=0.9, label="share of time discretisation", **style),
    ]

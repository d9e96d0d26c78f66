"""Errors against the mesh size with their observed orders, from ``rates.csv``: of one case, and of all in a grid."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress

import numpy as np
import pandas as pd

from study.ledger.orders import RatesError, orders
from study.present.charts.chart import Chart, Curve, LegendEntry, LogAxis, SlopeTriangle, Style, Subplot
from study.present.charts.palette import DARK, looks


def by_family(rates: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """The rows of each family, from the coarsest level to the finest."""
    for family, rows in rates.groupby("family", sort=False):
        yield str(family), rows.sort_values("level")


def finest_orders(rates: pd.DataFrame, refinements: int) -> dict[str, float]:
    """family ↦ the order of ``error`` over the last so many refinements, or as many as there are.

    A family with a single level, or with errors that have no order, is left out. Over two refinements a fixed front, or
    a jump of the material, has the same place in the cells of both meshes.
    """
    found = {}
    for family, rows in by_family(rates):
        ends = rows.tail(refinements + 1).iloc[[0, -1]]
        if len(rows) > 1:
            with suppress(RatesError):
                found[family] = float(orders(ends["h"].to_numpy(), ends["error"].to_numpy())[0])
    return found


def last_orders(rates: pd.DataFrame) -> tuple[list[float], list[float]]:
    """The orders over the last refinement, of all families but graded ones, and of these."""
    found = finest_orders(rates, refinements=1)
    graded = [found.pop("graded")] if "graded" in found else []
    return list(found.values()), graded


def spread(values: Sequence[float]) -> str:
    """The smallest and the largest, or the only one."""
    low, high = (f"{value:.3g}" for value in (min(values), max(values)))
    return low if low == high else f"{low} … {high}"


def slope_triangle(curves: Sequence[Curve], slope: float, decades: float, small: bool = False) -> SlopeTriangle | None:
    """Above the left end of the curves, which an increasing curve leaves free.

    ``decades`` is the height of the axes, from which distances are taken. In a ``small`` chart the slope stands
    above the triangle, where there is room. None without an expected slope, or where all curves have one point.
    """
    if math.isnan(slope) or max(len(curve.x) for curve in curves) < 2:
        return None
    left = min(math.log10(curve.x.min()) for curve in curves)
    width = max(math.log10(curve.x.max()) for curve in curves) - left
    start, end = left + 0.09 * width, left + 0.37 * width
    base = _intercept(curves, slope, start, end) + 0.07 * decades
    top = base + slope * (end - start)
    texts = ("", f"{slope:.3g}") if small else (f"{slope:.3g}", "1")
    corners = 10 ** np.array([[start, base], [end, top], [start, top]])
    return SlopeTriangle(corners, *texts, top=float(10 ** (top + (0.16 if small else 0.07) * decades)))


def _intercept(curves: Sequence[Curve], slope: float, start: float, end: float) -> float:
    """The smallest b such that b + slope (x − start) lies above all curves between start and end (logarithms)."""
    highest = -math.inf
    for curve in curves:
        order = np.argsort(curve.x)
        x, y = np.log10(curve.x[order]), np.log10(curve.y[order])
        at = np.concatenate([x[(x > start) & (x < end)], np.clip([start, end], x[0], x[-1])])
        highest = max(highest, float((np.interp(at, x, y) - slope * (at - start)).max()))
    return highest


FLOOR = 1e-3
"""What is smaller than this fraction of the smallest error is not shown: it would flatten the errors."""


def convergence_chart(rates: pd.DataFrame, order: float) -> Chart:
    """Error, discrete error and ``time_share`` × ``error`` on every mesh family, and the expected order as a slope."""
    look = looks(rates["family"])
    errors = error_curves(rates, look)
    parts = pd.concat([rates["error"], rates["discrete_error"], rates["time_share"] * rates["error"]])
    low, high = parts[parts >= FLOOR * rates["error"].min()].min(), parts.max()
    triangle = slope_triangle(errors, order, math.log10(high / low))
    subplot = Subplot(
        str(rates["case"].iloc[0]),
        LogAxis.around("mesh size", rates["h"].min(), rates["h"].max(), "h"),
        LogAxis.around("maximum over time in ‖·‖_V", low, max(high, triangle.top if triangle else 0.0)),
        [*_part_curves(rates, look), *errors],
        triangle=triangle,
    )
    summary = "errors against the mesh size, both logarithmic"
    return Chart(summary, [subplot], [family_legend(look), _KINDS], _caption(rates, order))


def error_curves(rates: pd.DataFrame, look: Mapping[str, Style]) -> list[Curve]:
    """The error on each mesh family."""
    return [Curve(rows["h"].to_numpy(), rows["error"].to_numpy(), look[family]) for family, rows in by_family(rates)]


def family_legend(look: Mapping[str, Style]) -> list[LegendEntry]:
    """The look of each mesh family."""
    return [LegendEntry(family, mine) for family, mine in look.items()]


def _part_curves(rates: pd.DataFrame, look: Mapping[str, Style]) -> Iterator[Curve]:
    """The discrete error, and the contribution of discretisation in time."""
    for family, rows in by_family(rates):
        h, mine = rows["h"].to_numpy(), look[family]
        yield Curve(h, (rows["time_share"] * rows["error"]).to_numpy(), Style(mine.colour, stroke="dotted"))
        yield Curve(h, rows["discrete_error"].to_numpy(), Style(mine.colour, mine.marker, "dashed", True))


_KINDS = (
    LegendEntry("error ‖u − u^h‖_V", Style(DARK, "o")),
    LegendEntry("discrete error ‖Π^h u − u^h‖_V", Style(DARK, "o", "dashed", hollow=True)),
    LegendEntry("share of time discretisation", Style(DARK, stroke="dotted")),
)


def _caption(rates: pd.DataFrame, order: float) -> str:
    finest = [rows.iloc[-1] for _, rows in by_family(rates)]
    orders, graded = last_orders(rates)
    closer = [row["error"] / row["discrete_error"] for row in finest if row["discrete_error"] > 0]
    seen = []
    if orders:
        seen.append(f"on the two finest meshes of a family the order is {spread(orders)}, expected {order:.3g}")
    if graded:
        seen.append(f"meshes graded towards the singularity reach the order {spread(graded)}")
    if closer:
        seen.append(f"on the finest meshes u^h is {spread(closer)} times closer to Π^h u than to u")
    share = 100 * rates["time_share"].max()
    seen.append(f"discretisation in time contributes at most {share:.2g} % of the error on any mesh")
    return (
        f"Convergence of {rates['case'].iloc[0]} on the mesh families {', '.join(rates['family'].unique())}: the "
        "largest error over time in the norm of V (filled markers), the discrete error ‖Π^h u − u^h‖_V (open) and what "
        "discretisation in time contributes (dotted) against the mesh size h; the triangle has the expected slope. "
        f"What to see: {'; '.join(seen)}. What is below {FLOOR:g} of the smallest error is not shown."
    )


MOST = 5
"""Columns of the grid."""


def overview_chart(rates: pd.DataFrame, orders: Mapping[str, float]) -> Chart:
    """One subplot per case; ``orders`` gives the expected order of each, the slope of its triangle.

    All share the horizontal axis and those of one row the vertical one.
    """
    cases = list(dict.fromkeys(rates["case"]))
    # Near the square root, with few places left empty.
    nearest = math.ceil(math.sqrt(len(cases)))
    columns = min((min(nearest, MOST), min(nearest + 1, MOST)), key=lambda columns: -len(cases) % columns)
    rows = [cases[start : start + columns] for start in range(0, len(cases), columns)]
    subplots = [subplot for row in rows for subplot in _row_of_cases(rates, row, orders)]
    summary = "error of every case against the mesh size, both logarithmic"
    return Chart(summary, subplots, [family_legend(looks(rates["family"]))], _caption_of_all(rates, orders), columns)


def _row_of_cases(rates: pd.DataFrame, cases: Sequence[str], orders: Mapping[str, float]) -> list[Subplot]:
    look, shown = looks(rates["family"]), rates[rates["case"].isin(cases)]
    low, high = shown["error"].min(), shown["error"].max()
    curves = {case: error_curves(shown[shown["case"] == case], look) for case in cases}
    decades = math.log10(high / low)
    triangles = {case: slope_triangle(curves[case], orders[case], decades, small=True) for case in cases}
    top = max(triangle.top if triangle else 0.0 for triangle in triangles.values())
    x = LogAxis.around("mesh size", rates["h"].min(), rates["h"].max(), "h", least=2)
    y = LogAxis.around("max_t ‖u − u^h‖_V", low, max(high, top), least=2)
    return [Subplot(case, x, y, curves[case], triangle=triangles[case]) for case in cases]


def _caption_of_all(rates: pd.DataFrame, orders: Mapping[str, float]) -> str:
    found, graded = [], []
    for case, of_case in rates.groupby("case", sort=False):
        mine, on_graded = last_orders(of_case)
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
        seen.append(f"meshes graded towards a singularity reach the order {spread(graded)}")
    return (
        f"The error max_t ‖u − u^h‖_V of all {rates['case'].nunique()} cases of {rates['claim'].iloc[0]} against the "
        "mesh size h, on every mesh family; the triangles have the expected orders, which are written above them. "
        f"What to see: {'; '.join(seen)}."
    )

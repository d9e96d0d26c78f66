"""The error of every case against the mesh size, in a grid, from ``rates.csv``."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import pandas as pd

from study.present.charts.axis import LogAxis
from study.present.charts.chart import Chart, Subplot
from study.present.charts.convergence_chart import error_curves, family_legend
from study.present.charts.finest_orders import last_orders, spread
from study.present.charts.palette import looks
from study.present.charts.slope_triangle import slope_triangle

MOST = 5
"""Columns of the grid."""


def overview_chart(rates: pd.DataFrame, orders: Mapping[str, float]) -> Chart:
    """One subplot per case; ``orders`` gives the expected order of each, the slope of its triangle.

    All share the horizontal axis and those of one row the vertical one.
    """
    cases = list(dict.fromkeys(rates["case"]))
    columns = _columns(len(cases))
    rows = [cases[start : start + columns] for start in range(0, len(cases), columns)]
    subplots = [subplot for row in rows for subplot in _row(rates, row, orders)]
    summary = "error of every case against the mesh size, both logarithmic"
    return Chart(summary, subplots, [family_legend(looks(rates["family"]))], _caption(rates, orders), columns)


def _row(rates: pd.DataFrame, cases: Sequence[str], orders: Mapping[str, float]) -> list[Subplot]:
    look, shown = looks(rates["family"]), rates[rates["case"].isin(cases)]
    low, high = shown["error"].min(), shown["error"].max()
    curves = {case: error_curves(shown[shown["case"] == case], look) for case in cases}
    decades = math.log10(high / low)
    triangles = {case: slope_triangle(curves[case], orders[case], decades, small=True) for case in cases}
    top = max(triangle.top if triangle else 0.0 for triangle in triangles.values())
    x = LogAxis.around("mesh size", rates["h"].min(), rates["h"].max(), "h", least=2)
    y = LogAxis.around("max_t ‖u − u^h‖_V", low, max(high, top), least=2)
    return [Subplot(case, x, y, curves[case], triangle=triangles[case]) for case in cases]


def _columns(subplots: int) -> int:
    """A number of columns near the square root that leaves few places empty."""
    nearest = math.ceil(math.sqrt(subplots))
    return min((min(nearest, MOST), min(nearest + 1, MOST)), key=lambda columns: -subplots % columns)


def _caption(rates: pd.DataFrame, orders: Mapping[str, float]) -> str:
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

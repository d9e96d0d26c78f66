"""Errors of one case against the mesh size, from its rows of ``rates.csv``."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import pandas as pd

from study.present.charts.axis import LogAxis
from study.present.charts.chart import Chart, Curve, LegendEntry, Style, Subplot
from study.present.charts.finest_orders import by_family, last_orders, spread
from study.present.charts.palette import DARK, Look, looks
from study.present.charts.slope_triangle import slope_triangle

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


def error_curves(rates: pd.DataFrame, look: Mapping[str, Look]) -> list[Curve]:
    """The error on each mesh family."""
    return [
        Curve(rows["h"].to_numpy(), rows["error"].to_numpy(), Style(look[family].colour, marker=look[family].marker))
        for family, rows in by_family(rates)
    ]


def family_legend(look: Mapping[str, Look]) -> list[LegendEntry]:
    """The look of each mesh family."""
    return [LegendEntry(family, Style(mine.colour, marker=mine.marker)) for family, mine in look.items()]


def _part_curves(rates: pd.DataFrame, look: Mapping[str, Look]) -> Sequence[Curve]:
    """The discrete error, and the contribution of discretisation in time."""
    found = []
    for family, rows in by_family(rates):
        h, mine = rows["h"].to_numpy(), look[family]
        time = (rows["time_share"] * rows["error"]).to_numpy()
        found.append(Curve(h, time, Style(mine.colour, "dotted")))
        found.append(Curve(h, rows["discrete_error"].to_numpy(), Style(mine.colour, "dashed", mine.marker, True)))
    return found


_KINDS = (
    LegendEntry("error ‖u − u^h‖_V", Style(DARK, marker="o")),
    LegendEntry("discrete error ‖Π^h u − u^h‖_V", Style(DARK, "dashed", "o", hollow=True)),
    LegendEntry("share of time discretisation", Style(DARK, "dotted")),
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

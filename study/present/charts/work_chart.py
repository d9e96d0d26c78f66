"""The root of the work of contact beside the error and the excess over the linear problem, from ``statements.csv``."""

from __future__ import annotations

import numpy as np
import pandas as pd

from study.ledger.orders import orders
from study.present.charts.chart import Chart, Curve, LegendEntry, LogAxis, Style, Subplot
from study.present.charts.convergence_chart import family_legend, slope_triangle, spread
from study.present.charts.palette import DARK, looks

LABEL = "beyond: work of contact"
SHOWN = {"work": ("solid", False), "error": ("dotted", True), "excess": ("dashed", True)}
"""How the quantities are drawn: stroke, and whether markers are hollow."""
_KINDS = (
    LegendEntry("work ‖R‖^{1/2}", Style(DARK, "o")),
    LegendEntry("error ‖u − u^h‖_V", Style(DARK, "o", "dotted", hollow=True)),
    LegendEntry("excess ‖u^h − u^h_{lin}‖_V", Style(DARK, "o", "dashed", hollow=True)),
)


def work_chart(statements: pd.DataFrame) -> Chart | None:
    """The chart of the rows of ``statements.csv``; None without any of this statement."""
    rows = statements[(statements["label"] == LABEL) & statements["quantity"].isin(SHOWN)]
    if rows.empty:
        return None
    look = looks(rows["family"])
    return Chart(
        "work of contact, error and excess against the mesh size, all logarithmic",
        [_subplot(str(case), mine, rows, look) for case, mine in rows.groupby("case", sort=False)],
        [family_legend(look), _KINDS],
        _caption(rows),
        columns=2,
    )


def _subplot(case: str, rows: pd.DataFrame, every: pd.DataFrame, look: dict[str, Style]) -> Subplot:
    """One case, with axes on which every case has room: they share them."""
    curves = []
    for (family, quantity), mine in rows.groupby(["family", "quantity"], sort=False):
        stroke, hollow = SHOWN[str(quantity)]
        like, table = look[str(family)], mine.sort_values("level")
        style = Style(like.colour, like.marker, stroke, hollow)  # type: ignore[arg-type]
        curves.append(Curve(table["h"].to_numpy(), table["value"].to_numpy(), style))
    low, high = every["value"].min(), every["value"].max()
    triangle = slope_triangle(curves, 1.0, float(np.log10(high / low)))
    top = max(high, triangle.top if triangle else 0.0)
    x = LogAxis.around("mesh size", every["h"].min(), every["h"].max(), "h", least=2)
    return Subplot(case, x, LogAxis.around("", low, top), curves, triangle=triangle)


def _caption(rows: pd.DataFrame) -> str:
    found: dict[str, list[float]] = {name: [] for name in SHOWN}
    for (_, family, quantity), mine in rows.groupby(["case", "family", "quantity"], sort=False):
        table = mine.sort_values("level").tail(3)
        if family == "one-diagonal" and len(table) > 1:
            found[str(quantity)] += [float(x) for x in orders(table["h"].to_numpy(), table["value"].to_numpy())]
    seen = "single levels show no order"
    if found["work"]:
        seen = (
            f"on the finest meshes with one diagonal the order of the work is {spread(found['work'])}, while the "
            f"error, for which the trains are hardly resolved, has {spread(found['error'])}; on irregular meshes the "
            "work scatters about the same line"
        )
    return (
        "The root of the work of contact (filled markers), the error (dotted) and the excess of u^h over the solution "
        "of the linear problem with the exact pressure as traction (dashed) against the mesh size h, for zones with "
        f"patches of seven widths; the triangle has the slope 1. What to see: {seen}."
    )

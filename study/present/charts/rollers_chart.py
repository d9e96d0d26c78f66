"""What contact costs beside the linear problem where a narrow patch rolls along Γ3, from ``statements.csv``."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from study.ledger.orders import fit
from study.present.charts.chart import Band, Chart, Curve, LegendEntry, LogAxis, Style, Subplot
from study.present.charts.convergence_chart import family_legend, slope_triangle
from study.present.charts.palette import GREY, looks

LABEL = "beyond: rollers"
CASE = r"roller-\d+"
"""A roller, for the level that its width belongs to."""
SHAKEN = "shaken"


def rollers_chart(statements: pd.DataFrame) -> Chart | None:
    """The excess on every mesh family, the mean over shaken meshes with their range; None without this statement."""
    mine = statements["label"].eq(LABEL) & statements["case"].str.fullmatch(CASE) & statements["quantity"].eq("excess")
    if not mine.any():
        return None
    rows = statements[mine].assign(family=statements["family"].where(~statements["family"].str.match(SHAKEN), SHAKEN))
    look = looks(rows["family"])
    tables = {str(family): _by_level(table) for family, table in rows.groupby("family", sort=False)}
    curves = [Curve(table["h"].to_numpy(), table["mean"].to_numpy(), look[name]) for name, table in tables.items()]
    bands = [
        Band(table["h"].to_numpy(), table["min"].to_numpy(), table["max"].to_numpy(), look[name].colour)
        for name, table in tables.items()
        if name == SHAKEN
    ]
    low, high = rows["value"].min(), rows["value"].max()
    triangle = slope_triangle(curves, 0.5, math.log10(high / low))
    linear = _line(min(curves, key=lambda curve: curve.y.min()))
    top = max(high, triangle.top if triangle else 0.0)
    subplot = Subplot(
        "",
        LogAxis.around("mesh size", rows["h"].min(), rows["h"].max(), "h"),
        LogAxis.around("excess max_t ‖u^h − u^h_{lin}‖_V", min(low, linear.y.min()), top),
        [*curves, linear],
        bands,
        triangle,
    )
    return Chart(
        "excess of contact over the linear problem against the mesh size, both logarithmic",
        [subplot],
        [family_legend(look), [LegendEntry("slope 1", linear.style)]],
        _caption(tables),
    )


def _by_level(rows: pd.DataFrame) -> pd.DataFrame:
    """h, and mean, least and largest value over the meshes of each level, coarse to fine."""
    levels = rows.groupby("level")
    return levels["value"].agg(["mean", "min", "max"]).assign(h=levels["h"].mean()).sort_values("h", ascending=False)


def _line(below: Curve) -> Curve:
    """A line of slope 1 under a curve."""
    x = np.array([below.x.min(), below.x.max()])
    return Curve(x, 0.8 * float((below.y / below.x).min()) * x, Style(GREY, stroke="dotted"))


def _caption(tables: dict[str, pd.DataFrame]) -> str:
    found = [
        f"{fit(table['h'].to_numpy(), table['mean'].to_numpy()).order:.2f} ({name})"
        for name, table in tables.items()
        if len(table) > 1
    ]
    seen = f"orders over all levels are {', '.join(found)}" if found else "single levels show no order"
    return (
        "The excess max_t ‖u^h − u^h_{lin}‖_V over the solution of the linear problem with the exact pressure as "
        "traction against the mesh size h, for a roller of the width 2h; of shaken meshes the mean, and the range as a "
        f"band. The triangle has the slope ½, the dotted line the slope 1. What to see: {seen}."
    )

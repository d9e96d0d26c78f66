"""What a rate in the norm of V does not see: orders of contact codes beside what they did to the contact."""

from __future__ import annotations

import numpy as np

from study.ledger.codes import GRADES, Codes
from study.present.charts.chart import Chart, Curve, LegendEntry, LinearAxis, LogAxis, Style, Subplot
from study.present.charts.palette import BLUE, GREEN, GREY, ORANGE, VERMILLION

MARKS = dict(zip(GRADES, ("o", "s", "D", "X", "h"), strict=True))
INKS = dict(zip(GRADES, (BLUE, GREEN, ORANGE, VERMILLION, GREY), strict=True))
SAME = 0.15
"""Difference from order 1 that is taken for order 1."""
FLOOR = 1e-11
"""Shares below are drawn here: rounding."""


def codes_chart(codes: Codes) -> Chart:
    """Each point is a code with its parameters on one case and mesh family, on the finest mesh.

    Above: its order in V; below: its distance from the solution in K^h over the discretisation error. Both against the
    error of its pressure over that of the solution in K^h.
    """
    rows = codes.series().dropna(subset=["order_in_v", "share", "excess"])
    share = rows["share"].clip(lower=FLOOR)
    x = LogAxis.around(
        "error of the pressure / that of the solution in K^h", rows["excess"].min(), rows["excess"].max()
    )
    orders, shares, legend = [], [], []
    for grade in [grade for grade in GRADES if (rows["class"] == grade).any()]:
        mine, look = rows["class"] == grade, Style(INKS[grade], MARKS[grade], hollow=True)
        places = zip(rows.loc[mine, "excess"], rows.loc[mine, "order_in_v"], share[mine], strict=True)
        for excess, order, part in places:
            orders.append(Curve(np.array([excess]), np.array([order]), look))
            shares.append(Curve(np.array([excess]), np.array([part]), look))
        legend.append(LegendEntry(grade, look))
    passing = rows[abs(rows["order_in_v"] - 1) <= SAME]
    bad = passing[passing["class"].isin(["stagnates", "wrong"])]
    lowest, highest = rows["order_in_v"].min(), rows["order_in_v"].max()
    return Chart(
        "order in V and distance from the right solution against the error of the pressure, for all contact codes",
        [
            Subplot("", x, LinearAxis.around("order in V", lowest, highest), orders, rules=(1.0,)),
            Subplot("", x, LogAxis.around("distance / error", share.min(), share.max()), shares, rules=(1.0,)),
        ],
        [legend[::2], legend[1::2]],
        f"{len(rows)} runs of {rows['code'].nunique()} contact codes, each with stated parameters on one case and mesh "
        "family. Above: the order of ‖u − u^h‖_V between the two finest meshes. Below: the distance from the solution "
        "in K^h over the discretisation error. Both against the error of the pressure on the finest mesh, over that of "
        f"the solution in K^h. What to see: of {len(bad)} runs whose contact stagnates or is wrong though their order "
        f"in V is 1 ± {SAME}, the error of the pressure is up to {bad['excess'].max():.0f} times what linear elements "
        "leave; an order in V does not see it.",
    )

"""The errors of all cases in one plot, each over its own constant, which theory gives."""

from __future__ import annotations

import numpy as np
import pandas as pd

from study.present.charts.chart import Chart, Curve, LinearAxis, LogAxis, Style, Subplot
from study.present.charts.convergence_chart import family_legend
from study.present.charts.palette import GREY, looks

DATA = ("case", "family", "level", "h", "error", "predicted_interpolation")


def collapsed_chart(rates: pd.DataFrame) -> Chart:
    """error/C and error/(C h) against h, C h the leading term of ‖u − Π^h u‖_V on the finest mesh of a family.

    C comes from second derivatives of u, (5.23), not from the errors: nothing is fitted.
    """
    look = looks(rates["family"])
    over, relative, last = [], [], dict[str, list[float]]()
    for (_, family), rows in rates.sort_values("level").groupby(["case", "family"], sort=False):
        h, finest = rows["h"].to_numpy(), rows.iloc[-1]
        scaled = rows["error"].to_numpy() * finest["h"] / finest["predicted_interpolation"]
        over.append(Curve(h, scaled, look[str(family)]))
        relative.append(Curve(h, scaled / h, look[str(family)]))
        last.setdefault(str(family), []).append(float(relative[-1].y[-1]))
    low, high, cases = rates["h"].min(), rates["h"].max(), rates["case"].nunique()
    line = Curve(np.array([low, high]), np.array([low, high]), Style(GREY))
    values, ends = (np.concatenate([curve.y for curve in curves]) for curves in (relative, over))
    x, families = LogAxis.around("mesh size", low, high, "h"), family_legend(look)
    finest_meshes = ", ".join(f"{min(ratios):.2f} … {max(ratios):.2f} ({family})" for family, ratios in last.items())
    return Chart(
        "errors of all cases over their constants against the mesh size",
        [
            Subplot("", x, LogAxis.around("error / C", min(ends.min(), low), max(ends.max(), high)), [line, *over]),
            Subplot("", x, LinearAxis.around("error / (C h)", values.min(), values.max()), relative, rules=(1.0,)),
        ],
        [families[::2], families[1::2]],
        f"The errors max_t ‖u − u^h‖_V of all {cases} cases of Prop. 5.4 on all mesh families, each divided by its "
        "constant C. C h is the leading term of the interpolation error ‖u − Π^h u‖_V on the finest mesh, which "
        "follows from second derivatives of u; nothing is fitted. What to see: all fall on the line C h; error / (C h) "
        f"lies between {values.min():.2f} and {values.max():.2f}, on the finest meshes of a case in {finest_meshes}. "
        "It tends to 1 where u^h is superclose to Π^h u, and to less where u^h is nearer to u than Π^h u is.",
    )

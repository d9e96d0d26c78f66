"""Dots in lines of names: how close bounds are to the error."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from study.present.charts.chart import Style
from study.present.charts.palette import BLACK, BLUE, DARK, GREEN, VERMILLION
from study.present.figures.drawing import PAGE, dots, entry, legend

SCHEMES = {"backward-euler": Style(VERMILLION, "s"), "bdf2": Style(GREEN, "^"), "midpoint": Style(BLUE, "o")}


def draw_effectivity(known: pd.DataFrame) -> Figure:
    """A line per case: left the bound from u_h alone over the error, right both ends of the enclosure over it.

    From ``upper`` and ``lower`` in the rows of ``bounds.csv`` whose error is known, the worst over the second half of
    time; one marker per scheme, mesh family and level, larger on finer levels.
    """
    cases = list(dict.fromkeys(known["case"]))
    row = {case: len(cases) - 1 - i for i, case in enumerate(cases)}
    figure = Figure(figsize=(PAGE, 1.2 + 0.15 * len(cases)))
    left, right = figure.subplots(1, 2, sharey=True)
    for axes, trajectory, columns in ((left, "bound", ("upper",)), (right, "enclosure", ("lower", "upper"))):
        mine = known[known["trajectory"] == trajectory]
        for scheme, look in SCHEMES.items():
            of_scheme = mine[mine["scheme"] == scheme]
            # Schemes side by side where their markers would hide each other.
            y = of_scheme["case"].map(row) + 0.22 * (list(SCHEMES).index(scheme) - 1)
            for column in columns:
                _draw_markers(axes, of_scheme[column], y, of_scheme["level"], look, filled=column == "upper")
        axes.axvline(1, color=BLACK, lw=0.7)
        axes.grid(True)
    left.set_xscale("log")
    ticks = [tick for tick in (1, 1.5, 2, 3, 5, 7, 10, 20, 50) if tick <= 1.1 * left.get_xlim()[1]]
    left.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    left.minorticks_off()
    left.set_yticks(list(row.values()), list(row))
    left.set(ylim=(-0.7, len(cases) - 0.3), xlabel="bound from $u_h$ alone / error")
    right.set(xlim=(0, None), xlabel="ends of the enclosure / error")
    used = [(scheme, look) for scheme, look in SCHEMES.items() if (known["scheme"] == scheme).any()]
    handles = [dots(scheme, color=look.colour, marker=look.marker) for scheme, look in used]
    handles += [
        dots(f"{end} end of the bound", color=DARK, mfc=fill) for end, fill in (("upper", DARK), ("lower", "white"))
    ]
    levels = sorted(known["level"].unique())[:: max(1, known["level"].nunique() - 1)]
    handles += [dots(f"$n={n}$", color=DARK, ms=float(np.sqrt(_area(n))), mew=0) for n in levels]
    legend(figure, [*handles, entry("the error itself", color=BLACK, lw=0.7)], columns=4)
    return figure


def caption_effectivity(known: pd.DataFrame) -> str:
    """What to see."""
    plain, enclosed = (known[known["trajectory"] == name] for name in ("bound", "enclosure"))
    wrong = int((known["upper"] < 1).sum() + (enclosed["lower"] > 1).sum())
    seen = [f"{wrong or 'no'} bounds on the wrong side of the error"]
    if len(plain):
        medians = [f"{mine['upper'].median():.3g} with {scheme}" for scheme, mine in plain.groupby("scheme")]
        seen.append(
            f"from u_h alone the bound is {plain['upper'].min():.3g} … {plain['upper'].max():.3g} times the error, the "
            f"median {', '.join(medians)}"
        )
    if len(enclosed):
        seen.append(
            f"an enclosure by a more accurate displacement has its lower end at {enclosed['lower'].min():.3g} … "
            f"{enclosed['lower'].max():.3g} and its upper end at {enclosed['upper'].min():.3g} … "
            f"{enclosed['upper'].max():.3g} times the error"
        )
    return (
        f"Effectivity of the bounds for {known['case'].nunique()} cases whose error is known, the worst "
        f"over the second half of time; a larger marker is a finer mesh. What to see: {'; '.join(seen)}."
    )


def _draw_markers(axes: Axes, x: pd.Series, y: pd.Series, levels: pd.Series, look: Style, filled: bool) -> None:
    style: dict[str, Any] = {"edgecolor": look.colour, "facecolor": look.colour if filled else "white"}
    axes.scatter(x, y, s=_area(levels), marker=look.marker, linewidth=0.6, zorder=3, **style)


def _area(level: Any) -> Any:
    """Of a marker, in square points."""
    return 5.0 * np.log2(level) - 8

"""An adapted mesh with its contact zone, and the bound of the error over unknowns."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation
from numpy.typing import NDArray

from study.present.charts.palette import BLUE, DARK, GREY, VERMILLION
from study.present.figures.drawing import PAGE, Drawing, entry, legend

Array = NDArray[np.float64]
ASPECT, THIN, THICK = 0.5, 0.25, 2.5


@dataclass(frozen=True, eq=False)
class AdaptedMesh:
    """What is drawn.

    Attributes:
        p, t: vertices (2, n) and cells (3, n).
        edges: ends of the edges of Γ3, (2, 2, n); ``closed`` says which are in contact at the last time, (n,).
        rows: ``adaptive.csv``.
        uniform: ``levels.csv`` of uniform meshes, empty if there is none.
    """

    p: Array
    t: NDArray[np.int64]
    edges: Array
    closed: NDArray[np.bool_]
    rows: pd.DataFrame
    uniform: pd.DataFrame


def drawing(name: str, found: AdaptedMesh) -> Drawing:
    """``adaptive``: the figure with its caption."""
    against = ", for meshes refined everywhere as well" if len(found.uniform) else ""
    caption = (
        f"{name}: the last mesh, with what of Γ3 is in contact at the last time in colour, and the bound of "
        f"max ‖u − u_h‖_V from u_h alone over unknowns{against}. The slope −1/2 is the best there is for P1."
    )
    return Drawing("adaptive", partial(_draw, found), caption)


def _draw(found: AdaptedMesh) -> Figure:
    figure = Figure(figsize=(PAGE, ASPECT * PAGE), layout="constrained")
    left, right = figure.subplots(1, 2)
    _mesh(left, found)
    _bounds(right, found)
    handles = [
        entry("Γ3 in contact", color=VERMILLION, lw=THICK),
        entry("Γ3 open", color=BLUE, lw=THICK),
        entry("adaptive", color=BLUE, marker="o"),
    ]
    if len(found.uniform):
        handles.append(entry("refined everywhere", color=GREY, marker="s"))
    legend(figure, handles, len(handles))
    return figure


def _mesh(axes: Axes, found: AdaptedMesh) -> None:
    axes.triplot(Triangulation(*found.p, found.t.T), color=DARK, lw=THIN)
    for which, colour in ((found.closed, VERMILLION), (~found.closed, BLUE)):
        lines = np.moveaxis(found.edges[:, :, which], 2, 0).transpose(0, 2, 1)
        axes.add_collection(LineCollection(list(lines), colors=colour, linewidths=THICK, zorder=3))
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title(f"mesh {found.rows['mesh'].iloc[-1]}, {found.rows['cells'].iloc[-1]} cells")


def _bounds(axes: Axes, found: AdaptedMesh) -> None:
    rows = found.rows
    axes.loglog(rows["dofs"], rows["bound"], color=BLUE, marker="o")
    if len(found.uniform):
        axes.loglog(found.uniform["dofs"], found.uniform["plain"], color=GREY, marker="s")
    if rows["error"].notna().all():
        axes.loglog(rows["dofs"], rows["error"], color=BLUE, ls=":")
    ends = np.array([rows["dofs"].iloc[0], rows["dofs"].iloc[-1]], dtype=float)
    last = rows["bound"].iloc[-1]
    axes.loglog(ends, 0.7 * last * (ends / ends[-1]) ** -0.5, color=DARK, ls="--", lw=0.8)
    middle = np.sqrt(ends.prod())
    place = middle, 0.7 * last * (middle / ends[-1]) ** -0.5
    axes.annotate("slope −1/2", place, textcoords="offset points", xytext=(-5, -5), ha="right", va="top")
    axes.set_xlabel("unknowns")
    axes.set_ylabel(r"bound of max $\Vert u-u_h\Vert_V$")

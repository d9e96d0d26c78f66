"""Gap and pressure on the contact faces of a solid as maps, from ``pictures/CASE.json``."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from study.present.charts.palette import VERMILLION
from study.present.figures.body_scale import PRESSURES
from study.present.figures.canvas import COLUMN, legend
from study.present.figures.face_map import Paint, draw_maps_of, label_maps, triangulation
from study.present.picture.face_history import Array
from study.present.picture.picture import Picture
from study.present.picture.polygon import Polygon
from study.present.picture.wording import face_names, heading, largest_differences, place, times_shown

GAPS = "PuBu"
LEVELS = 10
"""Shades of a map."""


def draw_maps(picture: Picture) -> Figure:
    """For every face a row of ``gap`` and one of ``pressure``; from left to right the times of the shapes.

    Surfaces are the exact values, dots the computed ones at the nodes, in the same colours.
    """
    instants = picture.instants
    rows = 2 * len(picture.polygons)
    figure = Figure(figsize=(COLUMN, 0.7 + 1.05 * rows))
    panels = figure.subplots(rows, len(instants), sharex="row", sharey="row", squeeze=False)
    for i, face in enumerate(picture.polygons):
        gap = "gap $w$", GAPS, face.gap_exact, face.gap
        pressure = "pressure $p$", PRESSURES, face.pressure_exact, face.pressure
        for row, (label, colours, exact, computed) in zip(panels[2 * i : 2 * i + 2], (gap, pressure), strict=True):
            top = float(max(exact[instants].max(), computed[instants].max())) or 1.0
            draw_maps_of(row, picture, face, _values(face, exact, computed, top, colours))
            bar = figure.colorbar(row[-1].collections[0], ax=list(row), fraction=0.05, ticks=[0, top], format="%.3g")
            bar.set_label(label)
    label_maps(panels, picture)
    figure.suptitle(heading(picture))
    legend(figure, _handles(), columns=3)
    return figure


def caption_maps(picture: Picture) -> str:
    """What to see."""
    gap, pressure = largest_differences(picture)
    return (
        f"Gap and contact pressure on {face_names(picture)} at t = {times_shown(picture)} "
        f"({place(picture)}), seen from inside the body: surfaces are exact, dots computed, in the same colours. What "
        "to see: nowhere are gap and pressure both positive, and where a dot stands out there is an error: at most "
        f"{pressure} for the pressure, a nodal force divided by the integral of its shape function; at most {gap} for "
        f"the gap, which itself is at most {100 * _largest_gap(picture):.2g} % of the largest displacement."
    )


def _largest_gap(picture: Picture) -> float:
    """The largest exact gap at the times of the shapes over the largest displacement."""
    instants = picture.instants
    displacement = max(float(np.linalg.norm(shape.displacement, axis=0).max()) for shape in picture.shapes)
    return max(float(face.gap_exact[instants].max()) for face in picture.polygons) / (displacement or 1.0)


def _values(face: Polygon, exact: Array, computed: Array, top: float, colours: str) -> Paint:
    levels = np.linspace(0, top, LEVELS + 1)
    style: dict[str, Any] = {"cmap": colormaps[colours], "norm": BoundaryNorm(levels, 256)}

    def paint(axes: Axes, instant: int) -> None:
        axes.tricontourf(triangulation(face), exact[instant].clip(0), levels, **style)
        axes.scatter(
            face.s[0], face.s[1], s=5, c=computed[instant].clip(0), edgecolors="0.4", linewidths=0.2, zorder=2, **style
        )

    return paint


def _handles() -> list[Line2D]:
    dot: dict[str, Any] = {"ls": "", "marker": "o", "mfc": "white", "mec": "0.4", "mew": 0.4, "ms": 2.6}
    return [
        Line2D([], [], color="0.6", lw=4, label="exact"),
        Line2D([], [], label="computed", **dot),
        Line2D([], [], color=VERMILLION, lw=1.0, label="exact front"),
    ]

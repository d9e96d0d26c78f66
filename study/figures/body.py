"""The deforming body on its foundation at three times, from ``pictures/CASE.json``."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon

from study.figures.canvas import BLUE, COLUMN, VERMILLION, legend
from study.figures.pictures import Array, Face, Picture, Shape, heading

SHARE = 0.12
"""The largest displacement is drawn as long as this fraction of the body's larger side."""
ARROW = 0.2
"""The same for the largest pressure."""
ARROWS = 16
"""At most about so many arrows on a face."""
BAND = 0.05
"""Thickness of the foundation as drawn."""


def draw_body(picture: Picture) -> Figure:
    """The magnified deformed mesh at the three times of ``shapes``, the foundation undeformed.

    The foundation of each face is the plane of its nodes ``x``, with the outer side grey; arrows are
    the ``pressure`` of the foundation on the body, all to one scale.
    """
    size = float(np.ptp(picture.vertices, axis=1).max())
    magnification = magnify(picture, size)
    limits = _limits(picture, magnification, size)
    aspect = float(np.ptp(limits[1]) / np.ptp(limits[0]))
    count = len(picture.shapes)
    figure = Figure(figsize=(COLUMN, 0.75 + (COLUMN - 0.1) / count * aspect))
    for axes, shape in zip(figure.subplots(1, count, squeeze=False)[0], picture.shapes, strict=True):
        _draw_shape(axes, picture, shape, magnification)
        for face in picture.faces:
            _draw_face(axes, face, picture.nearest(shape.time), size, _highest(picture))
        axes.set(xlim=limits[0], ylim=limits[1], aspect="equal")
        axes.set_title(f"$t={shape.time:.3g}$")
        axes.axis("off")
    figure.suptitle(heading(picture))
    legend(figure, _handles(picture, magnification), columns=2)
    return figure


def magnify(picture: Picture, size: float) -> float:
    """The magnification of displacements, rounded down to two digits so that it can be stated."""
    largest = max(float(np.linalg.norm(shape.displacement, axis=0).max()) for shape in picture.shapes)
    if largest == 0:
        return 1.0
    exact = SHARE * size / largest
    unit = 10.0 ** (math.floor(math.log10(exact)) - 1)
    return math.floor(exact / unit) * unit


def _highest(picture: Picture) -> float:
    """The largest pressure at the times shown."""
    instants = [picture.nearest(shape.time) for shape in picture.shapes]
    return max((float(face.pressure[instants].max()) for face in picture.faces), default=0.0)


def _limits(picture: Picture, magnification: float, size: float) -> Array:
    """Room for every shape and for arrows of full length, (2, 2), the same for all times."""
    points = [picture.vertices] + [picture.vertices + magnification * shape.displacement for shape in picture.shapes]
    points += [face.x + ARROW * size * face.normal[:, None] for face in picture.faces]
    everything = np.hstack(points)
    margin = 0.02 * size * np.array([-1, 1])
    return np.column_stack([everything.min(axis=1), everything.max(axis=1)]) + margin


def _draw_shape(axes: Axes, picture: Picture, shape: Shape, magnification: float) -> None:
    x, y = picture.vertices + magnification * shape.displacement
    # In a column a cell is about this many points wide; thicker lines would fill fine meshes.
    cell = 72 * COLUMN / len(picture.shapes) / math.sqrt(picture.cells.shape[1] / 2)
    axes.triplot(x, y, picture.cells.T, color=BLUE, lw=min(0.3, 0.12 * cell), zorder=2)


def _draw_face(axes: Axes, face: Face, instant: int, size: float, highest: float) -> None:
    """The foundation, and arrows that end on it where it presses."""
    ends = face.x[:, [face.s.argmin(), face.s.argmax()]]
    depth = BAND * size * face.normal[:, None]
    axes.add_patch(Polygon(np.hstack([ends, ends[:, ::-1] + depth]).T, facecolor="0.82", edgecolor="none", zorder=0.5))
    axes.plot(*ends, color="0.25", lw=0.9, solid_capstyle="butt", zorder=2.5)
    every = max(1, round(len(face.s) / ARROWS))
    shown = np.flatnonzero(face.touching[instant])
    shown = shown[shown % every == 0]
    length = ARROW * size * face.pressure[instant, shown] / (highest or 1.0)
    arrows = -face.normal[:, None] * length
    scale: dict[str, Any] = {
        "angles": "xy",
        "scale_units": "xy",
        "scale": 1,
        "pivot": "tip",
        "units": "xy",
        "minlength": 0,
    }
    axes.quiver(*face.x[:, shown], *arrows, color=VERMILLION, width=0.012 * size, zorder=3, **scale)


def _handles(picture: Picture, magnification: float) -> list[Artist]:
    arrow: dict[str, Any] = {"color": VERMILLION, "ls": "", "marker": r"$\uparrow$", "ms": 6, "mew": 0.2}
    return [
        Line2D([], [], color=BLUE, lw=0.6, label=rf"body, displacement $\times\,{magnification:.2g}$"),
        Patch(facecolor="0.82", edgecolor="0.25", label="foundation"),
        Line2D([], [], label=f"contact pressure, at most {_highest(picture):.3g}", **arrow),
    ]

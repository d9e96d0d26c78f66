"""The deforming body on its foundation at some times, from ``pictures/CASE.json``."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PathCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Polygon
from matplotlib.path import Path

from study.figures.canvas import BLACK, COLUMN, VERMILLION, legend
from study.figures.pictures import Array, Face, Picture, Shape, heading, place

SHARE = 0.12
"""The largest displacement is drawn as long as this fraction of the body's larger side."""
ARROW = 0.2
"""The same for the largest pressure."""
ARROWS = 16
"""At most about so many arrows on a face."""
BAND = 0.05
"""Thickness of the foundation as drawn."""
COLOURS = "YlGnBu"
"""Light for small stresses, so that the mesh stays visible, and in an order that every eye sees."""
SHADES = 16
CLIPPED = 0.005
"""The fraction of cells, those at a singular corner, whose stress may lie beyond the end of the colours."""


@dataclass(frozen=True, eq=False)
class Scale:
    """What all times of a picture are drawn to.

    Attributes:
        size: the body's larger side.
        magnification: of displacements.
        limits: of x and y, (2, 2).
        pressure: the largest one shown.
        stress: the end of the colours.
    """

    size: float
    magnification: float
    limits: Array
    pressure: float
    stress: float

    @classmethod
    def of(cls, picture: Picture) -> Scale:
        """Room for every shape and for arrows of full length."""
        size = float(np.ptp(picture.vertices, axis=1).max())
        magnification = magnify(picture, size)
        instants = [picture.nearest(shape.time) for shape in picture.shapes]
        return cls(
            size=size,
            magnification=magnification,
            limits=_limits(picture, magnification, size),
            pressure=max((float(face.pressure[instants].max()) for face in picture.faces), default=0.0),
            stress=float(np.quantile([shape.von_mises for shape in picture.shapes], 1 - CLIPPED)) or 1.0,
        )

    @property
    def aspect(self) -> float:
        """Height over width."""
        return float(np.ptp(self.limits[1]) / np.ptp(self.limits[0]))

    @property
    def colours(self) -> ScalarMappable:
        """From 0 to the end of the colours."""
        return ScalarMappable(Normalize(0, self.stress), colormaps[COLOURS].resampled(SHADES))


def draw_body(picture: Picture) -> Figure:
    """The magnified deformed mesh at the times of ``shapes``, coloured by its von Mises stress.

    The foundation of each face is the plane of its nodes ``x``, undeformed, with the outer side grey; arrows are the
    ``pressure`` of the foundation on the body, all to one scale.
    """
    scale = Scale.of(picture)
    count = len(picture.shapes)
    figure = Figure(figsize=(COLUMN, 1.15 + (COLUMN - 0.1) / count * scale.aspect))
    panels = figure.subplots(1, count, squeeze=False)[0]
    for axes, shape in zip(panels, picture.shapes, strict=True):
        draw_moment(axes, picture, shape, scale, COLUMN / count)
        axes.set_title(f"$t={shape.time:.3g}$")
    colour_bar(figure, list(panels), scale, orientation="horizontal", fraction=0.05, shrink=0.7, pad=0.02)
    figure.suptitle(heading(picture))
    legend(figure, handles(scale), columns=2)
    return figure


def caption_body(picture: Picture) -> str:
    """What to see."""
    scale = Scale.of(picture)
    shape = max(picture.shapes, key=lambda shape: float(shape.von_mises.max()))
    times = ", ".join(f"{shape.time:.3g}" for shape in picture.shapes)
    return (
        f"The deformed body at t = {times} ({place(picture)}): displacements times {scale.magnification:.2g}, cells "
        f"coloured by the von Mises stress √(3/2) |dev σ| of the computed stress A ε(δu) + G ε(u), dev σ the deviator "
        f"in the plane; arrows are the contact pressure, at most {scale.pressure:.3g}. What to see: where there is "
        f"contact ({_contact(picture)}), the body lies on the foundation and is pressed, elsewhere it has come off and "
        f"is not. The largest von Mises stress is {shape.von_mises.max():.3g}, at t = {shape.time:.3g}; one cell in "
        f"{1 / CLIPPED:.0f} may lie beyond the end of the colours, {scale.stress:.3g}."
    )


def _contact(picture: Picture) -> str:
    """How many vertices of Γ3 are in contact at each time."""
    counts = [
        sum(int(face.touching[picture.nearest(shape.time)].sum()) for face in picture.faces) for shape in picture.shapes
    ]
    vertices = sum(len(face.s) for face in picture.faces)
    return f"{', '.join(map(str, counts))} of {vertices} vertices of Γ3"


def magnify(picture: Picture, size: float) -> float:
    """The magnification of displacements, rounded down to two digits so that it can be stated."""
    largest = max(float(np.linalg.norm(shape.displacement, axis=0).max()) for shape in picture.shapes)
    if largest == 0:
        return 1.0
    exact = SHARE * size / largest
    unit = 10.0 ** (math.floor(math.log10(exact)) - 1)
    return math.floor(exact / unit) * unit


def _limits(picture: Picture, magnification: float, size: float) -> Array:
    points = [picture.vertices] + [picture.vertices + magnification * shape.displacement for shape in picture.shapes]
    points += [face.x + ARROW * size * face.normal[:, None] for face in picture.faces]
    everything = np.hstack(points)
    margin = 0.02 * size * np.array([-1, 1])
    return np.column_stack([everything.min(axis=1), everything.max(axis=1)]) + margin


def draw_moment(axes: Axes, picture: Picture, shape: Shape, scale: Scale, width: float) -> None:
    """One shape and the foundation with its pressure, in axes ``width`` inches wide."""
    corners = (picture.vertices + scale.magnification * shape.displacement).T[picture.cells.T]
    # A cell is about this many points wide; thicker lines would fill fine meshes.
    cell = 72 * width / math.sqrt(picture.cells.shape[1] / 2)
    # One path for all cells of a shade: a path for each cell takes three times as long to write.
    shades = np.clip(shape.von_mises / scale.stress * SHADES, 0, SHADES - 1).astype(int)
    used = np.unique(shades)
    body = PathCollection(
        [_outlines(corners[shades == shade]) for shade in used],
        facecolors=scale.colours.cmap(used),
        edgecolors=(0, 0, 0, 0.4),
        linewidths=min(0.3, 0.04 * cell),
        zorder=2,
    )
    axes.add_collection(body, autolim=False)
    for face in picture.faces:
        _draw_face(axes, face, picture.nearest(shape.time), scale)
    axes.set(xlim=scale.limits[0], ylim=scale.limits[1], aspect="equal")
    axes.axis("off")


def _outlines(corners: Array) -> Path:
    """Triangles, (n, 3, 2), as one path."""
    codes = np.tile([Path.MOVETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY], len(corners))
    return Path(np.concatenate([corners, corners[:, :1]], axis=1).reshape(-1, 2), codes)


def _draw_face(axes: Axes, face: Face, instant: int, scale: Scale) -> None:
    """The foundation, black and thick where the body lies on it, and arrows that end on it where it presses."""
    size = scale.size
    ends = face.x[:, [face.s.argmin(), face.s.argmax()]]
    depth = BAND * size * face.normal[:, None]
    axes.add_patch(Polygon(np.hstack([ends, ends[:, ::-1] + depth]).T, facecolor="0.82", edgecolor="none", zorder=0.5))
    axes.plot(*ends, color="0.25", lw=0.6, solid_capstyle="butt", zorder=2.5)
    for interval in face.computed_zone(instant):
        axes.plot(*face.point(np.array(interval)), color=BLACK, lw=1.8, solid_capstyle="butt", zorder=2.6)
    every = max(1, round(len(face.s) / ARROWS))
    shown = np.flatnonzero(face.touching[instant])
    shown = shown[shown % every == 0]
    length = ARROW * size * face.pressure[instant, shown] / (scale.pressure or 1.0)
    arrows = -face.normal[:, None] * length
    style: dict[str, Any] = {"angles": "xy", "scale_units": "xy", "scale": 1, "pivot": "tip", "units": "xy"}
    axes.quiver(*face.x[:, shown], *arrows, color=VERMILLION, width=0.012 * size, minlength=0, zorder=3, **style)


def colour_bar(figure: Figure, panels: list[Axes], scale: Scale, **layout: Any) -> None:
    """The colours of the stress, beside or under some axes."""
    bar = figure.colorbar(scale.colours, ax=panels, extend="max", **layout)
    bar.set_label(r"von Mises stress $\sqrt{3/2}\,|\mathrm{dev}\,\sigma|$")
    bar.outline.set_linewidth(0.4)


def handles(scale: Scale) -> list[Artist]:
    """What a picture of a moment shows."""
    arrow: dict[str, Any] = {"color": VERMILLION, "ls": "", "marker": r"$\uparrow$", "ms": 6, "mew": 0.2}
    return [
        Line2D([], [], color="0.35", lw=0.6, label=rf"body, displacement $\times\,{scale.magnification:.2g}$"),
        Patch(facecolor="0.82", edgecolor="0.25", label="foundation"),
        Line2D([], [], label=f"contact pressure, at most {scale.pressure:.3g}", **arrow),
        Line2D([], [], color=BLACK, lw=1.8, label="computed contact zone"),
    ]

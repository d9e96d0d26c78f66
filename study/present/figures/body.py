"""The deforming body on its foundation at some times, from ``pictures/CASE.json``."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib import colormaps, patches
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PathCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.path import Path
from numpy.typing import NDArray

from study.present.figures.canvas import BLACK, COLUMN, VERMILLION, legend
from study.present.figures.pictures import Array, Picture, Polygon, Segment, Shape, heading, place
from study.present.figures.view import View

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
PRESSURES = "OrRd"
"""The same for the pressure on the faces of solids."""
SHADES = 16
CLIPPED = 0.005
"""The fraction of cells, those at a singular corner, whose stress may lie beyond the end of the colours."""


@dataclass(frozen=True, eq=False)
class Scale:
    """What all times of a picture are drawn to.

    Attributes:
        view: from the body to the page.
        size: the body's larger side.
        magnification: of displacements.
        limits: of what is drawn to the right and upwards, (2, 2).
        pressure: the largest one shown.
        stress: the end of the colours.
    """

    view: View
    size: float
    magnification: float
    limits: Array
    pressure: float
    stress: float

    @classmethod
    def of(cls, picture: Picture) -> Scale:
        """Room for every shape and for arrows of full length."""
        size = float(np.ptp(picture.vertices, axis=1).max())
        magnification, view = magnify(picture, size), View.of(picture)
        instants = [picture.nearest(shape.time) for shape in picture.shapes]
        return cls(
            view=view,
            size=size,
            magnification=magnification,
            limits=_limits(picture, view, magnification, size),
            pressure=max((float(face.pressure[instants].max()) for face in picture.faces), default=0.0),
            stress=float(np.quantile([shape.von_mises for shape in picture.shapes], 1 - CLIPPED)) or 1.0,
        )

    @property
    def aspect(self) -> float:
        """Height over width."""
        return float(np.ptp(self.limits[1]) / np.ptp(self.limits[0]))

    @property
    def colours(self) -> ScalarMappable:
        """Of the stress, from 0 to the end of the colours."""
        return ScalarMappable(Normalize(0, self.stress), colormaps[COLOURS].resampled(SHADES))

    @property
    def pressures(self) -> ScalarMappable:
        """Of the pressure, from 0 to the largest one."""
        return ScalarMappable(Normalize(0, self.pressure or 1.0), colormaps[PRESSURES].resampled(SHADES))


def draw_body(picture: Picture) -> Figure:
    """The magnified deformed mesh at the times of ``shapes``, coloured by its von Mises stress.

    In the plane the foundation of each face is the line of its nodes ``x``, undeformed, with the outer side grey;
    arrows are the ``pressure`` of the foundation on the body, all to one scale. A solid is seen through its foundation,
    and the pressure colours its contact faces.
    """
    scale = Scale.of(picture)
    count = len(picture.shapes)
    bars = 2 if picture.polygons else 1
    figure = Figure(figsize=(COLUMN, 0.7 + 0.45 * bars + (COLUMN - 0.1) / count * scale.aspect))
    panels = figure.subplots(1, count, squeeze=False)[0]
    for axes, shape in zip(panels, picture.shapes, strict=True):
        draw_moment(axes, picture, shape, scale, COLUMN / count)
        axes.set_title(f"$t={shape.time:.3g}$")
    layout: dict[str, Any] = {"orientation": "horizontal", "fraction": 0.05, "shrink": 0.7, "pad": 0.02}
    colour_bar(figure, list(panels), scale, **layout)
    if picture.polygons:
        figure.colorbar(scale.pressures, ax=list(panels), **layout).set_label(r"contact pressure $p^h$ on $\Gamma_3$")
    figure.suptitle(heading(picture))
    legend(figure, solid_handles(scale) if picture.polygons else handles(scale), columns=2)
    return figure


def caption_body(picture: Picture) -> str:
    """What to see."""
    scale = Scale.of(picture)
    shape = max(picture.shapes, key=lambda shape: float(shape.von_mises.max()))
    times = ", ".join(f"{shape.time:.3g}" for shape in picture.shapes)
    drawn, seen, deviator = _IN_SPACE if picture.polygons else _IN_THE_PLANE
    return (
        f"The deformed body at t = {times} ({place(picture)}): displacements times {scale.magnification:.2g}, cells "
        f"coloured by the von Mises stress √(3/2) |dev σ| of the computed stress A ε(δu) + G ε(u){deviator}; {drawn}, "
        f"at most {scale.pressure:.3g}. What to see: where there is contact ({_contact(picture)}), {seen}. The largest "
        f"von Mises stress is {shape.von_mises.max():.3g}, at t = {shape.time:.3g}; one cell in {1 / CLIPPED:.0f} may "
        f"lie beyond the end of the colours, {scale.stress:.3g}."
    )


_IN_THE_PLANE = (
    "arrows are the contact pressure",
    "the body lies on the foundation and is pressed, elsewhere it has come off and is not",
    ", dev σ the deviator in the plane",
)
_IN_SPACE = (
    "the body is turned and seen through its foundation, and Γ3 is coloured by the contact pressure",
    "Γ3 is flat and pressed, elsewhere it has come off and is not",
    "",
)


def _contact(picture: Picture) -> str:
    """How many vertices of Γ3 are in contact at each time."""
    counts = [
        sum(int(face.touching[picture.nearest(shape.time)].sum()) for face in picture.faces) for shape in picture.shapes
    ]
    vertices = sum(face.pressure.shape[1] for face in picture.faces)
    return f"{', '.join(map(str, counts))} of {vertices} vertices of Γ3"


def magnify(picture: Picture, size: float) -> float:
    """The magnification of displacements, rounded down to two digits so that it can be stated."""
    largest = max(float(np.linalg.norm(shape.displacement, axis=0).max()) for shape in picture.shapes)
    if largest == 0:
        return 1.0
    exact = SHARE * size / largest
    unit = 10.0 ** (math.floor(math.log10(exact)) - 1)
    return math.floor(exact / unit) * unit


def _limits(picture: Picture, view: View, magnification: float, size: float) -> Array:
    points = [picture.vertices] + [picture.vertices + magnification * shape.displacement for shape in picture.shapes]
    points += [face.x + ARROW * size * face.normal[:, None] for face in picture.segments]
    everything = view.flat(np.hstack(points))
    margin = 0.02 * size * np.array([-1, 1])
    return np.column_stack([everything.min(axis=1), everything.max(axis=1)]) + margin


def draw_moment(axes: Axes, picture: Picture, shape: Shape, scale: Scale, width: float) -> None:
    """One shape with its pressure, in the plane with the foundation, in axes ``width`` inches wide."""
    instant = picture.nearest(shape.time)
    moved = picture.vertices + scale.magnification * shape.displacement
    shades, colours = _shades(picture, shape, scale)
    order = scale.view.order(moved, picture.cells, shades)
    flat = scale.view.flat(moved)
    corners = flat.T[picture.cells.T]
    # A cell is about this many points wide; thicker lines would fill fine meshes.
    cell = 72 * width / math.sqrt(len(order) / 2)
    # One path for all cells of a shade in a row: a path for each cell takes three times as long to write.
    runs = np.split(order, np.flatnonzero(np.diff(shades[order])) + 1)
    body = PathCollection(
        [_outlines(corners[run]) for run in runs],
        facecolors=colours[[shades[run[0]] for run in runs]],
        edgecolors=(0, 0, 0, 0.4),
        linewidths=min(0.3, 0.04 * cell),
        zorder=2,
    )
    axes.add_collection(body, autolim=False)
    for face in picture.segments:
        _draw_face(axes, face, instant, scale)
    for polygon in picture.polygons:
        _draw_touching(axes, polygon, flat[:, polygon.nodes], instant, scale)
    axes.set(xlim=scale.limits[0], ylim=scale.limits[1], aspect="equal")
    axes.axis("off")


def _draw_touching(axes: Axes, face: Polygon, nodes: Array, instant: int, scale: Scale) -> None:
    """The nodes in contact, if the face is seen."""
    if scale.view.axes[2] @ face.normal > 0:
        axes.plot(*nodes[:, face.touching[instant]], "o", color=BLACK, ms=0.9, mew=0, zorder=3)


def _shades(picture: Picture, shape: Shape, scale: Scale) -> tuple[NDArray[np.int64], Array]:
    """A number for each cell, (cells,), and the colours that these numbers stand for: stresses, then pressures.

    A facet of a contact face has the mean pressure of its corners.
    """
    stress = _steps(shape.von_mises / scale.stress)
    for face in picture.polygons:
        pressure = face.pressure[picture.nearest(shape.time)][face.facets.corners].mean(axis=0)
        stress[face.facets.cells] = SHADES + _steps(pressure / (scale.pressure or 1.0))
    steps = np.arange(SHADES)
    return stress, np.concatenate([scale.colours.cmap(steps), scale.pressures.cmap(steps)])


def _steps(shares: Array) -> NDArray[np.int64]:
    return np.clip(shares * SHADES, 0, SHADES - 1).astype(np.int64)


def _outlines(corners: Array) -> Path:
    """Triangles, (n, 3, 2), as one path."""
    codes = np.tile([Path.MOVETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY], len(corners))
    return Path(np.concatenate([corners, corners[:, :1]], axis=1).reshape(-1, 2), codes)


def _draw_face(axes: Axes, face: Segment, instant: int, scale: Scale) -> None:
    """The foundation, black and thick where the body lies on it, and arrows that end on it where it presses."""
    size = scale.size
    ends = face.x[:, [face.s.argmin(), face.s.argmax()]]
    depth = BAND * size * face.normal[:, None]
    axes.add_patch(
        patches.Polygon(np.hstack([ends, ends[:, ::-1] + depth]).T, facecolor="0.82", edgecolor="none", zorder=0.5)
    )
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
        patches.Patch(facecolor="0.82", edgecolor="0.25", label="foundation"),
        Line2D([], [], label=f"contact pressure, at most {scale.pressure:.3g}", **arrow),
        Line2D([], [], color=BLACK, lw=1.8, label="computed contact zone"),
    ]


def solid_handles(scale: Scale) -> list[Artist]:
    """The same for a solid."""
    dot: dict[str, Any] = {"color": BLACK, "ls": "", "marker": "o", "ms": 2, "mew": 0}
    return [
        Line2D([], [], color="0.35", lw=0.6, label=rf"body, displacement $\times\,{scale.magnification:.2g}$"),
        Line2D([], [], label="vertices in contact", **dot),
    ]

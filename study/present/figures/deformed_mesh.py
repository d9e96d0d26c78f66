"""The deformed mesh at one time, coloured by stress and pressure, on its foundation."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib import patches
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PathCollection
from matplotlib.colors import Colormap, LinearSegmentedColormap, Normalize, PowerNorm
from matplotlib.path import Path
from numpy.typing import NDArray

from study.present.charts.palette import BLACK, BLUE, RAMPS, VERMILLION
from study.present.picture.faces import Array, Segment
from study.present.picture.picture import Picture, Shape
from study.present.picture.view import ARROW, FOUNDATION, View, end_of_colours, magnification, shade

SHADES = 16


def ramp(name: str, shades: int = 256) -> Colormap:
    """The colours of a quantity, from zero to its largest value."""
    return LinearSegmentedColormap.from_list(name, RAMPS[name], shades)


@dataclass(frozen=True, eq=False)
class BodyScale:
    """What all times of a picture are drawn to: ``limits`` are those of the drawing, (2, 2), to the right and upwards.

    ``size`` is the body's longest side, ``pressure`` and ``gap`` are the largest ones shown, ``stress`` is the end of
    the colours.
    """

    view: View
    size: float
    magnification: float
    limits: Array
    pressure: float
    gap: float
    stress: float

    @classmethod
    def of(cls, picture: Picture) -> BodyScale:
        """Room for every shape and for arrows of full length."""
        view = View.of(picture)
        factor = magnification(picture.vertices, [shape.displacement for shape in picture.shapes])
        at, faces = picture.instants, picture.faces
        return cls(
            view=view,
            size=picture.size,
            magnification=factor,
            limits=_limits(picture, view, factor),
            pressure=max((float(face.pressure[at].max()) for face in faces), default=0.0),
            gap=max((float(face.gap[at].max()) for face in faces), default=0.0),
            stress=end_of_colours(np.array([shape.von_mises for shape in picture.shapes])),
        )

    @property
    def aspect(self) -> float:
        """Height over width."""
        return float(np.ptp(self.limits[1]) / np.ptp(self.limits[0]))

    @property
    def stress_colours(self) -> ScalarMappable:
        """From 0 to the end of the colours, as ``shade`` has it."""
        return ScalarMappable(PowerNorm(0.5, 0, self.stress), ramp("stress", SHADES))

    @property
    def pressure_colours(self) -> ScalarMappable:
        """From 0 to the largest pressure."""
        return ScalarMappable(Normalize(0, self.pressure or 1.0), ramp("pressure", SHADES))


def _limits(picture: Picture, view: View, factor: float) -> Array:
    points = [picture.vertices] + [picture.vertices + factor * shape.displacement for shape in picture.shapes]
    points += [face.x + ARROW * picture.size * face.normal[:, None] for face in picture.segments]
    everything = view.flat(np.hstack(points))
    margin = 0.02 * picture.size * np.array([-1, 1])
    return np.column_stack([everything.min(axis=1), everything.max(axis=1)]) + margin


GAP: dict[str, Any] = {"facecolor": (BLUE, 0.3), "edgecolor": BLUE, "linewidth": 0.5}
ARROWS = 16
"""At most about so many on a face."""
ROUND_OFF = 1e-9
"""Below this a gap or a pressure counts as zero; where they are not zero they are of order one."""


def draw_foundation(axes: Axes, face: Segment, instant: int, scale: BodyScale) -> None:
    """Grey, with a thick black line where the body lies on it, arrows that end on it where it presses, and the gap.

    The gap hangs below the surface, to a scale of its own: beside large displacements elsewhere nobody would see it.
    """
    ends = face.x[:, [face.s.argmin(), face.s.argmax()]]
    depth = FOUNDATION * scale.size * face.normal[:, None]
    axes.add_patch(
        patches.Polygon(np.hstack([ends, ends[:, ::-1] + depth]).T, facecolor="0.82", edgecolor="none", zorder=0.5)
    )
    axes.plot(*ends, color="0.25", lw=0.6, solid_capstyle="butt", zorder=2.5)
    if scale.gap > ROUND_OFF:
        depth = ARROW * scale.size * face.gap[instant].clip(0) / scale.gap * face.normal[:, None]
        gap = np.hstack([face.x, (face.x + depth)[:, ::-1]]).T
        axes.add_patch(patches.Polygon(gap, **GAP, zorder=0.6))
    for interval in face.computed_zone(instant):
        axes.plot(*face.point(np.array(interval)), color=BLACK, lw=1.8, solid_capstyle="butt", zorder=2.6)
    every = max(1, round(len(face.s) / ARROWS))
    shown = np.flatnonzero(face.touching[instant])
    shown = shown[shown % every == 0]
    length = ARROW * scale.size * face.pressure[instant, shown] / (scale.pressure or 1.0)
    arrows = -face.normal[:, None] * length
    style: dict[str, Any] = {"angles": "xy", "scale_units": "xy", "scale": 1, "pivot": "tip", "units": "xy"}
    axes.quiver(*face.x[:, shown], *arrows, color=VERMILLION, width=0.012 * scale.size, minlength=0, zorder=3, **style)


def draw_deformed_mesh(axes: Axes, picture: Picture, shape: Shape, scale: BodyScale, width: float) -> None:
    """One shape with its pressure, in the plane with the foundation, in axes ``width`` inches wide."""
    instant = picture.nearest(shape.time)
    moved = picture.vertices + scale.magnification * shape.displacement
    shades, colours = cell_shades(picture, shape, scale)
    order = scale.view.order(moved, picture.cells, shades)
    flat = scale.view.flat(moved)
    # A cell is about this many points wide; thicker lines would fill fine meshes.
    cell = 72 * width / math.sqrt(len(order) / 2)
    axes.add_collection(_cells(flat.T[picture.cells.T], order, shades, colours, cell), autolim=False)
    for face in picture.segments:
        draw_foundation(axes, face, instant, scale)
    for polygon in picture.polygons:
        # Only faces that are seen.
        if scale.view.axes[2] @ polygon.normal > 0:
            touching = flat[:, polygon.nodes[polygon.touching[instant]]]
            axes.plot(*touching, "o", color=BLACK, ms=min(cell / 6, 2.0), mew=0, zorder=3)
    axes.set(xlim=scale.limits[0], ylim=scale.limits[1], aspect="equal")
    axes.axis("off")


def cell_shades(picture: Picture, shape: Shape, scale: BodyScale) -> tuple[NDArray[np.int64], Array]:
    """A number for each cell, (cells,), and the colours that these numbers stand for: stresses, then pressures.

    A facet of a contact face has the mean pressure of its corners.
    """
    stress = _steps(shade(shape.von_mises / scale.stress))
    for face in picture.polygons:
        pressure = face.pressure[picture.nearest(shape.time)][face.facets.corners].mean(axis=0)
        stress[face.facets.cells] = SHADES + _steps(pressure / (scale.pressure or 1.0))
    steps = np.arange(SHADES)
    return stress, np.concatenate([scale.stress_colours.cmap(steps), scale.pressure_colours.cmap(steps)])


def _cells(
    corners: Array, order: NDArray[np.int64], shades: NDArray[np.int64], colours: Array, cell: float
) -> PathCollection:
    """Triangles with the given corners, (cells, 3, 2), in the given order."""
    # One path for all cells of a shade in a row: a path for each cell takes three times as long to write.
    runs = np.split(order, np.flatnonzero(np.diff(shades[order])) + 1)
    closed = [np.concatenate([corners[run], corners[run, :1]], axis=1).reshape(-1, 2) for run in runs]
    triangle = [Path.MOVETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY]
    return PathCollection(
        [Path(points, np.tile(triangle, len(points) // 4)) for points in closed],
        facecolors=colours[[shades[run[0]] for run in runs]],
        edgecolors=(0, 0, 0, 0.4),
        linewidths=min(0.3, 0.04 * cell),
        zorder=2,
    )


def _steps(shares: Array) -> NDArray[np.int64]:
    return np.clip(shares * SHADES, 0, SHADES - 1).astype(np.int64)

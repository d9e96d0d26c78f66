"""The deformed mesh at one time, coloured by stress and pressure."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PathCollection
from matplotlib.path import Path
from numpy.typing import NDArray

from study.present.charts.palette import BLACK
from study.present.figures.body_scale import SHADES, BodyScale
from study.present.figures.foundation import draw_foundation
from study.present.picture.face_history import Array
from study.present.picture.picture import Picture, Shape


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
    stress = _steps(shape.von_mises / scale.stress)
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
    return PathCollection(
        [_outlines(corners[run]) for run in runs],
        facecolors=colours[[shades[run[0]] for run in runs]],
        edgecolors=(0, 0, 0, 0.4),
        linewidths=min(0.3, 0.04 * cell),
        zorder=2,
    )


def _outlines(corners: Array) -> Path:
    """Triangles, (n, 3, 2), as one path."""
    codes = np.tile([Path.MOVETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY], len(corners))
    return Path(np.concatenate([corners, corners[:, :1]], axis=1).reshape(-1, 2), codes)


def _steps(shares: Array) -> NDArray[np.int64]:
    return np.clip(shares * SHADES, 0, SHADES - 1).astype(np.int64)

"""A face of a solid as a map, seen from inside the body, at the times of the shapes of a picture."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from matplotlib.axes import Axes
from matplotlib.tri import Triangulation

from study.present.charts.palette import VERMILLION
from study.present.picture.face_history import Array
from study.present.picture.picture import Picture
from study.present.picture.polygon import Polygon
from study.present.picture.wording import face_symbol

Paint = Callable[[Axes, int], Any]
"""Draws what a map shows at one of the times of the picture."""


def draw_maps_of(row: Array, picture: Picture, face: Polygon, paint: Paint) -> None:
    """The maps of a face at the times of the shapes."""
    for axes, shape in zip(row, picture.shapes, strict=True):
        instant = picture.nearest(shape.time)
        paint(axes, instant)
        _draw_front(axes, face, instant)
        axes.set(aspect="equal", xlim=(face.s[0].min(), face.s[0].max()), ylim=(face.s[1].min(), face.s[1].max()))
    row[0].set_ylabel(rf"$s_2$ on ${face_symbol(face, picture)}$")


def label_maps(panels: Array, picture: Picture) -> None:
    """Times above the first row, the label of the horizontal axis below the last."""
    for axes, shape in zip(panels[0], picture.shapes, strict=True):
        axes.set_title(f"$t={shape.time:.3g}$")
    for axes in panels[-1]:
        axes.set_xlabel("$s_1$")


def triangulation(face: Polygon) -> Triangulation:
    """The triangles between the nodes."""
    return Triangulation(*face.s, face.facets.corners.T)


def refined_triangulation(face: Polygon) -> Triangulation:
    """The triangles between the points at which ψ is known."""
    return Triangulation(*face.facets.refined(face.s), face.facets.quarters.T)


def _draw_front(axes: Axes, face: Polygon, instant: int) -> None:
    level = face.level[instant]
    if level.min() < 0 <= level.max():
        axes.tricontour(refined_triangulation(face), level, [0], colors=VERMILLION, linewidths=1.0)

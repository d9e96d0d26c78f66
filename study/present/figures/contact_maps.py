"""Contact of a solid, from ``pictures/CASE.json``: maps of the faces, seen from inside the body."""

from __future__ import annotations

from collections.abc import Callable
from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

from study.present.charts.palette import BLUE, SKY, VERMILLION
from study.present.figures.contact_lines import HARMLESS, HOLLOW, LINES, zone_handles
from study.present.figures.deformed_mesh import ramp
from study.present.figures.drawing import COLUMN, dots, entry, legend
from study.present.figures.profiles import largest_differences
from study.present.picture.faces import Array, Polygon
from study.present.picture.picture import Picture
from study.present.picture.zone_history import misplaced_nodes, outside

Paint = Callable[[Axes, int], Any]
"""Draws what a map shows at one of the times of the picture."""


def draw_maps_of(row: Array, picture: Picture, face: Polygon, paint: Paint) -> None:
    """The maps of a face with its exact front, at the times of the shapes."""
    for axes, instant in zip(row, picture.instants, strict=True):
        draw_map(axes, face, instant, paint)
    row[0].set_ylabel(rf"$s_2$ on ${picture.symbol(face)}$")


def draw_map(axes: Axes, face: Polygon, instant: int, paint: Paint) -> None:
    """The map of a face with its exact front at one time."""
    paint(axes, instant)
    level = face.level[instant]
    if level.min() < 0 <= level.max():
        axes.tricontour(refined_triangulation(face), level, [0], colors=VERMILLION, linewidths=1.0)
    axes.set(aspect="equal", xlim=(face.s[0].min(), face.s[0].max()), ylim=(face.s[1].min(), face.s[1].max()))


def label_maps(panels: Array, picture: Picture) -> None:
    """Times above the first row, the label of the horizontal axis below the last."""
    for axes, shape in zip(panels[0], picture.shapes, strict=True):
        axes.set_title(f"$t={shape.time:.3g}$")
    for axes in panels[-1]:
        axes.set_xlabel("$s_1$")


def refined_triangulation(face: Polygon) -> Triangulation:
    """The triangles between the points at which ψ is known."""
    return Triangulation(*face.facets.refined(face.s), face.facets.quarters.T)


def draw_fronts(picture: Picture) -> Figure:
    """For every face a row with the exact zone and the nodes in contact at three times; below, their numbers over time.

    The exact zone is where the linear interpolant of ``level`` is not negative.
    """
    rows, columns = len(picture.polygons), len(picture.shapes)
    figure = Figure(figsize=(COLUMN, 2.2 + 1.25 * rows))
    grid = figure.add_gridspec(2, height_ratios=(rows, 0.9))
    panels = grid[0].subgridspec(rows, columns).subplots(sharex="row", sharey="row", squeeze=False)
    for row, face in zip(panels, picture.polygons, strict=True):
        draw_maps_of(row, picture, face, _zone(face, picture.times))
    label_maps(panels, picture)
    _draw_counts(figure.add_subplot(grid[1]), picture)
    figure.suptitle(f"{picture.heading}: contact zone")
    legend(figure, zone_handles(picture), columns=2)
    return figure


def caption_fronts(picture: Picture) -> str:
    """What to see."""
    wrong = [misplaced_nodes(face) for face in picture.polygons]
    face, worst = max(zip(picture.polygons, wrong, strict=True), key=lambda found: int(found[1].max()))
    when = int(np.argmax(worst))
    seen = (
        f"{np.mean(wrong):.2g} nodes of a face are on the wrong side of the front on average and {worst[when]} of "
        f"{len(face.nodes)} at most, on {picture.name(face)} at t = {picture.times[1:][when]:.3g}; {HARMLESS}"
        if worst[when] > 0
        else f"none of the {sum(len(face.nodes) for face in picture.polygons)} nodes is ever on the wrong side"
    )
    return (
        f"Contact zone of {picture.names} at t = {picture.times_shown} "
        f"({picture.place}), seen from inside the body: exact zone filled, dots are nodes with a positive computed "
        "pressure; below, the number of nodes in the exact zone (lines) and in computed contact (markers) over time, "
        f"after t = 0, where nothing has been solved. What to see: how closely the dots fill the exact zone; {seen}."
    )


def _zone(face: Polygon, times: Array) -> Paint:
    strays = outside(face, times)

    def paint(axes: Axes, instant: int) -> None:
        level, touching = face.level[instant], face.touching[instant]
        if level.max() >= 0:
            axes.tricontourf(refined_triangulation(face), level, [0, level.max() + 1], colors=[SKY], alpha=0.45)
        for chosen, style in ((touching & ~strays[instant], {"color": BLUE, "mew": 0}), (strays[instant], HOLLOW)):
            if chosen.any():
                axes.plot(*face.s[:, chosen], "o", ms=1.6, clip_on=False, zorder=3, **style)

    return paint


def _draw_counts(axes: Axes, picture: Picture) -> None:
    for face, (colour, marker) in zip(picture.polygons, cycle(LINES), strict=False):
        times, label = picture.times[1:], f"${picture.symbol(face)}$"
        axes.plot(times, face.inside.sum(axis=1)[1:], color=colour, lw=0.8)
        axes.plot(times, face.touching.sum(axis=1)[1:], marker, color=colour, mfc="white", ms=2.6, label=label)
    axes.set(xlabel="time $t$", ylabel="nodes in contact", ylim=(0, max(len(face.nodes) for face in picture.polygons)))
    axes.grid(True)
    if len(picture.polygons) > 1:
        axes.legend(frameon=True)


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
        gap = "gap $w$", "gap", face.gap_exact, face.gap
        pressure = "pressure $p$", "pressure", face.pressure_exact, face.pressure
        for row, (label, colours, exact, computed) in zip(panels[2 * i : 2 * i + 2], (gap, pressure), strict=True):
            top = float(max(exact[instants].max(), computed[instants].max())) or 1.0
            draw_maps_of(row, picture, face, paint_values(face, exact, computed, top, colours))
            bar = figure.colorbar(row[-1].collections[0], ax=list(row), fraction=0.05, ticks=[0, top], format="%.3g")
            bar.set_label(label)
    label_maps(panels, picture)
    figure.suptitle(picture.heading)
    marks = dots("computed", mfc="white", mec="0.4", mew=0.4, ms=2.6)
    handles = entry("exact", color="0.6", lw=4), marks, entry("exact front", color=VERMILLION, lw=1.0)
    legend(figure, handles, columns=3)
    return figure


def caption_maps(picture: Picture) -> str:
    """What to see."""
    gap, pressure = largest_differences(picture)
    displacement = max(float(np.linalg.norm(shape.displacement, axis=0).max()) for shape in picture.shapes)
    largest_gap = max(float(face.gap_exact[picture.instants].max()) for face in picture.polygons)
    return (
        f"Gap and contact pressure on {picture.names} at t = {picture.times_shown} "
        f"({picture.place}), seen from inside the body: surfaces are exact, dots computed, in the same colours. What "
        "to see: nowhere are gap and pressure both positive, and where a dot stands out there is an error: at most "
        f"{pressure} for the pressure, a nodal force divided by the integral of its shape function; at most {gap} for "
        f"the gap, which itself is at most {100 * largest_gap / (displacement or 1.0):.2g} % of the largest "
        "displacement."
    )


def paint_values(face: Polygon, exact: Array, computed: Array, top: float, colours: str) -> Paint:
    """Exact values as a surface, computed ones as dots, in colours from 0 to ``top``."""
    levels = np.linspace(0, top, LEVELS + 1)
    style: dict[str, Any] = {"cmap": ramp(colours), "norm": BoundaryNorm(levels, 256)}

    def paint(axes: Axes, instant: int) -> None:
        axes.tricontourf(Triangulation(*face.s, face.facets.corners.T), exact[instant].clip(0), levels, **style)
        rim: dict[str, Any] = {"edgecolors": "0.4", "linewidths": 0.2}
        axes.scatter(face.s[0], face.s[1], s=5, c=computed[instant].clip(0), zorder=2, **rim, **style)

    return paint

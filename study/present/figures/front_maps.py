"""The contact zone of a solid, from ``pictures/CASE.json``: maps at some times, and counts of nodes over time."""

from __future__ import annotations

from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from study.present.charts.palette import BLUE, SKY
from study.present.figures.canvas import COLUMN, legend
from study.present.figures.face_map import Paint, draw_maps_of, label_maps, refined_triangulation
from study.present.figures.zone import LINES, zone_handles
from study.present.picture.picture import Picture
from study.present.picture.polygon import Polygon
from study.present.picture.wording import HARMLESS, face_name, face_names, face_symbol, heading, place, times_shown
from study.present.picture.zone_history import misplaced_nodes


def draw_fronts(picture: Picture) -> Figure:
    """For every face a row with the exact zone and the nodes in contact at three times; below, their numbers over time.

    The exact zone is where the linear interpolant of ``level`` is not negative.
    """
    rows, columns = len(picture.polygons), len(picture.shapes)
    figure = Figure(figsize=(COLUMN, 1.9 + 1.2 * rows))
    grid = figure.add_gridspec(2, height_ratios=(rows, 0.9))
    panels = grid[0].subgridspec(rows, columns).subplots(sharex="row", sharey="row", squeeze=False)
    for row, face in zip(panels, picture.polygons, strict=True):
        draw_maps_of(row, picture, face, _zone(face))
    label_maps(panels, picture)
    _draw_counts(figure.add_subplot(grid[1]), picture)
    figure.suptitle(f"{heading(picture)}: contact zone")
    legend(figure, zone_handles(), columns=2)
    return figure


def caption_fronts(picture: Picture) -> str:
    """What to see."""
    wrong = [misplaced_nodes(face) for face in picture.polygons]
    face, worst = max(zip(picture.polygons, wrong, strict=True), key=lambda found: int(found[1].max()))
    when = int(np.argmax(worst))
    seen = (
        f"{np.mean(wrong):.2g} nodes of a face are on the wrong side of the front on average and {worst[when]} of "
        f"{len(face.nodes)} at most, on {face_name(face, picture)} at t = {picture.times[1:][when]:.3g}; {HARMLESS}"
        if worst[when] > 0
        else f"none of the {sum(len(face.nodes) for face in picture.polygons)} nodes is ever on the wrong side"
    )
    return (
        f"Contact zone of {face_names(picture)} at t = {times_shown(picture)} "
        f"({place(picture)}), seen from inside the body: exact zone filled, dots are nodes with a positive computed "
        "pressure; below, the number of nodes in the exact zone (lines) and in computed contact (markers) over time, "
        f"after t = 0, where nothing has been solved. What to see: how closely the dots fill the exact zone; {seen}."
    )


def _zone(face: Polygon) -> Paint:
    def paint(axes: Axes, instant: int) -> None:
        level, touching = face.level[instant], face.touching[instant]
        if level.max() >= 0:
            axes.tricontourf(refined_triangulation(face), level, [0, level.max() + 1], colors=[SKY], alpha=0.45)
        if touching.any():
            axes.plot(*face.s[:, touching], "o", color=BLUE, ms=1.6, mew=0, clip_on=False, zorder=3)

    return paint


def _draw_counts(axes: Axes, picture: Picture) -> None:
    for face, (colour, marker) in zip(picture.polygons, cycle(LINES), strict=False):
        times, label = picture.times[1:], f"${face_symbol(face, picture)}$"
        axes.plot(times, face.inside.sum(axis=1)[1:], color=colour, lw=0.8)
        axes.plot(times, face.touching.sum(axis=1)[1:], marker, color=colour, mfc="white", ms=2.6, label=label)
    axes.set(xlabel="time $t$", ylabel="nodes in contact", ylim=(0, max(len(face.nodes) for face in picture.polygons)))
    axes.grid(True)
    if len(picture.polygons) > 1:
        axes.legend(frameon=True)

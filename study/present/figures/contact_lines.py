"""Contact in the plane, from ``pictures/CASE.json``: the zone over time."""

from __future__ import annotations

from itertools import cycle
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from study.present.charts.palette import BLACK, BLUE, GREEN, GREY, PURPLE, SKY, VERMILLION
from study.present.figures.drawing import COLUMN, dots, legend
from study.present.picture.faces import Array, Segment
from study.present.picture.picture import Picture
from study.present.picture.zone_history import caps, misplaced_length, outside, strands

ROWS = 40
"""At most about so many times are shown as dots: more would run into each other."""
WIDTH = 0.4
"""Of the panel of errors, relative to one of a face."""
HARMLESS = "where gap and pressure vanish to high order at a front, this hardly changes the error in the norm of V"
"""What misplaced fronts mean for the error."""
LINES = ((BLACK, "o"), (GREEN, "s"), (PURPLE, "^"))
"""Colour and marker for each face."""


def draw_zone(picture: Picture) -> Figure:
    """One panel per face, s to the right and t upwards, and beside them the error of the computed zone.

    The filled region is the exact zone; a dot is a node in contact, at every time or, if there are many, at evenly
    chosen ones, and hollow outside of the exact zone. The last panel shows ``misplaced_length``.
    """
    count = len(picture.segments)
    figure = Figure(figsize=(COLUMN + 0.8 * (count - 1), 3.2))
    *panels, beside = figure.subplots(1, count + 1, sharey=True, width_ratios=(*[1] * count, WIDTH))
    for axes, face in zip(panels, picture.segments, strict=True):
        _draw_face(axes, face, picture.times, faces=count)
        axes.set_xlabel(rf"{'position $s$ along' if count < 3 else '$s$ on'} ${picture.symbol(face)}$")
    errors = _draw_misplaced(beside, picture)
    panels[0].set_ylabel(r"time $t$")
    figure.suptitle(f"{picture.heading}: contact zone")
    legend(figure, [*zone_handles(picture), *(errors if count > 1 else [])], columns=2 if count < 3 else 3)
    return figure


def _why_outside(picture: Picture) -> str:
    """What gap and pressure are at hollow dots, for captions; nothing where there are none."""
    gap, pressure = strays(picture)
    text = "; hollow dots lie outside of it, where the exact gap is at most {:.2g} % and the computed pressure {:.2g} %"
    return text.format(gap, pressure) + " of the largest" if pressure else ""


HOLLOW: dict[str, Any] = {"color": BLUE, "mfc": "white", "mew": 0.5}
"""Nodes in contact outside of the exact zone."""


def zone_handles(picture: Picture) -> list[Artist]:
    """Entries of the legend: the exact zone, the computed one, and why some of its nodes lie outside."""
    exact = Patch(facecolor=(SKY, 0.45), edgecolor=VERMILLION, label=r"exact zone, $w=0$")
    handles = [exact, dots(r"nodes in contact, $p^h>0$", ms=2.5, mew=0, color=BLUE)]
    gap, pressure = strays(picture)
    if pressure:
        why = f"outside of it: there $w\\leq{gap:.2g}$ %\nand $p^h\\leq{pressure:.2g}$ % of their maxima"
        handles.append(dots(why, ms=2.5, **HOLLOW))
    return handles


def strays(picture: Picture) -> tuple[float, float]:
    """The largest exact gap and the largest computed pressure at nodes in contact outside of the exact zone.

    In per cent of the largest gap and pressure on any face; 0 where there are none.
    """
    pairs = [(face, outside(face, picture.times)) for face in picture.faces]
    return _share([(face.gap_exact, where) for face, where in pairs]), _share(
        [(face.pressure, where) for face, where in pairs]
    )


def _share(found: list[tuple[Array, NDArray[np.bool_]]]) -> float:
    largest = max(float(values.max(initial=0.0)) for values, _ in found) or 1.0
    return 100 * max(float(values[where].max(initial=0.0)) for values, where in found) / largest


def caption_zone(picture: Picture) -> str:
    """What to see."""
    errors = [misplaced_length(face, picture.times) for face in picture.segments]
    face, worst = max(zip(picture.segments, errors, strict=True), key=lambda found: float(found[1].max()))
    when = int(np.argmax(worst))
    seen = (
        f"computed fronts are off by {np.mean(errors):.2g} cells on average and by {worst[when]:.2g} at most, on "
        f"{picture.name(face)} at t = {picture.times[1:][when]:.3g}, all fronts of a face added up; {HARMLESS}"
        if worst[when] > 0
        else "no node is ever on the wrong side"
    )
    seen += _why_outside(picture)
    return (
        f"Contact zone of {picture.names} in space and time "
        f"({picture.place}): exact zone filled, dots are nodes with a positive computed pressure; on the right the "
        "length of their symmetric difference in cells, after t = 0, where nothing has been solved. What to see: "
        f"how closely the dots fill the exact zone; {seen}."
    )


def _draw_face(axes: Axes, face: Segment, times: Array, faces: int) -> None:
    pieces = strands(face.zone_times, face.zone)
    columns = [np.array(piece).T for piece in pieces]
    outlines = [np.column_stack([[*left, *right[::-1]], [*t, *t[::-1]]]) for t, left, right in columns]
    axes.add_collection(PolyCollection(outlines, facecolor=SKY, alpha=0.45, linewidth=0, zorder=1))
    for t, left, right in columns:
        axes.plot(left, t, right, t, color=VERMILLION, lw=1.0, zorder=2)
    for t, left, right in caps(pieces):
        if times[0] < t < times[-1]:
            axes.plot([left, right], [t, t], color=VERMILLION, lw=1.0, zorder=2)
    stride = max(1, round(len(times) / ROWS))
    stray = outside(face, times)[::stride]
    inside = face.touching[::stride] & ~stray
    # A diameter in points that leaves white between neighbouring dots.
    size = float(np.clip(0.55 * min(200 / (len(face.s) * faces), 150 / (len(times) // stride)), 0.7, 2.5))
    for chosen, style in ((inside, {"color": BLUE, "mew": 0}), (stray, HOLLOW)):
        when, where = np.nonzero(chosen)
        # The layout has no room beside what is empty and may leave the axes.
        if len(when):
            axes.plot(face.s[where], times[::stride][when], "o", ms=size, clip_on=False, zorder=3, **style)
    if not (pieces or face.touching.any()):
        axes.text(0.5, 0.5, "no contact", transform=axes.transAxes, ha="center", va="center", color=GREY)
    axes.set(xlim=(face.s.min(), face.s.max()), ylim=(times[0], times[-1]))
    axes.xaxis.set_major_locator(MaxNLocator(5 if faces == 1 else 2))


def _draw_misplaced(axes: Axes, picture: Picture) -> list[Line2D]:
    lines: list[Line2D] = []
    largest = 2.0
    for face, (colour, marker) in zip(picture.segments, cycle(LINES), strict=False):
        error = misplaced_length(face, picture.times)
        largest = max(largest, 1.05 * float(error.max()))
        style: dict[str, Any] = {"color": colour, "marker": marker, "ms": 2.2, "lw": 0.7, "clip_on": False}
        lines += axes.plot(error, picture.times[1:], label=rf"fronts on ${picture.symbol(face)}$", **style)
    axes.set(xlim=(0, largest), xlabel="error in cells")
    axes.xaxis.set_major_locator(MaxNLocator(3, integer=True))
    axes.grid(True)
    return lines

"""The contact zone in space and time, from ``pictures/CASE.json``: exact region, computed nodes, their difference."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle, pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from study.present.figures.canvas import BLACK, BLUE, COLUMN, GREEN, GREY, PURPLE, SKY, VERMILLION, legend
from study.present.figures.pictures import CHEAP, Array, Picture, Segment, heading, name, place, symbol

ROWS = 40
"""At most about so many times are shown as dots: more would run into each other."""
WIDTH = 0.4
"""Of the panel of errors, relative to one of a face."""
LINES = ((BLACK, "o"), (GREEN, "s"), (PURPLE, "^"))
"""Colour and marker of the error on each face."""

Intervals = Sequence[tuple[float, float]]
Strand = list[tuple[float, float, float]]
"""One connected piece of a zone: t, s0, s1 in increasing time."""


def draw_zone(picture: Picture) -> Figure:
    """One panel per face, s to the right and t upwards, and beside them how far off the computed zone is.

    The filled region is ``zone_exact``; a dot is a node with positive ``pressure``, at every time node
    or, if there are many, at evenly chosen ones. The last panel shows ``misplaced``.
    """
    count = len(picture.segments)
    figure = Figure(figsize=(COLUMN + 0.8 * (count - 1), 3.2))
    *panels, beside = figure.subplots(1, count + 1, sharey=True, width_ratios=(*[1] * count, WIDTH))
    for axes, face in zip(panels, picture.segments, strict=True):
        _draw_face(axes, face, picture.times, faces=count)
        axes.set_xlabel(
            rf"position $s$ along ${symbol(face, picture)}$" if count < 3 else rf"$s$ on ${symbol(face, picture)}$"
        )
    errors = _draw_misplaced(beside, picture)
    panels[0].set_ylabel(r"time $t$")
    figure.suptitle(f"{heading(picture)}: contact zone")
    dot: dict[str, Any] = {"ls": "", "marker": "o", "ms": 2.5, "mew": 0, "color": BLUE}
    handles = [
        Patch(facecolor=(SKY, 0.45), edgecolor=VERMILLION, label=r"exact zone, $w=0$"),
        Line2D([], [], label=r"nodes in contact, $p^h>0$", **dot),
    ]
    legend(figure, [*handles, *(errors if count > 1 else [])], columns=2 if count < 3 else 3)
    return figure


def caption_zone(picture: Picture) -> str:
    """What to see."""
    errors = [misplaced(face, picture.times) for face in picture.segments]
    face, worst = max(zip(picture.segments, errors, strict=True), key=lambda found: float(found[1].max()))
    when = int(np.argmax(worst))
    seen = (
        f"computed fronts are off by {np.mean(errors):.2g} cells on the average and by {worst[when]:.2g} at most, on "
        f"{name(face, picture)} at t = {picture.times[1:][when]:.3g}, all fronts of a face added up; {CHEAP}"
        if worst[when] > 0
        else "no node is ever on the wrong side"
    )
    return (
        f"Contact zone of {', '.join(name(face, picture) for face in picture.segments)} in space and time "
        f"({place(picture)}): exact zone filled, dots are nodes with a positive computed pressure; on the right the "
        "length that one zone has and the other has not, in cells, after t = 0, where nothing has been solved. What "
        f"to see: how closely the dots fill the exact zone; {seen}."
    )


def misplaced(face: Segment, times: Array) -> Array:
    """|Z(t) Δ Z^h(t)|/h at the times after the first: the distances of all fronts in cells, added up, (times − 1,).

    Z^h is ``Segment.computed_zone``; it is defined where zones are born and vanish, too, and no wrong node can hide.
    Clamped ends of a face, which have no node, do not count.
    """
    free = float(face.s.min()), float(face.s.max())
    differences = [
        _difference(_within(free, exact_zone(face, float(time))), face.computed_zone(instant))
        for instant, time in enumerate(times)
        if instant
    ]
    return np.array(differences) / face.spacing


def exact_zone(face: Segment, time: float) -> list[tuple[float, float]]:
    """The exact zone at a time, linear between those at which it is known."""
    pieces = strands(face.zone_times, face.zone)
    columns = [np.array(piece).T for piece in pieces if piece[0][0] <= time <= piece[-1][0]]
    return [(float(np.interp(time, t, left)), float(np.interp(time, t, right))) for t, left, right in columns]


def _within(limits: tuple[float, float], zone: Intervals) -> list[tuple[float, float]]:
    low, high = limits
    return [(max(a, low), min(b, high)) for a, b in zone if a < high and b > low]


def _difference(one: Intervals, other: Intervals) -> float:
    """The length of the symmetric difference of two unions of intervals."""
    ends = sorted({end for interval in (*one, *other) for end in interval})
    return float(sum(b - a for a, b in pairwise(ends) if _inside((a + b) / 2, one) != _inside((a + b) / 2, other)))


def _inside(s: float, zone: Intervals) -> bool:
    return any(a <= s <= b for a, b in zone)


def _draw_misplaced(axes: Axes, picture: Picture) -> list[Line2D]:
    lines: list[Line2D] = []
    largest = 2.0
    for face, (colour, marker) in zip(picture.segments, cycle(LINES), strict=False):
        error = misplaced(face, picture.times)
        largest = max(largest, 1.05 * float(error.max()))
        style: dict[str, Any] = {"color": colour, "marker": marker, "ms": 2.2, "lw": 0.7, "clip_on": False}
        lines += axes.plot(error, picture.times[1:], label=rf"fronts on ${symbol(face, picture)}$", **style)
    axes.set_xlim(0, largest)
    axes.set_xlabel("off by, cells")
    axes.xaxis.set_major_locator(MaxNLocator(3, integer=True))
    axes.grid(True)
    return lines


def strands(times: Array, zone: Sequence[Intervals]) -> list[Strand]:
    """The connected pieces of a zone between its births, mergers, splits and ends.

    An event between two known times is drawn half-way between them.
    """
    done: list[Strand] = []
    growing: list[Strand] = []
    for i, intervals in enumerate(zone):
        if i and _continues(zone[i - 1], intervals):
            for strand, (left, right) in zip(growing, intervals, strict=True):
                strand.append((float(times[i]), left, right))
            continue
        event = float(times[max(i - 1, 0)] + times[i]) / 2
        for strand, interval in zip(growing, zone[i - 1] if i else [], strict=True):
            strand.append((event, *_tip(interval, intervals, zone[max(i - 2, 0)])))
        done += growing
        before, after = zone[i - 1] if i else intervals, zone[min(i + 1, len(zone) - 1)]
        growing = [[(event, *_tip(own, before, after)), (float(times[i]), *own)] for own in intervals]
    return done + growing


def caps(pieces: Sequence[Strand]) -> list[tuple[float, float, float]]:
    """The horizontal part of the boundary of a zone: t, s0, s1 where only one strand begins or ends."""
    tips = [tip for piece in pieces for tip in (piece[0], piece[-1])]
    found = []
    for t in sorted({tip[0] for tip in tips}):
        here = [(left, right) for time, left, right in tips if time == t]
        for left, right in pairwise(sorted({end for interval in here for end in interval})):
            # Strands before an event do not overlap, nor do those after it: what is covered twice goes on.
            if sum(a <= left and right <= b for a, b in here) == 1:
                found.append((t, left, right))
    return found


def _tip(interval: tuple[float, float], across: Intervals, along: Intervals) -> tuple[float, float]:
    """The end of a strand at an event, from the intervals across the event and those further along the strand.

    Whole where it meets another strand or begins at once over its whole length, otherwise a point.
    """
    if any(_meet(interval, other) for other in across) or interval in along:
        return interval
    centre = sum(interval) / 2
    return centre, centre


def _meet(one: tuple[float, float], other: tuple[float, float]) -> bool:
    return max(one[0], other[0]) <= min(one[1], other[1])


def _continues(before: Intervals, after: Intervals) -> bool:
    """Whether each interval goes on in the one of the same place."""
    return len(before) == len(after) and all(_meet(a, b) for a, b in zip(before, after, strict=True))


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
    when, where = np.nonzero(face.touching[::stride])
    size = _dot_size(len(face.s) * faces, len(times) // stride)
    if len(when):
        axes.plot(face.s[where], times[::stride][when], "o", color=BLUE, ms=size, mew=0, clip_on=False, zorder=3)
    elif not pieces:
        axes.text(0.5, 0.5, "no contact", transform=axes.transAxes, ha="center", va="center", color=GREY)
    axes.set_xlim(face.s.min(), face.s.max())
    axes.set_ylim(times[0], times[-1])
    axes.xaxis.set_major_locator(MaxNLocator(5 if faces == 1 else 2))


def _dot_size(columns: int, rows: int) -> float:
    """A diameter in points that leaves white between neighbouring dots."""
    return float(np.clip(0.55 * min(200 / columns, 150 / rows), 0.7, 2.5))

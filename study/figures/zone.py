"""The contact zone in space and time, from ``pictures/CASE.json``: exact region and computed nodes."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from study.figures.canvas import BLUE, COLUMN, GREY, SKY, VERMILLION, legend
from study.figures.pictures import Array, Face, Picture, heading, symbol

ROWS = 40
"""At most about so many times are shown as dots: more would run into each other."""

Intervals = Sequence[tuple[float, float]]
Strand = list[tuple[float, float, float]]
"""One connected piece of a zone: t, s0, s1 in increasing time."""


def draw_zone(picture: Picture) -> Figure:
    """One panel per face, s to the right and t upwards.

    The filled region is ``zone_exact``; a dot is a node with positive ``pressure``, at every time node
    or, if there are many, at evenly chosen ones.
    """
    count = len(picture.faces)
    figure = Figure(figsize=(COLUMN, 3.2))
    panels = figure.subplots(1, count, sharey=True, squeeze=False)[0]
    for axes, face in zip(panels, picture.faces, strict=True):
        _draw_face(axes, face, picture.times, faces=count)
        axes.set_xlabel(
            rf"position $s$ along ${symbol(face, picture)}$" if count < 3 else rf"$s$ on ${symbol(face, picture)}$"
        )
    panels[0].set_ylabel(r"time $t$")
    figure.suptitle(f"{heading(picture)}: contact zone")
    dot: dict[str, Any] = {"ls": "", "marker": "o", "ms": 2.5, "mew": 0, "color": BLUE}
    handles = [
        Patch(facecolor=(SKY, 0.45), edgecolor=VERMILLION, label=r"exact zone, $w=0$"),
        Line2D([], [], label=r"nodes in contact, $p^h>0$", **dot),
    ]
    legend(figure, handles, columns=2)
    return figure


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
        middle = float(times[max(i - 1, 0)] + times[i]) / 2
        for strand in growing:
            strand.append((middle, *strand[-1][1:]))
        done += growing
        growing = [[(middle, left, right), (float(times[i]), left, right)] for left, right in intervals]
    return done + growing


def jumps(times: Array, zone: Sequence[Intervals]) -> list[tuple[float, float, float]]:
    """Where a zone changes at once: t, s0, s1 of the stretches that are in it before or after, not both."""
    found = []
    for i in range(1, len(zone)):
        if not _continues(zone[i - 1], zone[i]):
            ends = sorted({end for interval in (*zone[i - 1], *zone[i]) for end in interval})
            middle = float(times[i - 1] + times[i]) / 2
            for left, right in pairwise(ends):
                inside = [any(a <= left and right <= b for a, b in intervals) for intervals in (zone[i - 1], zone[i])]
                found += [(middle, left, right)] if inside[0] != inside[1] else []
    return found


def _continues(before: Intervals, after: Intervals) -> bool:
    """Whether each interval goes on in the one of the same place."""
    pairs = zip(before, after, strict=False)
    return len(before) == len(after) and all(max(a0, b0) <= min(a1, b1) for (a0, a1), (b0, b1) in pairs)


def _draw_face(axes: Axes, face: Face, times: Array, faces: int) -> None:
    pieces = [np.array(strand) for strand in strands(face.zone_times, face.zone)]
    outlines = [np.vstack([piece[:, [1, 0]], piece[::-1][:, [2, 0]]]) for piece in pieces]
    axes.add_collection(PolyCollection(outlines, facecolor=SKY, alpha=0.45, linewidth=0, zorder=1))
    for t, left, right in (piece.T for piece in pieces):
        axes.plot(left, t, right, t, color=VERMILLION, lw=1.0, zorder=2)
    for t, left, right in jumps(face.zone_times, face.zone):
        axes.plot([left, right], [t, t], color=VERMILLION, lw=1.0, zorder=2)
    stride = max(1, round(len(times) / ROWS))
    when, where = np.nonzero(face.touching[::stride])
    size = _dot_size(len(face.s) * faces, len(times) // stride)
    axes.plot(face.s[where], times[::stride][when], "o", color=BLUE, ms=size, mew=0, zorder=3)
    if not (pieces or len(when)):
        axes.text(0.5, 0.5, "no contact", transform=axes.transAxes, ha="center", va="center", color=GREY)
    axes.set_xlim(face.s.min(), face.s.max())
    axes.set_ylim(times[0], times[-1])
    axes.xaxis.set_major_locator(MaxNLocator(5 if faces == 1 else 2))


def _dot_size(columns: int, rows: int) -> float:
    """A diameter in points that leaves white between neighbouring dots."""
    return float(np.clip(0.55 * min(200 / columns, 150 / rows), 0.7, 2.5))

"""Contact in the plane, from ``pictures/CASE.json``: the zone over time, gap and pressure along the faces."""

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

from study.present.charts.palette import BLACK, BLUE, GREEN, GREY, PURPLE, SKY, VERMILLION
from study.present.figures.drawing import COLUMN, dots, entry, legend
from study.present.picture.faces import Array, Segment
from study.present.picture.picture import Picture
from study.present.picture.zone_history import caps, misplaced_length, strands

ROWS = 40
"""At most about so many times are shown as dots: more would run into each other."""
WIDTH = 0.4
"""Of the panel of errors, relative to one of a face."""
ROUND_OFF = 1e-9
"""Below this a gap or a pressure counts as zero; where they are not zero they are of order one."""
HARMLESS = "where gap and pressure vanish to high order at a front, this hardly changes the error in the norm of V"
"""What misplaced fronts mean for the error."""
LINES = ((BLACK, "o"), (GREEN, "s"), (PURPLE, "^"))
"""Colour and marker for each face."""


def draw_zone(picture: Picture) -> Figure:
    """One panel per face, s to the right and t upwards, and beside them the error of the computed zone.

    The filled region is the exact zone; a dot is a node in contact, at every time or, if there are many, at evenly
    chosen ones. The last panel shows ``misplaced_length``.
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
    legend(figure, [*zone_handles(), *(errors if count > 1 else [])], columns=2 if count < 3 else 3)
    return figure


def zone_handles() -> list[Artist]:
    """Entries of the legend: the exact zone and the computed one."""
    exact = Patch(facecolor=(SKY, 0.45), edgecolor=VERMILLION, label=r"exact zone, $w=0$")
    return [exact, dots(r"nodes in contact, $p^h>0$", ms=2.5, mew=0, color=BLUE)]


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
    when, where = np.nonzero(face.touching[::stride])
    # A diameter in points that leaves white between neighbouring dots.
    size = float(np.clip(0.55 * min(200 / (len(face.s) * faces), 150 / (len(times) // stride)), 0.7, 2.5))
    if len(when):
        axes.plot(face.s[where], times[::stride][when], "o", color=BLUE, ms=size, mew=0, clip_on=False, zorder=3)
    elif not pieces:
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


MARKERS = 24
"""At most about so many markers on a line."""


def draw_profiles(picture: Picture) -> Figure:
    """For every face a row of ``gap`` and one of ``pressure``; from left to right the times of the shapes.

    Lines are the exact values, markers the computed ones at the nodes, not at all of them if there are many.
    """
    instants = picture.instants
    rows = 2 * len(picture.segments)
    figure = Figure(figsize=(COLUMN, 0.9 + 1.1 * rows))
    panels = figure.subplots(rows, len(instants), sharex="row", sharey="row", squeeze=False)
    for i, face in enumerate(picture.segments):
        s = rf"$s$ on ${picture.symbol(face)}$"
        _draw_row(panels[2 * i], face, face.line_gap[instants], face.gap[instants], BLUE)
        _draw_row(panels[2 * i + 1], face, face.line_pressure[instants], face.pressure[instants], VERMILLION)
        panels[2 * i, 0].set_ylabel("gap $w$")
        panels[2 * i + 1, 0].set_ylabel("pressure $p$")
        for upper, lower in panels[2 * i : 2 * i + 2].T:
            upper.tick_params(labelbottom=False)
            lower.set_xlabel(s)
    for axes, instant in zip(panels[0], instants, strict=True):
        axes.set_title(f"$t={picture.times[instant]:.3g}$")
    figure.align_ylabels(panels[:, 0])
    figure.suptitle(picture.heading)
    kinds = (("computed gap", BLUE), ("computed pressure", VERMILLION))
    computed = [dots(label, color=colour, mfc="white", ms=2.6) for label, colour in kinds]
    legend(figure, [entry("exact", color=BLACK, lw=0.9), *computed], columns=3)
    return figure


def caption_profiles(picture: Picture) -> str:
    """What to see."""
    gap, pressure = largest_differences(picture)
    return (
        f"Gap and contact pressure along Γ3 at t = {picture.times_shown} ({picture.place}): lines are exact, markers "
        "computed. What to see: nowhere are gap and pressure both positive, and markers lie on the lines: the error at "
        f"the nodes is at most {gap} for the gap and, for the pressure, a nodal force divided by the integral of its "
        f"shape function, at most {pressure}."
    )


def _draw_row(panels: list[Axes], face: Segment, exact: Array, computed: Array, colour: str) -> None:
    every = max(1, round(len(face.s) / MARKERS))
    for axes, line, marks in zip(panels, exact, computed, strict=True):
        axes.plot(face.line, line, color=BLACK, lw=0.9)
        axes.plot(face.s, marks, "o", color=colour, mfc="white", ms=2.6, markevery=every, clip_on=False, zorder=3)
        axes.set_xlim(face.line.min(), face.line.max())
        axes.grid(True)
    # From zero, so that round-off around a constant does not fill the panel.
    low, high = min(exact.min(), computed.min(), 0.0), max(exact.max(), computed.max())
    high = high if high > ROUND_OFF else 1.0
    room = 0.06 * (high - low)
    panels[0].set_ylim(low - room, high + room)


def largest_differences(picture: Picture) -> tuple[str, str]:
    """How far computed gaps and pressures are from the exact ones at the nodes, at the times of the shapes."""
    at, faces = picture.instants, picture.faces
    gap = _largest_difference([(face.gap[at], face.gap_exact[at]) for face in faces])
    return gap, _largest_difference([(face.pressure[at], face.pressure_exact[at]) for face in faces])


def _largest_difference(pairs: list[tuple[Array, Array]]) -> str:
    """max |computed − exact|, in per cent of max |exact| where that is not round-off."""
    difference = max(float(abs(computed - exact).max()) for computed, exact in pairs)
    size = max(float(abs(exact).max()) for _, exact in pairs)
    if size <= ROUND_OFF:
        return f"{difference:.1e}, the largest being 0"
    return f"{100 * difference / size:.2g} % of the largest"

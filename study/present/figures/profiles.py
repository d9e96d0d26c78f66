"""Gap and pressure along the contact faces at three times, from ``pictures/CASE.json``."""

from __future__ import annotations

from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from study.present.charts.palette import BLACK, BLUE, VERMILLION
from study.present.figures.canvas import COLUMN, legend
from study.present.picture.face_history import Array
from study.present.picture.picture import Picture
from study.present.picture.segment import Segment
from study.present.picture.wording import ROUND_OFF, face_symbol, heading, largest_differences, place, times_shown

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
        s = rf"$s$ on ${face_symbol(face, picture)}$"
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
    figure.suptitle(heading(picture))
    legend(figure, _handles(), columns=3)
    return figure


def caption_profiles(picture: Picture) -> str:
    """What to see."""
    gap, pressure = largest_differences(picture)
    return (
        f"Gap and contact pressure along Γ3 at t = {times_shown(picture)} ({place(picture)}): lines are exact, markers "
        "computed. What to see: nowhere are gap and pressure both positive, and markers lie on the lines: the error at "
        f"the nodes is at most {gap} for the gap and, for the pressure, a nodal force divided by the integral of its "
        f"shape function, at most {pressure}."
    )


def _draw_row(panels: list[Axes], face: Segment, exact: Array, computed: Array, colour: str) -> None:
    every = max(1, round(len(face.s) / MARKERS))
    for axes, line, dots in zip(panels, exact, computed, strict=True):
        axes.plot(face.line, line, color=BLACK, lw=0.9)
        axes.plot(face.s, dots, "o", color=colour, mfc="white", ms=2.6, markevery=every, clip_on=False, zorder=3)
        axes.set_xlim(face.line.min(), face.line.max())
        axes.grid(True)
    # From zero, so that round-off around a constant does not fill the panel.
    low, high = min(exact.min(), computed.min(), 0.0), max(exact.max(), computed.max())
    high = high if high > ROUND_OFF else 1.0
    room = 0.06 * (high - low)
    panels[0].set_ylim(low - room, high + room)


def _handles() -> list[Line2D]:
    style: dict[str, Any] = {"ls": "", "marker": "o", "mfc": "white", "ms": 2.6}
    return [
        Line2D([], [], color=BLACK, lw=0.9, label="exact"),
        Line2D([], [], color=BLUE, label="computed gap", **style),
        Line2D([], [], color=VERMILLION, label="computed pressure", **style),
    ]

"""Gap and pressure along the faces of a body in the plane, from ``pictures/CASE.json``."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from study.present.charts.palette import BLACK, BLUE, VERMILLION
from study.present.figures.deformed_mesh import ROUND_OFF
from study.present.figures.drawing import COLUMN, dots, entry, legend
from study.present.picture.faces import Array, Segment
from study.present.picture.picture import Picture

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

"""Figures of one run: contact zone, gap and pressure on the faces of Γ3.

Faces are lines in 2D, and maps seen from inside the body in 3D.
"""

from collections.abc import Sequence
from itertools import cycle

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation

from manufactured.colours import BLACK, BLUE, GREEN, GREY, PURPLE, SKY, VERMILLION
from study.present.body import ROUND_OFF, ramp
from study.present.drawing import RIM, Style, caption, column_width, dots, entry, is_slide, legend
from study.present.picture import Array, FaceHistory, Picture, Polygon, Segment, misplaced_length

ZONE_POINTS, ZONE_CUT = 401, 0.01
"""The number of positions along a face at which the exact zone is drawn, and the largest depth inside of it."""
MAP_LEVELS = 10
"""The number of colours of a map."""
FACE_LINES = ((BLACK, "o"), (GREEN, "s"), (PURPLE, "^"))
"""Colour and marker of the first, second and third contact face."""
INSIDE_STYLE: Style = {"color": BLUE, "mew": 0}
STRAY: Style = {"color": BLUE, "mfc": "white", "mew": 0.5}
"""The styles of nodes in contact inside the exact contact zone, and of nodes in contact outside of it."""
NODES: Style = {"mfc": "white", "ms": 2.6}
"""The style of computed values at nodes."""
QUANTITY_LABELS = {"gap": "gap $w$", "pressure": "pressure $p$"}
QUANTITY_COLOURS = {"gap": BLUE, "pressure": VERMILLION}
"""The labels and colours of gap and pressure."""


def draw_zone(picture: Picture) -> Figure:
    """Draw the contact zone of each face in 2D, exact and computed, with the position s to the right and time upwards.

    The filled region is the exact zone. Dots are nodes in contact; they are hollow outside the exact zone. The last
    panel shows the error of the computed zone, as ``misplaced_length`` returns it.
    """
    count = len(picture.segments)
    figure = Figure(figsize=(column_width() + 0.8 * (count - 1), 3.2))
    *panels, last = figure.subplots(1, count + 1, sharey=True, width_ratios=(*[1] * count, 0.4))
    handles = _zone_handles(picture)
    for axes, face, (colour, marker) in zip(panels, picture.segments, cycle(FACE_LINES), strict=False):
        name = picture.symbol(face)
        _draw_zone_of_face(axes, face, count)
        axes.set_xlabel(f"position $s$ along {name}" if count < 3 else f"$s$ on {name}")
        lines = last.plot(
            misplaced_length(face),
            picture.times[1:],
            color=colour,
            marker=marker,
            ms=2.2,
            lw=0.7,
            clip_on=False,
            label=f"fronts on {name}",
        )
        handles += lines if count > 1 else []
    largest = max(2.0, 1.05 * last.dataLim.xmax)
    last.set(xlim=(0, largest), xlabel="error in cells" if count == 1 else "error\nin cells")
    last.xaxis.set_major_locator(MaxNLocator(3, integer=True))
    last.grid(True)
    panels[0].set_ylabel(r"time $t$")
    figure.suptitle(f"{picture.heading}: contact zone")
    legend(figure, handles, columns=2 if count < 3 else 3)
    return figure


def _draw_zone_of_face(axes: Axes, face: Segment, faces: int) -> None:
    """Draw the contact zone of one face in 2D; ``faces`` is the number of faces in the figure."""
    times, s = face.times, np.linspace(face.s.min(), face.s.max(), ZONE_POINTS)
    # Far from the front the depth is cut off, so that the front of a zone that appears at once is drawn halfway.
    depth = face.depth(face.zone, s).clip(-ZONE_CUT, ZONE_CUT)
    axes.contourf(s, face.zone_times, depth, [0, 1], colors=[SKY], alpha=0.45)
    axes.contour(s, face.zone_times, depth, [0], colors=VERMILLION, linewidths=1.0)
    for nodes, style in ((face.touching & ~face.outside, INSIDE_STYLE), (face.outside, STRAY)):
        when, where = np.nonzero(nodes)
        # An empty line would disturb the layout of Matplotlib.
        if len(when):
            axes.plot(face.s[where], times[when], "o", ms=2.5 / faces**0.5, clip_on=False, zorder=3, **style)
    if depth.max() < 0 and not face.touching.any():
        axes.text(0.5, 0.5, "no contact", transform=axes.transAxes, ha="center", va="center", color=GREY)
    axes.set(xlim=(face.s.min(), face.s.max()), ylim=(times[0], times[-1]))
    axes.xaxis.set_major_locator(MaxNLocator(5 if faces == 1 else 2))


def _zone_handles(picture: Picture) -> list[Artist]:
    """Return the legend entries of the exact zone, of nodes in contact, and of nodes in contact outside of the zone."""
    exact = Patch(facecolor=(SKY, 0.45), edgecolor=VERMILLION, label=r"exact zone, $w=0$")
    handles = [exact, dots(r"nodes in contact, $p^h>0$", ms=2.5, **INSIDE_STYLE)]
    if any(face.outside.any() for face in picture.faces):
        handles.append(dots("nodes in contact outside of it", ms=2.5, **STRAY))
    return handles


def _strays(picture: Picture, name: str) -> float:
    """Return the largest gap or pressure at nodes that are in contact outside the exact zone.

    Parameters:
        picture: the run.
        name: "gap_exact" or "pressure".

    Returns:
        The largest value at these nodes, in per cent of the largest value on all faces; 0 if there are no such nodes.
    """
    values, strays = _at_nodes(picture, name), _at_nodes(picture, "outside")
    return 100 * values[strays].max(initial=0.0) / (values.max(initial=0.0) or 1.0)


def _at_nodes(picture: Picture, name: str) -> Array:
    """Return an attribute of all contact faces, at all times and nodes, (times, nodes of all faces)."""
    return np.hstack([getattr(face, name) for face in picture.faces])


def _worst(picture: Picture, errors: Sequence[Array]) -> tuple[FaceHistory, float, str]:
    """Return the face with the largest error after t = 0, this error, and a text with the face and the time."""
    number = int(np.argmax([error.max() for error in errors]))
    face, error = picture.faces[number], errors[number]
    when = picture.times[1:][error.argmax()]
    return face, error.max(), f"on {picture.name(face)} at t = {when:.3g}"


def caption_zone(picture: Picture) -> str:
    """Return the caption of ``draw_zone``."""
    errors = [misplaced_length(face) for face in picture.segments]
    _, worst, where = _worst(picture, errors)
    return caption(
        "zone",
        picture=picture,
        mean=np.mean(errors),
        worst=worst,
        where=where,
        gap=_strays(picture, "gap_exact"),
        pressure=_strays(picture, "pressure"),
    )


def draw_profiles(picture: Picture) -> Figure:
    """Draw gap and pressure along each contact face in 2D at the times of ``picture.shown``.

    There is a row for each face and quantity, and a column for each time. Lines are exact values, markers are computed
    values at the nodes. If there are several faces, a slide has a column for each face, at the time of the largest
    pressure.
    """
    faces, shown, heading = picture.segments, picture.shown, picture.heading
    titles = [picture.clock(instant) for instant in shown]
    rows = [[(face, instant) for instant in shown] for face in faces]
    if is_slide() and len(faces) > 1:
        loudest = max(shown, key=lambda instant: max(face.pressure[instant].max() for face in faces))
        titles = [picture.symbol(face) for face in faces]
        rows, heading = [[(face, loudest) for face in faces]], f"{heading}, {picture.clock(loudest)}"
    figure = Figure(figsize=(column_width(), 0.9 + 2.2 * len(rows)))
    panels = figure.subplots(2 * len(rows), len(titles), sharey="row", squeeze=False)
    for number, row in enumerate(rows):
        for (name, colour), line in zip(QUANTITY_COLOURS.items(), panels[2 * number :], strict=False):
            for (face, instant), axes in zip(row, line, strict=True):
                exact, computed = getattr(face, f"line_{name}")[instant], getattr(face, name)[instant]
                draw_profile(axes, face, exact, computed, colour)
                axes.tick_params(labelbottom=name == "pressure")
                axes.set_xlabel(f"$s$ on {picture.symbol(face)}" if name == "pressure" else "")
            # The axis includes zero, so that round-off around a constant does not fill the panel.
            low, high = line[0].get_ylim()
            high = high if high > ROUND_OFF else 1.0
            line[0].set(ylim=(min(low, -0.06 * high), high), ylabel=QUANTITY_LABELS[name])
    for axes, title in zip(panels[0], titles, strict=True):
        axes.set_title(title)
    figure.align_ylabels(panels[:, 0])
    figure.suptitle(heading)
    markers = [dots(f"computed {name}", color=colour, **NODES) for name, colour in QUANTITY_COLOURS.items()]
    legend(figure, [entry("exact", color=BLACK, lw=0.9), *markers], columns=3, wide=True)
    return figure


def draw_profile(axes: Axes, face: Segment, exact: Array, computed: Array, colour: str) -> None:
    """Draw exact and computed values along a face in 2D."""
    axes.plot(face.line, exact, color=BLACK, lw=0.9)
    axes.plot(face.s, computed, "o", color=colour, clip_on=False, zorder=3, **NODES)
    axes.set_xlim(face.line.min(), face.line.max())
    axes.locator_params(axis="x", nbins=3)
    axes.grid(True)


def caption_profiles(picture: Picture) -> str:
    """Return the caption of ``draw_profiles``."""
    gap, pressure = _largest_difference(picture, "gap"), _largest_difference(picture, "pressure")
    return caption("profiles", picture=picture, gap=gap, pressure=pressure)


def _largest_difference(picture: Picture, name: str) -> str:
    """Return the largest error of the gap or of the pressure as text.

    The errors are taken at the nodes and at the times of ``picture.shown``. They are given in per cent of the largest
    exact value, unless this value is zero up to rounding.
    """
    computed, exact = (_at_nodes(picture, attribute)[picture.shown] for attribute in (name, f"{name}_exact"))
    difference, size = abs(computed - exact).max(), abs(exact).max()
    if size > ROUND_OFF:
        return f"{100 * difference / size:.2g} % of the largest"
    return f"{difference:.1e}, the largest being 0"


def draw_fronts(picture: Picture) -> Figure:
    """Draw maps of the contact zone in 3D, exact and computed, at the times of ``picture.shown``.

    There is a row for each face and a column for each time.

    The filled region is the exact zone, where the level function is not negative; dots are nodes in contact. Below, the
    numbers of nodes in contact are shown over time, exact and computed.
    """
    rows = len(picture.polygons)
    figure = Figure(figsize=(column_width(), 2.2 + 1.25 * rows))
    grid = figure.add_gridspec(2, height_ratios=(rows, 0.9))
    panels = grid[0].subgridspec(rows, len(picture.shown)).subplots(sharex="row", sharey="row", squeeze=False)
    counts = figure.add_subplot(grid[1])
    for face, row, (colour, marker) in zip(picture.polygons, panels, cycle(FACE_LINES), strict=False):
        row[0].set_ylabel(f"$s_2$ on {picture.symbol(face)}")
        for axes, instant in zip(row, picture.shown, strict=True):
            _draw_zone_map(axes, face, instant)
        times, label = picture.times[1:], picture.symbol(face)
        counts.plot(times, face.inside.sum(axis=1)[1:], color=colour, lw=0.8)
        counts.plot(times, face.touching.sum(axis=1)[1:], marker, color=colour, mfc="white", ms=2.6, label=label)
    for axes, instant in zip(panels[0], picture.shown, strict=True):
        axes.set_title(picture.clock(instant))
    for axes in panels[-1]:
        axes.set_xlabel("$s_1$")
    most = max(len(face.nodes) for face in picture.polygons)
    counts.set(xlabel="time $t$", ylabel="nodes in contact", ylim=(0, most))
    counts.grid(True)
    if rows > 1:
        counts.legend(frameon=True)
    figure.suptitle(f"{picture.heading}: contact zone")
    legend(figure, _zone_handles(picture), columns=2)
    return figure


def caption_fronts(picture: Picture) -> str:
    """Return the caption of ``draw_fronts``."""
    # Nodes in contact outside the exact zone, and nodes in the exact zone that are not in contact.
    wrong = [(face.touching != face.inside)[1:].sum(axis=1) for face in picture.polygons]
    face, worst, where = _worst(picture, wrong)
    return caption(
        "fronts",
        picture=picture,
        mean=np.mean(wrong),
        worst=worst,
        where=where,
        nodes=face.x.shape[1],
        all_nodes=sum(len(face.nodes) for face in picture.polygons),
    )


def draw_map(axes: Axes, face: Polygon, instant: int, top: float) -> None:
    """Draw the map of the pressure on a contact face in 3D: exact values as a surface, computed values as dots.

    Parameters:
        axes: the axes.
        face: the contact face.
        instant: the index of the time.
        top: the value of the last colour; the first colour is for 0.
    """
    exact, computed = face.pressure_exact[instant].clip(0), face.pressure[instant].clip(0)
    levels = np.linspace(0, top, MAP_LEVELS + 1)
    style: Style = {"cmap": ramp("pressure"), "norm": BoundaryNorm(levels, 256)}
    axes.tricontourf(Triangulation(*face.s, face.facets.corners.T), exact, levels, **style)
    axes.scatter(face.s[0], face.s[1], s=5, c=computed, zorder=2, edgecolors=RIM, linewidths=0.2, **style)
    _draw_front(axes, face, face.level[instant])


def _draw_zone_map(axes: Axes, face: Polygon, instant: int) -> None:
    """Draw the map of the exact contact zone on a face in 3D, and the nodes in contact."""
    level, stray = face.level[instant], face.outside[instant]
    if level.max() >= 0:
        axes.tricontourf(_refined(face), level, [0, level.max() + 1], colors=[SKY], alpha=0.45)
    for nodes, style in ((face.touching[instant] & ~stray, INSIDE_STYLE), (stray, STRAY)):
        if nodes.any():
            axes.plot(*face.s[:, nodes], "o", ms=1.6, clip_on=False, zorder=3, **style)
    _draw_front(axes, face, level)


def _draw_front(axes: Axes, face: Polygon, level: Array) -> None:
    """Draw the exact contact front of a face in 3D, where the level function is 0, and set the limits of the axes."""
    if level.min() < 0 <= level.max():
        axes.tricontour(_refined(face), level, [0], colors=VERMILLION, linewidths=1.0)
    axes.set(aspect="equal", xlim=(face.s[0].min(), face.s[0].max()), ylim=(face.s[1].min(), face.s[1].max()))


def _refined(face: Polygon) -> Triangulation:
    """Return the triangulation of the nodes and edge midpoints of a face, at which the level function is known."""
    return Triangulation(*face.facets.refined(face.s), face.facets.quarters.T)

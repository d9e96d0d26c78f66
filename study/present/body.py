"""Figures of one run, the deforming body and its contact faces, and a sketch of the problem of the paper.

Contact faces are lines in 2D, and maps seen from inside the body in 3D.
"""

from collections.abc import Sequence
from itertools import cycle
from math import floor, log10, sqrt
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import BoundaryNorm, Colormap, Normalize, PowerNorm
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation
from numpy.linalg import norm

from manufactured.colours import BLACK, BLUE, DARK, GREEN, GREY, PURPLE, SKY, VERMILLION
from study.ledger.files import Json
from study.ledger.pictures import Array, Numbers
from study.ledger.text import below
from study.present.drawing import (
    FOUNDATION,
    FOUNDATION_EDGE,
    OUTLINE,
    RAMPS,
    RIM,
    Style,
    column_width,
    dots,
    entry,
    is_slide,
    legend,
)
from study.present.picture import Bools, FaceHistory, Picture, Polygon, Segment, misplaced_length

DRAWN_DISPLACEMENT = 0.12
"""The length of the largest displacement in figures, as a fraction of the longest side of the body."""
ARROW_LENGTH = 0.2
"""The length of the arrow of the largest pressure, and the drawn depth of the largest gap, as a fraction of the longest
side of the body."""
THICKNESS = 0.05
"""The drawn thickness of the foundation, as a fraction of the longest side of the body."""
BRIGHTEST = 0.95
"""Stresses above this quantile have the last colour, because few large stresses would otherwise leave one colour to all
others."""
OBLIQUE = np.array([0.35, 0.55, 0.25])
"""The absolute components that are added to the direction of view of a body in 3D, so that three sides of a box are
visible."""
NEGLIGIBLE_CONTACT = 1e-9
"""Gaps and pressures below this value count as zero; values that are not due to rounding are of order one."""
COLOUR_SHADES = 16
"""The number of colours of the stress, and of the pressure."""
MOST_ARROWS = 16
"""The approximate largest number of pressure arrows on a contact face."""
GAP_STYLE: Style = dict(facecolor=(BLUE, 0.3), edgecolor=BLUE, linewidth=0.5)


def ramp(name: str, shades: int = 256) -> Colormap:
    """Return the colour map of a quantity, "stress" or "pressure", with ``shades`` colours from zero upwards."""
    return colormaps[RAMPS[name]].resampled(shades)


def band(curve: Array, shift: Array) -> Array:
    """Return the corners of the region between a plane curve and its shifted copy, (2, 2n).

    Parameters:
        curve: the points of the curve, (2, n).
        shift: the shift of all points, (2, 1), or of each point, (2, n).
    """
    return np.hstack([curve, (curve + shift)[:, ::-1]])


def magnification(vertices: Array, displacements: Array) -> float:
    """Return the factor by which displacements are multiplied in figures, rounded down to two digits.

    Parameters:
        vertices: the vertices of the mesh, (d, vertices).
        displacements: the displacements of the vertices at all times, (times, d, vertices).
    """
    largest = norm(displacements, axis=1).max()
    if largest == 0:
        return 1.0
    exact = DRAWN_DISPLACEMENT * np.ptp(vertices, axis=1).max() / largest
    return float(below(exact, 1 - floor(log10(exact))))


def view_of(picture: Picture) -> Array:
    """Return the parallel projection for a body: the identity in 2D, an oblique view of the contact faces in 3D.

    In 3D, the direction towards the eye is the sum of the outward normals of the contact faces, with every component
    increased in absolute value by ``OBLIQUE``. The third coordinate points upwards or downwards in the figure: a body
    on a floor is turned upside down, because a body seen from below looks hollow.

    Returns:
        Orthonormal rows, (d, d): the directions to the right, upwards and, in 3D, towards the eye.
    """
    if len(picture.vertices) == 2:
        return np.eye(2)
    normal = np.sum([face.normal for face in picture.faces], axis=0)
    side = np.where(normal > 0, 1, -1)
    towards = side * (abs(normal) + OBLIQUE)
    towards /= norm(towards)
    right = np.cross([0, 0, side[2]], towards)
    right /= norm(right)
    return np.array([right, np.cross(towards, right), towards])


def drawing_order(view: Array, x: Array, cells: Numbers) -> Numbers:
    """Return the indices of the triangles that face the eye, in the order in which they must be drawn.

    In 3D the farthest triangle comes first, so that nearer triangles hide it. In 2D, where no triangle hides another,
    all triangles are returned.

    Parameters:
        view: the projection, (d, d).
        x: vertices, (d, vertices).
        cells: vertex numbers of the triangles, (3, triangles).
    """
    if len(x) == 2:
        return np.arange(cells.shape[1])
    a, b, c = ((view[:2] @ x)[:, corner] for corner in cells)
    p, q = b - a
    r, s = c - a
    facing = np.flatnonzero(p * s - q * r > 0)
    depth = (view[2] @ x)[cells].mean(axis=0)
    return facing[np.argsort(depth[facing], kind="stable")]


class BodyScale:
    """The projection and the scales with which all times of a run are drawn.

    The limits leave room for the body at all drawn times and for the longest arrows.

    Attributes:
        view: the projection, (d, d), from ``view_of``.
        size: the longest side of the box around the undeformed body.
        magnification: the factor by which displacements are multiplied.
        limits: the horizontal and vertical limits of the drawing, (2, 2), a row for each direction.
        pressure, gap: the largest contact pressure and the largest gap at the drawn times.
        stress: the upper limit of the colour scale of the stress.
        aspect: the height of the drawing divided by its width.
        stress_colours: the colours of stresses. They go with the root of the stress, so that small stresses remain
            visible.
        pressure_colours: the colour map of pressures, from 0 to the largest pressure.
    """

    def __init__(self, picture: Picture) -> None:
        at = picture.shown
        faces = picture.faces
        stresses = picture.von_mises[at]
        self.view = view_of(picture)
        self.size = np.ptp(picture.vertices, axis=1).max()
        self.magnification = magnification(picture.vertices, picture.displacement[at])
        points = [picture.vertices, *(picture.vertices + self.magnification * picture.displacement[at])]
        points += [face.x + ARROW_LENGTH * self.size * face.normal[:, None] for face in picture.segments]
        drawn = self.view[:2] @ np.hstack(points)
        margin = 0.02 * self.size * np.array([-1, 1])
        self.limits = np.column_stack([drawn.min(axis=1), drawn.max(axis=1)]) + margin
        self.pressure = max((face.pressure[at].max() for face in faces), default=0.0)
        self.gap = max((face.gap[at].max() for face in faces), default=0.0)
        self.stress = np.quantile(stresses, BRIGHTEST) or stresses.max() or 1.0
        self.aspect = np.ptp(self.limits[1]) / np.ptp(self.limits[0])
        self.stress_colours = ScalarMappable(PowerNorm(0.5, 0, self.stress), ramp("stress", COLOUR_SHADES))
        self.pressure_colours = ScalarMappable(Normalize(0, self.pressure or 1.0), ramp("pressure", COLOUR_SHADES))


def draw_deformed_mesh(
    axes: Axes, picture: Picture, instant: int, scale: BodyScale, width: float, lines: bool = True
) -> None:
    """Draw the deformed mesh at one time with stress, contact pressure and, in 2D, foundation and gap.

    Parameters:
        axes: the axes, which are cleared of ticks and labels.
        picture: the run.
        instant: the index of the time.
        scale: the scales for all times.
        width: the width of the axes in inches.
        lines: whether the edges of the mesh are drawn.
    """
    moved = picture.vertices + scale.magnification * picture.displacement[instant]
    order = drawing_order(scale.view, moved, picture.cells)
    flat = scale.view[:2] @ moved
    # A cell is about this many points wide; thicker lines would cover fine meshes.
    cell = 72 * width / sqrt(len(order) / 2)
    triangles = PolyCollection(
        flat.T[picture.cells.T[order]],
        facecolors=cell_colours(picture, instant, scale)[order],
        edgecolors=(0, 0, 0, 0.4) if lines else "face",
        linewidths=min(0.3, 0.04 * cell),
        zorder=2,
    )
    axes.add_collection(triangles, autolim=False)
    for face in picture.segments:
        _draw_foundation(axes, face, instant, scale)
    for polygon in picture.polygons:
        # Faces that point away from the eye are hidden.
        if scale.view[2] @ polygon.normal > 0:
            touching = flat[:, polygon.nodes[polygon.touching[instant]]]
            axes.plot(*touching, "o", color=BLACK, ms=min(cell / 6, 2.0), mew=0, zorder=3)
    axes.set(xlim=scale.limits[0], ylim=scale.limits[1], aspect="equal")
    axes.axis("off")


def cell_colours(picture: Picture, instant: int, scale: BodyScale) -> Array:
    """Return the colour of each triangle of the mesh at the time of index ``instant``, (cells, 4).

    The colour shows the von Mises stress of the triangle, except on contact faces in 3D: there it shows the mean of the
    pressures at the corners of the triangle.

    Parameters:
        picture: the data of the picture.
        instant: the index of the time.
        scale: the colour scales of the stress and of the pressure.
    """
    colours = scale.stress_colours.to_rgba(picture.von_mises[instant])
    for face in picture.polygons:
        pressure = face.pressure[instant][face.facets.corners].mean(axis=0)
        colours[face.facets.cells] = scale.pressure_colours.to_rgba(pressure)
    return colours


def _draw_foundation(axes: Axes, face: Segment, instant: int, scale: BodyScale) -> None:
    """Draw the foundation of a contact face in 2D with contact zone, pressure and gap at one time.

    The contact zone is a thick line, the pressure is shown by arrows. The gap is drawn below the surface of the
    foundation with its own scale, because it is small compared with the magnified displacements.
    """
    normal = face.normal[:, None]
    longest = ARROW_LENGTH * scale.size * normal
    ends = face.x[:, [face.s.argmin(), face.s.argmax()]]
    ground = band(ends, THICKNESS * scale.size * normal)
    axes.fill(*ground, facecolor=FOUNDATION, edgecolor="none", zorder=0.5)
    axes.plot(*ends, color=FOUNDATION_EDGE, lw=0.6, solid_capstyle="butt", zorder=2.5)
    if scale.gap > NEGLIGIBLE_CONTACT:
        depth = longest * face.gap[instant].clip(0) / scale.gap
        axes.fill(*band(face.x, depth), **GAP_STYLE, zorder=0.6)
    for interval in face.computed_zone(instant):
        points = [np.interp(interval, face.s, component) for component in face.x]
        axes.plot(*points, color=BLACK, lw=1.8, solid_capstyle="butt", zorder=2.6)
    every = max(1, round(len(face.s) / MOST_ARROWS))
    shown = np.flatnonzero(face.touching[instant])
    shown = shown[shown % every == 0]
    arrows = -longest * face.pressure[instant, shown] / (scale.pressure or 1.0)
    axes.quiver(
        *face.x[:, shown],
        *arrows,
        angles="xy",
        scale_units="xy",
        scale=1,
        pivot="tip",
        units="xy",
        width=0.012 * scale.size,
        minlength=0,
        color=VERMILLION,
        zorder=3,
    )


def draw_shapes(
    figure: Figure, panels: Sequence[Axes], picture: Picture, width: float, columns: int, **layout: Any
) -> None:
    """Draw the deformed body at the times ``picture.shown``, with colour bars and a legend.

    Parameters:
        figure: the figure.
        panels: the axes for each time.
        picture: the run.
        width: the width of each of the axes in inches.
        columns: the number of columns of the legend.
        layout: place and size of the colour bars, as keyword arguments of ``Figure.colorbar``.
    """
    scale = BodyScale(picture)
    for axes, instant in zip(panels, picture.shown, strict=True):
        draw_deformed_mesh(axes, picture, instant, scale, width)
        axes.set_title(picture.clock(instant))
    draw_keys(figure, panels, picture, scale, columns, **layout)
    figure.suptitle(picture.heading)


def draw_keys(
    figure: Figure,
    panels: Sequence[Axes],
    picture: Picture,
    scale: BodyScale,
    columns: int,
    more: Sequence[Artist] = (),
    **layout: Any,
) -> None:
    """Add a legend and a colour bar of the stress to a figure of a body and, in 3D, a colour bar of the pressure.

    Parameters:
        figure, panels: the figure and its axes.
        picture, scale: the run and its scales.
        columns: the number of columns of the legend.
        more: further entries of the legend.
        layout: place and size of the colour bars, as keyword arguments of ``Figure.colorbar``.
    """
    ends = [0, scale.stress / 4, scale.stress]
    bar = figure.colorbar(scale.stress_colours, ax=panels, extend="max", ticks=ends, format="%.3g", **layout)
    bar.set_label(r"von Mises stress $\sqrt{3/2}\,|\mathrm{dev}\,\sigma|$")
    bar.outline.set_linewidth(0.4)
    handles: list[Artist] = [entry(rf"body, displacement $\times\,{scale.magnification:.2g}$", color=OUTLINE, lw=0.6)]
    if picture.polygons:
        bar = figure.colorbar(scale.pressure_colours, ax=panels, **layout)
        bar.set_label(r"contact pressure $p^h$ on $\Gamma_3$")
        handles.append(dots("vertices in contact", color=BLACK, ms=2, mew=0))
    else:
        handles += [
            Patch(facecolor=FOUNDATION, edgecolor=FOUNDATION_EDGE, label="foundation"),
            dots(
                f"contact pressure, at most {scale.pressure:.3g}",
                color=VERMILLION,
                marker=r"$\uparrow$",
                ms=6,
                mew=0.2,
            ),
            entry("computed contact zone", color=BLACK, lw=1.8),
        ]
        if scale.gap > NEGLIGIBLE_CONTACT:
            handles.append(Patch(**GAP_STYLE, label=f"gap, at most {scale.gap:.3g}"))
    legend(figure, [*handles, *more], columns=columns, wide=True)


def draw_body(picture: Picture) -> Figure:
    """Draw the deformed body at the times ``picture.shown``, coloured by its von Mises stress.

    In 2D, the foundation is drawn grey; arrows show the contact pressure, and the gap is drawn below the surface of the
    foundation. In 3D, the body is seen through its foundation, and the colours of contact faces show the pressure.
    """
    count = len(picture.shown)
    bars = 2 if picture.polygons else 1
    aspect = BodyScale(picture).aspect
    figure = Figure(figsize=(column_width(), 0.7 + 0.45 * bars + (column_width() - 0.1) / count * aspect))
    panels = figure.subplots(1, count, squeeze=False)[0]
    layout: Style = dict(orientation="horizontal", fraction=0.05, shrink=0.7, pad=0.02)
    if is_slide():
        layout = dict(fraction=0.04, shrink=0.8)
    draw_shapes(figure, panels, picture, column_width() / count, 2, **layout)
    return figure


def values_of_body(picture: Picture) -> Json:
    """Return the values in the caption of ``draw_body``: name in the template ↦ value."""
    scale = BodyScale(picture)
    stresses = picture.von_mises.max(axis=1)
    worst = max(picture.shown, key=stresses.__getitem__)
    touching = np.sum([face.touching[picture.shown].sum(axis=1) for face in picture.faces], axis=0)
    return dict(
        picture=picture,
        scale=scale,
        gap=scale.gap if scale.gap > NEGLIGIBLE_CONTACT else 0.0,
        touching=touching,
        vertices=sum(face.pressure.shape[1] for face in picture.faces),
        stress=stresses[worst],
        time=picture.times[worst],
        bright=1 / (1 - BRIGHTEST),
    )


# Contact faces: zone, gap and pressure.

ZONE_POINTS = 401
ZONE_CUT = 0.01
"""The number of positions along a face at which the exact zone is drawn, and the largest depth inside of it."""
MAP_LEVELS = 10
"""The number of colours of a map."""
FACE_LINES = ((BLACK, "o"), (GREEN, "s"), (PURPLE, "^"))
"""Colour and marker of the first, second and third contact face."""
INSIDE_STYLE: Style = dict(color=BLUE, mew=0)
STRAY: Style = dict(color=BLUE, mfc="white", mew=0.5)
"""The styles of nodes in contact inside the exact contact zone, and of nodes in contact outside of it."""
NODES: Style = dict(mfc="white", ms=2.6)
"""The style of computed values at nodes."""
QUANTITY_LABELS = {"gap": "gap $w$", "pressure": "pressure $p$"}
QUANTITY_COLOURS = {"gap": BLUE, "pressure": VERMILLION}
"""The labels and colours of gap and pressure."""


def draw_zone(picture: Picture) -> Figure:
    """Draw the contact zone of each face in 2D, exact and computed, with the position s to the right and time upwards.

    The filled region is the exact zone. Dots are nodes in contact; they are hollow outside the exact zone. The last
    panel shows the error of the computed zone: the length on which exact and computed zone differ, in cells.
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
    ends = face.s.min(), face.s.max()
    s = np.linspace(*ends, ZONE_POINTS)
    # Far from the front the depth is cut off, so that the front of a zone that appears at once is drawn halfway.
    depth = face.depth(face.zone, s).clip(-ZONE_CUT, ZONE_CUT)
    axes.contourf(s, face.zone_times, depth, [0, 1], colors=[SKY], alpha=0.45)
    axes.contour(s, face.zone_times, depth, [0], colors=VERMILLION, linewidths=1.0)
    _plot_nodes(axes, *np.meshgrid(face.s, face.times), face.touching, face.outside, 2.5 / faces**0.5)
    if depth.max() < 0 and not face.touching.any():
        axes.text(0.5, 0.5, "no contact", transform=axes.transAxes, ha="center", va="center", color=GREY)
    axes.set(xlim=ends, ylim=(face.times[0], face.times[-1]))
    axes.xaxis.set_major_locator(MaxNLocator(5 if faces == 1 else 2))


def _plot_nodes(axes: Axes, x: Array, y: Array, touching: Bools, outside: Bools, size: float) -> None:
    """Plot the nodes in contact at the places (x, y): those inside and those outside of the exact contact zone."""
    for nodes, style in ((touching & ~outside, INSIDE_STYLE), (outside, STRAY)):
        # An empty line would disturb the layout of Matplotlib.
        if nodes.any():
            axes.plot(x[nodes], y[nodes], "o", ms=size, clip_on=False, zorder=3, **style)


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
    values = _at_nodes(picture, name)
    strays = _at_nodes(picture, "outside")
    return 100 * values[strays].max(initial=0.0) / (values.max(initial=0.0) or 1.0)


def _at_nodes(picture: Picture, name: str) -> Array:
    """Return an attribute of all contact faces, at all times and nodes, (times, nodes of all faces)."""
    return np.hstack([getattr(face, name) for face in picture.faces])


def _worst(picture: Picture, errors: Sequence[Array]) -> tuple[FaceHistory, float, str]:
    """Return the face with the largest error after t = 0, this error, and a text with the face and the time."""
    number = int(np.argmax([error.max() for error in errors]))
    face = picture.faces[number]
    error = errors[number]
    when = picture.times[1:][error.argmax()]
    return face, error.max(), f"on {picture.name(face)} at t = {when:.3g}"


def values_of_zone(picture: Picture) -> Json:
    """Return the values in the caption of ``draw_zone``: name in the template ↦ value."""
    errors = [misplaced_length(face) for face in picture.segments]
    _, worst, where = _worst(picture, errors)
    return dict(
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
    values at the nodes. In the format for slides, a figure with several faces has a column for each
    face instead, at the time at which the pressure is largest.
    """
    faces = picture.segments
    shown = picture.shown
    heading = picture.heading
    titles = [picture.clock(instant) for instant in shown]
    rows = [[(face, instant) for instant in shown] for face in faces]
    if is_slide() and len(faces) > 1:
        loudest = max(shown, key=lambda instant: max(face.pressure[instant].max() for face in faces))
        titles = [picture.symbol(face) for face in faces]
        rows = [[(face, loudest) for face in faces]]
        heading = f"{heading}, {picture.clock(loudest)}"
    figure = Figure(figsize=(column_width(), 0.9 + 2.2 * len(rows)))
    panels = figure.subplots(2 * len(rows), len(titles), sharey="row", squeeze=False)
    for number, row in enumerate(rows):
        for (name, colour), line in zip(QUANTITY_COLOURS.items(), panels[2 * number :], strict=False):
            for (face, instant), axes in zip(row, line, strict=True):
                exact = getattr(face, f"line_{name}")[instant]
                computed = getattr(face, name)[instant]
                draw_profile(axes, face, exact, computed, colour)
                axes.tick_params(labelbottom=name == "pressure")
                axes.set_xlabel(f"$s$ on {picture.symbol(face)}" if name == "pressure" else "")
            # The axis includes zero, so that round-off around a constant does not fill the panel.
            low, high = line[0].get_ylim()
            high = high if high > NEGLIGIBLE_CONTACT else 1.0
            line[0].set(ylim=(min(low, -0.06 * high), high), ylabel=QUANTITY_LABELS[name])
    for axes, title in zip(panels[0], titles, strict=True):
        axes.set_title(title)
    figure.align_ylabels(panels[:, 0])
    figure.suptitle(heading)
    markers = [dots(f"computed {name}", color=colour, **NODES) for name, colour in QUANTITY_COLOURS.items()]
    legend(figure, [entry("exact", color=BLACK, lw=0.9), *markers], columns=3, wide=True)
    return figure


def draw_profile(axes: Axes, face: Segment, exact: Array, computed: Array, colour: str) -> None:
    """Draw the exact and computed gap, or the exact and computed pressure, along a contact face in 2D.

    Parameters:
        axes: the axes.
        face: the contact face.
        exact: the exact values at the positions ``face.line``, drawn as a black line.
        computed: the computed values at the nodes ``face.s``, drawn as markers.
        colour: the colour of the markers.
    """
    axes.plot(face.line, exact, color=BLACK, lw=0.9)
    axes.plot(face.s, computed, "o", color=colour, clip_on=False, zorder=3, **NODES)
    axes.set_xlim(face.line.min(), face.line.max())
    axes.locator_params(axis="x", nbins=3)
    axes.grid(True)


def values_of_profiles(picture: Picture) -> Json:
    """Return the values in the caption of ``draw_profiles``: name in the template ↦ value."""
    differences = {name: _largest_difference(picture, name) for name in QUANTITY_LABELS}
    return dict(picture=picture, **differences)


def _largest_difference(picture: Picture, name: str) -> str:
    """Return the largest error of the gap or of the pressure as text.

    The errors are taken at the nodes and at the times of ``picture.shown``. They are given in per cent of the largest
    exact value, unless this value is zero up to rounding.
    """
    computed, exact = (_at_nodes(picture, attribute)[picture.shown] for attribute in (name, f"{name}_exact"))
    difference = abs(computed - exact).max()
    size = abs(exact).max()
    if size > NEGLIGIBLE_CONTACT:
        return f"{100 * difference / size:.2g} % of the largest"
    return f"{difference:.1e}, the largest being 0"


def draw_fronts(picture: Picture) -> Figure:
    """Draw maps of the contact zone in 3D, exact and computed, at the times of ``picture.shown``.

    There is a row for each face and a column for each time.

    The filled region is the exact zone, where the level function ψ of the solution is not negative; dots are nodes in
    contact. The lowest axes show the numbers of nodes in contact over time, exact and computed.
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
        times = picture.times[1:]
        label = picture.symbol(face)
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


def values_of_fronts(picture: Picture) -> Json:
    """Return the values in the caption of ``draw_fronts``: name in the template ↦ value."""
    # Nodes in contact outside the exact zone, and nodes in the exact zone that are not in contact.
    wrong = [(face.touching != face.inside)[1:].sum(axis=1) for face in picture.polygons]
    face, worst, where = _worst(picture, wrong)
    return dict(
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
    exact = face.pressure_exact[instant].clip(0)
    computed = face.pressure[instant].clip(0)
    levels = np.linspace(0, top, MAP_LEVELS + 1)
    style: Style = dict(cmap=ramp("pressure"), norm=BoundaryNorm(levels, 256))
    axes.tricontourf(Triangulation(*face.s, face.facets.corners.T), exact, levels, **style)
    axes.scatter(face.s[0], face.s[1], s=5, c=computed, zorder=2, edgecolors=RIM, linewidths=0.2, **style)
    _draw_front(axes, face, face.level[instant])


def _draw_zone_map(axes: Axes, face: Polygon, instant: int) -> None:
    """Draw the map of the exact contact zone on a face in 3D, and the nodes in contact."""
    level = face.level[instant]
    if level.max() >= 0:
        axes.tricontourf(_refined(face), level, [0, level.max() + 1], colors=[SKY], alpha=0.45)
    _plot_nodes(axes, face.s[0], face.s[1], face.touching[instant], face.outside[instant], 1.6)
    _draw_front(axes, face, level)


def _draw_front(axes: Axes, face: Polygon, level: Array) -> None:
    """Draw the exact contact front of a face in 3D, where the level function is 0, and set the limits of the axes."""
    if level.min() < 0 <= level.max():
        axes.tricontour(_refined(face), level, [0], colors=VERMILLION, linewidths=1.0)
    left, bottom = face.s.min(axis=1)
    right, top = face.s.max(axis=1)
    axes.set(aspect="equal", xlim=(left, right), ylim=(bottom, top))


def _refined(face: Polygon) -> Triangulation:
    """Return the triangulation of the nodes and edge midpoints of a face, at which the level function is known."""
    return Triangulation(*face.facets.refined(face.s), face.facets.quarters.T)


# The problem of the paper.


def draw_sketch() -> Figure:
    """Draw a sketch of a body on a foundation with Γ1, Γ2, Γ3, forces, gap and pressure; nothing is computed.

    The drawn gap is (s − c)_+² and the drawn pressure (c − s)_+, where c is the position of the contact front.
    """
    wide = 1.5
    high = 0.62
    front = 0.75
    figure = Figure(figsize=(column_width(), 1.75))
    axes = figure.subplots()
    s = np.linspace(0, wide, 61)
    gap = 0.28 * np.maximum(s - front, 0) ** 2
    axes.fill([*s, wide, 0], [*gap, high, high], facecolor=ramp("stress")(0), edgecolor=BLACK, linewidth=0.8)
    axes.add_patch(Rectangle((0, high), wide, 0.05, facecolor="none", edgecolor=DARK, linewidth=0, hatch="/////"))
    axes.plot([0, wide], [high, high], color=DARK, lw=1.6)
    axes.plot(s, gap, color=BLUE, lw=1.6)

    axes.add_patch(Rectangle((-0.12, -0.09), 1.74, 0.09, facecolor=FOUNDATION, edgecolor="none", zorder=0.5))
    axes.plot([-0.12, 1.62], [0, 0], color=FOUNDATION_EDGE, lw=0.6, zorder=0.6)
    axes.fill_between(s, gap, **GAP_STYLE)
    for at in np.arange(0.06, front, 0.12):
        arrow(axes, (at, -0.26 * (1 - at / front) - 0.015), (at, 0), VERMILLION)
    arrow(axes, (1.07, 0.028), (1.07, -0.17), BLACK)
    for at in (0.22, 0.36, 0.5):
        arrow(axes, (wide + 0.2, at + 0.05), (wide, at), GREEN)
        arrow(axes, (-0.2, at), (0, at), GREEN)
    arrow(axes, (1.25, 0.57), (1.25, 0.42), GREEN)

    for x, y, text, colour, side in (
        (0.75, 0.72, r"$\Gamma_1$: clamped, $u=0$", BLACK, "center"),
        (0.24, 0.33, r"$\Omega$", BLACK, "center"),
        (0.75, 0.33, r"$\sigma=\mathcal{A}\varepsilon(\dot u)+\mathcal{G}\varepsilon(u)$", BLACK, "center"),
        (0.34, 0.075, r"$\Gamma_3$", BLUE, "center"),
        (1.53, 0.06, "gap $w$", BLUE, "left"),
        (0.33, -0.235, "pressure $p$", VERMILLION, "left"),
        (1.11, -0.14, r"$\nu$", BLACK, "left"),
        (1.62, -0.15, "foundation", BLACK, "right"),
        (1.72, 0.41, r"$\Gamma_2$: $\sigma\nu=f_2$", GREEN, "left"),
        (-0.2, 0.14, r"$\Gamma_2$", GREEN, "left"),
        (1.28, 0.5, "$f_0$", GREEN, "left"),
    ):
        axes.text(x, y, text, color=colour, ha=side, va="center")
    axes.set(xlim=(-0.3, 1.92), ylim=(-0.36, 0.76), aspect="equal")
    axes.axis("off")
    return figure


def arrow(axes: Axes, start: Any, end: Any, colour: str, head: float = 6, **more: Any) -> None:
    """Draw an arrow between two points.

    Parameters:
        axes: the axes.
        start, end: the two points in the coordinates of the axes; the head is at ``end``.
        colour: the colour.
        head: the size of the head in typographic points.
        more: further arguments of Matplotlib's ``annotate``.
    """
    style = dict(arrowstyle="-|>", color=colour, lw=0.9, shrinkA=0, shrinkB=0, mutation_scale=head)
    axes.annotate("", end, start, arrowprops=style, **more)

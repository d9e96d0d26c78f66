"""Functions that draw a deforming body on its foundation: projection, scales, and the figure of several times."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib import patches
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Colormap, LinearSegmentedColormap, Normalize, PowerNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray

from manufactured.colours import BLACK, BLUE, VERMILLION
from study.present.drawing import (
    FOUNDATION,
    FOUNDATION_EDGE,
    OUTLINE,
    RAMPS,
    Style,
    caption,
    column_width,
    dots,
    entry,
    is_slide,
    legend,
)
from study.present.picture import Array, Picture, Segment

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
ROUND_OFF = 1e-9
"""Gaps and pressures below this value count as zero; values that are not due to rounding are of order one."""
COLOUR_SHADES = 16
"""The number of colours of the stress, and of the pressure."""
MOST_ARROWS = 16
"""The approximate largest number of pressure arrows on a contact face."""
GAP_STYLE: Style = {"facecolor": (BLUE, 0.3), "edgecolor": BLUE, "linewidth": 0.5}


def ramp(name: str, shades: int = 256) -> Colormap:
    """Return the colour map of a quantity of ``RAMPS``, with ``shades`` colours from zero to the largest value."""
    return LinearSegmentedColormap.from_list(name, RAMPS[name], shades)


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
    largest = np.linalg.norm(displacements, axis=1).max()
    if largest == 0:
        return 1.0
    exact = DRAWN_DISPLACEMENT * np.ptp(vertices, axis=1).max() / largest
    unit = 10.0 ** (math.floor(math.log10(exact)) - 1)
    return float(f"{math.floor(exact / unit) * unit:.2g}")


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
    towards /= np.linalg.norm(towards)
    right = np.cross([0, 0, side[2]], towards)
    right /= np.linalg.norm(right)
    return np.array([right, np.cross(towards, right), towards])


def drawing_order(view: Array, x: Array, cells: NDArray[np.int64]) -> NDArray[np.int64]:
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
    (p, q), (r, s) = b - a, c - a
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
        at, faces, stresses = picture.shown, picture.faces, picture.von_mises[picture.shown]
        self.view = view_of(picture)
        self.size = picture.size
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
    order, flat = drawing_order(scale.view, moved, picture.cells), scale.view[:2] @ moved
    # A cell is about this many points wide; thicker lines would cover fine meshes.
    cell = 72 * width / math.sqrt(len(order) / 2)
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

    In 3D, the colour of a triangle on a contact face shows the mean pressure at its corners; the colours of all other
    triangles show their von Mises stress.
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
    ends = face.x[:, [face.s.argmin(), face.s.argmax()]]
    ground = band(ends, THICKNESS * scale.size * face.normal[:, None])
    axes.add_patch(patches.Polygon(ground.T, facecolor=FOUNDATION, edgecolor="none", zorder=0.5))
    axes.plot(*ends, color=FOUNDATION_EDGE, lw=0.6, solid_capstyle="butt", zorder=2.5)
    if scale.gap > ROUND_OFF:
        depth = ARROW_LENGTH * scale.size * face.gap[instant].clip(0) / scale.gap * face.normal[:, None]
        axes.add_patch(patches.Polygon(band(face.x, depth).T, **GAP_STYLE, zorder=0.6))
    for interval in face.computed_zone(instant):
        points = [np.interp(interval, face.s, component) for component in face.x]
        axes.plot(*points, color=BLACK, lw=1.8, solid_capstyle="butt", zorder=2.6)
    every = max(1, round(len(face.s) / MOST_ARROWS))
    shown = np.flatnonzero(face.touching[instant])
    shown = shown[shown % every == 0]
    arrows = -face.normal[:, None] * ARROW_LENGTH * scale.size * face.pressure[instant, shown] / (scale.pressure or 1.0)
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
    draw_keys(figure, list(panels), picture, scale, columns, **layout)
    figure.suptitle(picture.heading)


def draw_keys(
    figure: Figure,
    panels: list[Axes],
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
            patches.Patch(facecolor=FOUNDATION, edgecolor=FOUNDATION_EDGE, label="foundation"),
            dots(
                f"contact pressure, at most {scale.pressure:.3g}",
                color=VERMILLION,
                marker=r"$\uparrow$",
                ms=6,
                mew=0.2,
            ),
            entry("computed contact zone", color=BLACK, lw=1.8),
        ]
        if scale.gap > ROUND_OFF:
            handles.append(patches.Patch(**GAP_STYLE, label=f"gap, at most {scale.gap:.3g}"))
    legend(figure, [*handles, *more], columns=columns, wide=True)


def draw_body(picture: Picture) -> Figure:
    """Draw the deformed body at the times ``picture.shown``, coloured by its von Mises stress.

    In 2D, the foundation is drawn grey; arrows show the contact pressure, and the gap is drawn below the surface of the
    foundation. In 3D, the body is seen through its foundation, and the colours of contact faces show the pressure.
    """
    count, bars = len(picture.shown), 2 if picture.polygons else 1
    aspect = BodyScale(picture).aspect
    figure = Figure(figsize=(column_width(), 0.7 + 0.45 * bars + (column_width() - 0.1) / count * aspect))
    panels = figure.subplots(1, count, squeeze=False)[0]
    layout: dict[str, Any] = {"orientation": "horizontal", "fraction": 0.05, "shrink": 0.7, "pad": 0.02}
    if is_slide():
        layout = {"fraction": 0.04, "shrink": 0.8}
    draw_shapes(figure, panels, picture, column_width() / count, 2, **layout)
    return figure


def caption_body(picture: Picture) -> str:
    """Return the caption of ``draw_body``."""
    scale, stresses = BodyScale(picture), picture.von_mises.max(axis=1)
    worst = max(picture.shown, key=stresses.__getitem__)
    touching = np.sum([face.touching[picture.shown].sum(axis=1) for face in picture.faces], axis=0)
    return caption(
        "body",
        picture=picture,
        scale=scale,
        gap=scale.gap if scale.gap > ROUND_OFF else 0.0,
        touching=touching,
        vertices=sum(face.pressure.shape[1] for face in picture.faces),
        stress=stresses[worst],
        time=picture.times[worst],
        bright=1 / (1 - BRIGHTEST),
    )

"""Pictures of a stated problem with supports and loads, and of the error on the cells of its mesh."""

from collections.abc import Sequence
from functools import partial

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.tri import Triangulation
from numpy.linalg import norm

from manufactured.body import Body, Kind, Part
from manufactured.colours import BLACK, BLUE, GREEN, VERMILLION
from manufactured.data import Data
from study.ledger.files import UsageError
from study.ledger.pictures import Array
from study.present.body import arrow, band, magnification
from study.present.drawing import (
    FOUNDATION,
    FOUNDATION_EDGE,
    Drawing,
    Output,
    Style,
    caption,
    column_width,
    entry,
    legend,
)

MeshInTime = tuple[tuple[Array, Array], tuple[Array, Array]]
"""A mesh and a displacement over time: vertices, (2, n), and vertex numbers of triangles, (3, cells); and times, (k,),
with displacements of the vertices, (k, 2, n)."""
PROBLEM_OUTPUT = Output(formats=("png", "svg"))
SUPPORT_DEPTH = 0.05
"""Drawn thickness of supports, as a fraction of the longest side of the body."""
LOAD_LENGTH = 0.2
"""Length of the arrow of the largest traction, as a fraction of the longest side of the body."""
LOAD_ARROWS = 7
"""Number of arrows of the traction on a side."""
NUMBER_DISTANCE = 0.5
"""Distance of the number of a side from the side, inside the body, in thicknesses of supports."""
LINE_WIDTHS = 12
"""Width of the lines of a mesh times the root of the number of its cells, in points."""
MIDDLE_SAMPLES = 200
"""Number of random points of the body; the one nearest to their mean is called its middle."""
TRACTION_TIMES = 5
"""Number of times of which the one with the largest tractions is shown, if no displacement is given."""


def problem_drawing(name: str, data: Data, solved: MeshInTime | None = None) -> Drawing:
    """Return the figure ``problem``: a problem as it is stated, and perhaps a mesh with its largest displacement.

    Parameters:
        name, data: the name and the data of the problem.
        solved: a mesh and a displacement over time, which is drawn at the time of its largest value. Without it, the
            loads are drawn at the time of the largest traction.

    Raises:
        UsageError: the body is not plane.
    """
    body = data.body
    if body.dim != 2:
        raise UsageError(f"{name} has a body in {body.dim} dimensions; pictures of problems show plane bodies")
    meshes: list[Triangulation] = []
    factor = 1.0
    moved = ""
    if solved is None:
        times = np.linspace(0.0, body.T, TRACTION_TIMES if data.in_time else 1)
        time = max(times, key=lambda time: max(abs(_traction(data, part, time)[1]).max() for part in body.parts))
    else:
        (vertices, cells), (times, displacements) = solved
        at = abs(displacements).max(axis=(1, 2)).argmax()
        time = times[at]
        factor = magnification(body.vertices, displacements[at : at + 1])
        meshes = [Triangulation(*x, cells.T) for x in (vertices, vertices + factor * displacements[at])]
        moved = f", and the mesh moved by {factor:g} times its displacement"
    when = f", t = {time:.3g}" if data.in_time else ""
    text = caption("problem_picture", name=name, moved=moved, when=when)
    draw = partial(draw_problem, f"{name}{when}", data, time, meshes, factor)
    return Drawing("problem", draw, text, f"The problem {name}")


def _traction(data: Data, part: Part, time: float) -> tuple[Array, Array]:
    """Return points on a side, and the traction at these points, (2, n) each; it is 0 on a side that is not LOADED."""
    places = (np.arange(LOAD_ARROWS) + 0.5) / LOAD_ARROWS
    points = part.start[:, None] + places * (part.end - part.start)[:, None]
    loaded = part.kind is Kind.LOADED
    return points, np.asarray(data.surface_load(part, points)(time)) if loaded else np.zeros_like(points)


def error_map(name: str, vertices: Array, cells: Array, squares: Sequence[float]) -> Drawing:
    """Return the figure ``cells``: a map of ‖ũ − u_h‖ per root of the area on the cells of a mesh.

    This is the distance of the computed displacement u_h from a more accurate displacement ũ.

    Parameters:
        name: the name of the problem.
        vertices, cells: the mesh, (2, vertices) and (3, cells).
        squares: the squared distances on the cells.
    """
    text = (
        f"{name}: distance of u_h from the better displacement ũ on each triangle, in the energy norm, divided by the "
        "root of the area. It estimates where the error arises; the error of a single triangle is not bounded."
    )
    draw = partial(_draw_map, vertices, cells, np.array(squares))
    return Drawing("cells", draw, text, f"Where the error of {name} arises")


def _draw_map(vertices: Array, cells: Array, squares: Array) -> Figure:
    figure, axes = _axes(vertices)
    corners = vertices[:, cells[1:]] - vertices[:, cells[:1]]
    areas = abs(np.linalg.det(np.moveaxis(corners, 2, 0))) / 2
    density = np.sqrt(squares / areas)
    drawn = axes.tripcolor(
        Triangulation(*vertices, cells.T),
        density,
        cmap="viridis",
        edgecolors="0.6",
        linewidth=min(0.2, LINE_WIDTHS / np.sqrt(len(squares)) / 2),
    )
    label = r"distance of $u_h$ from $\tilde u$, $(\Vert\tilde u - u_h\Vert_T^2/|T|)^{1/2}$"
    figure.colorbar(drawn, ax=axes, location="bottom", aspect=40, label=label)
    return figure


def _axes(points: Array) -> tuple[Figure, Axes]:
    """Return a figure whose shape fits points of the plane, (2, n), and its axes."""
    wide, high = np.ptp(points, axis=1)
    shape = np.clip(high / wide, 0.4, 1.4)
    figure = Figure(figsize=(1.4 * column_width(), 1.4 * column_width() * shape + 0.5))
    axes = figure.subplots()
    axes.set(aspect="equal", xlabel="$x_1$", ylabel="$x_2$")
    return figure, axes


def draw_problem(title: str, data: Data, time: float, meshes: Sequence[Triangulation], factor: float) -> Figure:
    """Draw the outline of the body with supports and loads, and perhaps a mesh with its displacement.

    Parameters:
        title: the title of the figure.
        data: the problem.
        time: the time of the loads.
        meshes: the mesh at rest and the displaced mesh; empty if no mesh is drawn.
        factor: the factor by which the drawn displacement of the second mesh is larger than the computed one.
    """
    body = data.body
    figure, axes = _axes(body.vertices)
    handles: list[Artist] = []
    for zorder, (mesh, colour) in enumerate(zip(meshes, ("0.8", BLUE), strict=False), start=1):
        # On fine meshes lines are thin, so that their cells can be seen.
        thin = min(0.4, LINE_WIDTHS / np.sqrt(len(mesh.triangles)))
        axes.triplot(mesh, color=colour, lw=thin, zorder=zorder)
    if meshes:
        handles.append(entry(f"displacement × {factor:g}", color=BLUE, lw=0.8))
    for number, part in enumerate(body.parts):
        _draw_side(axes, part, number, body.extent)
    loaded = _draw_loads(axes, data, time)
    axes.margins(0.06)
    axes.tick_params(length=2)
    axes.set_title(title)
    present = {part.kind.name for part in body.parts}
    handles += [Patch(label=kind, **style) for kind, style in SUPPORT_STYLES.items() if kind in present]
    if loaded:
        handles.append(entry("load", color=VERMILLION, marker=">"))
    legend(figure, handles, 4)
    return figure


SUPPORT_EDGE: Style = dict(edgecolor=FOUNDATION_EDGE, linewidth=0.4)
SUPPORT_STYLES = {
    "CLAMPED": dict(SUPPORT_EDGE, hatch="/////", facecolor="white"),
    "CONTACT": dict(SUPPORT_EDGE, facecolor=FOUNDATION),
    "ROLLER": dict(SUPPORT_EDGE, hatch="oo", facecolor="white"),
}
"""Kind of a supported side ↦ the style of the band that is drawn outside of it."""


def _draw_side(axes: Axes, part: Part, number: int, size: float) -> None:
    """Draw the support of a side outside of the body, and its number inside."""
    outward = SUPPORT_DEPTH * size * part.normal
    axes.plot(*part.corners, color=BLACK, lw=0.9, zorder=4)
    if part.kind.name in SUPPORT_STYLES:
        axes.fill(*band(part.corners, outward[:, None]), zorder=3, **SUPPORT_STYLES[part.kind.name])
    x, y = part.corners.mean(axis=1) - NUMBER_DISTANCE * outward
    moved = norm(part.prescribed(part.corners), axis=0).max()
    label, frame = (f"{number}: |u| ≤ {moved:.3g}", "round") if moved else (str(number), "circle")
    box = dict(boxstyle=f"{frame},pad=0.15", facecolor="white", edgecolor=GREEN, linewidth=0.6)
    axes.text(x, y, label, color=GREEN, ha="center", va="center", bbox=box, zorder=6)


def _draw_loads(axes: Axes, data: Data, time: float) -> bool:
    """Draw tractions as arrows with the size of the largest arrow on each side, and the force on the volume.

    Returns:
        Whether there is a load.
    """
    body = data.body
    tractions = [_traction(data, part, time) for part in body.parts]
    sizes = [norm(traction, axis=0) for _, traction in tractions]
    strongest = np.max(sizes)
    for part, (points, traction), lengths in zip(body.parts, tractions, sizes, strict=True):
        largest = lengths.max()
        if largest == 0:
            continue
        arrows = LOAD_LENGTH * body.extent / strongest * traction
        # An arrow that pushes ends at the side; an arrow that pulls starts there.
        pushes = part.normal @ traction < 0
        starts = np.where(pushes, points - arrows, points)
        for start, length in zip(starts.T, arrows.T, strict=True):
            arrow(axes, start, start + length, VERMILLION, 7, zorder=5, annotation_clip=False)
        axes.update_datalim(np.hstack([starts, starts + arrows]).T)
        # Of equal arrows the middle one gets the label.
        top = np.argmax((lengths >= 0.99 * largest) * (1 - np.linspace(-0.5, 0.5, len(lengths)) ** 2))
        far = starts[:, top] if pushes[top] else (starts + arrows)[:, top]
        _label(axes, far + SUPPORT_DEPTH * body.extent * part.normal, f"{largest:.3g}")
    middle = _middle(body)
    force = data.body_force(middle[:, None])(time)[:, 0]
    weight = norm(force)
    if weight:
        push = LOAD_LENGTH / 2 * body.extent / weight * force
        arrow(axes, middle, middle + push, VERMILLION, 7, zorder=5)
        _label(axes, middle - push / 3, f"$f_0$: {weight:.3g}")
    return bool(strongest or weight)


def _middle(body: Body) -> Array:
    """Return a point near the middle of the body, (2,)."""
    inside = body.sample(np.random.default_rng(0), MIDDLE_SAMPLES)
    return inside[:, norm(inside - inside.mean(axis=1, keepdims=True), axis=0).argmin()]


def _label(axes: Axes, place: Array, text: str) -> None:
    box = dict(boxstyle="round,pad=0.1", facecolor=(1, 1, 1, 0.7), edgecolor="none")
    axes.text(place[0], place[1], text, color=VERMILLION, ha="center", va="center", bbox=box, zorder=6)
    axes.update_datalim(place[None])

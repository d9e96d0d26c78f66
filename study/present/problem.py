"""Pictures of problems: a sketch of the problem of the paper, and a stated problem with supports and loads."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Polygon, Rectangle
from matplotlib.tri import Triangulation

from manufactured.colours import BLACK, BLUE, DARK, GREEN, VERMILLION
from study.present.body import GAP_STYLE, band, magnification
from study.present.drawing import (
    FOUNDATION,
    FOUNDATION_EDGE,
    RAMPS,
    Drawing,
    Style,
    caption,
    column_width,
    entry,
    legend,
)
from study.present.picture import Array

BAND = 0.05
"""Drawn thickness of supports, as a fraction of the longest side of the body."""
ARROW = 0.2
"""Length of the arrow of the largest traction, as a fraction of the longest side of the body."""
NUMBER = 0.5
"""Distance of the number of a side from the side, inside the body, in thicknesses of supports."""
FINE = 12
"""Width of the lines of a mesh times the root of the number of its cells, in points."""


@dataclass(frozen=True, eq=False)
class Side:
    """One side of a plane body.

    Attributes:
        kind: CLAMPED, LOADED, CONTACT or ROLLER.
        ends: the coordinates of both ends, (2, 2), one column for each end; the body lies to the left.
        points: points on the side at which its traction is known, (2, n).
        traction: the traction at these points, (2, n).
        moved: the size of the displacement that is prescribed on the side; 0 if there is none.
    """

    kind: str
    ends: Array
    points: Array
    traction: Array
    moved: float = 0.0

    @property
    def normal(self) -> Array:
        """The outward unit normal, (2,)."""
        along = self.ends[:, 1] - self.ends[:, 0]
        return np.array([along[1], -along[0]]) / np.linalg.norm(along)


@dataclass(frozen=True, eq=False)
class ProblemPicture:
    """What the picture of a problem shows.

    Attributes:
        name: the name of the problem.
        sides: the sides in the order of their numbers.
        middle: a point near the middle of the body, (2,).
        force: the force on the volume there, (2,).
        when: the time of loads and displacement, as text; empty for static problems.
        vertices, cells: the mesh, (2, vertices) and (cells, 3); without cells no mesh is drawn.
        displacement: the displacements of the vertices, (2, vertices).
    """

    name: str
    sides: Sequence[Side]
    middle: Array
    force: Array
    when: str
    vertices: Array
    cells: Array
    displacement: Array

    @property
    def corners(self) -> Array:
        """The corners of the body, (2, corners)."""
        return np.array([side.ends[:, 0] for side in self.sides]).T

    @property
    def size(self) -> float:
        """The longest side of the box around the body."""
        return np.ptp(self.corners, axis=1).max()

    @property
    def factor(self) -> float:
        """The factor by which the displacement is drawn too large."""
        return magnification(self.vertices, self.displacement[None])

    def drawing(self) -> Drawing:
        """Return the figure ``problem``."""
        moved = f", and the mesh moved by {self.factor:g} times its displacement" if len(self.cells) else ""
        text = caption("problem_picture", name=self.name, moved=moved, when=self.when)
        return Drawing("problem", partial(draw_problem, self), text, f"The problem {self.name}")


def error_map(name: str, vertices: Array, cells: Array, squares: Sequence[float]) -> Drawing:
    """Return the figure ``cells``: a map of ‖ũ − u_h‖², per area, on the cells of a mesh.

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
        linewidth=min(0.2, FINE / np.sqrt(len(squares)) / 2),
    )
    label = r"distance of $u_h$ from $\tilde u$, $(\Vert\tilde u - u_h\Vert_T^2/|T|)^{1/2}$"
    figure.colorbar(drawn, ax=axes, location="bottom", aspect=40, label=label)
    return figure


def _axes(points: Array) -> tuple[Figure, Axes]:
    """Return a figure whose shape fits points of the plane, (2, n), and its axes."""
    wide, high = np.ptp(points, axis=1)
    shape = np.clip(high / wide, 0.4, 1.4)
    figure = Figure(figsize=(1.4 * column_width(), 1.4 * column_width() * shape + 0.5), layout="constrained")
    axes = figure.subplots()
    axes.set_aspect("equal")
    axes.set(xlabel="$x_1$", ylabel="$x_2$")
    return figure, axes


def draw_problem(picture: ProblemPicture) -> Figure:
    """Draw outline, supports, loads, the mesh and its displacement, if there is one."""
    figure, axes = _axes(picture.corners)
    handles: list[Artist] = []
    if len(picture.cells):
        # On fine meshes lines are thin, so that their cells can be seen.
        thin = min(0.4, FINE / np.sqrt(len(picture.cells)))
        axes.triplot(Triangulation(*picture.vertices, picture.cells), color="0.8", lw=thin, zorder=1)
        moved = picture.vertices + picture.factor * picture.displacement
        axes.triplot(Triangulation(*moved, picture.cells), color=BLUE, lw=thin, zorder=2)
        handles.append(entry(f"displacement × {picture.factor:g}", color=BLUE, lw=0.8))
    for number, side in enumerate(picture.sides):
        _draw_side(axes, side, number, picture.size)
    _draw_loads(axes, picture)
    axes.margins(0.06)
    axes.tick_params(length=2)
    axes.set_title(f"{picture.name}{picture.when}")
    present = {side.kind for side in picture.sides}
    handles += [Patch(label=kind, **style) for kind, style in BANDS.items() if kind in present]
    if picture.force.any() or any(side.traction.any() for side in picture.sides):
        handles.append(entry("load", color=VERMILLION, marker=">"))
    legend(figure, handles, 4)
    return figure


RIM: Style = {"edgecolor": FOUNDATION_EDGE, "linewidth": 0.4}
BANDS = {
    "CLAMPED": RIM | {"hatch": "/////", "facecolor": "white"},
    "CONTACT": RIM | {"facecolor": FOUNDATION},
    "ROLLER": RIM | {"hatch": "oo", "facecolor": "white"},
}
"""Kind of a supported side ↦ the style of the band that is drawn outside of it."""


def _draw_side(axes: Axes, side: Side, number: int, size: float) -> None:
    """Draw the support of a side outside of the body, and its number inside."""
    outward, middle = BAND * size * side.normal, side.ends.mean(axis=1)
    axes.plot(*side.ends, color=BLACK, lw=0.9, zorder=4)
    if side.kind in BANDS:
        axes.fill(*band(side.ends, outward[:, None]), zorder=3, **BANDS[side.kind])
    x, y = middle - NUMBER * outward
    label, frame = (f"{number}: |u| ≤ {side.moved:.3g}", "round") if side.moved else (str(number), "circle")
    box = {"boxstyle": f"{frame},pad=0.15", "facecolor": "white", "edgecolor": GREEN, "linewidth": 0.6}
    axes.text(x, y, label, color=GREEN, ha="center", va="center", bbox=box, zorder=6)


def _draw_loads(axes: Axes, picture: ProblemPicture) -> None:
    """Draw tractions as arrows with the size of the largest arrow on each side, and the force on the volume."""
    sizes = [np.linalg.norm(side.traction, axis=0).max(initial=0.0) for side in picture.sides]
    for side, largest in zip(picture.sides, sizes, strict=True):
        if largest == 0:
            continue
        arrows = ARROW * picture.size / max(sizes) * side.traction
        # An arrow that pushes ends at the side; an arrow that pulls starts there.
        pushes = side.normal @ side.traction < 0
        starts = np.where(pushes, side.points - arrows, side.points)
        for start, arrow in zip(starts.T, arrows.T, strict=True):
            _arrow(axes, start, start + arrow, VERMILLION, 7, zorder=5, annotation_clip=False)
        axes.update_datalim(np.hstack([starts, starts + arrows]).T)
        # Of equal arrows the middle one gets the label.
        lengths = np.linalg.norm(side.traction, axis=0)
        top = np.argmax((lengths >= 0.99 * largest) * (1 - np.linspace(-0.5, 0.5, len(lengths)) ** 2))
        far = starts[:, top] if pushes[top] else (starts + arrows)[:, top]
        _label(axes, far + BAND * picture.size * side.normal, f"{largest:.3g}")
    weight = np.linalg.norm(picture.force)
    if weight:
        arrow = ARROW / 2 * picture.size / weight * picture.force
        _arrow(axes, picture.middle, picture.middle + arrow, VERMILLION, 7, zorder=5)
        _label(axes, picture.middle - arrow / 3, f"$f_0$: {weight:.3g}")


def _label(axes: Axes, place: Array, text: str) -> None:
    box = {"boxstyle": "round,pad=0.1", "facecolor": (1, 1, 1, 0.7), "edgecolor": "none"}
    axes.text(place[0], place[1], text, color=VERMILLION, ha="center", va="center", bbox=box, zorder=6)
    axes.update_datalim(place[None])


def draw_sketch() -> Figure:
    """Draw a sketch of a body on a foundation with Γ1, Γ2, Γ3, forces, gap and pressure; nothing is computed.

    The drawn gap is (s − c)_+² and the drawn pressure (c − s)_+, where c is the position of the contact front.
    """
    wide, high, front = 1.5, 0.62, 0.75
    figure = Figure(figsize=(column_width(), 1.75))
    axes = figure.subplots()
    s = np.linspace(0, wide, 61)
    gap = 0.28 * np.maximum(s - front, 0) ** 2
    outline = np.vstack([np.column_stack([s, gap]), [[wide, high], [0, high]]])
    axes.add_patch(Polygon(outline, facecolor=RAMPS["stress"][0], edgecolor=BLACK, linewidth=0.8))
    axes.add_patch(Rectangle((0, high), wide, 0.05, facecolor="none", edgecolor=DARK, linewidth=0, hatch="/////"))
    axes.plot([0, wide], [high, high], color=DARK, lw=1.6)
    axes.plot(s, gap, color=BLUE, lw=1.6)

    axes.add_patch(Rectangle((-0.12, -0.09), wide + 0.24, 0.09, facecolor=FOUNDATION, edgecolor="none", zorder=0.5))
    axes.plot([-0.12, wide + 0.12], [0, 0], color=FOUNDATION_EDGE, lw=0.6, zorder=0.6)
    axes.fill_between(s, 0 * s, gap, **GAP_STYLE)
    for at in np.arange(0.06, front, 0.12):
        _arrow(axes, (at, -0.26 * (1 - at / front) - 0.015), (at, 0), VERMILLION)
    _arrow(axes, (front + 0.32, 0.028), (front + 0.32, -0.17), BLACK)
    for at in (0.22, 0.36, 0.5):
        _arrow(axes, (wide + 0.2, at + 0.05), (wide, at), GREEN)
        _arrow(axes, (-0.2, at), (0, at), GREEN)
    _arrow(axes, (1.25, 0.57), (1.25, 0.42), GREEN)

    for x, y, text, colour, side in (
        (wide / 2, high + 0.1, r"$\Gamma_1$: clamped, $u=0$", BLACK, "center"),
        (0.24, 0.33, r"$\Omega$", BLACK, "center"),
        (0.75, 0.33, r"$\sigma=\mathcal{A}\varepsilon(\dot u)+\mathcal{G}\varepsilon(u)$", BLACK, "center"),
        (0.34, 0.075, r"$\Gamma_3$", BLUE, "center"),
        (wide + 0.03, 0.06, "gap $w$", BLUE, "left"),
        (0.33, -0.235, "pressure $p$", VERMILLION, "left"),
        (front + 0.36, -0.14, r"$\nu$", BLACK, "left"),
        (wide + 0.12, -0.15, "foundation", BLACK, "right"),
        (wide + 0.22, 0.41, r"$\Gamma_2$: $\sigma\nu=f_2$", GREEN, "left"),
        (-0.2, 0.14, r"$\Gamma_2$", GREEN, "left"),
        (1.28, 0.5, "$f_0$", GREEN, "left"),
    ):
        axes.text(x, y, text, color=colour, ha=side, va="center")
    axes.set(xlim=(-0.3, wide + 0.42), ylim=(-0.36, high + 0.14), aspect="equal")
    axes.axis("off")
    return figure


def caption_sketch() -> str:
    """Return the caption of ``draw_sketch``."""
    return caption("problem")


def _arrow(axes: Axes, start: Any, end: Any, colour: str, head: float = 6, **more: Any) -> None:
    """Draw an arrow between two points; ``head`` is the size of its head in points."""
    style = {"arrowstyle": "-|>", "color": colour, "lw": 0.9, "shrinkA": 0, "shrinkB": 0, "mutation_scale": head}
    axes.annotate("", tuple(end), tuple(start), arrowprops=style, **more)

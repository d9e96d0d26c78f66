"""A sketch of the problem, for those who have not met it: the body, the parts of its boundary, loads and foundation."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import patches
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from study.present.charts.palette import BLACK, BLUE, DARK, GREEN, RAMPS, VERMILLION
from study.present.figures.deformed_mesh import GAP
from study.present.figures.drawing import COLUMN
from study.present.picture.faces import Array

WIDE, HIGH, FRONT = 1.5, 0.62, 0.75
"""Of the body; how far contact reaches along its lower side."""
CAPTION = (
    "The problem: a body Ω is clamped on Γ1, loaded on Γ2 and in its interior, and may touch a rigid foundation along "
    "Γ3, whose outward unit normal is ν. What to see: where there is a gap w = −u_ν > 0 there is no pressure "
    "p = −σ_ν, and where there is a pressure the gap is 0; the front between the two is unknown and moves."
)


def draw_sketch() -> Figure:
    """Nothing on it is computed: the gap is (s − c)_+² and the pressure (c − s)_+ beside a front c."""
    figure = Figure(figsize=(COLUMN, 1.75))
    axes = figure.subplots()
    s = np.linspace(0, WIDE, 61)
    gap = 0.28 * np.maximum(s - FRONT, 0) ** 2
    _draw_body(axes, s, gap)
    _draw_foundation(axes, s, gap)
    _draw_loads(axes)
    axes.set(xlim=(-0.3, WIDE + 0.42), ylim=(-0.36, HIGH + 0.14), aspect="equal")
    axes.axis("off")
    return figure


def _draw_body(axes: Axes, s: Array, gap: Array) -> None:
    lower = np.column_stack([s, gap])
    outline = np.vstack([lower, [[WIDE, HIGH], [0, HIGH]]])
    axes.add_patch(patches.Polygon(outline, facecolor=RAMPS["stress"][0], edgecolor=BLACK, linewidth=0.8))
    clamp: dict[str, Any] = {"facecolor": "none", "edgecolor": DARK, "linewidth": 0, "hatch": "/////"}
    axes.add_patch(patches.Rectangle((0, HIGH), WIDE, 0.05, **clamp))
    axes.plot([0, WIDE], [HIGH, HIGH], color=DARK, lw=1.6)
    axes.plot(*lower.T, color=BLUE, lw=1.6)
    _write(axes, WIDE / 2, HIGH + 0.1, r"$\Gamma_1$: clamped, $u=0$")
    _write(axes, 0.24, 0.33, r"$\Omega$")
    _write(axes, 0.75, 0.33, r"$\sigma=\mathcal{A}\varepsilon(\dot u)+\mathcal{G}\varepsilon(u)$")
    _write(axes, 0.34, 0.075, r"$\Gamma_3$", color=BLUE)


def _draw_foundation(axes: Axes, s: Array, gap: Array) -> None:
    axes.add_patch(patches.Rectangle((-0.12, -0.09), WIDE + 0.24, 0.09, facecolor="0.82", edgecolor="none", zorder=0.5))
    axes.plot([-0.12, WIDE + 0.12], [0, 0], color="0.25", lw=0.6, zorder=0.6)
    axes.fill_between(s, 0 * s, gap, **GAP)
    _write(axes, WIDE + 0.03, 0.06, "gap $w$", color=BLUE, ha="left")
    for at in np.arange(0.06, FRONT, 0.12):
        _arrow(axes, (at, -0.26 * (1 - at / FRONT) - 0.015), (at, 0), VERMILLION)
    _write(axes, 0.33, -0.235, "pressure $p$", color=VERMILLION, ha="left")
    _arrow(axes, (FRONT + 0.32, 0.028), (FRONT + 0.32, -0.17), BLACK)
    _write(axes, FRONT + 0.36, -0.14, r"$\nu$", ha="left")
    _write(axes, WIDE + 0.12, -0.15, "foundation", ha="right")


def _draw_loads(axes: Axes) -> None:
    for at in (0.22, 0.36, 0.5):
        _arrow(axes, (WIDE + 0.2, at + 0.05), (WIDE, at), GREEN)
        _arrow(axes, (-0.2, at), (0, at), GREEN)
    _write(axes, WIDE + 0.22, 0.41, r"$\Gamma_2$: $\sigma\nu=f_2$", color=GREEN, ha="left")
    _write(axes, -0.2, 0.14, r"$\Gamma_2$", color=GREEN, ha="left")
    _arrow(axes, (1.25, 0.57), (1.25, 0.42), GREEN)
    _write(axes, 1.28, 0.5, "$f_0$", color=GREEN, ha="left")


def _arrow(axes: Axes, start: tuple[float, float], end: tuple[float, float], colour: str) -> None:
    style: dict[str, Any] = {"arrowstyle": "-|>", "color": colour, "lw": 0.9, "mutation_scale": 6}
    axes.annotate("", end, start, arrowprops=style | {"shrinkA": 0, "shrinkB": 0})


def _write(axes: Axes, x: float, y: float, text: str, **style: Any) -> None:
    axes.text(x, y, text, **({"ha": "center", "va": "center"} | style))

"""The surface of a solid at six times on one page."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

from manufactured.tensors import Array
from study.present.figures.body import COLOURS, SHADES, SHARE
from study.present.figures.canvas import PAGE, VERMILLION
from study.present.show.storyboard import COLUMNS, MOMENTS
from study.solve.motion import Frame, Motion
from study.solve.von_mises import von_mises

VIEW = {"elev": -25.0, "azim": -60.0}
"""From below: the contact face of a cube is its bottom."""


def draw_surface(name: str, motion: Motion) -> Figure:
    """The magnified deformed surface at six times, coloured by the von Mises stress.

    Vertices in contact are marked, those on hidden faces, too.
    """
    chosen = np.linspace(0, len(motion.frames) - 1, MOMENTS).round().astype(int)
    shown = [motion.frames[n] for n in chosen]
    moved = [motion.space.nodal(frame.u) for frame in shown]
    vertices = motion.space.mesh.p
    largest = max(float(np.linalg.norm(u, axis=0).max()) for u in moved)
    magnification = float(f"{SHARE * np.ptp(vertices) / largest:.1g}") if largest else 1.0
    points = [vertices + magnification * u for u in moved]
    limits = np.column_stack([np.min(points, axis=(0, 2)), np.max(points, axis=(0, 2))])
    stress = max(float(von_mises(frame.stress).max()) for frame in shown) or 1.0
    colours = ScalarMappable(Normalize(0, stress), colormaps[COLOURS].resampled(SHADES))
    figure = Figure(figsize=(PAGE, 4.8))
    panels = figure.subplots(MOMENTS // COLUMNS, COLUMNS, subplot_kw={"projection": "3d", "computed_zorder": False})
    for axes, frame, x in zip(panels.flat, shown, points, strict=True):
        _draw_moment(axes, motion, frame, x, colours)
        axes.set(xlim=limits[0], ylim=limits[1], zlim=limits[2], title=f"$t={frame.time:.3g}$")
        axes.set_box_aspect(np.ptp(limits, axis=1))
    bar = figure.colorbar(colours, ax=list(panels.flat), shrink=0.7, fraction=0.04)
    bar.set_label(r"von Mises stress $\sqrt{3/2}\,|\mathrm{dev}\,\sigma|$")
    figure.suptitle(
        rf"{name} ({motion.family}, $n={motion.level}$) from below, displacement $\times\,{magnification:.2g}$; "
        "dots are vertices in contact, hidden ones too"
    )
    return figure


def _draw_moment(axes: Any, motion: Motion, frame: Frame, x: Array, colours: ScalarMappable) -> None:
    """The surface with the vertices at x, (3, n), in three-dimensional axes."""
    facets, stress = _surface(motion, frame)
    faces: dict[str, Any] = {"facecolors": colours.to_rgba(stress), "edgecolors": (0, 0, 0, 0.3), "linewidths": 0.2}
    axes.add_collection3d(Poly3DCollection(x.T[facets.T], **faces))
    axes.scatter(*x[:, _touching(motion, frame)], color=VERMILLION, s=4, depthshade=False, zorder=3)
    axes.view_init(**VIEW)
    axes.set_axis_off()


def _surface(motion: Motion, frame: Frame) -> tuple[Array, Array]:
    """The facets of the boundary, (3, n), and the stress of their cells."""
    mesh = motion.space.mesh
    boundary = mesh.boundary_facets()
    return mesh.facets[:, boundary], von_mises(frame.stress)[mesh.f2t[0, boundary]]


def _touching(motion: Motion, frame: Frame) -> Array:
    """The vertices with a contact force."""
    vertices = np.concatenate([vertices for _, vertices in motion.space.contact])
    return np.unique(vertices[frame.multipliers > 0])

"""The foundation of a face in the plane, with the computed contact zone and pressure."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib import patches
from matplotlib.axes import Axes

from study.present.charts.palette import BLACK, VERMILLION
from study.present.figures.body_scale import BodyScale
from study.present.picture.proportions import ARROW, FOUNDATION
from study.present.picture.segment import Segment

ARROWS = 16
"""At most about so many on a face."""


def draw_foundation(axes: Axes, face: Segment, instant: int, scale: BodyScale) -> None:
    """Grey, with a thick black line where the body lies on it, and arrows that end on it where it presses."""
    ends = face.x[:, [face.s.argmin(), face.s.argmax()]]
    depth = FOUNDATION * scale.size * face.normal[:, None]
    axes.add_patch(
        patches.Polygon(np.hstack([ends, ends[:, ::-1] + depth]).T, facecolor="0.82", edgecolor="none", zorder=0.5)
    )
    axes.plot(*ends, color="0.25", lw=0.6, solid_capstyle="butt", zorder=2.5)
    for interval in face.computed_zone(instant):
        axes.plot(*face.point(np.array(interval)), color=BLACK, lw=1.8, solid_capstyle="butt", zorder=2.6)
    _draw_arrows(axes, face, instant, scale)


def _draw_arrows(axes: Axes, face: Segment, instant: int, scale: BodyScale) -> None:
    every = max(1, round(len(face.s) / ARROWS))
    shown = np.flatnonzero(face.touching[instant])
    shown = shown[shown % every == 0]
    length = ARROW * scale.size * face.pressure[instant, shown] / (scale.pressure or 1.0)
    arrows = -face.normal[:, None] * length
    style: dict[str, Any] = {"angles": "xy", "scale_units": "xy", "scale": 1, "pivot": "tip", "units": "xy"}
    axes.quiver(*face.x[:, shown], *arrows, color=VERMILLION, width=0.012 * scale.size, minlength=0, zorder=3, **style)

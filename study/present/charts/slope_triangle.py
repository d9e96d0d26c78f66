"""Where the triangle with the expected slope is placed in a logarithmic chart."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from study.present.charts.chart import Curve, SlopeTriangle


def slope_triangle(curves: Sequence[Curve], slope: float, decades: float, small: bool = False) -> SlopeTriangle | None:
    """Above the left end of the curves, which an increasing curve leaves free.

    ``decades`` is the height of the axes, from which distances are taken. In a ``small`` chart the slope stands
    above the triangle, where there is room. None without an expected slope, or where all curves have one point.
    """
    if math.isnan(slope) or max(len(curve.x) for curve in curves) < 2:
        return None
    left = min(math.log10(curve.x.min()) for curve in curves)
    width = max(math.log10(curve.x.max()) for curve in curves) - left
    start, end = left + 0.09 * width, left + 0.37 * width
    base = _intercept(curves, slope, start, end) + 0.07 * decades
    top = base + slope * (end - start)
    texts = ("", f"{slope:.3g}") if small else (f"{slope:.3g}", "1")
    corners = 10 ** np.array([[start, base], [end, top], [start, top]])
    return SlopeTriangle(corners, *texts, top=float(10 ** (top + (0.16 if small else 0.07) * decades)))


def _intercept(curves: Sequence[Curve], slope: float, start: float, end: float) -> float:
    """The smallest b such that b + slope (x − start) lies above all curves between start and end (logarithms)."""
    highest = -math.inf
    for curve in curves:
        order = np.argsort(curve.x)
        x, y = np.log10(curve.x[order]), np.log10(curve.y[order])
        at = np.concatenate([x[(x > start) & (x < end)], np.clip([start, end], x[0], x[-1])])
        highest = max(highest, float((np.interp(at, x, y) - slope * (at - start)).max()))
    return highest

"""Logarithmic axes: limits, few readable ticks, and a slope triangle that keeps clear of the curves."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter
from numpy.typing import NDArray

Array = NDArray[np.float64]
Curve = tuple[Array, Array]
"""Abscissae in increasing order, and ordinates; all positive."""

_STEPS = ((1,), (1, 3), (1, 2, 5), (1, 1.5, 2, 3, 5, 7), (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8, 9))


def set_ticks(axis: Axis, limits: tuple[float, float], least: int = 3) -> None:
    """The coarsest labelled ticks of which at least ``least`` lie within the limits."""
    low, high = limits
    for steps in _STEPS:
        decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
        ticks = [tick for tick in (step * 10.0**k for k in decades for step in steps) if low <= tick <= high]
        if len(ticks) >= least:
            break
    plain = low >= 1e-3 and high < 1e4
    axis.set_major_locator(FixedLocator(ticks))
    axis.set_major_formatter(FuncFormatter(lambda tick, _: f"{tick:.4g}" if plain else _power(tick)))
    axis.set_minor_locator(LogLocator(subs=tuple(range(2, 10)), numticks=99))
    axis.set_minor_formatter(NullFormatter())


def slope_triangle(axes: Axes, curves: Sequence[Curve], slope: float, height: float, small: bool = False) -> float:
    """Draw a triangle of the given slope above the left end of the curves; returns how high it reaches.

    The hypotenuse runs parallel to the expected curves, the right angle is at its upper left, where an
    increasing curve cannot be. ``height`` is the height of the axes in decades, from which distances
    are taken. In a ``small`` panel the slope stands above the triangle, where there is room. Without
    an expected slope, or with a single level, there is nothing to draw, and the height is 0.
    """
    if math.isnan(slope) or max(len(x) for x, _ in curves) < 2:
        return 0.0
    left = min(math.log10(x[0]) for x, _ in curves)
    width = max(math.log10(x[-1]) for x, _ in curves) - left
    start, end = left + 0.09 * width, left + 0.37 * width
    base = _envelope(curves, slope, start, end) + 0.07 * height
    corners = 10 ** np.array(
        [[start, base], [end, base + slope * (end - start)], [start, base + slope * (end - start)]]
    )
    axes.fill(*corners.T, facecolor="0.93", edgecolor="0.35", lw=0.6, zorder=1.5)
    (x0, y0), (x1, y1), _ = corners
    beside, above = ((x0, math.sqrt(y0 * y1)), (math.sqrt(x0 * x1), y1))
    texts = {above: f"{slope:.3g}"} if small else {beside: f"{slope:.3g}", above: "1"}
    for at, text in texts.items():
        shift, sides = ((0, 1.5), ("center", "bottom")) if at == above else ((-2, 0), ("right", "center"))
        axes.annotate(text, at, shift, textcoords="offset points", ha=sides[0], va=sides[1], fontsize=7)
    return float(y1 * 10 ** ((0.16 if small else 0.07) * height))


def _envelope(curves: Sequence[Curve], slope: float, start: float, end: float) -> float:
    """The smallest b such that b + slope (x − start) lies above all curves between start and end (logarithms)."""
    highest = -math.inf
    for x, y in curves:
        nodes = np.log10(x)
        at = np.concatenate([nodes[(nodes > start) & (nodes < end)], np.clip([start, end], nodes[0], nodes[-1])])
        highest = max(highest, float((np.interp(at, nodes, np.log10(y)) - slope * (at - start)).max()))
    return highest


def _power(tick: float) -> str:
    exponent = math.floor(math.log10(tick) + 1e-9)
    mantissa = tick / 10**exponent
    return rf"$10^{{{exponent}}}$" if abs(mantissa - 1) < 1e-9 else rf"${mantissa:.3g}\cdot10^{{{exponent}}}$"

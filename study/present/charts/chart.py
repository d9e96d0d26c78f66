"""What a chart shows, as plain data: computed once, drawn by Matplotlib for figures and as SVG on the page.

Texts are plain Unicode with scripts as in u^h and x_{ij}; each renderer sets them in its own way.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from study.present.charts.axis import Axis

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Style:
    """How a curve or, in the legend, a band is drawn; ``marker`` is a name in Matplotlib, "" for none."""

    colour: str
    stroke: Literal["solid", "dashed", "dotted", "band"] = "solid"
    marker: str = ""
    hollow: bool = False


@dataclass(frozen=True, eq=False)
class Curve:
    """A line through points, (n,) each."""

    x: Array
    y: Array
    style: Style


@dataclass(frozen=True, eq=False)
class Band:
    """What lies between two curves, (n,) each."""

    x: Array
    low: Array
    high: Array
    colour: str


@dataclass(frozen=True, eq=False)
class SlopeTriangle:
    """A triangle whose hypotenuse has the expected slope and whose right angle is at its upper left.

    Attributes:
        corners: lower left, upper right, upper left, (3, 2).
        beside, above: texts at the middle of the left and of the upper side.
        top: how high the triangle and its texts reach.
    """

    corners: Array
    beside: str
    above: str
    top: float


@dataclass(frozen=True, eq=False)
class Subplot:
    """One pair of axes.

    Attributes:
        title: above the axes.
        x, y: the axes.
        curves: in the order in which they are drawn.
        bands: drawn under the curves.
        triangle: shows the expected slope.
        rules: values of y with a horizontal line.
    """

    title: str
    x: Axis
    y: Axis
    curves: Sequence[Curve]
    bands: Sequence[Band] = ()
    triangle: SlopeTriangle | None = None
    rules: Sequence[float] = ()


@dataclass(frozen=True)
class LegendEntry:
    """A line of the legend."""

    text: str
    style: Style


@dataclass(frozen=True, eq=False)
class Chart:
    """Subplots, one above the other or in a grid, with one legend.

    Attributes:
        summary: one line for those who cannot see the chart.
        subplots: row by row.
        legend: its columns.
        caption: what is shown and what to see, with numbers from the same data.
        columns: of the grid.
    """

    summary: str
    subplots: Sequence[Subplot]
    legend: Sequence[Sequence[LegendEntry]]
    caption: str
    columns: int = 1

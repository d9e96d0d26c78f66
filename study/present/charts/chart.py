"""What a chart shows, as plain data: computed once, drawn by Matplotlib for figures and as SVG on the page.

Texts are plain Unicode with scripts as in u^h and x_{ij}; each renderer sets them in its own way.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import NDArray

MARGIN = 0.06
"""Of the range, on each side."""
_MANTISSAS = ((1,), (1, 3), (1, 2, 5), (1, 1.5, 2, 3, 5, 7), (1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8, 9))


@dataclass(frozen=True)
class LogAxis:
    """A logarithmic axis with at least ``least`` ticks in its range; its label is a text and a symbol in italics."""

    scale: ClassVar[str] = "log"
    label: str
    low: float
    high: float
    symbol: str = ""
    least: int = 3

    @classmethod
    def around(cls, label: str, low: float, high: float, symbol: str = "", least: int = 3) -> LogAxis:
        """With a margin on each side, of half a decade around a single value."""
        decades = math.log10(high / low)
        margin = 10 ** (MARGIN * decades if decades > 0.01 else 0.5)
        return cls(label, low / margin, high * margin, symbol, least)

    def position(self, value: float) -> float:
        """0 at the lower end, 1 at the upper one; what is not positive lies far below the axis."""
        return math.log10(max(value / self.low, 1e-9)) / math.log10(self.high / self.low)

    def ticks(self) -> list[tuple[float, str]]:
        """The coarsest round values of which there are enough, with their texts; in a short range, at equal steps.

        Very small or large ones have powers of ten in their texts.
        """
        decades = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)) + 1)
        plain = self.low >= 1e-3 and self.high < 1e4
        for mantissas in _MANTISSAS:
            ticks = [tick for k in decades for m in mantissas if self.low <= (tick := m * 10.0**k) <= self.high]
            if len(ticks) >= self.least:
                return [(tick, f"{tick:.4g}" if plain else _power(tick)) for tick in ticks]
        return LinearAxis("", self.low, self.high).ticks()


@dataclass(frozen=True)
class LinearAxis:
    """An axis of equal steps, otherwise like a logarithmic one."""

    scale: ClassVar[str] = "linear"
    label: str
    low: float
    high: float
    symbol: str = ""

    @classmethod
    def around(cls, label: str, low: float, high: float, symbol: str = "") -> LinearAxis:
        """With a margin on each side, of one half around a single value."""
        margin = MARGIN * (high - low) or 0.5
        return cls(label, low - margin, high + margin, symbol)

    def position(self, value: float) -> float:
        return (value - self.low) / (self.high - self.low)

    def ticks(self) -> list[tuple[float, str]]:
        """At the multiples of 1, 2 or 5 times a power of ten, at most seven of them."""
        unit = 10.0 ** math.floor(math.log10(self.high - self.low)) / 10
        step = next(unit * m for m in (1, 2, 5, 10, 20) if (self.high - self.low) / (unit * m) <= 6)
        multiples = np.arange(math.ceil(self.low / step - 1e-9), math.floor(self.high / step + 1e-9) + 1)
        return [(float(step * n), f"{step * n:.4g}") for n in multiples]


Axis = LogAxis | LinearAxis


def _power(tick: float) -> str:
    exponent = math.floor(math.log10(tick) + 1e-9)
    mantissa = tick / 10**exponent
    power = f"10^{{{exponent}}}".replace("-", "−")
    return power if abs(mantissa - 1) < 1e-9 else f"{mantissa:.3g}·{power}"


Array = NDArray[np.float64]


@dataclass(frozen=True)
class Style:
    """How a curve or, in the legend, a band is drawn; ``marker`` is a name in Matplotlib, "" for none."""

    colour: str
    marker: str = ""
    stroke: Literal["solid", "dashed", "dotted", "band"] = "solid"
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
    """A triangle with the expected slope and a right angle at its upper left, up to ``top`` with its texts.

    ``corners`` are lower left, upper right and upper left, (3, 2); texts are beside the left and above the upper side.
    """

    corners: Array
    beside: str
    above: str
    top: float


@dataclass(frozen=True, eq=False)
class Subplot:
    """One pair of axes: bands under curves, the expected slope, and values of y with a horizontal line."""

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
    """Subplots, one above the other or row by row in a grid of so many columns, with one legend, column by column.

    ``summary`` is one line for those who cannot see the chart, ``caption`` says what to see, with numbers.
    """

    summary: str
    subplots: Sequence[Subplot]
    legend: Sequence[Sequence[LegendEntry]]
    caption: str
    columns: int = 1

"""Plots as numbers for SVG: lines, bands and dots in the coordinates of a view box, ticks with their texts."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from study.present.figures.canvas import looks

WIDTH, HEIGHT = 360, 270
LEFT, RIGHT, TOP, BOTTOM = 52, 350, 10, 232
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
"""Okabe and Ito; in the order of levels."""
MARKERS = {
    "o": "M-3.5,0a3.5,3.5 0 1,0 7,0a3.5,3.5 0 1,0 -7,0z",
    "s": "M-3,-3h6v6h-6z",
    "^": "M0,-4L3.8,3H-3.8z",
    "v": "M0,4L3.8,-3H-3.8z",
    "D": "M0,-4.2L4.2,0L0,4.2L-4.2,0z",
}

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Scale:
    """From values to coordinates.

    Attributes:
        low, high: values at the ends, positive where logarithmic.
        start, end: their coordinates.
        logarithmic: whether equal quotients have equal distances.
    """

    low: float
    high: float
    start: float
    end: float
    logarithmic: bool = True

    def __call__(self, value: float) -> float:
        """The coordinate of a value."""
        a, b, v = (math.log10(x) if self.logarithmic else x for x in (self.low, self.high, value))
        return round(self.start + (v - a) / ((b - a) or 1) * (self.end - self.start), 2)

    def ticks(self) -> list[tuple[float, str]]:
        """Coordinates and texts of round values: quarters, or decades and, where these are few, values between."""
        if not self.logarithmic:
            return [(self(v), f"{v:g}") for v in np.linspace(self.low, self.high, 5)]
        decades = range(math.floor(math.log10(self.low)), math.ceil(math.log10(self.high)) + 1)
        ratio = self.high / self.low
        steps = (1, 2, 3, 5, 7) if ratio < 10 else (1, 2, 5) if ratio < 100 else (1,)
        values = [float(f"{step}e{decade}") for decade in decades for step in steps]
        return [(self(v), f"{v:g}") for v in values if self.low <= v <= self.high]


@dataclass(frozen=True)
class Key:
    """A line of a legend."""

    text: str
    colour: str
    marker: str = ""


@dataclass(frozen=True)
class Stroke:
    """A path; a band where ``fill``."""

    d: str
    colour: str
    dash: str = ""
    fill: bool = False


@dataclass
class Chart:
    """A plot: its name for those who cannot see it, its scales, and what is drawn."""

    name: str
    x: Scale
    y: Scale
    x_label: str
    y_label: str
    strokes: list[Stroke] = field(default_factory=list)
    dots: list[tuple[float, float, str, str]] = field(default_factory=list)
    legend: list[Key] = field(default_factory=list)

    def line(self, x: Sequence[float] | Array, y: Sequence[float] | Array, colour: str, dash: str = "") -> None:
        """A line through points."""
        self.strokes.append(Stroke(_path(self._points(x, y)), colour, dash))

    def band(self, x: Array, low: Array, high: Array, colour: str) -> None:
        """What lies between two lines."""
        outline = [*self._points(x, high), *reversed(self._points(x, low))]
        self.strokes.append(Stroke(_path(outline) + "Z", colour, fill=True))

    def markers(self, x: Array, y: Array, colour: str, marker: str) -> None:
        """Dots at points; shapes without one of their own are round."""
        shape = MARKERS.get(marker, MARKERS["o"])
        self.dots += [(*point, colour, shape) for point in self._points(x, y)]

    def _points(self, x: Sequence[float] | Array, y: Sequence[float] | Array) -> list[tuple[float, float]]:
        low, high = self.y.low, self.y.high
        return [(self.x(float(a)), self.y(float(np.clip(b, low, high)))) for a, b in zip(x, y, strict=True)]


def convergence(rates: pd.DataFrame, expected: float) -> Chart:
    """Error and discrete error of a case against h on every mesh family, and a line of the predicted order."""
    h = rates["h"].to_numpy()
    ends = np.array([h.min(), h.max()])
    slope = 1.6 * float((rates["error"] / rates["h"] ** expected).max()) * ends**expected
    shown = np.concatenate([rates["error"], rates["discrete_error"], slope])
    chart = Chart(
        "errors against the mesh size, both logarithmic",
        Scale(h.min() / 1.15, h.max() * 1.15, LEFT, RIGHT),
        _positive(shown, BOTTOM, TOP),
        "h",
        "error",
    )
    for family, look in looks(rates["family"]).items():
        rows = rates[rates["family"] == family].sort_values("h")
        of_family = rows["h"].to_numpy()
        chart.line(of_family, rows["discrete_error"].to_numpy(), look.colour, "2 3")
        chart.line(of_family, rows["error"].to_numpy(), look.colour)
        chart.markers(of_family, rows["error"].to_numpy(), look.colour, look.marker)
        chart.legend.append(Key(family, look.colour, MARKERS.get(look.marker, MARKERS["o"])))
    chart.line(ends, slope, "currentColor", "7 3")
    return chart


def enclosure(series: pd.DataFrame) -> Chart:
    """Bands [d − y, d + y] around the error over time, one for every level, from rows of ``enclosures.csv``."""
    rows = series.assign(low=series["distance"] - series["bound"], high=series["distance"] + series["bound"])
    known = rows["error"].notna().all()
    middle = "error" if known else "distance"
    values = rows[["high", middle]].to_numpy()
    chart = Chart(
        "error over time between its guaranteed bounds, logarithmic",
        Scale(0.0, float(rows["time"].max()), LEFT, RIGHT, logarithmic=False),
        _positive(values, BOTTOM, TOP),
        "time t",
        "error",
    )
    for (level, of_level), colour in zip(rows.groupby("level"), COLOURS, strict=False):
        time = of_level["time"].to_numpy()
        chart.band(time, of_level["low"].to_numpy(), of_level["high"].to_numpy(), colour)
        chart.line(time, of_level[middle].to_numpy(), colour)
        chart.legend.append(Key(f"n = {level}", colour))
    return chart


@dataclass(frozen=True)
class Strip:
    """Orders of one case on a line from 0 to ``HIGHEST``: what is predicted, and what each mesh family shows."""

    HIGHEST = 1.5
    WIDTH = 150

    predicted: float
    seen: list[tuple[float, str]]

    @classmethod
    def of(cls, rates: pd.DataFrame, expected: float) -> Strip:
        """From the orders of every family."""
        colours = looks(rates["family"])
        return cls(
            cls._at(expected),
            [(cls._at(order), colours[str(family)].colour) for family, order in finest_orders(rates).items()],
        )

    @classmethod
    def _at(cls, order: float) -> float:
        return round(cls.WIDTH * min(max(order / cls.HIGHEST, 0.0), 1.0), 1)


def finest_orders(rates: pd.DataFrame) -> dict[str, float]:
    """The order of the error of a case over the last two refinements (or one) on every mesh family.

    A front that is fixed, or a jump of the material, lies alike in the cells of these levels.
    """
    found = {}
    for family, rows in rates.groupby("family", sort=False):
        ends = rows.sort_values("level").tail(3)[["h", "error"]].to_numpy()[[0, -1]]
        if len(rows) > 1 and (ends[:, 1] > 0).all():
            found[str(family)] = float(np.log(ends[0, 1] / ends[1, 1]) / np.log(ends[0, 0] / ends[1, 0]))
    return found


def _positive(values: Array, start: float, end: float) -> Scale:
    """A logarithmic scale for the positive ones of some values, with room around them."""
    positive = values[values > 0]
    low, high = (positive.min(), positive.max()) if len(positive) else (0.1, 1.0)
    return Scale(float(low) / 1.4, float(high) * 1.8, start, end)


def _path(points: Iterable[tuple[float, float]]) -> str:
    return "M" + "L".join(f"{x:g},{y:g}" for x, y in points)

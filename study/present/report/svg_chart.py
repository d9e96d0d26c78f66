"""Texts in HTML and SVG, and a chart as SVG: paths and texts in a view box, which ``macros.html`` writes out."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup, escape

from study.present.charts.chart import Array, Axis, Chart, Style, Subplot
from study.present.charts.palette import BLACK, DARK

_SCRIPT = re.compile(r"(?<=\S)([\^_])(\{(?:[^{}]|\{[^{}]*\})*\}|\([^()]*\)|\d+(?:\.\d+)?|[\w+−∞])")
_TAGS = {"^": "sup", "_": "sub"}
_OFFSETS = {"": 0.0, "^": -0.35, "_": 0.2}
_SIZE = 0.72
"""Of scripts, and how far their baseline is below that of the line, both in font sizes of the line."""


def typeset(text: str) -> Markup:
    """Escaped text in which x^y, x_y, x^∞, x^{yz}, x^1.5 and x^(1+s) have scripts; braces of scripts are dropped."""
    out = Markup()
    for piece, script in _pieces(text):
        tag = Markup(_TAGS.get(script, ""))
        out += Markup("<{0}>{1}</{0}>").format(tag, typeset(piece)) if script else escape(piece)
    return out


def typeset_svg(text: str) -> Markup:
    """The same as the content of a text element; scripts of scripts stand on their line."""
    out, baseline = Markup(), 0.0
    for piece, script in _pieces(text):
        size = _SIZE if script else 1.0
        shift = Markup('<tspan dy="{:.3g}em" font-size="{:g}em">{}</tspan>')
        out += shift.format((_OFFSETS[script] - baseline) / size, size, piece)
        baseline = _OFFSETS[script]
    return out


def _pieces(text: str) -> Iterator[tuple[str, str]]:
    """Pieces of a line, each with "^" or "_" for a script and "" for the line itself."""
    end = 0
    for match in _SCRIPT.finditer(text):
        if match.start() > end:
            yield text[end : match.start()], ""
        yield match[2][1:-1] if match[2].startswith("{") else match[2], match[1]
        end = match.end()
    if end < len(text):
        yield text[end:], ""


WIDTH, LEFT, RIGHT, TOP = 360, 58, 350, 10
HEIGHTS = (222, 120)
"""Of the subplots, from above."""
BETWEEN, BELOW = 14, 38
"""Heights between subplots, and for ticks and label of the last one."""
MARKERS = {
    "o": "M-3.5,0a3.5,3.5 0 1,0 7,0a3.5,3.5 0 1,0 -7,0z",
    "s": "M-3,-3h6v6h-6z",
    "^": "M0,-4L3.8,3H-3.8z",
    "v": "M0,4L3.8,-3H-3.8z",
    "D": "M0,-4.2L4.2,0L0,4.2L-4.2,0z",
}
Points = list[tuple[float, float]]


@dataclass(frozen=True)
class SvgAxis:
    """An axis between two coordinates."""

    axis: Axis
    start: float
    end: float

    def __call__(self, value: float) -> float:
        """The coordinate of a value; far outside of the axis all are the same."""
        return round(self.start + float(np.clip(self.axis.position(value), -2, 3)) * (self.end - self.start), 2)

    @property
    def ticks(self) -> list[tuple[float, Markup]]:
        """Coordinates and texts."""
        return [(self(value), typeset_svg(text)) for value, text in self.axis.ticks()]

    @property
    def middle(self) -> float:
        """Where the label is centred."""
        return (self.start + self.end) / 2

    @property
    def label(self) -> Markup:
        """The text with its symbol in italics."""
        symbol = Markup(' <tspan font-style="italic">{}</tspan>').format(self.axis.symbol) if self.axis.symbol else ""
        return typeset_svg(self.axis.label) + symbol


@dataclass(frozen=True)
class SvgSubplot:
    """One pair of axes."""

    subplot: Subplot
    x: SvgAxis
    y: SvgAxis

    @property
    def bands(self) -> list[tuple[str, str]]:
        """Path and colour of each."""
        found = [(self._points(band.x, band.high), self._points(band.x, band.low), band) for band in self.subplot.bands]
        return [(path([*above, *reversed(below)]) + "Z", band.colour) for above, below, band in found]

    @property
    def curves(self) -> list[tuple[str, Points, dict[str, str]]]:
        """Path, places of markers and style of each."""
        found = [(self._points(curve.x, curve.y), svg_style(curve.style)) for curve in self.subplot.curves]
        return [(path(points), points, style) for points, style in found]

    @property
    def rules(self) -> list[float]:
        """Coordinates of horizontal lines."""
        return [self.y(value) for value in self.subplot.rules]

    @property
    def triangle(self) -> Points:
        """Corners of the triangle with the expected slope, or none."""
        found = self.subplot.triangle
        return self._points(*found.corners.T) if found else []

    def _points(self, x: Array, y: Array) -> Points:
        return [(self.x(a), self.y(b)) for a, b in zip(x, y, strict=True) if np.isfinite(b)]


@dataclass(frozen=True)
class SvgChart:
    """Subplots one above the other."""

    chart: Chart

    @property
    def subplots(self) -> list[SvgSubplot]:
        """From above."""
        found, top = [], TOP
        for subplot, height in zip(self.chart.subplots, HEIGHTS, strict=False):
            found.append(SvgSubplot(subplot, SvgAxis(subplot.x, LEFT, RIGHT), SvgAxis(subplot.y, top + height, top)))
            top += height + BETWEEN
        return found

    @property
    def height(self) -> float:
        """Of the view box."""
        return self.subplots[-1].y.start + BELOW

    @property
    def legend(self) -> list[tuple[str, dict[str, str]]]:
        """Texts and styles."""
        return [(entry.text, svg_style(entry.style)) for column in self.chart.legend for entry in column]


def svg_style(style: Style) -> dict[str, str]:
    """A style in the words of SVG: the colour, the class of the line, the path of the marker around 0 and its fill.

    What is black or dark on paper has the colour of the text, on dark screens, too. Markers without a path of their own
    are round.
    """
    colour = "currentColor" if style.colour in (BLACK, DARK) else style.colour
    marker = MARKERS.get(style.marker, MARKERS["o"]) if style.marker else ""
    fill = "var(--paper)" if style.hollow else colour
    return {"colour": colour, "stroke": style.stroke, "marker": marker, "fill": fill}


def path(points: Iterable[tuple[float, float]]) -> str:
    """A line through points."""
    return "M" + "L".join(f"{x:g},{y:g}" for x, y in points)

"""All colours of figures, animations and the report page, and the line style of each mesh family."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import cycle
from typing import Literal

# Colours of Okabe and Ito, Color Universal Design (2008); their yellow is too light for lines.
BLUE, VERMILLION, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
ORANGE, SKY, BLACK = "#E69F00", "#56B4E9", "#000000"
GREY, DARK = "#8C8C8C", "#4D4D4D"
OUTLINE, RIM, SURFACE = "0.35", "0.4", "0.6"
FOUNDATION, FOUNDATION_EDGE, TRIANGLE = "0.82", "0.25", "0.93"
COLOURS = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY)
"""Colours of the first, second, … line in a figure."""

RAMPS = {
    "stress": ("#ffffd9", "#edf8b1", "#c7e9b4", "#7fcdbb", "#41b6c4", "#1d91c0", "#225ea8", "#253494", "#081d58"),
    "pressure": ("#fff7ec", "#fee8c8", "#fdd49e", "#fdbb84", "#fc8d59", "#ef6548", "#d7301f", "#b30000", "#7f0000"),
    "gap": ("#fff7fb", "#ece7f2", "#d0d1e6", "#a6bddb", "#74a9cf", "#3690c0", "#0570b0", "#045a8d", "#023858"),
}
"""Quantity ↦ colours from zero to the largest value: YlGnBu, OrRd and PuBu of ColorBrewer (Harrower and Brewer 2003).

Larger values have darker colours, so that figures can be read in grey; small values leave the mesh visible.
"""
_LIGHT = {
    "paper": "#fff", "ink": "#1a1a1a", "soft": "#595959", "rule": "#d0d0d0", "shade": "#f4f4f2", "link": "#00558a",
    "blue": BLUE, "vermillion": VERMILLION, "green": GREEN, "ground": "#bdbdbd", "good": "#00694d", "bad": "#a84300",
    "focus": BLUE, "rim": "#444", "text": "#1a1a1a", "halo": "#fff",
}  # fmt: skip
_DARK = {
    "paper": "#16181a", "ink": "#e8e8e6", "soft": "#a9a9a6", "rule": "#44484c", "shade": "#1f2225", "link": "#7cc4f0",
    "blue": SKY, "vermillion": "#EE8434", "green": "#2BBD93", "ground": "#5a5f63", "good": "#4fd0a8", "bad": "#ff9d5c",
    "focus": "#7cc4f0",
}  # fmt: skip
PAGE = {"light": _LIGHT, "dark": _LIGHT | _DARK}
"""CSS variables of the report page, for light and for dark pages."""


Stroke = Literal["solid", "dashed", "dotted", "none", "band"]


@dataclass(frozen=True)
class Style:
    """The style of a curve or, in a legend, of a band.

    Attributes:
        colour: the colour.
        marker: Matplotlib's name of the marker; empty for no marker.
        stroke: how the line is drawn; "band" marks the legend entry of a band.
        hollow: whether markers are filled white.
    """

    colour: str
    marker: str = ""
    stroke: Stroke = "solid"
    hollow: bool = False


_FAMILIES = {
    "one-diagonal": Style(BLUE, "o"),
    "criss-cross": Style(VERMILLION, "s"),
    "shaken": Style(GREEN, "^"),
    "unstructured": Style(PURPLE, "D"),
    "graded": Style(ORANGE, "v"),
}
_OTHERS = (Style(SKY, "P"), Style(BLACK, "X"), Style(GREY, "h"))


def family_styles(families: Iterable[str]) -> dict[str, Style]:
    """Return mesh family ↦ style. Families that are not in ``_FAMILIES`` get the styles ``_OTHERS``, alphabetically."""
    names = set(families)
    known = {name: style for name, style in _FAMILIES.items() if name in names}
    return known | dict(zip(sorted(names - set(known)), cycle(_OTHERS), strict=False))

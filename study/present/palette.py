"""Where figures, animations and the report page use colours, and the line style of each mesh family."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import cycle
from typing import Literal

import numpy as np
from matplotlib.colors import to_hex, to_rgb

from manufactured.colours import BLACK as BLACK
from manufactured.colours import BLUE as BLUE
from manufactured.colours import DARK as DARK
from manufactured.colours import GREEN as GREEN
from manufactured.colours import GREY as GREY
from manufactured.colours import ORANGE as ORANGE
from manufactured.colours import PURPLE as PURPLE
from manufactured.colours import SKY as SKY
from manufactured.colours import VERMILLION as VERMILLION

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
CONTRAST = 4.5
"""The contrast of text that the Web Content Accessibility Guidelines 2.2 ask for (criterion 1.4.3)."""


def luminance(colour: str) -> float:
    """Return the relative luminance of a colour #RRGGBB, from 0 for black to 1 for white, as those guidelines do."""
    rgb = np.array(to_rgb(colour))
    linear = np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)
    return float(linear @ (0.2126, 0.7152, 0.0722))


def contrast(one: str, other: str) -> float:
    """Return the contrast of two colours, from 1 to 21."""
    low, high = sorted((luminance(one), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def readable(colour: str, background: str) -> str:
    """Return a colour mixed with as little black or white as makes it readable as text on a background."""
    end = np.full(3, float(luminance(background) < 0.2))
    mixed = (to_hex((1 - share) * np.array(to_rgb(colour)) + share * end) for share in np.linspace(0, 1, 101))
    return next(shade for shade in mixed if contrast(shade, background) >= CONTRAST)


def _page(**greys: str) -> dict[str, str]:
    """Return the CSS variables of a page from its greys; colours are readable on tinted lines of tables, ``shade``."""
    hues = {"blue": BLUE, "link": BLUE, "focus": BLUE, "green": GREEN, "good": GREEN, "vermillion": VERMILLION}
    hues |= {"bad": VERMILLION, "warn": ORANGE}
    pictures = {"rim": "#444", "text": "#1a1a1a", "halo": "#fff"}  # the same on both pages, as ``RAMPS`` are
    return {**pictures, **greys, **{name: readable(colour, greys["shade"]) for name, colour in hues.items()}}


PAGE = {
    "light": _page(paper="#fff", ink="#1a1a1a", soft="#595959", rule="#d0d0d0", shade="#f4f4f2", ground="#bdbdbd"),
    "dark": _page(paper="#16181a", ink="#e8e8e6", soft="#a9a9a6", rule="#44484c", shade="#1f2225", ground="#5a5f63"),
}
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

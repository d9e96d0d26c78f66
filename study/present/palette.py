"""Where figures and animations use colours, and the line style of each mesh family.

The colours of the report page are in ``page/page.css``.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import cycle
from typing import Literal

from manufactured.colours import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILLION

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

"""Colours, and the look of a mesh family, the same in every figure and on the page."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import cycle

from study.present.charts.chart import Style

# Okabe and Ito, Color Universal Design (2008); their yellow is too light for lines.
BLUE, VERMILLION, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
ORANGE, SKY, BLACK = "#E69F00", "#56B4E9", "#000000"
GREY, DARK = "#8C8C8C", "#4D4D4D"
COLOURS = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY)
"""In the order in which lines are coloured."""

_KNOWN = {
    "one-diagonal": Style(BLUE, "o"),
    "criss-cross": Style(VERMILLION, "s"),
    "shaken": Style(GREEN, "^"),
    "unstructured": Style(PURPLE, "D"),
    "graded": Style(ORANGE, "v"),
}
_SPARE = (Style(SKY, "P"), Style(BLACK, "X"), Style(GREY, "h"))


def looks(families: Iterable[str]) -> dict[str, Style]:
    """The look of each mesh family; families without one of their own get spare ones in alphabetical order."""
    names = set(families)
    known = {name: look for name, look in _KNOWN.items() if name in names}
    return known | dict(zip(sorted(names - set(known)), cycle(_SPARE), strict=False))

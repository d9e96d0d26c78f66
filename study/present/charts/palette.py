"""Colours, and the look of a mesh family, the same in every figure and on the page."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import cycle

# Okabe and Ito, Color Universal Design (2008); their yellow is too light for lines.
BLUE, VERMILLION, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
ORANGE, SKY, BLACK = "#E69F00", "#56B4E9", "#000000"
GREY, DARK = "#8C8C8C", "#4D4D4D"
COLOURS = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY)
"""In the order in which lines are coloured."""


@dataclass(frozen=True)
class Look:
    """A colour, and a marker by its name in Matplotlib."""

    colour: str
    marker: str


_KNOWN = {
    "one-diagonal": Look(BLUE, "o"),
    "criss-cross": Look(VERMILLION, "s"),
    "shaken": Look(GREEN, "^"),
    "unstructured": Look(PURPLE, "D"),
    "graded": Look(ORANGE, "v"),
}
_SPARE = (Look(SKY, "P"), Look(BLACK, "X"), Look(GREY, "h"))


def looks(families: Iterable[str]) -> dict[str, Look]:
    """The look of each mesh family; families without one of their own get spare ones in alphabetical order."""
    names = set(families)
    known = {name: look for name, look in _KNOWN.items() if name in names}
    return known | dict(zip(sorted(names - set(known)), cycle(_SPARE), strict=False))

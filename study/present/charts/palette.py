"""Every colour of figures, films and page, and the look of a mesh family: written here and nowhere else."""

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

RAMPS = {
    "stress": ("#ffffd9", "#edf8b1", "#c7e9b4", "#7fcdbb", "#41b6c4", "#1d91c0", "#225ea8", "#253494", "#081d58"),
    "pressure": ("#fff7ec", "#fee8c8", "#fdd49e", "#fdbb84", "#fc8d59", "#ef6548", "#d7301f", "#b30000", "#7f0000"),
    "gap": ("#fff7fb", "#ece7f2", "#d0d1e6", "#a6bddb", "#74a9cf", "#3690c0", "#0570b0", "#045a8d", "#023858"),
}
"""From zero to the largest value: YlGnBu, OrRd and PuBu of ColorBrewer (Harrower and Brewer 2003).

They grow darker throughout, so that they read without colours, too, and small values leave a mesh visible.
"""
PAGE = {
    "light": {"blue": BLUE, "vermillion": VERMILLION, "green": GREEN, "purple": PURPLE},
    "dark": {"blue": SKY, "vermillion": "#EE8434", "green": "#2BBD93", "purple": "#E2A3C3"},
}
"""The colours of the page by what the reader prefers; on dark paper they are lighter."""

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

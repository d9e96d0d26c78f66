"""Figures from the data files; nothing is solved here.

``drawings`` lists all of them, ``overview`` those over all cases. Each kind of figure has one function that draws it
from its data alone, and one that says in a caption what to see in it.
"""

from study.present.figures.drawing import Drawing, draw_figures, draw_one
from study.present.figures.listing import drawings, enclosure, overview

__all__ = ["Drawing", "draw_figures", "draw_one", "drawings", "enclosure", "overview"]

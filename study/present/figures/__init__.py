"""Figures from the data files: of each kind one function draws, and one says in a caption what to see."""

from study.present.figures.drawing import Drawing, draw_figures, draw_one
from study.present.figures.listing import drawings, enclosure, overview

__all__ = ["Drawing", "draw_figures", "draw_one", "drawings", "enclosure", "overview"]

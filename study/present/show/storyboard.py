"""The body at six times on one page."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from study.ledger.files import write_whole
from study.present.figures.body_legend import body_handles, draw_colour_bars
from study.present.figures.body_scale import BodyScale
from study.present.figures.canvas import PAGE, legend
from study.present.figures.deformed_mesh import draw_deformed_mesh
from study.present.picture.picture import Picture
from study.present.picture.wording import heading

MOMENTS, COLUMNS = 6, 3
DPI = 200


def draw_storyboard(picture: Picture) -> Figure:
    """Six of the shapes of a picture, from the first to the last: the deformed body with stress and contact."""
    chosen = np.linspace(0, len(picture.shapes) - 1, MOMENTS).round().astype(int)
    picture = replace(picture, shapes=[picture.shapes[n] for n in chosen])
    scale = BodyScale.of(picture)
    rows, width = MOMENTS // COLUMNS, (PAGE - 0.8) / COLUMNS
    figure = Figure(figsize=(PAGE, 0.8 + rows * (0.2 + width * scale.aspect)))
    panels = figure.subplots(rows, COLUMNS)
    for axes, shape in zip(panels.flat, picture.shapes, strict=True):
        draw_deformed_mesh(axes, picture, shape, scale, width)
        axes.set_title(f"$t={shape.time:.3g}$")
    draw_colour_bars(figure, list(panels.flat), picture, scale, fraction=0.04, shrink=0.8)
    figure.suptitle(heading(picture))
    legend(figure, body_handles(picture, scale), columns=4)
    return figure


def write_png(path: Path, figure: Figure) -> Path:
    """A figure in pixels, without dates or versions."""
    figure.set_dpi(DPI)
    metadata = {"Software": None}
    return write_whole(path, partial(FigureCanvasAgg(figure).print_png, metadata=metadata))

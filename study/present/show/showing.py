"""A case to look at: its storyboard, its animation with the pressure on the contact faces, and files for ParaView."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from study.ledger.files import write_whole
from study.ledger.mesh_series import MeshSeries
from study.present.figures.deformed_body import draw_shapes
from study.present.figures.deformed_mesh import BodyScale
from study.present.figures.drawing import PAGE, in_style
from study.present.picture.picture import Picture, with_every_shape
from study.present.show.animation import write_gif, write_mp4
from study.present.show.vtk import write_vtk

MOMENTS, COLUMNS = 6, 3
SHARP = 200
"""Dots per inch of the storyboard."""


def draw_storyboard(picture: Picture) -> Figure:
    """Six of the shapes of a picture, from the first to the last: the deformed body with stress and contact."""
    chosen = np.linspace(0, len(picture.shapes) - 1, MOMENTS).round().astype(int)
    picture = replace(picture, shapes=[picture.shapes[n] for n in chosen])
    rows, width = MOMENTS // COLUMNS, (PAGE - 0.8) / COLUMNS
    figure = Figure(figsize=(PAGE, 0.8 + rows * (0.2 + width * BodyScale.of(picture).aspect)))
    draw_shapes(figure, figure.subplots(rows, COLUMNS).ravel(), picture, width, 4, fraction=0.04, shrink=0.8)
    return figure


@dataclass(frozen=True)
class Shown:
    """What was written, and what was left out with the reason."""

    written: list[Path]
    left_out: list[str]


def count_images(record: Mapping[str, Any]) -> int:
    """How often ``draw_show`` notifies: for the storyboard, and for every frame of the animation."""
    return 1 + len(record["times"])


def draw_show(
    record: Mapping[str, Any], series: MeshSeries, directory: Path, notify: Callable[[], object] = lambda: None
) -> Shown:
    """Write ``storyboard.png``, ``animation.gif``, ``animation.mp4`` and ``vtk/`` in a directory.

    ``record`` is a picture in the form of ``pictures/CASE.json``; ``notify`` is called after each image.

    Raises:
        StoreError: the directory cannot be written.
    """
    picture = with_every_shape(record)
    with in_style():
        storyboard = draw_storyboard(picture)
        storyboard.set_dpi(SHARP)
        draw = partial(FigureCanvasAgg(storyboard).print_png, metadata={"Software": None})
        written = [write_whole(directory / "storyboard.png", draw)]
        notify()
        moving = _animate(picture, directory, notify)
    vtk = write_vtk(directory / "vtk", picture.case, series)
    return Shown([*written, *moving.written, *vtk], moving.left_out)


def _animate(picture: Picture, directory: Path, notify: Callable[[], object]) -> Shown:
    gif = write_gif(directory / "animation.gif", picture, notify)
    mp4 = write_mp4(directory / "animation.mp4", picture)
    if mp4:
        return Shown([gif, mp4], [])
    return Shown([gif], ["animation.mp4: there is no ffmpeg on this machine; install it and run again"])

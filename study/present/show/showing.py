"""A case to look at: its storyboard, its animation with the pressure on the contact faces, and files for ParaView."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.animation import FFMpegWriter
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image

from study.ledger.files import write_whole
from study.ledger.mesh_series import MeshSeries
from study.present.charts.palette import BLACK, SKY, VERMILLION
from study.present.figures.deformed_body import draw_keys, draw_shapes
from study.present.figures.deformed_mesh import BodyScale, draw_deformed_mesh
from study.present.figures.drawing import PAGE, in_style
from study.present.picture.faces import Segment
from study.present.picture.picture import Picture, with_every_shape
from study.present.picture.zone_history import exact_zone
from study.present.show.vtk import write_vtk

DPI = 110
COLOURS = 256
"""As many as a frame of a GIF can have: with fewer, small arrows lose their colour to the shades of the stress."""
PER_SECOND = 8
HOLD = 1000
"""Milliseconds that the last time of a GIF stays."""


def write_gif(path: Path, picture: Picture, notify: Callable[[], object]) -> Path:
    """One frame for every shape of the picture; ``notify`` is called after each."""
    figure = Figure(figsize=_size(picture), dpi=DPI)
    canvas = FigureCanvasAgg(figure)
    images = []
    for _ in played(figure, picture):
        canvas.draw()
        images.append(Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB").quantize(COLOURS))
        notify()
    durations = [1000 // PER_SECOND] * (len(images) - 1) + [HOLD]
    return write_whole(
        path,
        lambda part: images[0].save(
            part, "GIF", save_all=True, append_images=images[1:], duration=durations, loop=0, optimize=False
        ),
    )


def write_mp4(path: Path, picture: Picture) -> Path | None:
    """The same as a film; None without ffmpeg."""
    if not FFMpegWriter.isAvailable():
        return None
    figure = Figure(figsize=_size(picture), dpi=DPI)
    FigureCanvasAgg(figure)
    # The name of a part does not tell ffmpeg the format.
    writer = FFMpegWriter(fps=PER_SECOND, extra_args=["-f", "mp4"])

    def write(part: Path) -> None:
        with writer.saving(figure, str(part), DPI):
            for _ in played(figure, picture):
                writer.grab_frame()

    return write_whole(path, write)


def _size(picture: Picture) -> tuple[float, float]:
    """In inches: room for the body, and for a panel for every face beside it."""
    return PAGE, 1.2 + max(0.45 * PAGE * min(BodyScale.of(picture).aspect, 1.2), 1.2 * len(picture.faces))


def played(figure: Figure, picture: Picture) -> Iterator[None]:
    """Draw one shape of a picture after the other on a figure; the caller takes each before the next is drawn."""
    scale = BodyScale.of(picture)
    body = figure.add_gridspec(1, 2, width_ratios=(3, 2))
    left = figure.add_subplot(body[0])
    right = body[1].subgridspec(len(picture.faces), 1).subplots(squeeze=False)[:, 0]
    draw_keys(figure, [left], picture, scale, 4, orientation="horizontal", fraction=0.05, shrink=0.8, pad=0.02)
    for number, shape in enumerate(picture.shapes):
        for axes in (left, *right):
            axes.clear()
        draw_deformed_mesh(left, picture, shape, scale, 0.5 * PAGE)
        for axes, face in zip(right, picture.segments, strict=True):
            _draw_pressure(axes, face, picture, picture.nearest(shape.time))
        figure.suptitle(f"{picture.heading},  $t={shape.time:.2f}$")
        if number == 0:
            # Later frames keep the layout of the first one: nothing may jump.
            figure.canvas.draw()
            figure.set_layout_engine("none")
        yield


def _draw_pressure(axes: Axes, face: Segment, picture: Picture, instant: int) -> None:
    """Exact pressure as a line, computed as dots, the exact contact zone shaded."""
    for start, end in exact_zone(face, float(picture.times[instant])):
        axes.axvspan(start, end, color=SKY, alpha=0.35, lw=0)
    axes.plot(face.line, face.line_pressure[instant], color=BLACK, lw=0.9)
    axes.plot(face.s, face.pressure[instant], "o", color=VERMILLION, mfc="white", ms=2.8, clip_on=False)
    top = max(float(face.pressure.max()), float(face.line_pressure.max()))
    axes.set(xlim=(face.line.min(), face.line.max()), ylim=(0, 1.08 * top if top > 0 else 1))
    axes.set_xlabel(rf"$s$ on ${picture.symbol(face)}$")
    axes.set_ylabel("pressure $p$")


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
    """How often ``draw_show`` notifies: for the storyboard, and for every frame of the animation of a plane body."""
    return 1 + (len(record["times"]) if len(record["vertices"]) == 2 else 0)


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
    if picture.polygons:
        return Shown([], ["animation.gif, animation.mp4: drawn for plane bodies only; play the PVD file in ParaView"])
    gif = write_gif(directory / "animation.gif", picture, notify)
    mp4 = write_mp4(directory / "animation.mp4", picture)
    if mp4:
        return Shown([gif, mp4], [])
    return Shown([gif], ["animation.mp4: there is no ffmpeg on this machine; install it and run again"])

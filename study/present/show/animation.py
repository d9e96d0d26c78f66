"""A case in motion: the deformed body, and beside it the pressure on its contact faces."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.animation import FFMpegWriter
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from PIL import Image

from study.ledger.files import write_whole
from study.present.charts.palette import BLACK, RAMPS, SKY, VERMILLION
from study.present.figures.contact_maps import draw_map, paint_values
from study.present.figures.deformed_body import draw_keys
from study.present.figures.deformed_mesh import ROUND_OFF, BodyScale, draw_deformed_mesh
from study.present.figures.drawing import PAGE, dots, entry
from study.present.picture.faces import FaceHistory, Polygon, Segment
from study.present.picture.picture import Picture
from study.present.picture.zone_history import exact_zone

DPI = 110
COLOURS = 128
"""Of a whole GIF: enough that small arrows keep theirs beside the shades of the stress."""
PER_SECOND = 8
HOLD = 1000
"""Milliseconds that the last time of a GIF stays."""


def write_gif(path: Path, picture: Picture, notify: Callable[[], object], dpi: int = DPI) -> Path:
    """One frame for every shape of the picture; ``notify`` is called after each."""
    figure = Figure(figsize=_size(picture), dpi=dpi)
    canvas = FigureCanvasAgg(figure)
    images = []
    for _ in played(figure, picture):
        canvas.draw()
        images.append(Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB"))
        notify()
    images = with_one_palette(images)
    durations = [1000 // PER_SECOND] * (len(images) - 1) + [HOLD]
    return write_whole(
        path,
        lambda part: images[0].save(
            part, "GIF", save_all=True, append_images=images[1:], duration=durations, loop=0, optimize=True
        ),
    )


def with_one_palette(images: list[Image.Image]) -> list[Image.Image]:
    """Frames in the same few colours and without dither, so that what does not move is written once."""
    together = Image.fromarray(np.concatenate([np.asarray(image) for image in images]))
    palette = together.quantize(COLOURS, dither=Image.Dither.NONE)
    return [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]


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
    panels = [_panel(axes, face, picture, scale) for axes, face in zip(right, picture.faces, strict=True)]
    bars = {"orientation": "horizontal", "fraction": 0.05, "shrink": 0.8, "pad": 0.02}
    draw_keys(figure, [left], picture, scale, 4, _SURFACE if picture.polygons else _LINE, **bars)
    for number, shape in enumerate(picture.shapes):
        for axes in (left, *right):
            axes.clear()
        draw_deformed_mesh(left, picture, shape, scale, 0.5 * PAGE)
        for draw in panels:
            draw(picture.nearest(shape.time))
        figure.suptitle(f"{picture.heading},  $t={shape.time:.2f}$")
        if number == 0:
            # Later frames keep the layout of the first one: nothing may jump.
            figure.canvas.draw()
            figure.set_layout_engine("none")
        yield


_LINE = (
    entry("exact pressure", color=BLACK, lw=0.9),
    dots("computed pressure", color=VERMILLION, mfc="white", ms=2.8),
    Patch(color=SKY, alpha=0.35, lw=0, label="exact contact zone"),
)
_SURFACE = (
    Patch(color=RAMPS["pressure"][3], lw=0, label="exact pressure"),
    dots("computed pressure, same colours", mfc=RAMPS["pressure"][3], mec="0.4", mew=0.4, ms=3.4),
    entry("exact front", color=VERMILLION, lw=1.0),
)


def _panel(axes: Axes, face: FaceHistory, picture: Picture, scale: BodyScale) -> Callable[[int], None]:
    """Draws the pressure on a face at one of the times of the picture."""
    if isinstance(face, Segment):
        return partial(_draw_pressure, axes, face, picture)
    assert isinstance(face, Polygon)
    paint = paint_values(face, face.pressure_exact, face.pressure, scale.pressure or 1.0, "pressure")

    def draw(instant: int) -> None:
        draw_map(axes, face, instant, paint)
        axes.set(xlabel="$s_1$", ylabel=rf"$s_2$ on ${picture.symbol(face)}$")

    return draw


def _draw_pressure(axes: Axes, face: Segment, picture: Picture, instant: int) -> None:
    """Exact pressure as a line, computed as dots, the exact contact zone shaded."""
    for start, end in exact_zone(face, float(picture.times[instant])):
        axes.axvspan(start, end, color=SKY, alpha=0.35, lw=0)
    axes.plot(face.line, face.line_pressure[instant], color=BLACK, lw=0.9)
    axes.plot(face.s, face.pressure[instant], "o", color=VERMILLION, mfc="white", ms=2.8, clip_on=False)
    top = max(float(face.pressure.max()), float(face.line_pressure.max()))
    axes.set(xlim=(face.line.min(), face.line.max()), ylim=(0, 1.08 * top if top > ROUND_OFF else 1))
    axes.set_xlabel(rf"$s$ on ${picture.symbol(face)}$")
    axes.set_ylabel("pressure $p$")

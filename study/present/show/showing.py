"""Everything that is drawn and written of a case to look at."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from study.ledger.mesh_series import MeshSeries
from study.present.figures.canvas import in_style
from study.present.picture.over_time import with_every_shape
from study.present.picture.picture import Picture
from study.present.show.animation import write_gif, write_mp4
from study.present.show.storyboard import draw_storyboard, write_png
from study.present.show.vtk import write_vtk


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
        written = [write_png(directory / "storyboard.png", draw_storyboard(picture))]
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

"""A case to look at: storyboard, animation, and files for ParaView, from one solve on a moderate mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from manufactured.case import Case
from study.fem.mesh import FAMILIES
from study.fem.naming import UsageError
from study.ledger.files import write_text
from study.present.figures.canvas import in_style
from study.present.figures.pictures import Picture, Shape
from study.present.show.animation import write_gif, write_mp4
from study.present.show.solid import draw_surface
from study.present.show.storyboard import draw_storyboard, write_png
from study.present.show.vtk import write_vtk
from study.run import pictures
from study.run import resources as memory
from study.solve.motion import Motion, von_mises

EVERY = 2
"""One of so many frames is shown."""
STEPS = pictures.STEPS
LEVELS = {2: pictures.LEVEL, 3: 9}
"""By dimension: moderate, and a multiple of what divides the faces of our cubes."""


@dataclass(frozen=True)
class Shown:
    """What was written, and what was left out with the reason."""

    written: list[Path]
    left_out: list[str]


def ticks(case: Case) -> int:
    """How often ``show`` notifies: for every frame solved, and for every one drawn into the animation."""
    return STEPS + 1 + (STEPS // EVERY + 1 if case.solution.body.dim == 2 else 0)


def show(case: Case, level: int, directory: Path, notify: Callable[[], object] = lambda: None) -> Shown:
    """Solve a case and write ``storyboard.png``, ``animation.gif``, ``animation.mp4`` and ``vtk/`` in a directory.

    ``notify`` is called ``ticks(case)`` times.

    Raises:
        UsageError: no mesh family serves the body, or there is not the memory for this level.
        StoreError: the directory cannot be written; said before anything is solved.
        MeshError: the mesh of this level does not fit the body.
    """
    body = case.solution.body
    serving = [family for family in (pictures.FAMILY, *FAMILIES) if family.serves(body)]
    if not serving:
        raise UsageError(f"no mesh family can mesh the body of {case.name}: in 3D it has to be a parallelepiped")
    memory.require(f"level {level}", memory.displacement(body.dim, level, serving[0].name), memory.available())
    write_text(directory / ".writable", "").unlink()
    motion = Motion.of(case.solution, serving[0], level, STEPS, notify)
    with in_style():
        if body.dim == 2:
            drawn = _draw_plane(film(case.name, motion), directory, notify)
        else:
            drawn = _draw_solid(case.name, motion, directory)
    return replace(drawn, written=[*drawn.written, *write_vtk(directory / "vtk", case.name, motion, EVERY)])


def _draw_plane(picture: Picture, directory: Path, notify: Callable[[], object]) -> Shown:
    written = [
        write_png(directory / "storyboard.png", draw_storyboard(picture)),
        write_gif(directory / "animation.gif", picture, notify),
    ]
    mp4 = write_mp4(directory / "animation.mp4", picture)
    if mp4:
        return Shown([*written, mp4], [])
    return Shown(written, ["animation.mp4: there is no ffmpeg on this machine; install it and run again"])


def _draw_solid(name: str, motion: Motion, directory: Path) -> Shown:
    written = [write_png(directory / "storyboard.png", draw_surface(name, motion))]
    return Shown(written, ["animation.gif, animation.mp4: drawn for plane bodies only; play the PVD file in ParaView"])


def film(name: str, motion: Motion) -> Picture:
    """The picture of a motion with a shape at every time shown."""
    picture = Picture.of(pictures.record(name, motion, EVERY))
    shapes = [
        Shape(frame.time, motion.space.nodal(frame.u), von_mises(frame.stress)) for frame in motion.frames[::EVERY]
    ]
    return replace(picture, shapes=shapes)

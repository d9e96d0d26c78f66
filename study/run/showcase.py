"""A case for display, solved on one moderate mesh: its picture, and fields for ParaView."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from manufactured.case import Case
from manufactured.tensors import Array, full
from study.fem.mesh import MeshFamily
from study.ledger.files import write_text
from study.ledger.pictures import MeshFields, MeshSeries
from study.run import executor
from study.solve.motion import Frame, Motion, von_mises
from study.statements import pictures
from study.statements.shared import estimates
from study.statements.shared.scope import regular

EVERY = 2
"""Every second frame is shown."""
STEPS = pictures.STEPS
LEVELS = {2: pictures.LEVEL, 3: 9}
"""The level for each dimension: moderate, and in 3D a multiple of the number that divides the faces of the cubes."""


@dataclass(frozen=True, eq=False)
class Showcase:
    """A case for display: its picture in the form of ``pictures/CASE.json``, and fields on the whole mesh."""

    picture: dict[str, Any]
    series: MeshSeries


def solve_showcase(case: Case, level: int, directory: Path, notify: Callable[[], object] = lambda: None) -> Showcase:
    """Solve a case for display; ``notify`` is called after each of the STEPS + 1 frames.

    Raises:
        UsageError: no mesh family can mesh the body, or there is not enough memory for this level.
        StoreError: the directory cannot be written; raised before anything is solved.
        MeshError: the mesh of this level does not fit the body.
    """
    family = affordable_family(case, level)
    write_text(directory / ".writable", "").unlink()
    motion = Motion.of(case.solution, family, level, STEPS, notify)
    return Showcase(pictures.record(case.name, motion, EVERY), mesh_series(motion, EVERY))


def affordable_family(case: Case, level: int) -> MeshFamily:
    """Return the mesh family with which a case is shown.

    Raises:
        UsageError: no mesh family can mesh the body, or there is not enough memory for this level.
    """
    dim = case.solution.body.dim
    family = pictures.FAMILY if dim == 2 else regular(case)
    executor.require(f"level {level}", estimates.displacement(dim, level, family.name), executor.available())
    return family


def mesh_series(motion: Motion, every: int) -> MeshSeries:
    """Return every ``every``-th frame of a motion as fields on the mesh.

    Fields at the vertices are ``displacement``, ``velocity``, and on Γ3 ``gap`` and ``pressure`` (``gap_1``, ``gap_2``,
    … if Γ3 has several faces). Fields on the cells, constant on each, are ``stress`` and ``von_mises``.
    """
    weights, mesh = pictures.contact_weights(motion.space), motion.space.mesh
    return MeshSeries(mesh.p, mesh.t, [_fields(motion, frame, weights) for frame in motion.frames[::every]])


def _fields(motion: Motion, frame: Frame, weights: Array) -> MeshFields:
    nodal = motion.space.nodal
    contact = dict(_on_contact(motion, {"gap": -frame.normal, "pressure": frame.multipliers / weights}))
    return MeshFields(
        frame.time,
        {"displacement": nodal(frame.u), "velocity": nodal(frame.velocity), **contact},
        {"stress": full(frame.stress), "von_mises": von_mises(frame.stress)},
    )


def _on_contact(motion: Motion, values: dict[str, Array]) -> Iterator[tuple[str, Array]]:
    """Yield values at the contact vertices, (m,), as fields over all vertices, one field for each face of Γ3."""
    faces, start = motion.space.contact, 0
    for number, (_, vertices) in enumerate(faces, start=1):
        rows = slice(start, start + len(vertices))
        start += len(vertices)
        for name, mine in values.items():
            field = np.full(motion.space.mesh.p.shape[1], np.nan)
            field[vertices] = mine[rows]
            yield name if len(faces) == 1 else f"{name}_{number}", field

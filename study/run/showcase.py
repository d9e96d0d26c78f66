"""Solves a case on one mesh for display: for pictures, and for files for ParaView. Used by ``study show``."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from manufactured.case import Case
from manufactured.tensors import Array, full
from study.fem.mesh import MeshFamily
from study.ledger.pictures import MeshFields, MeshSeries
from study.run import executor
from study.solve.motion import Motion, von_mises
from study.statements import pictures
from study.statements.shared import estimates
from study.statements.shared.scope import regular

SHOWN_EVERY = 2
"""Every second time step is shown."""
SHOWN_STEPS = pictures.PICTURE_STEPS
SHOWN_LEVELS = {2: pictures.LEVEL, 3: 9}
"""Dimension ↦ default level (cells along a side). In 3D it is a multiple of the number of parts into which a
face of the cube is divided."""


def solve_showcase(
    case: Case, family: MeshFamily, level: int, notify: Callable[[], object]
) -> tuple[dict[str, Any], MeshSeries]:
    """Solve a case on one mesh for display.

    Parameters:
        case: the case.
        family, level: the mesh family, and the number of cells of the mesh along a side.
        notify: called after each of the SHOWN_STEPS + 1 times.

    Returns:
        The data of a picture, in the format of ``pictures/CASE.json.gz``; and fields on the whole mesh over time.

    Raises:
        MeshError: the mesh of this level does not fit the body.
    """
    motion = Motion.of(case.solution, family, level, SHOWN_STEPS, notify)
    return pictures.record(case.name, motion, SHOWN_EVERY), mesh_series(motion, SHOWN_EVERY)


def affordable_family(case: Case, level: int) -> MeshFamily:
    """Return the mesh family with which a case is shown, after checking that there is enough memory.

    Raises:
        UsageError: no mesh family can mesh the body, or there is not enough memory for this level.
    """
    dim = case.solution.body.dim
    family = pictures.FAMILY if dim == 2 else regular(case)
    executor.require(f"level {level}", estimates.displacement(dim, level, family.name), executor.available())
    return family


def mesh_series(motion: Motion, every: int) -> MeshSeries:
    """Return fields on the mesh of a solved case, at every ``every``-th time.

    Fields at the vertices are ``displacement``, ``velocity``, and on the contact boundary ``gap`` and ``pressure``
    (``gap_1``, ``gap_2``, … if this boundary has several faces). Fields on the cells, constant on each, are ``stress``
    and ``von_mises``.
    """
    weights, mesh = pictures.contact_weights(motion.space), motion.space.mesh
    nodal, fields = motion.space.nodal, []
    for frame in motion.frames[::every]:
        contact = dict(_on_contact(motion, {"gap": -frame.normal, "pressure": frame.multipliers / weights}))
        at_vertices = {"displacement": nodal(frame.u), "velocity": nodal(frame.velocity), **contact}
        on_cells = {"stress": full(frame.stress), "von_mises": von_mises(frame.stress)}
        fields.append(MeshFields(frame.time, at_vertices, on_cells))
    return MeshSeries(mesh.p, mesh.t, fields)


def _on_contact(motion: Motion, values: dict[str, Array]) -> Iterator[tuple[str, Array]]:
    """Yield names and fields over all vertices from values on the contact boundary; other vertices have NaN.

    Each quantity gives one field for each contact face.

    Parameters:
        motion: the solved case.
        values: name of a quantity ↦ its values at the m vertices of the contact boundary, (m,).
    """
    faces, start = motion.space.contact, 0
    for number, (_, vertices) in enumerate(faces, start=1):
        rows = slice(start, start + len(vertices))
        start += len(vertices)
        for name, mine in values.items():
            field = np.full(motion.space.mesh.p.shape[1], np.nan)
            field[vertices] = mine[rows]
            yield name if len(faces) == 1 else f"{name}_{number}", field

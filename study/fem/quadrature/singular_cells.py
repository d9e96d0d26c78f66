"""The cells in which the integrand is not smooth."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from skfem import Mesh

from manufactured.tensors import Array
from study.fem.line import TOUCHING, Line
from study.fem.mesh import MeshError, cell_volumes


def rough_cells(mesh: Mesh, lines: Sequence[Line], points: Sequence[tuple[float, ...]]) -> list[Array]:
    """The cells at each line and then at each point: those that need a rule of their own.

    Raises:
        MeshError: two lines or points meet one cell, a point is no vertex, or either is given in 3D.
    """
    names = [*map(str, lines), *(f"the point {tuple(point)}" for point in points)]
    if mesh.dim() != 2 and names:
        raise MeshError(
            f"cells are cut and graded in 2D only, this 3D solution is rough at {', '.join(names)}; take a contact "
            "face without `rough`, a material without `steps` and a solution without `singular`"
        )
    found = [_touching(mesh, line) for line in lines] + [_around(mesh, point) for point in points]
    owner = np.full(mesh.t.shape[1], -1)
    for i, cells in enumerate(found):
        taken = cells[owner[cells] >= 0]
        if taken.size:
            place = ", ".join(f"{x:.3g}" for x in mesh.p[:, mesh.t[:, taken[0]]].mean(axis=1))
            raise MeshError(
                f"the cell around ({place}) meets two lines or points at which the solution is rough, "
                f"{names[owner[taken[0]]]} and {names[i]}, and cells are cut for one only; take a finer level, or "
                "move them apart where they cross"
            )
        owner[cells] = i
    return found


def _touching(mesh: Mesh, line: Line) -> Array:
    """Cells that a line crosses, or touches at an edge or a vertex: the integrand is singular there, too."""
    distance = (np.array(line.direction) @ mesh.p - line.offset)[mesh.t]
    near = TOUCHING * (distance.max(axis=0) - distance.min(axis=0))
    return np.flatnonzero((distance.min(axis=0) <= near) & (distance.max(axis=0) >= -near))


def _around(mesh: Mesh, point: tuple[float, ...]) -> Array:
    """Cells with a singular point as a vertex."""
    apart = np.linalg.norm(mesh.p - np.array(point)[:, None], axis=0)
    vertex = int(apart.argmin())
    here = np.flatnonzero((mesh.t == vertex).any(axis=0))
    if apart[vertex] > TOUCHING * np.sqrt(cell_volumes(mesh).sum()):
        raise MeshError(
            f"the solution is singular at {tuple(point)}, which is not a vertex of the mesh (the nearest is "
            f"{apart[vertex]:.3g} away); list it as a vertex of the body"
        )
    return here

"""One-diagonal meshes with randomly displaced vertices."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from skfem import Mesh

from manufactured.body import Body
from manufactured.tensors import Array
from study.fem.mesh import unit_grid
from study.fem.mesh.geometry import simplicial_mesh
from study.fem.mesh.multilinear import has_grids, mapped
from study.fem.mesh.segments import on_segment


@dataclass(frozen=True)
class Shaken:
    """One-diagonal meshes with every vertex moved by up to 2/d ``amplitude`` cells in each direction.

    Vertices slide in the faces, on the edges between parts and on the interfaces they lie on; corners
    of parts stay. Levels are independent of each other, so the meshes are neither nested nor symmetric.
    A simplex of the grid on the unit cube keeps 1 − 4 ``amplitude`` of its volume at least, in every dimension.
    """

    seed: int = 2002
    amplitude: float = 0.2
    name: str = "shaken"

    def serves(self, body: Body) -> bool:
        return has_grids(body)

    def __call__(self, body: Body, n: int) -> Mesh:
        # The grid is shaken before it is mapped, so that vertices of stretched bodies move in proportion to the cells.
        plain = unit_grid.vertices(n, body.dim)
        amplitude = self.amplitude * 2 / body.dim
        shift = np.random.default_rng([self.seed, n]).uniform(-1, 1, plain.shape) * amplitude / n
        shift[(plain == 0) | (plain == 1)] = 0
        resting = mapped(body, plain)
        ends = [*body.vertices.T]
        for line in _kept_lines(body):
            ends += [*line.T]
            on = np.flatnonzero(on_segment(resting, line))
            if on.size > 1:
                along = plain[:, on[-1]] - plain[:, on[0]]
                along /= np.linalg.norm(along)
                shift[:, on] = np.multiply.outer(along, along @ shift[:, on])
        points = mapped(body, plain + shift)
        fixed = [np.linalg.norm(resting - end[:, None], axis=0).argmin() for end in ends]
        points[:, fixed] = resting[:, fixed]
        return simplicial_mesh(points, unit_grid.kuhn(n, body.dim))


def _kept_lines(body: Body) -> Iterator[Array]:
    """Segments (d, 2) that meshes have to keep: edges of parts in 3D, interfaces in 2D."""
    if body.dim == 3:
        for part in body.parts:
            yield from (part.corners[:, [i - 1, i]] for i in range(part.corners.shape[1]))
    yield from (interface.corners for interface in body.interfaces)

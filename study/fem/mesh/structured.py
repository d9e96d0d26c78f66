"""Structured meshes: grids of the unit cube, mapped onto the body, and the same with displaced vertices."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from skfem import Mesh

from manufactured.body import Body
from manufactured.tensors import Array
from study.fem.mesh.geometry import on_segment, simplicial_mesh
from study.fem.mesh.mapped_grid import grid_vertices, has_grids, kuhn, lowest_corners, mapped
from study.fem.mesh.meshed_body import require_plane


@dataclass(frozen=True)
class OneDiagonal:
    """n^d parallelepipeds, each cut into d! simplices along the same diagonal (``mapped_grid.kuhn``)."""

    name: str = "one-diagonal"

    def serves(self, body: Body) -> bool:
        return has_grids(body)

    def __call__(self, body: Body, n: int) -> Mesh:
        return simplicial_mesh(mapped(body, grid_vertices(n, body.dim)), kuhn(n, body.dim))


@dataclass(frozen=True)
class CrissCross:
    """n × n quadrilaterals, each cut by both diagonals."""

    name: str = "criss-cross"

    def serves(self, body: Body) -> bool:
        return body.dim == 2 and has_grids(body)

    def __call__(self, body: Body, n: int) -> Mesh:
        require_plane(self, body)
        points, a = mapped(body, grid_vertices(n, 2)), lowest_corners(n, 2)
        b, c, d = a + 1, a + n + 2, a + n + 1
        centres = (points[:, a] + points[:, b] + points[:, c] + points[:, d]) / 4
        m = points.shape[1] + np.arange(n * n)
        return simplicial_mesh(np.hstack([points, centres]), np.hstack([[a, b, m], [b, c, m], [c, d, m], [d, a, m]]))


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
        plain = grid_vertices(n, body.dim)
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
        return simplicial_mesh(points, kuhn(n, body.dim))


def _kept_lines(body: Body) -> Iterator[Array]:
    """Segments (d, 2) that meshes have to keep: edges of parts in 3D, interfaces in 2D."""
    if body.dim == 3:
        for part in body.parts:
            yield from (part.corners[:, [i - 1, i]] for i in range(part.corners.shape[1]))
    yield from (interface.corners for interface in body.interfaces)

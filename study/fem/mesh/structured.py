"""Structured meshes: grids of the unit cube, mapped onto the body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from skfem import Mesh

from manufactured.body import Body
from study.fem.mesh import unit_grid
from study.fem.mesh.family import require_plane
from study.fem.mesh.geometry import simplicial_mesh
from study.fem.mesh.multilinear import has_grids, mapped


@dataclass(frozen=True)
class OneDiagonal:
    """n^d parallelepipeds, each cut into d! simplices along the same diagonal (``unit_grid.kuhn``)."""

    name: str = "one-diagonal"

    def serves(self, body: Body) -> bool:
        return has_grids(body)

    def __call__(self, body: Body, n: int) -> Mesh:
        return simplicial_mesh(mapped(body, unit_grid.vertices(n, body.dim)), unit_grid.kuhn(n, body.dim))


@dataclass(frozen=True)
class CrissCross:
    """n × n quadrilaterals, each cut by both diagonals."""

    name: str = "criss-cross"

    def serves(self, body: Body) -> bool:
        return body.dim == 2 and has_grids(body)

    def __call__(self, body: Body, n: int) -> Mesh:
        require_plane(self, body)
        points = mapped(body, unit_grid.vertices(n, 2))
        a = unit_grid.lowest_corners(n, 2)
        b, c, d = a + 1, a + n + 2, a + n + 1
        centres = (points[:, a] + points[:, b] + points[:, c] + points[:, d]) / 4
        m = points.shape[1] + np.arange(n * n)
        return simplicial_mesh(np.hstack([points, centres]), np.hstack([[a, b, m], [b, c, m], [c, d, m], [d, a, m]]))

"""The visible surface of a mesh, for pictures: all cells in 2D, the boundary facets in 3D."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from skfem import Mesh

from manufactured.tensors import Array


@dataclass(frozen=True, eq=False)
class Skin:
    """The triangles of the visible surface.

    Attributes:
        vertices: the vertices of the mesh that they use, (v,).
        triangles: their corners as positions in ``vertices``, (3, k); in 3D counter-clockwise seen from outside.
        cells: the cell of the mesh behind each, (k,).
    """

    vertices: Array
    triangles: Array
    cells: Array

    @classmethod
    def of(cls, mesh: Mesh) -> Skin:
        """From a mesh of triangles or tetrahedra."""
        if mesh.dim() == 2:
            return cls(np.arange(mesh.p.shape[1]), mesh.t, np.arange(mesh.t.shape[1]))
        facets = mesh.boundary_facets()
        cells = mesh.f2t[0, facets]
        outer = _outwards(mesh.p, mesh.facets[:, facets], mesh.t[:, cells])
        vertices, triangles = np.unique(outer, return_inverse=True)
        return cls(vertices, triangles.reshape(outer.shape), cells)


def _outwards(points: Array, facets: Array, cells: Array) -> Array:
    """Facets of tetrahedra, (3, k), with their corners counter-clockwise seen from outside."""
    inner = cells.sum(axis=0) - facets.sum(axis=0)
    a, b, c, d = (points[:, corner].T for corner in (*facets, inner))
    # The fourth vertex lies behind a facet whose corners run counter-clockwise.
    seen_from_inside = np.linalg.det(np.stack([b - a, c - a, d - a], axis=1)) > 0
    return np.where(seen_from_inside, facets[[0, 2, 1]], facets)

"""The Alfeld split: a triangle is cut from its barycentre into three thirds, one at each side."""

from __future__ import annotations

import numpy as np
from skfem import Mesh, MeshTri

from manufactured.tensors import Array, Points

CORNERS = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
"""Vertices of the reference triangle, (2, 3)."""
SIDES = ((1, 2), (2, 0), (0, 1))
"""The vertices of side i, opposite to vertex i; third i has these two and the barycentre as its vertices."""


def thirds(corners: Points) -> Points:
    """Vertices of the thirds of triangles: (2, 3, ...) → (2, 3 vertices, 3 thirds, ...)."""
    centre = corners.mean(axis=1)
    return np.stack([np.stack([corners[:, a], corners[:, b], centre], axis=1) for a, b in SIDES], axis=2)


def alfeld_split(mesh: Mesh) -> tuple[Mesh, Points]:
    """The mesh of the thirds, those of a cell one after the other, and their vertices, (2, 3, thirds)."""
    vertices = np.vstack([mesh.t, mesh.p.shape[1] + np.arange(mesh.t.shape[1])])
    cells = np.stack([vertices[[a, b, 3]] for a, b in SIDES], axis=2).reshape(3, -1)
    points = np.hstack([mesh.p, mesh.p[:, mesh.t].mean(axis=1)])
    return MeshTri(points, np.ascontiguousarray(cells)), points[:, cells]


def barycentric(corners: Points, x: Points) -> Array:
    """Barycentric coordinates of points (2, n, q) in triangles with the vertices (2, 3, n), (3, n, q)."""
    edges = np.moveaxis(corners[:, :2] - corners[:, 2:], 2, 0)
    found = np.einsum("nvd,dnq->vnq", np.linalg.inv(edges), x - corners[:, 2][..., None])
    return np.concatenate([found, 1 - found.sum(axis=0, keepdims=True)])

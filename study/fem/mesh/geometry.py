"""The simplices of a mesh, their volumes and gradients, distances to a segment, and the visible surface of a mesh."""

from __future__ import annotations

from dataclasses import dataclass
from math import factorial

import numpy as np
import scipy.sparse as sps
from skfem import Mesh, MeshTet, MeshTri

from manufactured.tensors import Array, Points


def simplicial_mesh(points: Points, cells: Array) -> Mesh:
    """The mesh with the vertices (d, n) and the triangles or tetrahedra (d+1, cells)."""
    kind = MeshTri if len(points) == 2 else MeshTet
    return kind(np.ascontiguousarray(points), np.ascontiguousarray(cells))


def size(mesh: Mesh) -> float:
    """h = (d! |Ω| / number of cells)^{1/d}, which is 1/n on one-diagonal meshes of the unit cube.

    In a quasi-uniform family it is equivalent to the largest diameter, whose random part on shaken meshes would
    otherwise bend every observed order.
    """
    return float((factorial(mesh.dim()) * cell_volumes(mesh).sum() / mesh.t.shape[1]) ** (1 / mesh.dim()))


def cell_volumes(mesh: Mesh) -> Array:
    """|T| of every cell, (cells,)."""
    return abs(determinants(mesh.p, mesh.t)) / factorial(mesh.dim())


def facet_measures(mesh: Mesh, facets: Array) -> Array:
    """Lengths or areas of the facets with the given indices, (n,): the root of Gram's determinant over (d−1)!."""
    edges = _edges(mesh.p, mesh.facets[:, facets])
    gram = np.einsum("ikn,iln->nkl", edges, edges)
    return np.sqrt(np.linalg.det(gram)) / factorial(mesh.dim() - 1)


def barycentric_gradients(mesh: Mesh) -> Array:
    """∇λ_i on every cell, (cells, d+1, d): by Cramer's rule, as LAPACK would take a call for each cell."""
    edges = _edges(mesh.p, mesh.t)
    inner = np.stack([_normal(edges, i) for i in range(len(edges))])
    inner /= (edges[:, 0] * inner[0]).sum(axis=0)
    return np.ascontiguousarray(np.moveaxis(np.concatenate([-inner.sum(axis=0, keepdims=True), inner]), 2, 0))


def determinants(points: Points, cells: Array) -> Array:
    """d! times the signed volume of cells, (cells,)."""
    edges = _edges(points, cells)
    found: Array = (edges[:, 0] * _normal(edges, 0)).sum(axis=0)
    return found


def _normal(edges: Array, i: int) -> Array:
    """What is normal to all of d edges (d, d, n) but the i-th, whose product with it is their determinant, (d, n)."""
    if len(edges) == 2:
        x, y = edges[:, 1 - i]
        return np.stack([y, -x] if i == 0 else [-y, x])
    (ax, ay, az), (bx, by, bz) = edges[:, (i + 1) % 3], edges[:, (i + 2) % 3]
    return np.stack([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])


def _edges(points: Points, simplices: Array) -> Array:
    """The edges from the first vertex of simplices (k+1, n), (d, k, n)."""
    corners = points[:, simplices]
    return corners[:, 1:] - corners[:, :1]


def with_midpoints(mesh: Mesh) -> sps.csr_array:
    """Vertex values of a P1 function ↦ those at the vertices and midpoints of edges, which ``mesh.refined()`` has."""
    edges, count = (mesh.facets if mesh.dim() == 2 else mesh.edges), mesh.p.shape[1]
    rows = np.repeat(np.arange(edges.shape[1]), 2)
    midpoints = sps.csr_array((np.full(len(rows), 0.5), (rows, edges.T.ravel())), shape=(edges.shape[1], count))
    return sps.csr_array(sps.vstack([sps.eye_array(count), midpoints]))


def nearest(points: Points, segment: Array) -> Array:
    """Where on a segment (d, 2), from 0 at its start to 1 at its end, the nearest points to others (d, n) lie, (n,)."""
    along = segment[:, 1] - segment[:, 0]
    return np.clip(along @ (points - segment[:, :1]) / (along @ along), 0, 1)


def distance(points: Points, segment: Array) -> Array:
    """Distances of points (d, n) to a segment (d, 2), (n,)."""
    foot = segment[:, :1] + np.multiply.outer(segment[:, 1] - segment[:, 0], nearest(points, segment))
    return np.linalg.norm(points - foot, axis=0)


def on_segment(points: Points, segment: Array) -> Array:
    """Whether points (d, n) lie on a segment (d, 2) up to rounding, (n,)."""
    return distance(points, segment) <= 1e-9 * np.linalg.norm(segment[:, 1] - segment[:, 0])


@dataclass(frozen=True, eq=False)
class Skin:
    """The visible surface of a mesh, for pictures: the triangles of all cells in 2D, of the boundary facets in 3D.

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
        if mesh.dim() == 2:
            return cls(np.arange(mesh.p.shape[1]), mesh.t, np.arange(mesh.t.shape[1]))
        facets = mesh.boundary_facets()
        cells, corners = mesh.f2t[0, facets], mesh.facets[:, facets]
        fourth = mesh.t[:, cells].sum(axis=0) - corners.sum(axis=0)
        a, b, c, d = (mesh.p[:, vertex].T for vertex in (*corners, fourth))
        # The fourth vertex lies behind a facet whose corners run counter-clockwise.
        seen_from_inside = np.linalg.det(np.stack([b - a, c - a, d - a], axis=1)) > 0
        outer = np.where(seen_from_inside, corners[[0, 2, 1]], corners)
        vertices, triangles = np.unique(outer, return_inverse=True)
        return cls(vertices, triangles.reshape(outer.shape), cells)

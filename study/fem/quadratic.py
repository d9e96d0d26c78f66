"""Continuous piecewise quadratic displacements in Bernstein form, and those of them that are admissible.

On a cell v = Σ_α c_α B_α with a coefficient at every vertex and one at every edge. On Γ3 the trace v_ν is a polynomial
in Bernstein form, and v_ν ≤ 0 follows from ν·c ≤ 0 for its coefficients: the functions with N v ≤ 0 lie in K. (Signs of
the values at vertices and midpoints would not suffice.) The converse fails: K has more quadratic functions than these.

Strains are linear on a cell. They are stored at the three points of a rule that integrates products of two exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sps
from skfem import Mesh

from manufactured.body import Body, Kind
from manufactured.tensors import Array, Points, Tensors, basis, mandel
from study.fem import bernstein
from study.fem.mesh import barycentric_gradients, boundary_parts, cell_volumes
from study.fem.quadrature import simplex_rule


@dataclass(frozen=True, eq=False)
class Quadratic:
    """Continuous piecewise quadratic displacements that vanish on Γ1, on a mesh of triangles.

    A function is the vector of its free coefficients: first the vertices, then the edges, two components each.
    """

    mesh: Mesh
    body: Body

    @cached_property
    def parts(self) -> list[Array]:
        """Edges of each part of the body."""
        return boundary_parts(self.mesh, self.body)

    @property
    def cells(self) -> int:
        return int(self.mesh.t.shape[1])

    @property
    def count(self) -> int:
        """The number of scalar coefficients."""
        return int(self.mesh.p.shape[1] + self.mesh.facets.shape[1])

    @cached_property
    def numbers(self) -> Array:
        """Scalar coefficients of the cells: three vertices, three edges, (6, cells)."""
        return np.vstack([self.mesh.t, self.mesh.p.shape[1] + self.mesh.t2f])

    def on_edges(self, edges: Array) -> Array:
        """Scalar coefficients of the traces on edges in the order of B_α, from the first vertex, (3, n)."""
        ends = self.mesh.facets[:, edges]
        return np.vstack([ends[0], self.mesh.p.shape[1] + edges, ends[1]])

    @cached_property
    def free(self) -> Array:
        """Positions of the free coefficients in the vector of all, two components each."""
        fixed = np.zeros(self.count, dtype=bool)
        for part, edges in zip(self.body.parts, self.parts, strict=True):
            if part.kind is Kind.CLAMPED:
                fixed[self.on_edges(edges)] = True
        return np.flatnonzero(np.repeat(~fixed, 2))

    @property
    def dofs(self) -> int:
        return len(self.free)

    @cached_property
    def volumes(self) -> Array:
        """|T|, (cells,)."""
        return cell_volumes(self.mesh)

    def shapes(self, barycentric: Array) -> sps.csr_array:
        """v ↦ its values at the same points (3, q) of every cell, (2·cells·q, dofs)."""
        values = bernstein.values(barycentric)
        blocks = np.einsum("iq,dj->qdij", values, np.eye(2))
        return self._matrix(np.broadcast_to(blocks, (self.cells, *blocks.shape)))

    def strains(self, barycentric: Array) -> sps.csr_array:
        """v ↦ ε(v) in Mandel form at the same points (3, q) of every cell, (3·cells·q, dofs)."""
        gradients = bernstein.gradients(barycentric, barycentric_gradients(self.mesh))
        return self._matrix(np.einsum("Ijk,qcik->cqIij", basis(2), gradients, optimize=True))

    def _matrix(self, blocks: Array) -> sps.csr_array:
        """Rows (cells, q, m) by columns (coefficient of the cell, component): (cells, q, m, 6, 2) → sparse."""
        columns = np.broadcast_to(2 * self.numbers.T[:, None, None, :, None] + np.arange(2), blocks.shape)
        rows = int(np.prod(blocks.shape[:3]))
        full = sps.csr_array((blocks.ravel(), columns.ravel(), 12 * np.arange(rows + 1)), shape=(rows, 2 * self.count))
        full.eliminate_zeros()
        return sps.csr_array(full[:, self.free])

    @cached_property
    def rule(self) -> tuple[Array, Array]:
        """Barycentric points (3, 3), at which strains are stored, and weights (3,) of sum 1."""
        return simplex_rule(2, 2)

    @cached_property
    def E(self) -> sps.csr_array:
        """Strains at the points of the rule, (3·cells·3, dofs)."""
        return self.strains(self.rule[0])

    @cached_property
    def points(self) -> Array:
        """The points of the rule, (2, cells, 3)."""
        return np.einsum("dvc,vq->dcq", self.mesh.p[:, self.mesh.t], self.rule[0])

    @cached_property
    def weights(self) -> Array:
        """|T|/3 at the points, (cells, 3)."""
        return np.multiply.outer(self.volumes, self.rule[1])

    def strain(self, v: Array) -> Tensors:
        """ε(v) at the points of the rule, (3, cells, 3)."""
        return np.moveaxis((self.E @ v).reshape(self.cells, 3, 3), 2, 0)

    def functional(self, stress: Tensors) -> Array:
        """(σ, ε(·))_Q for a stress at the points of the rule, (3, cells, 3) → (dofs,)."""
        return self.E.T @ np.moveaxis(self.weights * stress, 0, 2).ravel()

    def form(self, C: Array, factor: Array) -> sps.csc_array:
        """The matrix of (α C ε(u), ε(v))_Q for α at the points of the rule, (cells, 3)."""
        weighted = sps.kron(sps.diags_array((self.weights * factor).ravel()), C, format="csr")
        matrix = sps.csc_array(self.E.T @ (weighted @ self.E))
        return sps.csc_array((matrix + matrix.T) / 2)

    @cached_property
    def N(self) -> sps.csr_array:
        """ν·c for the coefficients on Γ3 that are free, one row per piece and coefficient, (m, dofs)."""
        normals: list[Array] = []
        columns: list[Array] = []
        free = np.zeros(2 * self.count, dtype=bool)
        free[self.free] = True
        for part, edges in zip(self.body.parts, self.parts, strict=True):
            if part.kind is Kind.CONTACT:
                mine = np.unique(self.on_edges(edges))
                mine = mine[free[2 * mine]]
                seen = [c for normal, c in zip(normals, columns, strict=True) if np.allclose(normal, part.normal)]
                columns.append(np.setdiff1d(mine, np.concatenate([np.empty(0, dtype=int), *seen])))
                normals.append(part.normal)
        total = sum(map(len, columns))
        places = 2 * np.concatenate(columns)[:, None] + np.arange(2)
        values = np.concatenate([np.tile(n, (len(c), 1)) for n, c in zip(normals, columns, strict=True)])
        full = sps.csr_array((values.ravel(), places.ravel(), 2 * np.arange(total + 1)), shape=(total, 2 * self.count))
        return sps.csr_array(full[:, self.free])

    def coefficients(self, v: Array) -> Array:
        """All coefficients of a function, zero on Γ1: (dofs,) → (count, 2)."""
        full = np.zeros(2 * self.count)
        full[self.free] = v
        return full.reshape(-1, 2)

    def strain_at(self, v: Array, cells: Array, points: Points) -> Tensors:
        """ε(v) at points of some cells, (2, n, q) → (3, n, q)."""
        slopes = barycentric_gradients(self.mesh)[cells]
        corner = self.mesh.p[:, self.mesh.t[0, cells]]
        barycentric = np.einsum("nid,dnq->inq", slopes, points - corner[..., None])
        barycentric[0] += 1
        local = self.coefficients(v)[self.numbers[:, cells]]
        gradient = np.einsum("inj,nik,inq->jknq", 2 * local[:3], slopes, barycentric, optimize=True)
        for edge, (a, b) in enumerate(bernstein.EDGES, start=3):
            for first, second in ((a, b), (b, a)):
                gradient += np.einsum("nj,nk,nq->jknq", 2 * local[edge], slopes[:, first], barycentric[second])
        return mandel(gradient)

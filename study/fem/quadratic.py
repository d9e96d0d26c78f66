"""Continuous piecewise quadratic displacements on triangles, with linear constraints that make them admissible.

On a cell, v = Σ_α c_α B_α with the Bernstein polynomials B_α of degree 2: λ_i² for every vertex i and 2 λ_a λ_b for
every edge (a, b). On the contact boundary Γ3 the normal component v_ν is then a polynomial in Bernstein form with the
coefficients ν·c. If all of them are ≤ 0, so is v_ν. These are the constraints N v ≤ 0. (Values ≤ 0 at vertices and
midpoints would not suffice.) Not every admissible quadratic displacement satisfies them.
"""

from functools import cached_property

import numpy as np
import scipy.sparse as sps
from skfem import Mesh

from manufactured.body import Part
from manufactured.tensors import Array, Points, Tensors, basis, mandel
from study.fem.mesh import barycentric, barycentric_gradients
from study.fem.quadrature import PointsAndWeights, placed, simplex_rule
from study.fem.space import Displacements

EDGES = ((0, 1), (1, 2), (0, 2))
"""The two vertices of each edge of a cell, in the order in which the mesh numbers the edges."""


def nodes_of(mesh: Mesh) -> Points:
    """Return the vertices of a triangular mesh, then the midpoints of its edges, (2, count)."""
    return np.hstack([mesh.p, mesh.p[:, mesh.facets].mean(axis=1)])


def numbers_of(mesh: Mesh) -> Array:
    """Return the numbers of the six nodes of every cell, of its 3 vertices and then its 3 edges, (6, cells)."""
    return np.vstack([mesh.t, mesh.p.shape[1] + mesh.t2f])


class Quadratic(Displacements):
    """Displacements of degree 2 on a triangular mesh.

    Every vertex and every edge has one coefficient vector; all vertices come first.
    """

    @cached_property
    def numbers(self) -> Array:
        """The numbers of the six basis functions of every cell, for its 3 vertices and then its 3 edges, (6, cells)."""
        return numbers_of(self.mesh)

    @property
    def nodes(self) -> Points:
        """The vertices, then the midpoints of the edges, (2, count)."""
        return nodes_of(self.mesh)

    def on_edges(self, edges: Array) -> Array:
        """Return the numbers of the three basis functions on each edge, (3, n): first vertex, edge, second vertex."""
        ends = self.mesh.facets[:, edges]
        return np.vstack([ends[0], self.mesh.p.shape[1] + edges, ends[1]])

    def numbers_on(self, part: Part) -> Array:
        return np.unique(self.on_edges(self.facets(part)))

    @cached_property
    def rule(self) -> PointsAndWeights:
        """The quadrature rule on a cell: barycentric coordinates of three points, (3, 3), and weights with sum 1."""
        return simplex_rule(2, 2)

    @cached_property
    def points(self) -> Array:
        """The quadrature points, (2, cells, 3)."""
        return placed(self.mesh.p, self.mesh.t, self.rule[0])

    @cached_property
    def weights(self) -> Array:
        """The quadrature weights |T|/3 at the three points of every cell T, (cells, 3)."""
        return np.multiply.outer(self.volumes, self.rule[1])

    @cached_property
    def E(self) -> sps.csr_array:
        return self.strains(self.rule[0])

    def shapes(self, barycentric: Array) -> Array:
        """Return the six basis functions of a cell at points given by barycentric coordinates, (3, q) → (6, q)."""
        return np.array([*(x * x for x in barycentric), *(2 * barycentric[a] * barycentric[b] for a, b in EDGES)])

    def strains(self, barycentric: Array) -> sps.csr_array:
        """Return the matrix from a displacement to its strain at q points of every cell, (3 · cells · q, dofs).

        Args:
            barycentric: the barycentric coordinates of the points, (3, q).
        """
        slopes, outer = barycentric_gradients(self.mesh), np.multiply.outer
        gradients = np.stack(
            [
                *(2 * outer(barycentric[i], slopes[:, i]) for i in range(3)),
                *(2 * (outer(barycentric[a], slopes[:, b]) + outer(barycentric[b], slopes[:, a])) for a, b in EDGES),
            ],
            axis=2,
        )
        values = np.einsum("Ijk,qcik->Icqij", basis(2), gradients, optimize=True)
        return self._matrix(values, self.numbers.T[:, None])

    def strain_at(self, v: Array, cells: Array, points: Points) -> Tensors:
        """Return the strain of a displacement at q points of each of the given cells.

        Args:
            v: the coefficients of the displacement, (dofs,).
            cells: numbers of cells, (n,).
            points: points in these cells, (2, n, q).

        Returns:
            Strains in Mandel form, (3, n, q).
        """
        slopes, at = barycentric_gradients(self.mesh)[cells], barycentric(self.mesh, cells, points)
        local = self.coefficients(v)[self.numbers[:, cells]]
        gradient = np.einsum("inj,nik,inq->jknq", 2 * local[:3], slopes, at, optimize=True)
        for edge, (a, b) in enumerate(EDGES, start=3):
            for first, second in ((a, b), (b, a)):
                gradient += np.einsum("nj,nk,nq->jknq", 2 * local[edge], slopes[:, first], at[second])
        return mandel(gradient)

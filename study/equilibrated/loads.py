"""P f_0 and P f_2: the data as composite stresses can balance them, and what is left over.

P are the L² projections onto polynomials of degree k − 1 on the thirds of cells and of degree k on the edges of Γ2. The
thirds are cut along the lines at which the data are rough (``study.fem.quadrature``).
"""

from __future__ import annotations

import numpy as np
from skfem import Mesh, MeshTri

from manufactured.body import Kind
from manufactured.data import Data
from manufactured.tensors import Array, Points, Vectors
from study.equilibrated.composite import SIDES, bernstein
from study.equilibrated.hybrid import Loads
from study.equilibrated.stresses import StressSpace
from study.fem.quadrature import Line, cell_rules

DEGREE = 4
"""Degree of the rule for f_0 on a third."""
EDGE_POINTS = 6
"""Gauss points for f_2 on an edge."""


def _cut(space: StressSpace) -> tuple[Mesh, Points]:
    """The mesh of the thirds, those of a cell one after the other, and their vertices, (2, 3, thirds)."""
    mesh = space.mesh
    vertices = np.vstack([mesh.t, mesh.p.shape[1] + np.arange(space.cells)])
    cells = np.stack([vertices[[a, b, 3]] for a, b in SIDES], axis=2).reshape(3, -1)
    points = np.hstack([mesh.p, mesh.p[:, mesh.t].mean(axis=1)])
    return MeshTri(points, np.ascontiguousarray(cells)), points[:, cells]


def _barycentric(corners: Points, x: Points) -> Array:
    """Coordinates of points of triangles (2, 3, n) in their vertices: (2, n, q) → (3, n, q)."""
    edges = np.moveaxis(corners[:, :2] - corners[:, 2:], 2, 0)
    found = np.einsum("nvd,dnq->vnq", np.linalg.inv(edges), x - corners[:, 2][..., None])
    return np.concatenate([found, 1 - found.sum(axis=0, keepdims=True)])


class _Block:
    """Some thirds with their quadrature, f_0 at the points and the functions it is projected onto."""

    def __init__(self, data: Data, cells: Array, points: Points, weights: Array, shapes: Array) -> None:
        self.cells, self.weights, self.shapes = cells, weights, shapes
        self.force = data.body_force(points)
        gram = np.einsum("anq,bnq,nq->nab", shapes, shapes, weights, optimize=True)
        self.projection = np.einsum("nab,bnq,nq->naq", np.linalg.inv(gram), shapes, weights, optimize=True)

    def __call__(self, time: float) -> tuple[Array, Array]:
        """Coefficients of P f_0, (n, lower, 2), and ‖f_0 − P f_0‖² on each third, (n,)."""
        force = self.force(time)
        coefficients = np.einsum("naq,dnq->nad", self.projection, force, optimize=True)
        rest = force - np.einsum("nad,anq->dnq", coefficients, self.shapes, optimize=True)
        return coefficients, np.einsum("dnq,dnq,nq->n", rest, rest, self.weights, optimize=True)


class ProjectedLoads:
    """t ↦ (P f_0, P f_2) and the oscillations, for data on a space of stresses."""

    def __init__(self, data: Data, space: StressSpace) -> None:
        self.space = space
        mesh, corners = _cut(space)
        lines = [Line(direction, offset) for direction, offset in data.lines]
        self._blocks = []
        for rule in cell_rules(mesh, DEGREE, lines, data.points):
            shapes = bernstein(space.degree - 1, _barycentric(corners[:, :, rule.cells], rule.points))
            self._blocks.append(_Block(data, rule.cells, rule.points, rule.weights, shapes))
        x, weights = np.polynomial.legendre.leggauss(EDGE_POINTS)
        x, self._weights = (x + 1) / 2, weights / 2
        self._shapes = bernstein(space.degree, np.array([1 - x, x]))
        self._projection = np.linalg.solve((self._shapes * self._weights) @ self._shapes.T, self._shapes * self._weights)
        self._edges = []
        for part, edges in space.on(Kind.LOADED):
            ends = space.mesh.p[:, space.mesh.facets[:, edges]]
            points = np.einsum("den,eq->dnq", ends, np.array([1 - x, x]))
            self._edges.append((edges, data.surface_load(part, points)))

    def __call__(self, time: float) -> Loads:
        """P f_0 and P f_2."""
        return self.with_oscillation(time)[0]

    def with_oscillation(self, time: float) -> tuple[Loads, Array, Array]:
        """The projections, ‖f_0 − P f_0‖² on the cells (cells,) and ‖f_2 − P f_2‖² on the edges (edges,)."""
        space = self.space
        lower = space.degree * (space.degree + 1) // 2
        force, rest = np.empty((3 * space.cells, lower, 2)), np.empty(3 * space.cells)
        for block in self._blocks:
            force[block.cells], rest[block.cells] = block(time)
        surface = np.zeros((space.mesh.facets.shape[1], space.degree + 1, 2))
        rough = np.zeros(len(surface))
        for edges, load in self._edges:
            values: Vectors = load(time)
            surface[edges] = np.einsum("aq,dnq->nad", self._projection, values)
            left = values - np.einsum("nad,aq->dnq", surface[edges], self._shapes)
            rough[edges] = np.einsum("dnq,dnq,q->n", left, left, self._weights) * space.lengths[edges]
        loads = Loads(force.reshape(space.cells, 3, lower, 2), surface)
        return loads, rest.reshape(space.cells, 3).sum(axis=1), rough

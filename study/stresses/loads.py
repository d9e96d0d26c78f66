"""P f_0 and P f_2: the data as composite stresses can balance them, and what is left over.

P are the L² projections onto polynomials of degree k − 1 on the thirds of cells and of degree k on the edges of Γ2.
Thirds and edges are cut along the lines at which the data are rough (``study.fem.quadrature``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from skfem import Mesh, MeshTri

from manufactured.body import Kind, Part
from manufactured.data import Data
from manufactured.tensors import Array, Points
from study.fem.line import Line
from study.fem.quadrature import CellRule, cell_rules, facet_rule, simplex_rule
from study.stresses.composite import SIDES, bernstein
from study.stresses.hybrid import Loads
from study.stresses.space import StressSpace

DEGREE = 4
"""Degree of the rule for f_0 on a third, at least; 2k if that is more."""
EDGE_POINTS = 6
"""Gauss points for f_2 on an edge."""
GRADED_POINTS = 28
"""Where edges are cut and their rules graded with the power 8: exact to degree 6, for products of two of degree 3."""
PARALLEL = 1e-9
"""Sine of an angle below which a line is parallel to a part."""


def cut(space: StressSpace) -> tuple[Mesh, Points]:
    """The mesh of the thirds, those of a cell one after the other, and their vertices, (2, 3, thirds)."""
    mesh = space.mesh
    vertices = np.vstack([mesh.t, mesh.p.shape[1] + np.arange(space.cells)])
    cells = np.stack([vertices[[a, b, 3]] for a, b in SIDES], axis=2).reshape(3, -1)
    points = np.hstack([mesh.p, mesh.p[:, mesh.t].mean(axis=1)])
    return MeshTri(points, np.ascontiguousarray(cells)), points[:, cells]


def barycentric(corners: Points, x: Points) -> Array:
    """Coordinates of points of triangles (2, 3, n) in their vertices: (2, n, q) → (3, n, q)."""
    edges = np.moveaxis(corners[:, :2] - corners[:, 2:], 2, 0)
    found = np.einsum("nvd,dnq->vnq", np.linalg.inv(edges), x - corners[:, 2][..., None])
    return np.concatenate([found, 1 - found.sum(axis=0, keepdims=True)])


class _Block:
    """Some thirds with their quadrature, f_0 at the points and the functions it is projected onto.

    Attributes:
        cells: which thirds, (n,).
        shapes: Bernstein polynomials of degree k − 1 of the thirds at the points, (lower, n, q).
            whole: those of degree k of the cells, (more, n, q).
    """

    def __init__(self, data: Data, rule: CellRule, shapes: Array, whole: Array) -> None:
        self.cells, self.weights = rule.cells, rule.weights
        self.shapes, self.whole = shapes, whole
        self.force = data.body_force(rule.points)
        gram = np.einsum("anq,bnq,nq->nab", shapes, shapes, rule.weights, optimize=True)
        self.projection = np.einsum("nab,bnq,nq->naq", np.linalg.inv(gram), shapes, rule.weights, optimize=True)

    def __call__(self, time: float) -> tuple[Array, Array, Array]:
        """P f_0, (n, lower, 2), and for g = f_0 − P f_0: ‖g‖² on the thirds, (n,), ∫ g q, (n, more, 2)."""
        force = self.force(time)
        coefficients = np.einsum("naq,dnq->nad", self.projection, force, optimize=True)
        rest = force - np.einsum("nad,anq->dnq", coefficients, self.shapes, optimize=True)
        weighted = rest * self.weights
        return (
            coefficients,
            np.einsum("dnq,dnq->n", rest, weighted),
            np.einsum("dnq,anq->nad", weighted, self.whole, optimize=True),
        )


class _Edges:
    """The edges of one piece of Γ2 with their quadrature, cut where lines of the data meet them."""

    def __init__(self, data: Data, space: StressSpace, part: Part, edges: Array) -> None:
        crossings = _crossings(data, part)
        rule = facet_rule(space.mesh, edges, part, crossings, GRADED_POINTS if crossings else EDGE_POINTS)
        self.edges, self.weights = edges, rule.weights
        self.shapes = bernstein(space.degree, rule.shapes)
        self.load = data.surface_load(part, part.point(rule.s))
        gram = np.einsum("anq,bnq,nq->nab", self.shapes, self.shapes, rule.weights)
        self.projection = np.einsum("nab,bnq,nq->naq", np.linalg.inv(gram), self.shapes, rule.weights)

    def __call__(self, time: float) -> tuple[Array, Array]:
        """P f_2, (n, k + 1, 2), and ‖f_2 − P f_2‖_e, (n,)."""
        values = self.load(time)
        coefficients = np.einsum("naq,dnq->nad", self.projection, values)
        left = values - np.einsum("nad,anq->dnq", coefficients, self.shapes)
        return coefficients, np.sqrt(np.einsum("dnq,dnq,nq->n", left, left, self.weights))


def _crossings(data: Data, part: Part) -> tuple[float, ...]:
    """Coordinates along a part at which lines of the data meet it."""
    found = []
    for direction, offset in data.lines:
        slope, start = np.dot(direction, part.tangent), np.dot(direction, part.start)
        if abs(slope) > PARALLEL and 0 < (offset - start) / slope < part.measure:
            found.append(float((offset - start) / slope))
    return tuple(sorted(found))


@dataclass(frozen=True, eq=False)
class Snapshot:
    """The data at one time.

    Attributes:
        loads: P f_0 and P f_2.
        bowed: ‖Π g‖_T for g = f_0 − P f_0 and the projection Π onto P_k(T)², (cells,).
        rest: ‖g − Π g‖_T, (cells,).
        around: ‖f_2 − P f_2‖_e, (edges,), zero off Γ2.
    """

    loads: Loads
    bowed: Array
    rest: Array
    around: Array


class ProjectedLoads:
    """t ↦ (P f_0, P f_2) and the oscillations, for data on a space of stresses."""

    def __init__(self, data: Data, space: StressSpace) -> None:
        self.space = space
        mesh, corners = cut(space)
        lines = [Line(direction, offset) for direction, offset in data.lines]
        cells = np.repeat(space.mesh.p[:, space.mesh.t], 3, axis=2)
        self._blocks = []
        for rule in cell_rules(mesh, max(DEGREE, 2 * space.degree), lines, data.points):
            local, full = (barycentric(c[:, :, rule.cells], rule.points) for c in (corners, cells))
            shapes, whole = bernstein(space.degree - 1, local), bernstein(space.degree, full)
            self._blocks.append(_Block(data, rule, shapes, whole))
        self._pieces = [_Edges(data, space, part, edges) for part, edges in space.on(Kind.LOADED)]

    def __call__(self, time: float) -> Loads:
        """P f_0 and P f_2."""
        return self.at(time).loads

    def at(self, time: float) -> Snapshot:
        """The projections, what they leave out and the data themselves."""
        space = self.space
        lower = space.degree * (space.degree + 1) // 2
        force, squares = np.empty((3 * space.cells, lower, 2)), np.empty(3 * space.cells)
        gram = _gram(space.degree)
        moments = np.empty((3 * space.cells, len(gram), 2))
        for block in self._blocks:
            force[block.cells], squares[block.cells], moments[block.cells] = block(time)
        surface = np.zeros((space.mesh.facets.shape[1], space.degree + 1, 2))
        around = np.zeros(len(surface))
        for piece in self._pieces:
            surface[piece.edges], around[piece.edges] = piece(time)
        total = squares.reshape(-1, 3).sum(axis=1)
        of_cells = moments.reshape(space.cells, 3, -1, 2).sum(axis=1)
        bowed = np.einsum("cad,ab,cbd->c", of_cells, np.linalg.inv(gram), of_cells) / space.volumes
        return Snapshot(
            Loads(force.reshape(space.cells, 3, lower, 2), surface),
            np.sqrt(np.maximum(bowed, 0.0)),
            np.sqrt(np.maximum(total - bowed, 0.0)),
            around,
        )


def _gram(degree: int) -> Array:
    """(1/|T|) ∫_T B_α B_β for polynomials of a degree."""
    barycentric, weights = simplex_rule(2, 2 * degree)
    at = bernstein(degree, barycentric)
    return (at * weights) @ at.T

"""The projected loads P f_0 and P f_2, which composite stresses can balance, and their distances from f_0 and f_2.

P is the L² projection for stresses of degree k: of the body force f_0 onto polynomials of degree k − 1 on the
subtriangles of cells, and of the traction f_2 onto polynomials of degree k on the edges of Γ2.

Every cell is divided by its barycentre into three subtriangles. Quadrature rules on subtriangles and edges are cut
along the lines at which the data are not smooth (``study.fem.quadrature``). Because f_0 jumps at moving contact fronts,
the rules on subtriangles are also cut along the fronts at the given time. This matters: without these cuts, ‖σ − σ^h‖_Q
on one-diagonal meshes was 2.4 times as large at n = 64, and the error of the pressure 19 times.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from manufactured.body import Kind, Part
from manufactured.data import Data, ForceInTime
from manufactured.tensors import Array, Points, Vectors
from study.fem.mesh import barycentric
from study.fem.quadrature import (
    CellRule,
    Line,
    amplitudes_of,
    bernstein,
    cell_rules,
    facet_rule,
    rough_cells,
    sliced_rules,
    strain_matrix,
)
from study.stresses.stress_space import StressSpace, alfeld_split, triangle_mass

LEAST_FORCE_DEGREE = 4
"""Least degree of the quadrature rule for the body force f_0 on a subtriangle of a cell.

For stresses of degree k, the degree 2k is used if it is larger.
"""
EDGE_POINTS, EDGE_PARTS = 6, 4
"""The quadrature rule for the traction f_2 on an edge: number of Gauss points on each part of the edge, and of parts.

An edge is divided into equal parts so that a kink of f_2 affects one part only.
"""
GRADED_POINTS = 28
"""Number of Gauss points on edges where the traction has a kink, towards which the points are graded.

The grading by the power 8 leaves the degree 6, which is enough for products of two cubics.
"""
PARALLEL_LINE = 1e-9
"""A line counts as parallel to a boundary part if the sine of the angle between them is below this number."""


@dataclass(frozen=True, eq=False)
class Loads:
    """Loads at one time, projected (P) onto piecewise polynomials and given by their Bernstein coefficients.

    Attributes:
        force: the projected body force P f_0, (cells, 3, lower, 2); loads at several times have one more axis, the
            first. Axes: cell, subtriangle, Bernstein polynomial of degree k − 1 (``lower`` in number), component; k is
            the degree of the stresses that balance the loads.
        surface: the projected traction P f_2, zero outside the loaded boundary, (edges, n, 2). Axes: edge, Bernstein
            polynomial of degree k (n = k + 1 in number), component.
    """

    force: Array
    surface: Array

    def __add__(self, other: Loads) -> Loads:
        return Loads(self.force + other.force, self.surface + other.surface)

    def __rmul__(self, factor: float) -> Loads:
        return Loads(factor * self.force, factor * self.surface)


def together(loads: Sequence[Loads]) -> Loads:
    """Join loads at single times to one object with loads at several times; the new axis is the first one."""
    return Loads(np.array([each.force for each in loads]), np.array([each.surface for each in loads]))


@dataclass(frozen=True, eq=False)
class LeftOut:
    """Norms of the part of the loads that their projection P onto piecewise polynomials leaves out, at one time.

    P f_0 has degree k − 1 on each of the three subtriangles of a cell, and P f_2 degree k on each edge, where k is the
    degree of the stresses that balance P f_0. Let g = f_0 − P f_0 for the body force f_0, and let Π be the L²
    projection onto the polynomials of degree k on a whole cell T.

    Attributes:
        low_order: the norm ‖Π g‖_T of the part of g that is a polynomial of degree k on the whole cell, (cells,).
        high_order: the norm ‖g − Π g‖_T of the rest of g, (cells,).
        on_edges: the norm ‖f_2 − P f_2‖_e of the rest of the traction f_2 on every edge e, zero outside the loaded
            boundary Γ2, (edges,).
    """

    low_order: Array
    high_order: Array
    on_edges: Array


@dataclass(frozen=True, eq=False)
class Snapshot:
    """Loads at one time, projected onto piecewise polynomials.

    Attributes:
        loads: the projected loads.
        left_out: norms of the part of the loads that the projection leaves out.
    """

    loads: Loads
    left_out: LeftOut


class ProjectedLoads:
    """Computes the projections P f_0 and P f_2 of body force and traction onto piecewise polynomials, at any time.

    Discrete stresses can balance the projected loads exactly.

    Args:
        data: the problem.
        space: the composite stresses that balance the projected loads.
        raised: a number added to the degree of the quadrature rule for f_0.
    """

    def __init__(self, data: Data, space: StressSpace, raised: int = 0) -> None:
        self.space = space
        self.data = data
        self._thirds, self._vertices = alfeld_split(space.mesh)
        self._degree = max(LEAST_FORCE_DEGREE, 2 * space.degree) + raised
        self._lines = [Line(*line) for line in data.lines]
        self._cut = np.any(rough_cells(self._thirds, self._lines, data.points), axis=0)
        self._inverse_mass = np.linalg.inv(triangle_mass(space.degree))
        self._parts = [_Edges(data, space, part, edges) for part, edges in space.on(Kind.LOADED)]

    def __call__(self, time: float) -> Loads:
        """Return the projected loads P f_0 and P f_2 at a time."""
        return self.at(time).loads

    def _block(self, rule: CellRule) -> _Block:
        mesh = self.space.mesh
        degree = self.space.degree
        # The vertices are not ``self._thirds.t``, because the mesh sorts them.
        in_thirds = barycentric(self._thirds.p, self._vertices[:, rule.cells], rule.points)
        # The subtriangles 3 n, 3 n + 1 and 3 n + 2 belong to the cell n.
        in_cells = barycentric(mesh.p, mesh.t[:, rule.cells // 3], rule.points)
        return _Block(rule, bernstein(degree - 1, in_thirds), bernstein(degree, in_cells))

    @cached_property
    def _blocks(self) -> list[tuple[_Block, ForceInTime]]:
        """The subtriangles of all cells, three per cell, divided into blocks that are processed together.

        Each block comes with the function from a time to the body force f_0 at its quadrature points, (2, n, q), where
        n is the number of subtriangles in the block and q the number of points in each.
        """
        rules = cell_rules(self._thirds, self._degree, self._lines, self.data.points)
        return [(self._block(rule), _force_at(self.data, rule.points)) for rule in rules]

    def _evaluated(self, time: float) -> Iterator[tuple[_Block, Vectors]]:
        """Yield blocks of subtriangles, each with the body force f_0 at its quadrature points at a time.

        First all subtriangles are yielded. Subtriangles that contact fronts cross at this time are then yielded again,
        with quadrature rules that are cut along the fronts; their results replace the first ones.
        """
        for block, force in self._blocks:
            yield block, force(time)
        fronts = [Line(*line) for line in self.data.fronts(time)]
        for rule in sliced_rules(self._thirds, fronts, self._cut, self._degree):
            yield self._block(rule), self.data.body_force(rule.points)(time)

    def at(self, time: float) -> Snapshot:
        """Return the projected loads at a time, and norms of the part of the loads that the projection leaves out."""
        space = self.space
        thirds = 3 * space.cells
        force = np.empty((thirds, len(space.force_shapes), 2))
        squares = np.empty(thirds)
        moments = np.empty((thirds, len(self._inverse_mass), 2))
        for block, values in self._evaluated(time):
            here = block.rule.cells
            force[here], squares[here], moments[here] = block.split(values)
        surface = np.zeros((len(space.lengths), space.degree + 1, 2))
        on_edges = np.zeros_like(space.lengths)
        for loaded in self._parts:
            surface[loaded.edges], on_edges[loaded.edges] = loaded.split(time)
        of_cells = moments.reshape(space.cells, 3, -1, 2).sum(axis=1)
        low_order = (of_cells * (self._inverse_mass @ of_cells)).sum(axis=(1, 2)) / space.volumes
        high_order = squares.reshape(-1, 3).sum(axis=1) - low_order
        low, high = np.sqrt(np.maximum([low_order, high_order], 0.0))
        loads = Loads(force.reshape(space.cells, 3, -1, 2), surface)
        return Snapshot(loads, LeftOut(low, high, on_edges))


class Projection:
    """The L² projection onto polynomials on n subtriangles or edges, from values at quadrature points.

    Calling the object with the values of a field with c components, (c, n, q), returns the coefficients of the
    projection, (n, basis, c), and the rest of the field at the points, (n, q, c).

    Args:
        shapes: the values of a basis of the polynomials at the q quadrature points on each subtriangle or edge, (basis,
            n, q).
        weights: the quadrature weights, (n, q).
    """

    def __init__(self, shapes: Array, weights: Array) -> None:
        self._shapes = np.ascontiguousarray(np.moveaxis(shapes, 0, 2))
        weighted = self._shapes.swapaxes(1, 2) * weights[:, None]
        self._matrix = np.linalg.inv(weighted @ self._shapes) @ weighted

    def __call__(self, field: Vectors) -> tuple[Array, Array]:
        """Split a field with c components, (c, n, q), into its projection and the rest.

        Returns:
            The coefficients of the projection, (n, basis, c), and the rest at the points, (n, q, c).
        """
        at_points = field.transpose(1, 2, 0)
        coefficients = self._matrix @ at_points
        return coefficients, at_points - self._shapes @ coefficients


class _Block:
    """Several subtriangles of cells with the same quadrature rule; projects the body force f_0 on them.

    Args:
        rule: the quadrature rule, with q points on each of the n subtriangles.
        shapes: the values of the ``lower`` Bernstein polynomials of degree k − 1 of the subtriangles at the points,
            (lower, n, q).
        whole: the values of the ``more`` Bernstein polynomials of degree k of the whole cells at the points,
            (more, n, q).
    """

    def __init__(self, rule: CellRule, shapes: Array, whole: Array) -> None:
        self.rule = rule
        self._whole = np.ascontiguousarray(np.moveaxis(whole, 0, 1))
        self._projection = Projection(shapes, rule.weights)

    def split(self, force: Vectors) -> tuple[Array, Array, Array]:
        """Split the body force f_0, given at the quadrature points, (2, n, q), into P f_0 and g = f_0 − P f_0.

        Returns:
            P f_0, (n, lower, 2); the squares ‖g‖² on the subtriangles, (n,); and the integrals ∫ g B_α over the
            subtriangles with the Bernstein polynomials B_α of degree k of the cells, (n, more, 2).
        """
        coefficients, rest = self._projection(force)
        weighted = rest * self.rule.weights[..., None]
        return coefficients, np.einsum("nqx,nqx->n", rest, weighted), self._whole @ weighted


def _force_at(data: Data, x: Points) -> ForceInTime:
    """Return the function from a time to f_0 at points (2, ...).

    If f_0 is known as a sum of products (``Modes``), the function uses this sum, which is faster.
    """
    if data.force_modes is None:
        return data.body_force(x)
    modes = data.force_modes(x.reshape(len(x), -1))
    rates = amplitudes_of(modes.viscous)
    strains = amplitudes_of(modes.elastic)
    viscous = strain_matrix(modes.viscous, x[0].size)
    elastic = strain_matrix(modes.elastic, x[0].size)

    def force(time: float) -> Vectors:
        now = np.array([time])
        total = viscous @ rates(now, True) + elastic @ strains(now, False)
        return total.reshape(x.shape)

    return force


class _Edges:
    """The edges of one part of Γ2, with a quadrature rule and the traction f_2 at its points."""

    def __init__(self, data: Data, space: StressSpace, part: Part, edges: Array) -> None:
        # The positions at which the part crosses lines where the data are not smooth.
        crossings = []
        for direction, offset in data.lines:
            slope = np.dot(direction, part.tangent)
            if abs(slope) > PARALLEL_LINE:
                s = (offset - np.dot(direction, part.start)) / slope
                if 0 < s < part.measure:
                    crossings.append(s)
        points, divisions = (GRADED_POINTS, 1) if crossings else (EDGE_POINTS, EDGE_PARTS)
        rule = facet_rule(space.mesh, edges, part, crossings, points, divisions)
        self.edges = edges
        self.weights = rule.weights
        self._projection = Projection(bernstein(space.degree, rule.shapes), rule.weights)
        self.load = data.surface_load(part, part.point(rule.s))

    def split(self, time: float) -> tuple[Array, Array]:
        """Return the L² projection P f_2 of the traction at a time onto polynomials of degree k on n edges e.

        Returns:
            The Bernstein coefficients of P f_2, (n, k + 1, 2), and the norms ‖f_2 − P f_2‖_e, (n,)."""
        coefficients, rest = self._projection(self.load(time))
        return coefficients, np.sqrt(np.einsum("nqd,nqd,nq->n", rest, rest, self.weights))

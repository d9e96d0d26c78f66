"""Distances to the exact solution in the norm of V, and the exact stress as a functional on V^h.

The strain of a P1 function is constant on every cell, so with the cell means ε̄ of the exact strain

    ‖u(t) − v‖_V² = Σ_T ∫_T A(ε(u) − ε̄)·(ε(u) − ε̄) + Σ_T |T| A(ε̄ − ε(v))·(ε̄ − ε(v)).

The first sum does not see v: it is evaluated once per time, and is a lower bound for every v ∈ V^h.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from skfem import Mesh

from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution, Fields
from manufactured.law import Linear
from manufactured.tensors import Array, Tensors
from study.fem.quadrature import CellRule, Line, cell_rules, facet_rule
from study.fem.space import Space

DEGREE = 4
"""Degree of the standard cell rule in 2D: exact for the square of a linear strain error, and two more for kinks
that cross a cell. Every row of a rate table records what a rule raised by two would change."""

SOLID_DEGREE = 2
"""The same in 3D, without the two more: evaluation of exact fields is what 3D levels cost."""

FACET_POINTS = 8
"""Gauss points on a contact facet, or on each side of a rough point of it."""


@dataclass(frozen=True, eq=False)
class Sample:
    """The exact solution at one time, as far as V^h can tell.

    Attributes:
        time: t.
        means: cell means of ε(u(t)), (D, cells).
        oscillation: Σ_T ∫_T A(ε(u) − ε̄)·(ε(u) − ε̄).
        interpolant: Π^h u(t), (n_dofs,).
    """

    time: float
    means: Tensors
    oscillation: float
    interpolant: Array


@dataclass(frozen=True, eq=False)
class Block:
    """Some cells with their quadrature.

    Attributes:
        cells: indices, (n,).
        viscous, elastic: quadrature weights times the factors of A and of G, (n, q).
        fields: the exact solution at the points.
    """

    cells: Array
    viscous: Array
    elastic: Array
    fields: Fields


class Gauge:
    """Measures functions of V^h against an exact solution.

    Where A varies within a cell, ε̄ is the mean of the exact strain weighted by A's factor.

    Args:
        solution: the exact solution.
        space: V^h.
        raised: added to the degree of the cell rules and to the points of the facet rules.
    """

    def __init__(self, solution: ExactSolution, space: Space, raised: int = 0) -> None:
        self.solution, self.space = solution, space
        self.A = solution.law.A
        self.degree = (DEGREE if space.dim == 2 else SOLID_DEGREE) + raised
        self.viscous, self.elastic = np.empty((2, len(space.volumes)))
        self._blocks = [self._block(rule) for rule in rules(solution, space.mesh, self.degree)]
        self._nodes = solution.at(space.mesh.p)
        self._faces = []
        for face in solution.faces:
            facets = space.facets(face.part)
            rule = facet_rule(space.mesh, facets, face.part, face.rough, FACET_POINTS + raised)
            self._faces.append((face, solution.on(face, rule.s), rule))

    def _block(self, rule: CellRule) -> Block:
        law = self.solution.law
        viscous, elastic = (rule.weights * tensor.factor(rule.points) for tensor in (law.A, law.G))
        self.viscous[rule.cells], self.elastic[rule.cells] = viscous.sum(axis=1), elastic.sum(axis=1)
        return Block(rule.cells, viscous, elastic, self.solution.at(rule.points))

    def sample(self, time: float) -> Sample:
        """Means, oscillation and interpolant of u(t)."""
        means = np.empty((self.A.matrix.shape[0], len(self.space.volumes)))
        oscillation = 0.0
        for block in self._blocks:
            strain = block.fields.strain(time)
            mean = np.einsum("Inq,nq->In", strain, block.viscous) / self.viscous[block.cells]
            means[:, block.cells] = mean
            strain -= mean[..., None]
            size = np.einsum("Inq,Inq->nq", np.tensordot(self.A.matrix, strain, axes=1), strain)
            oscillation += float(np.vdot(size, block.viscous))
        return Sample(time, means, oscillation, self.space.interpolate(self._nodes.displacement(time)))

    def distance(self, sample: Sample, v: Array) -> float:
        """‖u(t) − v‖_V for v ∈ V^h."""
        difference = sample.means - self.space.strain(v)
        between = float(np.einsum("Ic,Ic,c->", self.A.matrix @ difference, difference, self.viscous))
        return float(np.sqrt(sample.oscillation + between))

    def load(self, time: float) -> Array:
        """(f(t), v)_V = (σ(t), ε(v))_Q − ∫_{Γ3} σ_ν v_ν for v ∈ V^h, (n_dofs,).

        Green's formula (2.14) with (2.2), (2.4) and σ_τ = 0: no derivative of σ is needed, so this
        serves solutions whose f_0 is not in L² as well.
        """
        G = self.solution.law.G
        rate, elastic = np.empty((2, self.A.matrix.shape[0], len(self.space.volumes)))
        for block in self._blocks:
            rate[:, block.cells] = np.einsum("Inq,nq->In", block.fields.strain_rate(time), block.viscous)
            # The mean of a linear G is G of the mean.
            strain = block.fields.strain(time)
            response = strain if isinstance(G, Linear) else G(strain)
            elastic[:, block.cells] = np.einsum("Inq,nq->In", response, block.elastic)
        stress = self.solution.law.A.matrix @ rate + (G.matrix @ elastic if isinstance(G, Linear) else elastic)
        return self.space.functional(stress / self.space.volumes) + self._contact_work(time)

    def _contact_work(self, time: float) -> Array:
        """∫_{Γ3} p v_ν, (n_dofs,)."""
        nodal = np.zeros_like(self.space.mesh.p)
        for face, fields, rule in self._faces:
            moments = np.einsum("anq,nq->an", rule.shapes, rule.weights * fields.pressure(time))
            vertices = self.space.mesh.facets[:, rule.facets]
            nodal += self.space.scatter(vertices, np.multiply.outer(face.part.normal, moments))
        return self.space.interpolate(nodal)


def rules(solution: ExactSolution, mesh: Mesh, degree: int) -> list[CellRule]:
    """Cell rules that respect where the strain of a solution is rough for all times."""
    return cell_rules(mesh, degree, rough_lines(solution), solution.singular)


def rough_lines(solution: ExactSolution) -> tuple[Line, ...]:
    """{s = c} for every c ∈ ``rough`` of every lifting, and where the factors of A and G jump."""
    found = []
    for face in solution.faces:
        if isinstance(face, ContactFace):
            tangent = face.part.tangent
            found += [Line(tuple(tangent), float(tangent @ face.part.start) + c) for c in face.rough]
    return (*found, *(Line(direction, offset) for direction, offset in solution.law.steps))

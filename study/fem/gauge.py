"""Distances to the exact solution in the norm of V, and the exact stress as a functional on V^h.

The strain of a P1 function is constant on every cell, so with the cell means ε̄ of the exact strain

    ‖u(t) − v‖_V² = Σ_T ∫_T A(ε(u) − ε̄)·(ε(u) − ε̄) + Σ_T |T| A(ε̄ − ε(v))·(ε̄ − ε(v)).

The first sum does not see v: it is evaluated once per time, and is a lower bound for every v ∈ V^h.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from manufactured.exact import ExactSolution
from manufactured.tensors import Array, Tensors
from study.fem.quadrature import Line, cell_rules, facet_rule
from study.fem.space import Space

DEGREE = 4
"""Degree of the standard cell rule: exact for the square of a linear strain error, and two more for
kinks that cross a cell. Every row of a rate table records what a rule raised by two would change."""

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


class Gauge:
    """Measures functions of V^h against an exact solution.

    Args:
        solution: the exact solution.
        space: V^h.
        raised: added to the degree of the cell rules and to the points of the facet rules.
    """

    def __init__(self, solution: ExactSolution, space: Space, raised: int = 0) -> None:
        self.solution, self.space = solution, space
        self.A = solution.law.A
        self.degree = DEGREE + raised
        rules = cell_rules(space.mesh, self.degree, rough_lines(solution))
        self._blocks = [(rule.cells, rule.weights, solution.at(rule.points)) for rule in rules]
        self._nodes = solution.at(space.mesh.p)
        self._faces = []
        for face in solution.faces:
            facets = space.facets(face.part)
            rule = facet_rule(space.mesh, facets, face.part, face.rough, FACET_POINTS + raised)
            self._faces.append((face, solution.on(face, rule.s), rule))

    def sample(self, time: float) -> Sample:
        """Means, oscillation and interpolant of u(t)."""
        means = np.empty((self.A.matrix.shape[0], len(self.space.volumes)))
        oscillation = 0.0
        for cells, weights, fields in self._blocks:
            strain = fields.strain(time)
            mean = np.einsum("Inq,nq->In", strain, weights) / self.space.volumes[cells]
            means[:, cells] = mean
            deviation = strain - mean[..., None]
            oscillation += float(
                np.einsum(
                    "Inq,Inq,nq->", self.A(deviation), deviation, weights, optimize=["einsum_path", (0, 1), (0, 1)]
                )
            )
        return Sample(time, means, oscillation, self.space.interpolate(self._nodes.displacement(time)))

    def distance(self, sample: Sample, v: Array) -> float:
        """‖u(t) − v‖_V for v ∈ V^h."""
        difference = sample.means - self.space.strain(v)
        between = float(np.einsum("Ic,Ic,c->", self.A(difference), difference, self.space.volumes))
        return float(np.sqrt(sample.oscillation + between))

    def load(self, time: float) -> Array:
        """(f(t), v)_V = (σ(t), ε(v))_Q − ∫_{Γ3} σ_ν v_ν for v ∈ V^h, (n_dofs,).

        Green's formula (2.14) with (2.2), (2.4) and σ_τ = 0: no derivative of σ is needed, so this
        serves solutions whose f_0 is not in L² as well.
        """
        stress = np.empty((self.solution.law.A.matrix.shape[0], len(self.space.volumes)))
        for cells, weights, fields in self._blocks:
            stress[:, cells] = np.einsum("Inq,nq->In", fields.stress(time), weights) / self.space.volumes[cells]
        return self.space.functional(stress) + self._contact_work(time)

    def _contact_work(self, time: float) -> Array:
        """∫_{Γ3} p v_ν, (n_dofs,)."""
        nodal = np.zeros_like(self.space.mesh.p)
        for face, fields, rule in self._faces:
            moments = np.einsum("anq,nq->an", rule.shapes, rule.weights * fields.pressure(time))
            vertices = self.space.mesh.facets[:, rule.facets]
            nodal += self.space.scatter(vertices, np.multiply.outer(face.part.normal, moments))
        return self.space.interpolate(nodal)


def rough_lines(solution: ExactSolution) -> tuple[Line, ...]:
    """Where the strains are rough for all times: {s = c} for every c ∈ ``rough`` of every face."""
    return tuple(
        Line(tuple(face.part.tangent), float(face.part.tangent @ face.part.start) + c)
        for face in solution.faces
        for c in face.rough
    )

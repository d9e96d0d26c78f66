"""Products in V and works of stresses of the exact solution beside functions of V^h, at the points of the gauge."""

from __future__ import annotations

import numpy as np

from manufactured.exact import ExactSolution
from manufactured.tensors import Array, Tensors
from study.fem.gauge import DEGREE, FACET_POINTS, rules, shared_lines
from study.fem.quadrature import facet_rule
from study.fem.space import Space


class Energies:
    """Strains at all points of the rules with which ``Gauge`` makes the load, so that both see the same stress.

    Attributes:
        exact: the solution at the points, whose strains are (D, points).
    """

    def __init__(self, solution: ExactSolution, space: Space) -> None:
        blocks = rules(solution, space.mesh, DEGREE, shared_lines(solution))
        self.space = space
        self.weights = np.concatenate([rule.weights.ravel() for rule in blocks])
        self._cells = np.concatenate([np.repeat(rule.cells, rule.weights.shape[1]) for rule in blocks])
        self.exact = solution.at(np.hstack([rule.points.reshape(space.dim, -1) for rule in blocks]))
        self._nodes = solution.at(space.mesh.p)

    def strain(self, v: Array) -> Tensors:
        """ε(v) of v ∈ V^h, (D, points)."""
        return self.space.strain(v)[:, self._cells]

    def interpolant(self, time: float) -> Array:
        """Π^h u(t), (n_dofs,)."""
        return self.space.interpolate(self._nodes.displacement(time))

    def interpolated_rate(self, time: float) -> Array:
        """Π^h u̇(t), (n_dofs,)."""
        return self.space.interpolate(self._nodes.velocity(time))

    def work(self, stress: Tensors, strain: Tensors) -> float:
        """(σ, ε)_Q."""
        return float(np.sum(stress * strain * self.weights))

    def functional(self, stress: Tensors) -> Array:
        """(σ, ε(·))_Q on V^h, (n_dofs,)."""
        count = len(self.space.volumes)
        sums = [np.bincount(self._cells, self.weights * component, count) for component in stress]
        return self.space.tested(np.array(sums))

    def product(self, one: Tensors, other: Tensors) -> float:
        """(A ε, ε')_Q, the product of V."""
        return self.work(self.exact.law.A(one), other)


class ContactWork:
    """R(t; v) = ∫_{Γ3} σ_ν v_ν, (5.40), for v ∈ V^h from the exact pressure, by the rules of ``Gauge``."""

    def __init__(self, solution: ExactSolution, space: Space) -> None:
        self.space, self._faces = space, []
        for face in solution.faces:
            facets = space.facets(face.part)
            rule = facet_rule(space.mesh, facets, face.part, face.rough, FACET_POINTS)
            self._faces.append((face.part.normal, space.mesh.facets[:, facets], rule, solution.on(face, rule.s)))

    def __call__(self, v: Array, time: float) -> float:
        nodal, total = self.space.nodal(v), 0.0
        for normal, ends, rule, exact in self._faces:
            trace = np.einsum("an,anq->nq", np.tensordot(normal, nodal[:, ends], axes=1), rule.shapes)
            total -= float(np.sum(exact.pressure(time) * trace * rule.weights))
        return total

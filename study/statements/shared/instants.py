"""Norms in V: on V^h, and of the exact velocity, and of what Π^h leaves of it, at some times."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from manufactured.exact import ExactSolution
from manufactured.tensors import Array
from study.fem.ahead import in_blocks
from study.fem.gauge import DEGREE, rules
from study.fem.space import Space
from study.solve.evolution import SemiDiscrete


def norm(problem: SemiDiscrete, v: Array) -> float:
    """‖v‖_V on V^h."""
    return math.sqrt(max(v @ (problem.M @ v), 0.0))


def dual_norm(functional: Array, riesz: Callable[[Array], Array]) -> float:
    """‖f‖_V for (f, v)_V = F·v on V^h, (FᵀM⁻¹F)^{1/2}; riesz is b ↦ M⁻¹b."""
    return math.sqrt(max(float(functional @ riesz(functional)), 0.0))


class Velocity:
    """‖u̇(t)‖_V and ‖u̇(t) − Π^h u̇(t)‖_V at n times, (n,), by the cell rules of the gauge."""

    def __init__(self, solution: ExactSolution, space: Space) -> None:
        self.space = space
        self._blocks = [
            (rule, solution.at(rule.points), solution.law.at(rule.points[..., None]).A)
            for rule in rules(solution, space.mesh, DEGREE)
        ]
        self._nodes = solution.at(space.mesh.p)
        self._entries = max(space.E.shape[0] * rule.weights.shape[1] for rule, _, _ in self._blocks)

    def norm(self, times: Array) -> Array:
        """‖u̇(t)‖_V."""
        return self._distances(times, lambda some: np.zeros((self.space.dofs, len(some))))

    def interpolation_error(self, times: Array) -> Array:
        """‖u̇(t) − Π^h u̇(t)‖_V."""
        return self._distances(times, lambda some: self.space.interpolate(self._nodes.velocity(some)))

    def _distances(self, times: Array, v: Callable[[Array], Array]) -> Array:
        """‖u̇(t) − v(t)‖_V for v ∈ V^h, some of the times together."""
        return np.sqrt(np.concatenate([self._squares(some, v(some)) for some in in_blocks(times, self._entries)]))

    def _squares(self, times: Array, v: Array) -> Array:
        strain, total = self.space.strain(v), np.zeros(len(times))
        for rule, fields, A in self._blocks:
            difference = fields.strain_rate(times) - strain[:, rule.cells, None]
            density = np.einsum("Icqn,Icqn->cqn", A(difference), difference)
            total += np.tensordot(rule.weights, density, axes=2)
        return total


def midpoints(T: float, count: int) -> Array:
    """The nodes of the composite midpoint rule on (0, T), each of weight T/count."""
    return (np.arange(count) + 0.5) * T / count

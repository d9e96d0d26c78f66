"""Norms in V: on V^h, and of the exact velocity, and of what Π^h leaves of it, at some times."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from manufactured.exact import ExactSolution
from manufactured.tensors import Array
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
            (rule, solution.at(rule.points), solution.law.at(rule.points).A)
            for rule in rules(solution, space.mesh, DEGREE)
        ]
        self._nodes = solution.at(space.mesh.p)

    def norm(self, times: Array) -> Array:
        """‖u̇(t)‖_V."""
        return self._distances(times, lambda time: np.zeros(self.space.dofs))

    def interpolation_error(self, times: Array) -> Array:
        """‖u̇(t) − Π^h u̇(t)‖_V."""
        return self._distances(times, lambda time: self.space.interpolate(self._nodes.velocity(time)))

    def _distances(self, times: Array, v: Callable[[float], Array]) -> Array:
        """Return ‖u̇(t) − v(t)‖_V at some times, for v(t) ∈ V^h."""
        return np.array([math.sqrt(self._square(time, v(time))) for time in times.tolist()])

    def _square(self, time: float, v: Array) -> float:
        """Return ‖u̇(t) − v‖_V² for v ∈ V^h."""
        strain, total = self.space.strain(v), 0.0
        for rule, fields, A in self._blocks:
            difference = fields.strain_rate(time) - strain[:, rule.cells, None]
            total += float(np.einsum("Icq,Icq,cq->", A(difference), difference, rule.weights))
        return total


def midpoints(T: float, count: int) -> Array:
    """The nodes of the composite midpoint rule on (0, T), each of weight T/count."""
    return (np.arange(count) + 0.5) * T / count

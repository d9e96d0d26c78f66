"""Bounds for backward Euler where Problem 5.1 is a gradient flow, whatever the mesh.

If (B^h ·, ·)_V has a convex potential, Problem 5.1 is u̇ + ∂φ(u) ∋ f in V^h with φ convex, infinite outside K^h. Let
U_n be the solution of backward Euler with N steps of size k, δU_n = (U_n − U_{n−1})/k, ξ_n = f(t_n) − δU_n ∈ ∂φ(U_n),
and û the piecewise linear interpolant. Then, with the element z = ξ-least of f(0) − ∂φ(u_0) in place of δU_0,

    max_t ‖u^h − û‖_V ≤ F + k (Σ_n (ξ_n − ξ_{n−1}, δU_n)_V)^½ ≤ k (‖z‖_V/√2 + 2 Var f),

    F = Σ_n ∫_{t_{n−1}}^{t_n} ‖f(t_n) − f(t)‖_V dt ≤ k Var f.

U_n itself, on (t_{n−1}, t_n], is k ‖δU_n‖_V ≤ k (‖z‖_V + Var f) further away at most. For any scheme what happens
between nodes is what interpolation leaves of u^h: with its values at nodes and û linear in between

    max_t ‖u^h − û‖_V ≤ max_n ‖u^h(t_n) − U_n‖_V + k/4 max_n osc_n u̇^h,   osc_n u̇^h ≤ 2 (‖z‖_V + Var f),

osc_n the largest difference of velocities within a step.

The proofs are in paper/time.tex. The first bound needs the computed solution,
the second only the data; neither knows h. z is u̇^h(0+), the projection of f(0) − B^h u_0 onto the cone of directions
that K^h allows at u_0, and at most ‖f(0)‖_V + ‖B^h u_0‖_V long.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from manufactured.tensors import Array
from study.solve.evolution import SemiDiscrete
from study.solve.factorisation import Cholesky
from study.solve.signorini import Signorini

TOUCHING = 1e-12
"""A row of N u_0, relative to the largest value of u_0, that counts as contact."""


@dataclass(frozen=True, eq=False)
class GradientFlow:
    """Problem 5.1 with its load on a grid in time.

    Attributes:
        problem: Problem 5.1 on a mesh.
        loads: F(t_0), …, F(t_m) at equal steps up to T, (m + 1, n).
    """

    problem: SemiDiscrete
    loads: Array

    @cached_property
    def riesz(self) -> Cholesky:
        """b ↦ M⁻¹b."""
        return Cholesky(self.problem.M)

    @cached_property
    def representers(self) -> Array:
        """f at the times of the grid, (m + 1, n)."""
        return np.array([self.riesz(load) for load in self.loads])

    def distance(self, i: Array, j: Array) -> Array:
        """‖f(t_i) − f(t_j)‖_V for indices of the grid."""
        squares = np.sum((self.loads[i] - self.loads[j]) * (self.representers[i] - self.representers[j]), axis=-1)
        root: Array = np.sqrt(np.maximum(squares, 0))
        return root

    @cached_property
    def variation(self) -> float:
        """Var f over the grid."""
        ends = np.arange(len(self.loads))
        return float(self.distance(ends[1:], ends[:-1]).sum())

    @cached_property
    def start(self) -> Array:
        """z, (n,)."""
        problem, u0 = self.problem, self.problem.u0
        touching = problem.N @ u0 >= -TOUCHING * abs(u0).max(initial=0.0)
        return Signorini(problem.M, problem.N[np.flatnonzero(touching)])(self.loads[0] - problem.elastic(u0))[0]

    def delay(self, steps: int) -> float:
        """F for so many steps, a divisor of m: by the larger end of every interval of the grid.

        An upper sum: with j intervals in a step and a load that is linear there it is 1 + 1/j times F.
        """
        nodes = np.arange(len(self.loads))
        inner = (len(self.loads) - 1) // steps
        ahead = np.repeat(nodes[inner::inner], inner)
        left, right = self.distance(ahead, nodes[:-1]), self.distance(ahead, nodes[1:])
        return float(np.maximum(left, right).mean()) * self.problem.T

    @cached_property
    def first(self) -> float:
        """‖z‖_V."""
        return math.sqrt(self.start @ (self.problem.M @ self.start))

    @property
    def fastest(self) -> float:
        """‖z‖_V + Var f ≥ ‖u̇^h(t)‖_V, ‖δU_n‖_V."""
        return self.first + self.variation

    def a_priori(self, steps: int) -> float:
        """k (‖z‖_V/√2 + 2 Var f)."""
        return self.problem.T / steps * (self.first / math.sqrt(2) + 2 * self.variation)

    def piecewise_constant(self, steps: int) -> float:
        """The bound for U_n on (t_{n−1}, t_n] in place of û: k (‖z‖_V/√2 + 2 Var f) + k (‖z‖_V + Var f)."""
        return self.a_priori(steps) + self.problem.T / steps * self.fastest

    def a_posteriori(self, states: Array) -> float:
        """F + k (Σ (ξ_n − ξ_{n−1}, δU_n)_V)^½ from U_0, …, U_N, (N + 1, n), N a divisor of m."""
        steps, M = len(states) - 1, self.problem.M
        k, every = self.problem.T / steps, (len(self.loads) - 1) // steps
        rates = np.vstack([self.start, np.diff(states, axis=0) / k])
        forces = self.loads[::every] - (M @ rates.T).T
        total = float(np.sum(np.diff(forces, axis=0) * rates[1:]))
        return self.delay(steps) + k * math.sqrt(max(total, 0.0))

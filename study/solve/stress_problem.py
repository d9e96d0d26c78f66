"""Problem 3.2 on the strains of V^h: at every time a stress, found as the solution of a convex programme.

Stresses are constant on cells. The admissible ones, (3.9) with V^h for V, are

    Σ^h(t) = {τ : (τ, ε(v))_Q ≥ (f(t), v)_V for all v ∈ K^h},      K^h = {v : N v ≤ 0},

and by Farkas' lemma τ ∈ Σ^h(t) if and only if Eᵀ W τ + Nᵀ λ = F(t) for some λ ≥ 0, where E takes nodal values to
strains and W carries the volumes |T|. A step of backward Euler minimises a convex potential over Σ^h(t_n)
(``study.solve.stress_potential``).

The Lagrange multiplier of the equation Eᵀ W τ + Nᵀ λ = F is u_n: stationarity in τ is ε_n = ε(u_n), stationarity in λ
is N u_n ≤ 0, λ·N u_n = 0. Nothing here imposes either: the history ε_{n−1} is the one computed from the stresses, and
Theorem 4.2 is what says that u_n ∈ K^h solves Problem 3.1. No code is shared with the contact solve of Problem 3.1, nor
with its march in time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sps

from manufactured.law import KelvinVoigt
from manufactured.tensors import Array
from study.fem.space import Space
from study.solve.steps import longest_step, require_unique, step_size
from study.solve.stress_potential import potential
from study.solve.stress_programme import Programme, StressState


@dataclass(frozen=True, eq=False)
class StressProblem:
    """Problem 3.2 on the strains of one V^h: A and G, N (m, n_dofs) of K^h, t ↦ F(t) and u_0^h, (n_dofs,)."""

    space: Space
    law: KelvinVoigt
    N: sps.csr_array
    load: Callable[[float], Array]
    u0: Array

    @classmethod
    def of(cls, space: Space, law: KelvinVoigt, load: Callable[[float], Array], u0: Array) -> StressProblem:
        """The problem for a law, a load and a start on a space."""
        return cls(space, law, space.N, load, u0)

    def march(self, steps: int) -> Iterator[StressState]:
        """Backward Euler: the states at t_0, t_1, …, t_steps.

        Raises:
            StepsError: fewer than one step, or steps so long that they need not have one solution.
            StressError: no potential for the law, or a programme that the solver did not solve.
        """
        k = step_size(self.space.body.T, steps)
        require_unique("backward Euler", k, self.law.growth, longest_step(self.law.growth))
        programme = Programme(self.space, self.N, potential(self.space, self.law, k))
        strain = self.space.strain(self.u0)
        nan = np.full(self.N.shape[0], np.nan)
        yield StressState(0.0, np.full_like(strain, np.nan), strain, self.u0, nan, 0.0)
        for n in range(1, steps + 1):
            state = programme(n * k, self.load(n * k), strain)
            strain = state.strain
            yield state

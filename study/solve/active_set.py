"""A quadratic programme solved to rounding, once it is known nearly which of its multipliers vanish.

The programme, in an unknown x and forces λ with a Lagrange multiplier u,

    min ½ Px·x + q·x   subject to   Bᵀx + Nᵀλ = F,   λ ≥ 0,

has the conditions  Px + q = Bu,  Bᵀx + Nᵀλ = F,  Nu ≤ 0,  λ·Nu = 0.  An interior point of duality gap δ
satisfies λ·Nu = −δ: where λ and Nu vanish together it is only within √δ of the solution. With the set A
of the λ that do not vanish, the conditions are one linear system.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sps
import scipy.sparse.linalg as spla

from manufactured.tensors import Array

SETS = 10
"""Sets tried, each from the signs of the solution with the one before."""
ROUNDING = 1e-12
"""Of the largest entry: sizes that a direct solve leaves without a sign."""


class Optimum(NamedTuple):
    """x, λ ≥ 0 and u with Nu ≤ 0."""

    x: Array
    multipliers: Array
    u: Array


class ActiveSet:
    """The programme for many q and F.

    Args:
        P: symmetric positive definite, (p, p).
        B: (p, dofs).
        N: (m, dofs).
    """

    def __init__(self, P: sps.sparray, B: sps.sparray, N: sps.csr_array) -> None:
        self.P, self.B, self.N = P, B, N
        self.active: Array | None = None

    def __call__(self, q: Array, F: Array, near: Optimum) -> Optimum:
        """The solution near an interior point; the interior point itself if no set tried has the right signs."""
        active = near.multipliers > -(self.N @ near.u)
        for _ in range(SETS):
            found = self._solve(q, F, active)
            normal = self.N @ found.u
            kept = found.multipliers > -ROUNDING * found.multipliers.max(initial=0.0)
            crossed = normal > ROUNDING * abs(found.u).max()
            following = np.where(active, kept, crossed)
            if (following == active).all():
                return found
            active = following
        return near

    def _solve(self, q: Array, F: Array, active: Array) -> Optimum:
        """The linear system with Nu = 0 on the set and λ = 0 off it, factored when the set is another one."""
        if self.active is None or (active != self.active).any():
            held = self.N[active]
            system = [[self.P, -self.B, None], [-self.B.T, None, -held.T], [None, -held, None]]
            self.factor, self.active = spla.splu(sps.csc_matrix(sps.block_array(system))), active
        x, u, forces = np.split(
            self.factor.solve(np.concatenate([-q, -F, np.zeros(int(active.sum()))])), np.cumsum([q.size, F.size])
        )
        multipliers = np.zeros(len(active))
        multipliers[active] = forces
        return Optimum(x, multipliers, u)

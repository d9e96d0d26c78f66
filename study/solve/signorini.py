"""One contact solve: minimise ½ vᵀSv − bᵀv over K^h = {v : Nv ≤ 0}, by condensation.

Optimality: S u + Nᵀλ = b, N u ≤ 0, λ ≥ 0, λ·N u = 0. Only the m rows of N are constrained, so with
the compliance W = N S⁻¹ Nᵀ, formed once, the multipliers solve the small complementarity problem

    g = N S⁻¹ b − W λ ≤ 0,   λ ≥ 0,   λ·g = 0,

by a primal–dual active set (M. Hintermüller, K. Ito, K. Kunisch, The primal-dual active set
strategy as a semismooth Newton method, SIAM J. Optim. 13 (2003) 865–888), and u = S⁻¹(b − Nᵀλ).

The unknowns with entries in N are eliminated last. With S = LLᵀ in that order Y = L⁻¹Nᵀ vanishes
but for the rows of these unknowns, where it is a solve with the trailing block of L, the Cholesky
factor of the Schur complement; W = YᵀY. A step is y = L⁻¹b, N S⁻¹ b = Yᵀy, u = L⁻ᵀ(y − Yλ): exact
to round-off, one pass forward and one backward through L.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
import scipy.sparse as sps
from scipy.linalg import cholesky, solve_triangular
from scipy.linalg.lapack import dpotrs
from scipy.optimize import nnls

from manufactured.tensors import Array
from study.solve.cholesky.factorisation import Cholesky


class ContactSolver(Protocol):
    """b ↦ (u, λ)."""

    def __call__(self, b: Array) -> tuple[Array, Array]: ...


class Signorini:
    """The contact solve with a fixed S and N; remembers the last active set as its next guess."""

    def __init__(self, S: sps.csc_array, N: sps.csr_array) -> None:
        constrained = np.unique(N.nonzero()[1])
        self.factor, self.N = Cholesky(S, constrained), N
        self.end = slice(S.shape[0] - len(constrained), None)
        columns = sps.csc_array(N)[:, self.factor.order[self.end]].toarray().T
        self.Y = solve_triangular(self.factor.trailing, columns, lower=True)
        self.W = self.Y.T @ self.Y
        self.active = np.zeros(N.shape[0], dtype=bool)
        self.block: tuple[bytes, Array, Array] | None = None

    def __call__(self, b: Array) -> tuple[Array, Array]:
        """u ∈ K^h and the multipliers λ ≥ 0 (nodal contact forces), (n,) and (m,); for several b, (k, n) and (k, m)."""
        y = self.factor.forward(b)
        gaps = y[..., self.end] @ self.Y
        single = b.ndim == 1
        multipliers = self.complementarity(gaps) if single else np.array([self.complementarity(gap) for gap in gaps])
        y[..., self.end] -= multipliers @ self.Y.T
        return self.factor.backward(y), multipliers

    def gap(self, b: Array) -> Array:
        """N S⁻¹ b, (m,); for several b, (k, m)."""
        return self.factor.forward(b)[..., self.end] @ self.Y

    def complementarity(self, gap: Array) -> Array:
        """λ ≥ 0 with gap − Wλ ≤ 0 and λ·(gap − Wλ) = 0, (m,)."""
        active = self.active
        visited: set[bytes] = set()
        # Most steps keep the active set of the step before, and have so few constraints that calls take the time.
        while (key := active.tobytes()) not in visited:
            visited.add(key)
            multipliers = self.multipliers_on(active, gap)
            following = np.where(active, multipliers, gap - self.W @ multipliers) > 0
            if following.tobytes() == key:
                self.active = active
                return multipliers
            active = following
        # The active sets cycle, which needs a W that is not an M-matrix inverse: finish with the
        # finite method of Lawson and Hanson on the equivalent least squares problem.
        L = cholesky(self.W, lower=True)
        multipliers, _ = nnls(L.T, solve_triangular(L, gap, lower=True))
        self.active = multipliers > 0
        return self.multipliers_on(self.active, gap)

    def multipliers_on(self, active: Array, gap: Array) -> Array:
        """λ with (gap − Wλ) = 0 on the active set and λ = 0 elsewhere; factors W there when the set is a new one."""
        if self.block is None or self.block[0] != active.tobytes():
            where = np.flatnonzero(active)
            self.block = active.tobytes(), where, cholesky(self.W[np.ix_(where, where)], lower=True)
        _, where, factor = self.block
        multipliers = np.zeros(len(gap))
        if len(where):
            # LAPACK itself, as SciPy's function around it looks at its arguments for longer than this takes.
            multipliers[where], _ = dpotrs(factor, gap[where], lower=True)
        return multipliers

"""One contact step: minimise ½ vᵀSv − bᵀv over K^h = {v : Nv ≤ g}, by condensation on the contact unknowns.

g ≥ 0 is the initial gap at the contact vertices, 0 in the paper. The optimality conditions are S u + Nᵀλ = b,
N u ≤ g, λ ≥ 0 and λ·(N u − g) = 0. Only the m rows of N are constrained. With the compliance W = N S⁻¹ Nᵀ, computed
once, the multipliers therefore solve the small complementarity problem

    d = N S⁻¹ b − g − W λ ≤ 0,   λ ≥ 0,   λ·d = 0,

by a primal–dual active set method (M. Hintermüller, K. Ito, K. Kunisch, The primal-dual active set strategy as a
semismooth Newton method, SIAM J. Optim. 13 (2003) 865–888). Then u = S⁻¹(b − Nᵀλ).

The contact unknowns, those with entries in N, are eliminated last. With S = LLᵀ in that order, Y = L⁻¹Nᵀ has nonzero
rows only for them, and there Y solves a system with the trailing block of L, the Cholesky factor of the Schur
complement. A step is y = L⁻¹b, N S⁻¹ b = Yᵀy, the multipliers, and u = L⁻ᵀ(y − Yλ): one forward and one backward
substitution. W = YᵀY.

Large problems in space are solved by multigrid instead (``study.solve.solver_choice``).
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
import scipy.sparse as sps
from scipy.linalg import cholesky, solve_triangular
from scipy.linalg.lapack import dpotrs
from scipy.optimize import nnls

from manufactured.tensors import Array, Points
from study.solve.factorisation import Cholesky


class ContactSolver(Protocol):
    """b ↦ (u, λ)."""

    def __call__(self, b: Array) -> tuple[Array, Array]: ...


class Signorini:
    """The contact solve with a fixed S and N. It remembers the last active set as the first guess of the next solve.

    Args:
        S: symmetric positive definite, (n, n).
        N: the constraints N v ≤ g, linearly independent rows, (m, n).
        x: points of the unknowns, for the order of elimination (see ``Cholesky``), (d, p).
        gap: the initial gap g, (m,) or a number.

    Raises:
        LinAlgError: S is not positive definite.
    """

    def __init__(self, S: sps.csc_array, N: sps.csr_array, x: Points | None = None, gap: Array | float = 0.0) -> None:
        contact = np.unique(N.nonzero()[1])
        self.N, self.initial_gap = N, gap
        self.factor = Cholesky(S, contact, x)
        self.contact = slice(S.shape[0] - len(contact), None)
        columns = sps.csc_array(N)[:, self.factor.order[self.contact]].toarray().T
        self.Y = solve_triangular(self.factor.trailing, columns, lower=True)
        self.W = self.Y.T @ self.Y
        self.active = np.zeros(N.shape[0], dtype=bool)
        self._factored: tuple[bytes, Array, Array] | None = None

    def __call__(self, b: Array) -> tuple[Array, Array]:
        """u ∈ K^h and the multipliers λ ≥ 0 (nodal contact forces), (n,) and (m,); for several b, (k, n) and (k, m)."""
        y = self.factor.forward(b)
        gaps = y[..., self.contact] @ self.Y - self.initial_gap
        single = b.ndim == 1
        multipliers = self.complementarity(gaps) if single else np.array([self.complementarity(gap) for gap in gaps])
        y[..., self.contact] -= multipliers @ self.Y.T
        return self.factor.backward(y), multipliers

    def gap(self, b: Array) -> Array:
        """N S⁻¹ b, (m,); for several b, (k, m)."""
        return self.factor.forward(b)[..., self.contact] @ self.Y

    def complementarity(self, gap: Array) -> Array:
        """λ ≥ 0 with gap − Wλ ≤ 0 and λ·(gap − Wλ) = 0, (m,)."""
        active = self.active
        visited: set[bytes] = set()
        while (key := active.tobytes()) not in visited:
            visited.add(key)
            multipliers = self.multipliers_on(active, gap)
            following = np.where(active, multipliers, gap - self.W @ multipliers) > 0
            if following.tobytes() == key:
                self.active = active
                return multipliers
            active = following
        # The active sets cycle. Lawson and Hanson's method for the equivalent least squares problem is always finite.
        L = cholesky(self.W, lower=True)
        multipliers, _ = nnls(L.T, solve_triangular(L, gap, lower=True))
        self.active = multipliers > 0
        return self.multipliers_on(self.active, gap)

    def multipliers_on(self, active: Array, gap: Array) -> Array:
        """λ with gap − Wλ = 0 on the active set and λ = 0 elsewhere; factorises W there for a new set, (m,)."""
        if self._factored is None or self._factored[0] != active.tobytes():
            where = np.flatnonzero(active)
            self._factored = active.tobytes(), where, cholesky(self.W[np.ix_(where, where)], lower=True)
        _, where, factor = self._factored
        multipliers = np.zeros(len(gap))
        if len(where):
            # LAPACK directly: the checks of SciPy's cho_solve take longer than the solve.
            multipliers[where], _ = dpotrs(factor, gap[where], lower=True)
        return multipliers

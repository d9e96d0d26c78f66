"""A direct solver for one contact problem: minimise ½ vᵀSv − bᵀv over K^h = {v : N v ≤ g}.

g ≥ 0 is the initial gap at the contact vertices, 0 in the paper. The optimality conditions are S u + Nᵀλ = b, N u ≤ g,
λ ≥ 0 and λ·(N u − g) = 0. Since u = S⁻¹(b − Nᵀλ), the multipliers λ solve a small complementarity problem with the
compliance matrix W = N S⁻¹ Nᵀ, (m, m), which is computed once:

    d = N S⁻¹ b − g − W λ ≤ 0,   λ ≥ 0,   λ·d = 0.

It is solved by a primal–dual active set method (M. Hintermüller, K. Ito, K. Kunisch, The primal-dual active set
strategy as a semismooth Newton method, SIAM J. Optim. 13 (2003) 865–888).

The contact unknowns, that is the unknowns with entries in N, are eliminated last. With S = LLᵀ in this order, Y = L⁻¹Nᵀ
has nonzero rows only for the contact unknowns, and there Y solves a system with the trailing block of L, the Cholesky
factor of the Schur complement. A step computes y = L⁻¹b, N S⁻¹ b = Yᵀy, the multipliers, and u = L⁻ᵀ(y − Yλ): one
forward and one backward substitution. W = YᵀY.

Large problems in 3D are solved by multigrid instead (``study.solve.multigrid``).
"""

from collections.abc import Callable

import numpy as np
import scipy.sparse as sps
from scipy.linalg import cholesky, solve_triangular
from scipy.linalg.lapack import dpotrs
from scipy.optimize import nnls

from manufactured.tensors import Array, Points
from study.solve.factorisation import Cholesky

ContactSolution = tuple[Array, Array]
"""The type of the solution of a contact problem: displacement u, (n,), and nodal contact forces λ, (m,)."""
ContactSolver = Callable[[Array], ContactSolution]
"""The type of a contact solver: a function from a load b, (n,), to the displacement and the contact forces."""


class Signorini:
    """The direct solver of contact problems: minimise ½ uᵀSu − bᵀu subject to N u ≤ g, for fixed matrices S and N.

    A call with b returns the displacement u and the contact forces λ ≥ 0, with S u + Nᵀλ = b. Each solve starts from
    the last active set.

    Args:
        S: a symmetric positive definite matrix, (n, n).
        N: the constraint matrix, with linearly independent rows, (m, n).
        x: the points to which the unknowns belong, (d, p); they give the order of elimination (see ``Cholesky``).
        gap: the initial gap g, (m,) or a number.

    Raises:
        LinAlgError: S is not positive definite.
    """

    def __init__(self, S: sps.csc_array, N: sps.csr_array, x: Points | None = None, gap: Array | float = 0.0) -> None:
        contact = np.unique(N.nonzero()[1])
        self.N = N
        self.initial_gap = gap
        self.factor = Cholesky(S, contact, x)
        self.contact = slice(S.shape[0] - len(contact), None)
        columns = sps.csc_array(N)[:, self.factor.order[self.contact]].toarray().T
        self.Y = solve_triangular(self.factor.trailing, columns, lower=True)
        self.W = self.Y.T @ self.Y
        self.active = np.zeros(N.shape[0], dtype=bool)
        self._factored: tuple[bytes, Array, Array] | None = None

    def __call__(self, b: Array) -> ContactSolution:
        """Solve the contact problem for a load b: return u ∈ K^h, (n,), and the nodal contact forces λ ≥ 0, (m,).

        For several right-hand sides b, (k, n), the results are (k, n) and (k, m).
        """
        y = self.factor.forward(b)
        gaps = y[..., self.contact] @ self.Y - self.initial_gap
        single = b.ndim == 1
        multipliers = self.complementarity(gaps) if single else np.array([self.complementarity(gap) for gap in gaps])
        y[..., self.contact] -= multipliers @ self.Y.T
        return self.factor.backward(y), multipliers

    def gap(self, b: Array) -> Array:
        """Return the normal displacements N S⁻¹ b of the contact vertices under a load b without contact forces, (m,).

        For several loads, (k, n), the result is (k, m).
        """
        return self.factor.forward(b)[..., self.contact] @ self.Y

    def complementarity(self, gap: Array) -> Array:
        """Solve the complementarity problem λ ≥ 0, p − Wλ ≤ 0, λ·(p − Wλ) = 0 for the contact forces λ, (m,).

        W = N S⁻¹ Nᵀ maps contact forces to the normal displacements that they cause at the contact vertices.

        Args:
            gap: the penetration p = N S⁻¹ b − g that the load b causes without contact forces, (m,). This is not the
                initial gap g; p is positive at vertices that the load would push into the foundation.
        """
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
        # Here the active sets repeat in a cycle. The method of Lawson and Hanson for least squares always terminates.
        L = cholesky(self.W, lower=True)
        multipliers, _ = nnls(L.T, solve_triangular(L, gap, lower=True))
        self.active = multipliers > 0
        return self.multipliers_on(self.active, gap)

    def multipliers_on(self, active: Array, gap: Array) -> Array:
        """Return the contact forces λ with p − Wλ = 0 on the active set and λ = 0 elsewhere, (m,).

        p is the penetration without contact forces, and W = N S⁻¹ Nᵀ maps contact forces to normal displacements. The
        block of W is factorised only if the active set differs from the last one.

        Args:
            active: the active set as flags, (m,).
            gap: the penetration p, (m,).
        """
        if self._factored is None or self._factored[0] != active.tobytes():
            where = np.flatnonzero(active)
            self._factored = active.tobytes(), where, cholesky(self.W[np.ix_(where, where)], lower=True)
        _, where, factor = self._factored
        multipliers = np.zeros(len(gap))
        if len(where):
            # LAPACK is called directly because the checks of SciPy's cho_solve take longer than the solve.
            multipliers[where], _ = dpotrs(factor, gap[where], lower=True)
        return multipliers

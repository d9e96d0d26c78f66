"""What a library's factorisation gives: S factorised once, condensed onto Γ3 column by column, an active set there.

The algorithm of this study without its ordering, its factorisation and its passes: what is left is due to these.
"""

import importlib.metadata
from time import perf_counter

import numpy as np
import scipy.sparse as sps
from problem import Answer, main
from scipy.sparse.linalg import splu

ITERATIONS = 50


def solve(given, library):
    start = perf_counter()
    factor, version = LIBRARIES[library](sps.csc_matrix(given.S))
    Y = factor(given.N.T.toarray())
    W = given.N @ Y
    active = np.zeros(len(W), dtype=bool)
    u, trajectory = given.u0, []
    for load in given.loads:
        alone = factor(load + given.M @ (u / given.k))
        multipliers, active = complementarity(W, given.N @ alone, active)
        u = alone - Y @ multipliers
        trajectory.append(u)
    return Answer(np.array(trajectory), perf_counter() - start, version, 1)


def superlu(S):
    """SciPy's LU in its Cholesky-like setting."""
    options = {"SymmetricMode": True}
    factor = splu(S, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
    return factor.solve, f"SciPy {importlib.metadata.version('scipy')}"


def cholmod(order):
    """The supernodal Cholesky factorisation of SuiteSparse, in an order of its own."""

    def factorised(S):
        from sksparse.cholmod import cholesky

        factor = cholesky(S, mode="supernodal", ordering_method=order)
        return factor, f"scikit-sparse {importlib.metadata.version('scikit-sparse')}"

    return factorised


LIBRARIES = {"superlu": superlu, "cholmod-amd": cholmod("amd"), "cholmod-metis": cholmod("metis")}


def complementarity(W, gap, active):
    """λ ≥ 0 with gap − Wλ ≤ 0 and λ·(gap − Wλ) = 0, and where λ > 0, from a guess of it."""
    for _ in range(ITERATIONS):
        multipliers = np.zeros_like(gap)
        multipliers[active] = np.linalg.solve(W[np.ix_(active, active)], gap[active])
        following = np.where(active, multipliers > 0, gap - W @ multipliers > 0)
        if (following == active).all():
            return multipliers, active
        active = following
    raise RuntimeError(f"the active set did not settle in {ITERATIONS} iterations")


if __name__ == "__main__":
    main(solve)

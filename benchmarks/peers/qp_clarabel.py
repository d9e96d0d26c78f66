"""Clarabel, an interior-point method for conic programmes: every step is a quadratic programme."""

from time import perf_counter

import clarabel
import numpy as np
import scipy.sparse as sps
from problem import Answer, main

GAP = 1e-13
"""Of the energy; the error in its norm is the root."""
RESIDUAL, REFINEMENT = 1e-12, 1e-16
"""Of feasibility, and of the linear systems inside: the latter is refined as far as it helps."""


def solve(given):
    start = perf_counter()
    S, N = sps.csc_matrix(sps.triu(given.S)), sps.csc_matrix(given.N)
    m = N.shape[0]
    settings = clarabel.DefaultSettings()
    settings.verbose = settings.presolve_enable = settings.chordal_decomposition_enable = False
    settings.tol_gap_abs = settings.tol_gap_rel = GAP
    settings.tol_feas = RESIDUAL
    settings.iterative_refinement_abstol = settings.iterative_refinement_reltol = REFINEMENT
    solver = clarabel.DefaultSolver(S, -given.u0, N, np.zeros(m), [clarabel.NonnegativeConeT(m)], settings)
    u, trajectory, iterations = given.u0, [], 0
    for load in given.loads:
        b = load + given.M @ (u / given.k)
        # In the energy norm of the step before the solution is of size one, as absolute tolerances expect.
        size = np.sqrt(u @ (given.S @ u))
        solver.update(q=-b / size)
        solution = solver.solve()
        iterations += solution.iterations
        u = size * np.array(solution.x)
        trajectory.append(u)
    return Answer(np.array(trajectory), perf_counter() - start, f"Clarabel {clarabel.__version__}", iterations)


if __name__ == "__main__":
    main(solve)

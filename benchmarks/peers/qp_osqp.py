"""OSQP, an operator splitting method: one factorisation, many iterations, accuracy as far as they bring it."""

from time import perf_counter

import numpy as np
import osqp
import scipy.sparse as sps
from problem import Answer, main

TOLERANCE, ITERATIONS = 1e-9, 20000


def solve(given):
    start = perf_counter()
    S, N = sps.csc_matrix(sps.triu(given.S)), sps.csc_matrix(given.N)
    solver = osqp.OSQP()
    solver.setup(
        S,
        -given.u0,
        N,
        np.full(N.shape[0], -np.inf),
        np.zeros(N.shape[0]),
        verbose=False,
        eps_abs=TOLERANCE,
        eps_rel=TOLERANCE,
        max_iter=ITERATIONS,
        polishing=True,
    )
    u, trajectory = given.u0, []
    for load in given.loads:
        solver.update(q=-(load + given.M @ (u / given.k)))
        u = solver.solve().x
        trajectory.append(u)
    return Answer(np.array(trajectory), perf_counter() - start, f"OSQP {osqp.__version__}")


if __name__ == "__main__":
    main(solve)

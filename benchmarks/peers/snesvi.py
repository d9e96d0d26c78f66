"""PETSc SNESVI on the same matrices, rotated so that the constraints are bounds."""

from time import perf_counter

import numpy as np
from problem import Answer, main
from vi import BoundedQuadratic, matrix, version


def solve(given, factorisation):
    start = perf_counter()
    R = matrix(given.R)
    S, M = matrix(given.S).ptap(R), matrix(given.M).ptap(R)
    upper = np.full(len(given.u0), np.inf)
    upper[given.bounded] = 0
    w = given.R.T @ given.u0
    step = BoundedQuadratic(S, np.full(len(w), -np.inf), upper, w, factorisation)
    old, inertia = M.createVecRight(), M.createVecLeft()
    trajectory = []
    for load in given.loads:
        old.array[:] = w
        M.mult(old, inertia)
        w = step(given.R.T @ load + inertia.array / given.k)
        trajectory.append(given.R @ w)
    return Answer(np.array(trajectory), perf_counter() - start, version(), step.factorisations)


if __name__ == "__main__":
    main(solve)

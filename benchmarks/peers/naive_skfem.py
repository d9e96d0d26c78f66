"""scikit-fem as its examples use it: an active set, and for every guess of it a new sparse direct solve."""

from time import perf_counter

import numpy as np
import skfem
from problem import Answer, bounds, main
from skfem.helpers import sym_grad

ITERATIONS = 50


def solve(given):
    start = perf_counter()
    basis = skfem.Basis(skfem.MeshTri(given.p, given.t), skfem.ElementVector(skfem.ElementTriP1()))
    nodal = basis.nodal_dofs.T.ravel()
    M = form(given.viscous).assemble(basis)
    S = (M / given.k + form(given.elastic).assemble(basis)).tocsr()
    assembled = perf_counter()
    lower, upper = (at(nodal, bound) for bound in bounds(given))
    fixed = np.setdiff1d(nodal, nodal[given.free])
    sign = np.where(upper == 0, 1.0, 0.0) - np.where(lower == 0, 1.0, 0.0)
    contact = np.flatnonzero(sign)
    active = np.zeros(len(contact), dtype=bool)
    u, trajectory, solves = np.zeros(len(nodal)), [], 0
    u[nodal[given.free]] = given.u0
    for load in given.loads:
        b = M @ u / given.k
        b[nodal[given.free]] += load
        u, active, needed = step(S, b, fixed, contact, sign[contact], active)
        solves += needed
        trajectory.append(u[nodal[given.free]])
    seconds = perf_counter() - assembled
    return Answer(np.array(trajectory), seconds, f"scikit-fem {skfem.__version__}", solves, assembled - start)


def at(nodal, values):
    """Nodal values in the order of the dofs."""
    ordered = np.empty_like(values)
    ordered[nodal] = values
    return ordered


def step(S, b, fixed, contact, sign, active):
    """u, the active set, and how many solves they took from a guess of it."""
    for solves in range(1, ITERATIONS + 1):
        u = skfem.solve(*skfem.condense(S, b, D=np.concatenate([fixed, contact[active]])))
        pressure = sign * (b[contact] - S[contact] @ u)
        following = np.where(active, pressure > 0, sign * u[contact] > 0)
        if (following == active).all():
            return u, active, solves
        active = following
    raise RuntimeError(f"the active set did not settle in {ITERATIONS} iterations")


def form(C):
    @skfem.BilinearForm
    def energy(u, v, w):
        return np.einsum("IJ,J...,I...->...", C, mandel(u), mandel(v))

    return energy


def mandel(v):
    strain = sym_grad(v)
    return np.array([strain[0, 0], strain[1, 1], np.sqrt(2) * strain[0, 1]])


if __name__ == "__main__":
    main(solve)

"""Spaces and matrices by DOLFINx on the same mesh, SNESVI for the steps; only the loads are given."""

from time import perf_counter

import dolfinx
import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix
from mpi4py import MPI
from petsc4py import PETSc
from problem import Answer, bounds, main
from vi import BoundedQuadratic, version


def solve(given):
    start = perf_counter()
    V, places = space(given)
    fixed = np.setdiff1d(np.arange(2 * given.p.shape[1]), given.free)
    clamped = fem.dirichletbc(PETSc.ScalarType((0, 0)), np.unique(np.argsort(places)[fixed] // 2).astype(np.int32), V)
    u, v = ufl.TrialFunction(V), ufl.TestFunction(V)
    inertia, stiffness = (
        ufl.inner(ufl.as_matrix(C.tolist()) * mandel(u), mandel(v)) * ufl.dx for C in (given.viscous, given.elastic)
    )
    M = assemble_matrix(fem.form(inertia))
    S = assemble_matrix(fem.form(1 / given.k * inertia + stiffness), bcs=[clamped])
    M.assemble(), S.assemble()
    assembled = perf_counter()
    # Nodal values of the problem, vertex by vertex, in the order of the dofs here.
    lower, upper = (bound[places] for bound in bounds(given))
    nodal = np.zeros((len(given.loads) + 1, len(places)))
    nodal[0, given.free] = given.u0
    step = BoundedQuadratic(S, lower, upper, nodal[0, places], "cholesky")
    old, product, b = M.createVecRight(), M.createVecLeft(), np.zeros(len(places))
    here = np.argsort(places)
    for n, load in enumerate(given.loads, start=1):
        old.array[:] = nodal[n - 1, places]
        M.mult(old, product)
        b[:] = product.array / given.k
        b[here[given.free]] += load
        b[here[fixed]] = 0
        nodal[n, places] = step(b)
    seconds = perf_counter() - assembled
    name = f"DOLFINx {dolfinx.__version__}, {version()}"
    return Answer(nodal[1:, given.free], seconds, name, step.factorisations, assembled - start)


def space(given):
    """Continuous P1 vectors, and which nodal value of the problem each of their dofs is, (2·vertices,)."""
    cell = ufl.Mesh(ufl.VectorElement("Lagrange", ufl.triangle, 1))
    mesh = dolfinx.mesh.create_mesh(MPI.COMM_SELF, given.t.T.astype(np.int64), given.p.T.copy(), cell)
    V = fem.VectorFunctionSpace(mesh, ("Lagrange", 1))
    vertex = np.empty(given.p.shape[1], dtype=np.int64)
    for c in range(given.t.shape[1]):
        vertex[V.dofmap.cell_dofs(c)] = mesh.geometry.dofmap.links(c)
    vertex = np.array(mesh.geometry.input_global_indices)[vertex]
    return V, (2 * vertex[:, None] + np.arange(2)).ravel()


def mandel(v):
    strain = ufl.sym(ufl.grad(v))
    return ufl.as_vector([strain[0, 0], strain[1, 1], np.sqrt(2) * strain[0, 1]])


if __name__ == "__main__":
    main(solve)

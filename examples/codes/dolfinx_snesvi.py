"""DOLFINx 0.11 for the stiffness matrix, PETSc's SNESVI (reduced space active sets) for the contact.

Bounds are those of single unknowns, so the vertices of Γ3 are given axes along ν; a vertex with two constraints is
served where the normals are at right angles.
"""

from __future__ import annotations

import basix.ufl
import dolfinx
import numpy as np
import scipy.sparse as sps
import ufl
from common import CannotExpressError, fixed, forces
from contact_judge import Task
from dolfinx import fem
from dolfinx.fem.petsc import assemble_matrix
from mpi4py import MPI
from petsc4py import PETSc

CODE = "DOLFINx + PETSc SNESVI"
VERSION = f"{dolfinx.__version__} + {'.'.join(map(str, PETSc.Sys.getVersion()))}"


def matrix(task: Task) -> sps.csr_matrix:
    """The stiffness matrix by DOLFINx, in the order of the task's vertices."""
    d = task.dim
    coordinates = basix.ufl.element("Lagrange", "triangle" if d == 2 else "tetrahedron", 1, shape=(d,))
    mesh = dolfinx.mesh.create_mesh(MPI.COMM_SELF, task.cells, coordinates, task.vertices)
    V, P0 = fem.functionspace(mesh, ("Lagrange", 1, (d,))), fem.functionspace(mesh, ("DG", 0))
    mine = mesh.topology.original_cell_index
    pairs = [(0, 0), (1, 1), (0, 1)] if d == 2 else [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]

    def mandel(v):
        e = ufl.sym(ufl.grad(v))
        return [e[i, j] * (1 if i == j else np.sqrt(2)) for i, j in pairs]

    u, v = ufl.TrialFunction(V), ufl.TestFunction(V)
    terms = []
    for (i, a), (j, b) in ((one, other) for one in enumerate(mandel(u)) for other in enumerate(mandel(v))):
        values = task.stiffness[:, i, j]
        if abs(values).max() > 0:
            c = fem.Function(P0)
            c.x.array[:] = values[mine]
            terms.append(c * a * b * ufl.dx)
    A = assemble_matrix(fem.form(sum(terms[1:], terms[0])))
    A.assemble()
    indptr, indices, data = A.getValuesCSR()
    K = sps.csr_matrix((data, indices, indptr))
    dofs = np.empty(len(task.vertices), int)
    dofs[mesh.geometry.input_global_indices[mesh.geometry.dofmap]] = V.dofmap.list
    order = (d * dofs[:, None] + np.arange(d)).ravel()
    return K[order][:, order]


def turned(task: Task) -> tuple[sps.csr_matrix, np.ndarray]:
    """Axes at the vertices as the columns of a block diagonal matrix, and the components that are bounded by 0."""
    frames, bounded = np.tile(np.eye(task.dim), (len(task.vertices), 1, 1)), []
    taken = np.zeros(len(task.vertices), int)
    for normal, vertices, _ in task.pieces():
        for v in vertices:
            k = taken[v]
            if k and abs(frames[v][:, 0] @ normal) > 1e-12:
                raise CannotExpressError("a vertex has two constraints that are not at right angles")
            q, _ = np.linalg.qr(np.column_stack([*frames[v].T[:k], normal, np.eye(task.dim)]))
            q[:, :k], q[:, k] = frames[v][:, :k], normal
            frames[v], taken[v] = q[:, : task.dim], k + 1
            bounded.append(task.dim * v + k)
    return sps.block_diag(list(frames), format="csr"), np.array(bounded)


def make(task: Task):
    """step(b, s0) ↦ u."""
    Q, bounded = turned(task)
    free = np.setdiff1d(np.arange(task.vertices.size), fixed(task))
    K = (Q.T @ matrix(task) @ Q).tocsr()[free][:, free]
    J = PETSc.Mat().createAIJ(K.shape, csr=(K.indptr, K.indices, K.data))
    x, upper, lower = J.createVecRight(), J.createVecRight(), J.createVecRight()
    lower.set(PETSc.NINFINITY)
    upper.array[:] = np.where(np.isin(free, bounded), 0.0, PETSc.INFINITY)

    def step(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
        b = J.createVecRight()
        b.array[:] = (Q.T @ forces(task, load, stress).ravel())[free]

        def residual(snes, v, f):
            J.mult(v, f)
            f.axpy(-1, b)

        snes = PETSc.SNES().create(PETSc.COMM_SELF)
        snes.setType("vinewtonrsls")
        snes.setFunction(residual, J.createVecRight())
        snes.setJacobian(lambda snes, v, M, P: None, J)
        snes.setVariableBounds(lower, upper)
        snes.getKSP().setType("preonly")
        snes.getKSP().getPC().setType("lu")
        snes.setTolerances(rtol=1e-12, atol=1e-13 * b.norm(), stol=0, max_it=100)
        snes.solve(None, x)
        step.solves += snes.getIterationNumber()
        u = np.zeros(task.vertices.size)
        u[free] = x.array
        return (Q @ u).reshape(-1, task.dim)

    step.solves = 0
    return step


VARIANTS = {"vinewtonrsls, rtol 1e-12": make}

"""scikit-fem: its assembly, and an active set of our own in twenty lines, which is how one writes contact with it."""

from __future__ import annotations

from importlib.metadata import version

import numpy as np
import scipy.sparse as sps
import skfem
from common import fixed, forces
from contact_judge import Task
from scipy.sparse.linalg import splu
from skfem.helpers import sym_grad

CODE, VERSION = "scikit-fem", version("scikit-fem")


def make(task: Task):
    """step(b, s0) ↦ u: vertices with λ + κ u_ν > 0 are held, κ = K's largest entry, until they stay the same."""
    d = task.dim
    mesh, element = (skfem.MeshTri, skfem.ElementTriP1()) if d == 2 else (skfem.MeshTet, skfem.ElementTetP1())
    basis = skfem.Basis(mesh(task.vertices.T, task.cells.T), skfem.ElementVector(element), intorder=0)
    pairs = [(0, 0), (1, 1), (0, 1)] if d == 2 else [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]

    def mandel(v):
        return np.array([sym_grad(v)[i, j] * (1 if i == j else np.sqrt(2)) for i, j in pairs])

    C = np.moveaxis(task.stiffness, 0, -1)[..., None]
    K = skfem.BilinearForm(lambda u, v, w: np.einsum("ij...,j...,i...->...", C, mandel(u), mandel(v))).assemble(basis)
    free = np.setdiff1d(np.arange(basis.N), fixed(task))
    rows = [(d * v + np.arange(d), normal) for normal, vertices, _ in task.pieces() for v in vertices]
    i, j = np.repeat(np.arange(len(rows)), d), np.concatenate([on for on, _ in rows])
    values = np.concatenate([normal for _, normal in rows])
    N = sps.csr_matrix((values, (i, j)), shape=(len(rows), basis.N))[:, free]
    K = K[free][:, free]

    def step(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
        b, held = forces(task, load, stress).ravel()[free], np.zeros(len(rows), bool)
        for _ in range(50):
            step.solves += 1
            B = N[held]
            both = splu(sps.bmat([[K, B.T], [B, None]], format="csc")).solve(np.append(b, np.zeros(B.shape[0])))
            v, force = both[: len(free)], np.zeros(len(rows))
            force[held] = both[len(free) :]
            wanted = force + abs(K).max() * (N @ v) > 0
            if (wanted == held).all():
                break
            held = wanted
        u = np.zeros(basis.N)
        u[free] = v
        return u.reshape(-1, d)

    step.solves = 0
    return step


VARIANTS = {"own active set, multipliers at vertices": make}

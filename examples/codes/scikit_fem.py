"""scikit-fem: its assembly, and an active set of our own in a few lines, which is how one writes contact with it."""

from __future__ import annotations

from importlib.metadata import version

import numpy as np
import skfem
from active_set import active_set
from contact_judge import Task
from skfem.helpers import sym_grad

CODE, VERSION, GAPS = "scikit-fem", version("scikit-fem"), True


def make(task: Task):
    """step(b, s0) ↦ u."""
    d = task.dim
    mesh, element = (skfem.MeshTri, skfem.ElementTriP1()) if d == 2 else (skfem.MeshTet, skfem.ElementTetP1())
    basis = skfem.Basis(mesh(task.vertices.T, task.cells.T), skfem.ElementVector(element), intorder=0)
    pairs = [(0, 0), (1, 1), (0, 1)] if d == 2 else [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]

    def mandel(v):
        return np.array([sym_grad(v)[i, j] * (1 if i == j else np.sqrt(2)) for i, j in pairs])

    C = np.moveaxis(task.stiffness, 0, -1)[..., None]
    K = skfem.BilinearForm(lambda u, v, w: np.einsum("ij...,j...,i...->...", C, mandel(u), mandel(v))).assemble(basis)
    return active_set(task, K)


VARIANTS = {"own active set, multipliers at vertices": make}

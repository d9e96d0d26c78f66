"""This study: its contact solve by condensation on the tasks as they are exported; shows the round trip."""

from __future__ import annotations

from importlib.metadata import version

import numpy as np
import scipy.sparse as sps
from contact_judge import Task

from study.solve.signorini import Signorini

CODE, VERSION = "this study", version("signorini-study")


def make(task: Task):
    """step(b, s0) ↦ u."""
    free = np.setdiff1d(np.arange(task.vertices.size), np.add.outer(task.dim * task.clamped, np.arange(task.dim)))
    S = stiffness(task)[free][:, free]
    N, gap = sps.csr_array(normals(task)[:, free]), np.concatenate(task.gaps())
    solve = Signorini(sps.csc_array(S), N, gap=gap)

    def step(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
        u = np.zeros(task.vertices.size)
        u[free], _ = solve((load - task.internal(stress)).ravel()[free])
        return u.reshape(task.vertices.shape)

    return step


def normals(task: Task) -> sps.csr_array:
    """v ↦ v_i·ν at the constrained vertices, piece after piece, for all vertices."""
    rows = [(v, normal) for normal, vertices, _ in task.pieces() for v in vertices]
    N = sps.lil_array((len(rows), task.vertices.size))
    for row, (vertex, normal) in enumerate(rows):
        N[row, task.dim * vertex : task.dim * (vertex + 1)] = normal
    return sps.csr_array(N)


def stiffness(task: Task) -> sps.csr_array:
    """(C ε(u), ε(v))_Q from the task alone, for all vertices."""
    rows = []
    for corner in range(task.dim + 1):
        for axis in range(task.dim):
            unit = np.zeros((task.dim + 1, task.dim))
            unit[corner, axis] = 1
            rows.append(_strain_of(task, unit))
    B = np.stack(rows, axis=2)
    local = np.einsum("c,cIi,cIJ,cJj->cij", task.volumes, B, task.stiffness, B)
    dofs = (task.dim * task.cells[:, :, None] + np.arange(task.dim)).reshape(len(task.cells), -1)
    i, j = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
    return sps.csr_array(sps.coo_array((local.ravel(), (i.ravel(), j.ravel())), shape=(task.vertices.size,) * 2))


def _strain_of(task: Task, values: np.ndarray) -> np.ndarray:
    """Mandel strains on all cells of the local values (d + 1, d)."""
    gradient = np.einsum("ij,cik->cjk", values, task.gradients)
    full = (gradient + gradient.swapaxes(1, 2)) / 2
    index = [(0, 0), (1, 1), (0, 1)] if task.dim == 2 else [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
    return np.stack([full[:, i, j] * (1 if i == j else np.sqrt(2)) for i, j in index], axis=1)


VARIANTS = {"condensed active set": make}
GAPS = True

"""Contact for programs that have a matrix and no method of their own: active sets with multipliers at the vertices."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sps
from common import fixed, forces
from contact_judge import Task
from scipy.sparse.linalg import splu


def active_set(task: Task, K: sps.spmatrix):
    """step(b, s0) ↦ u from the matrix of all components, vertex after vertex: vertices with λ + κ (u_ν − gap) > 0 are
    held, κ the largest entry of K, until they stay the same."""
    d, gap = task.dim, np.concatenate(task.gaps())
    free = np.setdiff1d(np.arange(task.vertices.size), fixed(task))
    rows = [(d * v + np.arange(d), normal) for normal, vertices, _ in task.pieces() for v in vertices]
    i, j = np.repeat(np.arange(len(rows)), d), np.concatenate([on for on, _ in rows])
    values = np.concatenate([normal for _, normal in rows])
    N = sps.csr_matrix((values, (i, j)), shape=(len(rows), task.vertices.size))[:, free]
    K = sps.csr_matrix(K)[free][:, free]

    def step(load: np.ndarray, stress: np.ndarray) -> np.ndarray:
        b, held = forces(task, load, stress).ravel()[free], np.zeros(len(rows), bool)
        for _ in range(50):
            step.solves += 1
            B = N[held]
            both = splu(sps.bmat([[K, B.T], [B, None]], format="csc")).solve(np.append(b, gap[held]))
            v, force = both[: len(free)], np.zeros(len(rows))
            force[held] = both[len(free) :]
            wanted = force + abs(K).max() * (N @ v - gap) > 0
            if (wanted == held).all():
                break
            held = wanted
        u = np.zeros(task.vertices.size)
        u[free] = v
        return u.reshape(-1, d)

    step.solves = 0
    return step

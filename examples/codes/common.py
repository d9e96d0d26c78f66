"""What adapters share: the task in the forms that codes ask for."""

from __future__ import annotations

import shutil
import subprocess

import numpy as np
from contact_judge import Task

MARGIN = 0.25
"""By which a slab is longer than its face at both ends, and as thick, relative to the face."""


class CannotExpressError(ValueError):
    """The code has no means for this task."""


def debian_version(package: str) -> str:
    """The version of a Debian package, "?" where there is none."""
    if not shutil.which("dpkg-query"):
        return "?"
    command = ["dpkg-query", "-W", "-f", "${Version}", package]
    return subprocess.run(command, capture_output=True, text=True, check=False).stdout.partition("+")[0] or "?"


def forces(task: Task, load: np.ndarray, stress: np.ndarray) -> np.ndarray:
    """Nodal forces b − (s_0, ε(φ_i)), (n, d), which are the same problem for linear elements."""
    return load - task.internal(stress)


def fixed(task: Task) -> np.ndarray:
    """Numbers of the components that are zero, vertex after vertex."""
    return np.add.outer(task.dim * task.clamped, np.arange(task.dim)).ravel()


def voigt(task: Task) -> np.ndarray:
    """C between (ε_11, ε_22, 2ε_12) and (σ_11, σ_22, σ_12), or six in space, for every cell."""
    shear = np.ones(task.stiffness.shape[1])
    shear[task.dim :] = np.sqrt(0.5)
    return task.stiffness * np.multiply.outer(shear, shear)


def normal_modulus(task: Task) -> float:
    """g = C_νννν, the largest over cells and pieces, which parameters of contact are stated in."""
    found = []
    for normal, _, _ in task.pieces():
        full = np.outer(normal, normal)
        pairs = [(0, 0), (1, 1), (0, 1)] if task.dim == 2 else [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
        n = np.array([full[i, j] * (1 if i == j else np.sqrt(2)) for i, j in pairs])
        found.append(np.einsum("i,cij,j->c", n, task.stiffness, n).max())
    return float(max(found))


def lame(task: Task) -> tuple[float, float]:
    """(μ, λ) of a homogeneous isotropic C.

    Raises:
        CannotExpressError: it is another one.
    """
    C, D = task.stiffness, task.stiffness.shape[1]
    mu, lam = C[0, -1, -1] / 2, C[0, 0, 1]
    trace = np.concatenate([np.ones(task.dim), np.zeros(D - task.dim)])
    if not np.allclose(C, 2 * mu * np.eye(D) + lam * np.outer(trace, trace), rtol=1e-12, atol=1e-12 * abs(C).max()):
        raise CannotExpressError("the adapter states homogeneous isotropic laws only")
    return float(mu), float(lam)


def young(task: Task) -> tuple[float, float]:
    """(E, ν) of a homogeneous isotropic C in plane strain or in space."""
    mu, lam = lame(task)
    return mu * (3 * lam + 2 * mu) / (lam + mu), lam / (2 * (lam + mu))


def slab(face: np.ndarray, normal: np.ndarray, segments: int) -> tuple[np.ndarray, np.ndarray]:
    """A foundation of its own for codes without rigid ones: vertices, and positive triangles, of which the first
    ``segments`` have the side that touches as their first edge."""
    along = np.array([-normal[1], normal[0]])
    s = face @ along
    length = np.ptp(s)
    steps = np.linspace(s.min() - MARGIN * length, s.max() + MARGIN * length, segments + 1) - s[0]
    near = face[0] + np.multiply.outer(steps, along)
    far, k = near + MARGIN * length * normal, np.arange(segments)
    m = segments + 1
    cells = [np.stack([k + 1, k, k + m], 1), np.stack([k + 1, k + m, k + m + 1], 1)]
    return np.concatenate([near, far]), np.concatenate(cells)

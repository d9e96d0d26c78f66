"""What peers are given and what they answer; needs NumPy and SciPy only, so that any Python can run it.

A file PROBLEM.npz holds one level: M u̇ + G u + N_K(u) ∋ F with backward Euler steps of size k, S = M/k + G,

    S, M, G, N      matrices on the free values, K = {v : N v ≤ 0}
    R, bounded      orthogonal R with N R = rows of the identity: u = R w has v_ν = w on ``bounded``
    loads, u0, k    F(t_1), …, F(t_steps), (steps, dofs); the start; the step
    p, t, free      vertices, triangles, and the free ones of the nodal values (two a vertex)
    viscous, elastic    A and G as matrices on Mandel vectors (11, 22, √2·12)
"""

import json
import sys
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import scipy.sparse as sps

MATRICES = ("S", "M", "G", "N", "R")


@dataclass(frozen=True)
class Answer:
    """What a peer has to say.

    Attributes:
        u: u_1, …, u_steps, (steps, dofs).
        seconds: for all set-ups and solves.
        version: of what ran.
        factorisations: of matrices with about as many unknowns; None if unknown.
        assembly_seconds: for assembly; None if matrices are given.
    """

    u: np.ndarray
    seconds: float
    version: str
    factorisations: int | None = None
    assembly_seconds: float | None = None


def save(path, matrices, **arrays):
    """Write a problem: compressed sparse rows of the matrices, and arrays."""
    for name in MATRICES:
        matrix = sps.csr_matrix(matrices[name], copy=True)
        matrix.eliminate_zeros()
        matrix.sort_indices()
        arrays |= {f"{name}_{part}": getattr(matrix, part) for part in ("data", "indices", "indptr", "shape")}
    np.savez(path, **arrays)


def load(path):
    """The problem in a file, entries as attributes."""
    with np.load(path) as file:
        found = {name: file[name] for name in file.files}
    for name in MATRICES:
        parts = [found.pop(f"{name}_{part}") for part in ("data", "indices", "indptr")]
        found[name] = sps.csr_matrix(tuple(parts), shape=tuple(found.pop(f"{name}_shape")))
    found["k"] = float(found["k"])
    return SimpleNamespace(**found)


def bounds(problem):
    """Bounds on all nodal values, (2·vertices,) each: zero on one side where N has its one entry.

    Raises:
        ValueError: a row of N has more than one entry, so v_ν is not one component.
    """
    N = problem.N
    if (np.diff(N.indptr) != 1).any():
        raise ValueError("a row of N has more than one entry: give a body whose contact faces follow the axes")
    lower, upper = np.full((2, 2 * problem.p.shape[1]), np.inf) * [[-1], [1]]
    unknowns = problem.free[N.indices]
    lower[unknowns[N.data < 0]] = 0
    upper[unknowns[N.data > 0]] = 0
    return lower, upper


def blas():
    """The kinds of BLAS that this process has loaded, by the names of files; empty where the system has no /proc."""
    maps = Path("/proc/self/maps")
    files = {line.split()[-1].lower() for line in maps.read_text().splitlines()} if maps.exists() else set()
    kinds = {"openblas": "OpenBLAS", "mkl": "MKL", "blis": "BLIS"}
    found = {name for file in files for part, name in kinds.items() if part in file}
    return ", ".join(sorted(found)) or ("reference" if any("/libblas" in file for file in files) else "")


def main(solve):
    """PROBLEM.npz ANSWER.npy [OPTION ...]: solve, keep the trajectory, print the rest as JSON.

    The first step is solved once before: compiled code is loaded with the first use by some, with the import by others.
    """
    source, target, *options = sys.argv[1:]
    given = load(source)
    solve(SimpleNamespace(**{**vars(given), "loads": given.loads[:1]}), *options)
    answer = solve(given, *options)
    np.save(target, answer.u)
    printed = {name: value for name, value in vars(answer).items() if name != "u"}
    print(json.dumps(printed | {"blas": blas()}))

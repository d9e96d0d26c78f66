"""The tensor field Φ that proves ∫ g·v ≤ C_Ω ‖g‖ ‖v‖_V and ∫_{Γ2} g·v ≤ C_Γ ‖g‖ ‖v‖_V, from a semidefinite programme.

For a totally symmetric Φ, continuous and linear on cells, and v = 0 on Γ1,

    ∫ (div Φ)(v, v) + 2 (Φv)·ε(v) = ∫_{Γ2 ∪ Γ3} Φ(ν, v, v),

since (Φv)·∇v = (Φv)·ε(v). With −2 (Φv)·ε(v) ≤ Aε(v)·ε(v) + A⁻¹(Φv)·(Φv) follows

    ‖v‖_V² ≥ ∫ div Φ(v, v) − A⁻¹(Φv)·(Φv) − ∫_{Γ2 ∪ Γ3} Φ(ν, v, v) ≥ μ ‖v‖² + κ ‖v‖²_{L²(Γ2)}

wherever the integrands are that large, which is a matter of 2 × 2 matrices at vertices: the square is convex along a
cell. No inequality of Korn's is needed. The largest min(μ, κ) is a semidefinite programme, with Schur's complement

    ( div Φ − μ 1   Φᵀ )
    ( Φ             A  )  ⪰ 0     at every vertex of every cell.
"""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import clarabel
import numpy as np
import scipy.sparse as sps

from study.bound.moduli import BoundError
from study.certify import checker

BITS = 28
"""Φ is rounded to multiples of 2^−BITS."""
MARGIN = 1e-6
"""Of all that has to be semidefinite, for rounding."""
WITH_FORCE, WITHOUT = Fraction(1), Fraction(1, 100)
"""μ over κ: where there is no f_0, C_Ω serves rounding errors only."""
SLACKS = (1e-4, 1e-3, 1e-2, 0.1)
"""Shares of μ that are given up until the rounded field proves the rest."""
TRIANGLE = [(i, j) for j in range(5) for i in range(j + 1)]
"""Entries of a symmetric 5 × 5 matrix as clarabel takes them."""


def constants(mesh: dict[str, Any], problem: checker.Problem) -> dict[str, Any]:
    """What the certificate says: a mesh, the values of Φ at its vertices, μ and κ.

    Raises:
        BoundError: none is found.
    """
    exact = checker.Mesh.of(mesh, problem)
    inside = WITH_FORCE if any(problem.force) else WITHOUT
    field, largest = _solve(exact, problem, float(inside))
    rounded = [[int(c) for c in row] for row in np.round(field * 2**BITS)]
    for slack in SLACKS:
        kappa = Fraction(largest * (1 - slack)).limit_denominator(10**6)
        found = {"mesh": mesh, "bits": BITS, "field": rounded, "volume": str(kappa * inside), "surface": str(kappa)}
        try:
            checker.load_constants(found, problem)
        except checker.RefusedError:
            continue
        return found
    raise BoundError("no constant of the loads was found for this body: its mesh may have cells that are too flat")


def _solve(mesh: checker.Mesh, problem: checker.Problem, inside: float) -> tuple[np.ndarray, float]:
    """Φ at the vertices, (vertices, 4), and the largest κ with μ = inside · κ."""
    A = np.array([[float(c) for c in row] for row in problem.A])
    unknowns, cones = 4 * len(mesh.points) + 1, []
    rows: list[Any] = []
    right: list[Any] = []
    for cell in mesh.cells:
        slopes = checker._slopes([mesh.place(v) for v in cell])
        for v in cell:
            block = np.zeros((5, 5, unknowns))
            for w, g in zip(cell, slopes, strict=True):
                for k, (i, j) in enumerate(((0, 0), (0, 1), (1, 1))):
                    block[i, j, 4 * w + k] += float(g[0])
                    block[i, j, 4 * w + k + 1] += float(g[1])
            block[[0, 1], [0, 1], -1] -= inside
            for stress, entries in enumerate(((0, 1), (2, 3), (1, 2))):
                for column, entry in enumerate(entries):
                    block[column, 2 + stress, 4 * v + entry] += 1
            constant = np.zeros((5, 5))
            constant[2:, 2:] = A
            constant[[0, 1], [0, 1]] = -MARGIN
            _add(rows, right, block, constant, 5)
            cones.append(clarabel.PSDTriangleConeT(5))
    for edge, part in mesh.parts.items():
        if problem.kinds[part] == "clamped":
            continue
        start, end = (np.array([float(c) for c in x]) for x in problem.sides[part])
        normal = np.array([(end - start)[1], (start - end)[0]]) / np.linalg.norm(end - start)
        for v in edge:
            block = np.zeros((2, 2, unknowns))
            for k, (i, j) in enumerate(((0, 0), (0, 1), (1, 1))):
                block[i, j, [4 * v + k, 4 * v + k + 1]] -= normal
            if part in problem.loads:
                block[[0, 1], [0, 1], -1] -= 1
            _add(rows, right, block, -MARGIN * np.eye(2), 2)
            cones.append(clarabel.PSDTriangleConeT(2))
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    objective = np.zeros(unknowns)
    objective[-1] = -1.0
    nothing = sps.csc_matrix((unknowns, unknowns))
    solver = clarabel.DefaultSolver(
        nothing, objective, sps.csc_matrix(sps.vstack(rows)), np.concatenate(right), cones, settings
    )
    x = np.array(solver.solve().x)
    return x[:-1].reshape(-1, 4), float(x[-1])


def _add(rows: list[Any], right: list[Any], block: np.ndarray, constant: np.ndarray, size: int) -> None:
    """constant + block·x ⪰ 0, off the diagonal times √2."""
    entries = [(i, j) for j in range(size) for i in range(j + 1)]
    scale = np.array([1.0 if i == j else np.sqrt(2) for i, j in entries])
    rows.append(sps.csr_matrix(-scale[:, None] * np.array([block[i, j] for i, j in entries])))
    right.append(scale * np.array([constant[i, j] for i, j in entries]))

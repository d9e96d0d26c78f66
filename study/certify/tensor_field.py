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

from collections.abc import Iterator
from fractions import Fraction
from typing import Any

import clarabel
import numpy as np
import scipy.sparse as sps

from manufactured.tensors import Array
from study.bound.problem import BoundError
from study.certify import checker

BITS = 28
"""Φ is rounded to multiples of 2^−BITS."""
MARGIN = 1e-6
"""Of all that has to be semidefinite, for rounding."""
WITH_FORCE, WITHOUT = Fraction(1), Fraction(1, 100)
"""μ over κ: where there is no f_0, C_Ω serves rounding errors only."""
SLACKS = (1e-4, 1e-3, 1e-2, 0.1)
"""Shares of μ that are given up until the rounded field proves the rest."""
ENTRIES = ((0, 0), (0, 1), (1, 1))
"""Of a symmetric 2 × 2 matrix, to whose k-th Φ contributes its entries k and k + 1."""


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


def _solve(mesh: checker.Mesh, problem: checker.Problem, inside: float) -> tuple[Array, float]:
    """Φ at the vertices, (vertices, 4), and the largest κ with μ = inside · κ."""
    blocks = [*_inside(mesh, problem, inside), *_on_boundary(mesh)]
    unknowns = 4 * len(mesh.points) + 1
    rows, right = zip(*(_triangle(linear, constant) for linear, constant in blocks), strict=True)
    cones = [clarabel.PSDTriangleConeT(len(constant)) for _, constant in blocks]
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    objective = np.zeros(unknowns)
    objective[-1] = -1.0
    matrix, nothing = sps.csc_matrix(sps.vstack(rows)), sps.csc_matrix((unknowns, unknowns))
    solver = clarabel.DefaultSolver(nothing, objective, matrix, np.concatenate(right), cones, settings)
    x = np.array(solver.solve().x)
    return x[:-1].reshape(-1, 4), float(x[-1])


def _inside(mesh: checker.Mesh, problem: checker.Problem, inside: float) -> Iterator[tuple[Array, Array]]:
    """Schur's complement at the vertices of the cells, as (5, 5, unknowns) and what is constant."""
    constant = -MARGIN * np.eye(5)
    constant[2:, 2:] = [[float(c) for c in row] for row in problem.A]
    for cell in mesh.cells:
        divergence = np.zeros((5, 5, 4 * len(mesh.points) + 1))
        a, b, c, d = (x * mesh.h / cell.det for x in cell.F)
        for w, slope in zip(cell.v, ((c - d, b - a), (d, -b), (-c, a)), strict=True):
            for k, entry in enumerate(ENTRIES):
                divergence[entry][[4 * w + k, 4 * w + k + 1]] += slope
        divergence[[0, 1], [0, 1], -1] -= inside
        for v in cell.v:
            block = divergence.copy()
            for stress, columns in enumerate(((0, 1), (2, 3), (1, 2))):
                block[[0, 1], 2 + stress, [4 * v + column for column in columns]] += 1
            yield block, constant


def _on_boundary(mesh: checker.Mesh) -> Iterator[tuple[Array, Array]]:
    """−Φ(ν) at the ends of edges that are not of Γ1, less κ where there is a load."""
    for edge, side in mesh.boundary.items():
        normal = np.array([float(c) for c in side.normal])
        normal /= np.linalg.norm(normal)
        for v in edge if side.kind != "clamped" else ():
            block = np.zeros((2, 2, 4 * len(mesh.points) + 1))
            for k, entry in enumerate(ENTRIES):
                block[entry][[4 * v + k, 4 * v + k + 1]] -= normal
            if side.load:
                block[[0, 1], [0, 1], -1] -= 1
            yield block, -MARGIN * np.eye(2)


def _triangle(linear: Array, constant: Array) -> tuple[sps.csr_matrix, Array]:
    """constant + linear · x ⪰ 0 as clarabel takes it: the upper triangle by columns, off the diagonal times √2."""
    entries = [(i, j) for j in range(len(constant)) for i in range(j + 1)]
    scale = np.array([1.0 if i == j else np.sqrt(2) for i, j in entries])
    rows, columns = zip(*entries, strict=True)
    return sps.csr_matrix(-scale[:, None] * linear[rows, columns]), scale * constant[rows, columns]

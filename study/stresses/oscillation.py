"""Data oscillation: a guaranteed bound of what the projections P f_0 and P f_2 leave out, in the dual of V.

Let g ∈ L²(T)² be orthogonal to P_q(T)², the polynomials of degree q ≥ 1 on a triangle, rigid motions among them. Korn's
inequality gives a smallest C_{T,q} with

    ∫_T g·v ≤ C_{T,q} ‖g‖_T ‖ε(v)‖_{A,T}   for all v ∈ H¹(T)²,

which grows in proportion to the size of T for fixed shape and A. Cut T into four similar triangles T' of half the size
and let P' be the projection onto P_q(T')² on each of them. P'g is still orthogonal to the rigid motions of T, so it is
balanced by stresses τ with τν = 0 on ∂T, and ∫ P'g·v = (τ, ε(v)); the least ‖τ‖_{A⁻¹} over composite stresses is at
most √λ ‖P'g‖ with an eigenvalue λ of a small matrix (``study.stresses.balancing``). g − P'g is orthogonal to every
P_q(T')², where the constant is C_{T,q}/2. Hence

    C_{T,q}² ≤ λ + C_{T,q}²/4,   that is   C_{T,q}² ≤ 4λ/3.

The same with a load on one side e of T, orthogonal to P1(e)², with halves of e for the T' and a constant that grows
like the root of the size:  C_e² ≤ λ_e + C_e²/2,  that is  C_e² ≤ 2 λ_e.

No constant from the literature enters. λ comes from dense eigenvalue solves in floating point arithmetic and is no
interval enclosure.
"""

from __future__ import annotations

import numpy as np

from manufactured.body import Kind
from manufactured.tensors import Array
from study.stresses.balancing import balancing_in_cell, balancing_on_side
from study.stresses.composite import CORNERS, SIDES
from study.stresses.loads import LeftOut
from study.stresses.stress_space import StressSpace

BLOCK = 256
"""Cells computed at a time."""


def cell_constants(F: Array, compliance: Array, q: int) -> Array:
    """An upper bound of C_{T,q} for triangles x = F x̂ + b: (cells, 2, 2) → (cells,).

    Cells that differ by their size, by a half turn, or by the order of their vertices, are computed once.
    """
    size = np.sqrt(abs(np.linalg.det(F)))
    shapes = (by_length(F) / size[:, None, None]).reshape(-1, 4)
    leading = np.take_along_axis(shapes, abs(shapes).argmax(axis=1)[:, None], axis=1)
    shapes, where = np.unique(np.round(shapes * np.sign(leading), 12), axis=0, return_inverse=True)
    blocks = np.array_split(shapes.reshape(-1, 2, 2), max(1, len(shapes) // BLOCK))
    found = [balancing_in_cell(q).constants(block, compliance, 1 / abs(np.linalg.det(block))) for block in blocks]
    return np.sqrt(4 / 3) * np.concatenate(found)[where] * size


def by_length(F: Array) -> Array:
    """The same triangles, with vertices in the order of the lengths of the sides opposite to them: (cells, 2, 2)."""
    corners = F @ CORNERS
    opposite = np.linalg.norm(corners[:, :, [2, 0, 1]] - corners[:, :, [1, 2, 0]], axis=1)
    sorted_corners = np.take_along_axis(corners, np.argsort(opposite, axis=1, kind="stable")[:, None], axis=2)
    return sorted_corners[:, :, 1:] - sorted_corners[:, :, :1]


def side_constants(F: Array, compliance: Array, side: int) -> Array:
    """An upper bound of C_e for one side of triangles x = F x̂ + b: (cells, 2, 2) → (cells,)."""
    a, b = SIDES[side]
    length = np.linalg.norm(F @ (CORNERS[:, b] - CORNERS[:, a]), axis=1)
    return np.sqrt(2) * balancing_on_side(side).constants(F, compliance, 1 / length)


def loaded_sides(space: StressSpace, compliance: Array) -> list[tuple[Array, Array, Array]]:
    """For each number of a side: the cells with this side on Γ2, their edges there, and upper bounds of C_e."""
    loaded = np.concatenate([np.empty(0, dtype=int), *(edges for _, edges in space.on(Kind.LOADED))])
    found = []
    for side in range(len(SIDES)):
        cells = np.flatnonzero(np.isin(space.edges[:, side], loaded))
        found.append((cells, space.edges[cells, side], side_constants(space.map[cells], compliance, side)))
    return found


class Oscillation:
    """η_T with (f_0 − P f_0, v)_T + Σ_e (f_2 − P f_2, v)_e ≤ η_T ‖ε(v)‖_{A,T} for the sides e of T on Γ2.

    η_T = C_{T,k−1} ‖Π g‖_T + C_{T,k} ‖g − Π g‖_T + Σ_e C_e ‖f_2 − P f_2‖_e with g = f_0 − P f_0, which is orthogonal to
    P_{k−1}, and its projection Π g onto P_k; k is the degree of the stresses.

    Args:
        space: the stresses that P belongs to, of degree 2 or more.
        compliance: A⁻¹ but for its factor, Mandel (3, 3).
        low: the least value of the factor of A.
    """

    def __init__(self, space: StressSpace, compliance: Array, low: float = 1.0) -> None:
        root = np.sqrt(low)
        self._cells = [cell_constants(space.map, compliance, q) / root for q in (space.degree - 1, space.degree)]
        self._sides = [(cells, edges, constants / root) for cells, edges, constants in loaded_sides(space, compliance)]

    def __call__(self, left_out: LeftOut) -> Array:
        """η_T from the norms of what P leaves out, (cells,)."""
        low, high = self._cells
        total = low * left_out.low_order + high * left_out.high_order
        for cells, edges, constants in self._sides:
            total[cells] += constants * left_out.on_edges[edges]
        return total

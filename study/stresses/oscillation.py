"""Constants that bound what the projections P f_0 and P f_2 leave out, computed cell by cell.

Let g ∈ L²(T)² be orthogonal to P_q(T)², the polynomials of degree q ≥ 1 on a triangle, rigid motions among them. Korn's
inequality gives a smallest C_{T,q} with

    ∫_T g·v ≤ C_{T,q} ‖g‖_T ‖ε(v)‖_{A,T}   for all v ∈ H¹(T)²,

which grows in proportion to the size of T for fixed shape and A. Cut T into four similar triangles T' of half the size
and let P be the projection onto P_q(T')² on each of them. P g is still orthogonal to the rigid motions of T, so it is
balanced by stresses τ with τν = 0 on ∂T, and ∫ P g·v = (τ, ε(v)); the least ‖τ‖_{A⁻¹} over composite stresses is at
most √λ ‖P g‖ with an eigenvalue λ of a small matrix. g − P g is orthogonal to every P_q(T')², where the constant is
C_{T,q}/2. Hence

    C_{T,q}² ≤ λ + C_{T,q}²/4,   that is   C_{T,q}² ≤ 4λ/3.

The same with a load on one side e of T, orthogonal to P1(e)², with halves of e for the T' and a constant that grows
like the root of the size:  C_e² ≤ λ_e + C_e²/2,  that is  C_e² ≤ 2 λ_e.

No constant from the literature enters. λ comes from dense eigenvalues in floating point arithmetic: it is computed, not
proved digit by digit.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.linalg import null_space

from manufactured.body import Kind
from manufactured.tensors import Array, basis
from study.fem.quadrature import simplex_rule
from study.stresses.composite import CORNERS, SIDES, bernstein, composite, indices, thirds
from study.stresses.loads import Snapshot
from study.stresses.space import StressSpace

ROUNDING = 1e-9
"""Relative singular values below which equations on the reference triangle are dependent."""


BLOCK = 256
"""Cells computed at a time."""


@dataclass(frozen=True, eq=False)
class _Family:
    """Stresses on the divided reference triangle that balance a space of loads.

    Attributes:
        free: those that balance the load 0, at the points, (points, 3, p).
        lifts: one for each load of a basis, (points, 3, r).
        weights: of the points, (points,).
        loads: ∫ d_i d'_j of the basis of loads, before the map, (r, r, 2, 2).
    """

    free: Array
    lifts: Array
    weights: Array
    loads: Array

    def constants(self, F: Array, compliance: Array, scale: Array) -> Array:
        """√λ for triangles x = F x̂ + b, (cells,).

        Args:
            F: (cells, 2, 2).
            compliance: A⁻¹ in Mandel form, (3, 3) or (cells, 3, 3).
            scale: (load)² = scale × ∫ |F d|², (cells,).
        """
        J = abs(np.linalg.det(F))
        E = basis(2)
        push = np.einsum("Iil,cij,Jjk,clk->cIJ", E, F, E, F, optimize=True) / J[:, None, None]
        metric = push.swapaxes(1, 2) @ compliance @ push * J[:, None, None]
        every = np.concatenate([self.free, self.lifts], axis=2)
        products = np.einsum("qIp,qJr,q->IJpr", every, every, self.weights, optimize=True)
        energy = np.tensordot(metric, products, axes=2)
        p = self.free.shape[2]
        coupling = np.linalg.solve(energy[:, :p, :p], energy[:, :p, p:])
        least = energy[:, p:, p:] - energy[:, p:, :p] @ coupling
        size = np.einsum("c,cij,cik,rsjk->crs", scale, F, F, self.loads, optimize=True)
        inverse = np.linalg.inv(np.linalg.cholesky(size))
        return np.sqrt(np.linalg.eigvalsh(inverse @ least @ inverse.swapaxes(1, 2))[:, -1])


def cell_constants(F: Array, compliance: Array, q: int) -> Array:
    """An upper bound of C_{T,q} for triangles x = F x̂ + b: (cells, 2, 2) → (cells,).

    Cells that differ by their size, or by a half turn, are computed once.
    """
    size = np.sqrt(abs(np.linalg.det(F)))
    shapes = (F / size[:, None, None]).reshape(-1, 4)
    leading = np.take_along_axis(shapes, abs(shapes).argmax(axis=1)[:, None], axis=1)
    shapes, where = np.unique(np.round(shapes * np.sign(leading), 12), axis=0, return_inverse=True)
    blocks = np.array_split(shapes.reshape(-1, 2, 2), max(1, len(shapes) // BLOCK))
    found = [_volume(q).constants(block, compliance, 1 / abs(np.linalg.det(block))) for block in blocks]
    return np.sqrt(4 / 3) * np.concatenate(found)[where] * size


def side_constants(F: Array, compliance: Array, side: int) -> Array:
    """An upper bound of C_e for one side of triangles x = F x̂ + b: (cells, 2, 2) → (cells,)."""
    a, b = SIDES[side]
    length = np.linalg.norm(F @ (CORNERS[:, b] - CORNERS[:, a]), axis=1)
    return np.sqrt(2) * _side(side).constants(F, compliance, 1 / length)


class LeftOut:
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
        loaded = np.concatenate([np.empty(0, dtype=int), *(edges for _, edges in space.on(Kind.LOADED))])
        self._sides = []
        for side in range(len(SIDES)):
            cells = np.flatnonzero(np.isin(space.edges[:, side], loaded))
            constants = side_constants(space.map[cells], compliance, side) / root
            self._sides.append((cells, space.edges[cells, side], constants))

    def __call__(self, snapshot: Snapshot) -> Array:
        """η_T for the data at one time, (cells,)."""
        below, at_degree = self._cells
        total = below * snapshot.bowed + at_degree * snapshot.rest
        for cells, edges, constants in self._sides:
            total[cells] += constants * snapshot.around[edges]
        return total


class _Divided:
    """Composite stresses on the four children of the reference triangle with matching tractions.

    Child i < 3 is x = (x̂ + v_i)/2, the middle one x = (v_0 + v_1 + v_2 − x̂)/2: with F = ±1/2 Piola's map keeps
    coefficients, turns Div into ±2 Div and |ê| σν into ±1/2 |ê| σν.
    """

    def __init__(self, degree: int) -> None:
        element = composite(degree)
        self.space = element.space.reshape(-1, element.space.shape[-1])
        self.degree, self.size = degree, self.space.shape[1]
        flat = element.tractions.reshape(3, degree + 1, 2, -1) @ self.space / 2
        inner, outer = [], []
        for side in range(3):
            rows = np.zeros((degree + 1, 2, 4, self.size))
            rows[:, :, side] = flat[side]
            rows[:, :, 3] = -flat[side][::-1]
            inner.append(rows)
            for child in SIDES[side]:
                rows = np.zeros((degree + 1, 2, 4, self.size))
                rows[:, :, child] = flat[side]
                outer.append(rows)
        self.inner = np.concatenate(inner).reshape(-1, 4 * self.size)
        # (3 sides, 2 halves, n, 2, unknowns)
        self.outer = np.array(outer).reshape(3, 2, degree + 1, 2, -1)
        divergence = element.divergence.reshape(-1, self.space.shape[0]) @ self.space
        self.divergence = np.kron(np.diag([2.0, 2.0, 2.0, -2.0]), divergence)
        barycentric, weights = simplex_rule(2, 2 * degree)
        at = bernstein(degree, barycentric).T
        third = np.einsum("qa,taJp->tqJp", at, element.space).reshape(-1, 3, self.size)
        values = np.zeros((4, len(third), 3, 4, self.size))
        for child in range(4):
            values[child, :, :, child] = third
        self.values = values.reshape(-1, 3, 4 * self.size)
        self.weights = np.tile(weights / 24, 12)


def _family(divided: _Divided, still: Array, moving: Array, loads: Array, products: Array) -> _Family:
    """Stresses w with still·w = 0 and moving·w ∈ span of the loads, which can all be balanced.

    Args:
        divided: where the stresses live.
        still: (equations, unknowns).
        moving: (m, unknowns).
        loads: (m, r).
        products: ∫ d_i d'_j of the r loads, (r, r, 2, 2).
    """
    admissible = null_space(still, rcond=ROUNDING)
    onto = moving @ admissible
    free = admissible @ null_space(onto, rcond=ROUNDING)
    lifts = admissible @ np.linalg.pinv(onto, rcond=ROUNDING) @ loads
    return _Family(divided.values @ free, divided.values @ lifts, divided.weights, products)


CHILDREN = np.stack([*((np.eye(3) + np.eye(3)[i]) / 2 for i in range(3)), (1 - np.eye(3)) / 2])
"""Vertices of the children in barycentric coordinates of the triangle, (4, 3 vertices, 3)."""


def _on_part(degree: int, corners: Array) -> Array:
    """Bernstein coefficients of a polynomial on a triangle ↦ those on a part of it, (polynomials, polynomials).

    corners: barycentric coordinates of the vertices of the part, (3 vertices, 3).
    """
    at = np.array(indices(degree)).T / degree
    inside = bernstein(degree, corners.T @ at)
    return np.linalg.solve(bernstein(degree, at).T, inside.T)


@lru_cache
def _volume(q: int) -> _Family:
    """Loads in P_q of the four children, orthogonal to P_q of the triangle, tractions 0 on the three sides."""
    divided = _Divided(q + 1)
    third = np.concatenate([_on_part(q, corners) for corners in np.moveaxis(thirds(np.eye(3)), 2, 0).swapaxes(1, 2)])
    barycentric, weights = simplex_rule(2, 2 * q)
    at = bernstein(q, barycentric)
    mass = np.kron(np.eye(4), (at * weights) @ at.T / 8)
    whole = np.vstack([_on_part(q, corners) for corners in CHILDREN])
    rest = null_space(whole.T @ mass, rcond=ROUNDING)
    loads = np.kron(np.kron(np.eye(4), third) @ rest, np.eye(2))
    still = np.vstack([divided.inner, divided.outer.reshape(-1, divided.inner.shape[1])])
    return _family(divided, still, divided.divergence, loads, _products(rest.T @ mass @ rest))


def _products(mass: Array) -> Array:
    """∫ d_i d'_j of vector loads from the products of their scalar factors, (r, r) → (2r, 2r, 2, 2)."""
    count = 2 * len(mass)
    return np.einsum("vw,ai,bj->vawbij", mass, np.eye(2), np.eye(2)).reshape(count, count, 2, 2)


@lru_cache
def _side(side: int) -> _Family:
    """Linear loads on the two halves of one side, Div = 0 and tractions 0 on the others."""
    divided = _Divided(2)
    unknowns = divided.inner.shape[1]
    others = np.delete(divided.outer, side, axis=0).reshape(-1, unknowns)
    still = np.vstack([divided.inner, others, divided.divergence])
    # A linear function with the values c_0, c_1 has the Bernstein coefficients c_0, (c_0 + c_1)/2, c_1.
    raised = np.array([[1.0, 0.0], [0.5, 0.5], [0.0, 1.0]])
    # Values at the ends of the halves; those of the linear functions of the side, and what is orthogonal to them.
    mass = np.kron(np.eye(2), (np.ones((2, 2)) + np.eye(2)) / 6 / 2)
    linear = np.array([[1.0, 0.0], [0.5, 0.5], [0.5, 0.5], [0.0, 1.0]])
    rest = null_space(linear.T @ mass, rcond=ROUNDING)
    loads = np.kron(np.kron(np.eye(2), raised) @ rest, np.eye(2))
    # |ê| t̂ on a half is its traction times its share 1/2 of the side: t on the side is twice that.
    return _family(
        divided, still, divided.outer[side].reshape(-1, unknowns), loads, 4 * _products(rest.T @ mass @ rest)
    )

"""The energy of stresses that balance a load on a triangle: the least λ with min ‖τ‖²_{A⁻¹} ≤ λ ‖load‖² for all loads.

The loads are piecewise polynomials on a triangle divided into four similar ones, orthogonal to the polynomials of the
whole; τ are composite stresses on the division without other tractions on its boundary.

The midpoints of its sides divide the reference triangle into four children: child i < 3 is x = (x̂ + v_i)/2, the middle
one x = (v_0 + v_1 + v_2 − x̂)/2. With F = ±1/2 the Piola transformation keeps coefficients, turns Div into ±2 Div and
|ê| σν into ±1/2 |ê| σν.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.linalg import null_space

from manufactured.tensors import Array, basis
from study.fem.quadrature import simplex_rule
from study.stresses.bernstein import bernstein, indices, triangle_mass
from study.stresses.composite import SIDES, composite, thirds

CHILDREN = np.stack([*((np.eye(3) + np.eye(3)[i]) / 2 for i in range(3)), (1 - np.eye(3)) / 2])
"""Vertices of the children in barycentric coordinates of the triangle, (4, 3 vertices, 3)."""
ROUNDING = 1e-9
"""Relative singular values below which equations on the reference triangle are dependent."""


class DividedTriangle:
    """Stresses of degree k on each child; traction matrices act on their coefficients, the unknowns.

    Attributes:
        inner: the jump of tractions across the three sides of the middle child, (equations, unknowns).
        outer: |ê| σν on the halves of the sides, (3 sides, 2 halves, k + 1, 2, unknowns).
        divergence: Div in Bernstein form of degree k − 1, (4 children · 3 thirds · lower · 2, unknowns).
        values: Mandel values at the points of a quadrature rule, (points, 3, unknowns).
        weights: of the rule, (points,).
    """

    def __init__(self, degree: int) -> None:
        element = composite(degree)
        space = element.space.reshape(-1, element.space.shape[-1])
        size = space.shape[1]
        self.inner, self.outer = _tractions(degree, element.tractions.reshape(3, degree + 1, 2, -1) @ space / 2)
        divergence = element.divergence.reshape(-1, space.shape[0]) @ space
        self.divergence = np.kron(np.diag([2.0, 2.0, 2.0, -2.0]), divergence)
        barycentric, weights = simplex_rule(2, 2 * degree)
        at = bernstein(degree, barycentric).T
        of_child = np.einsum("qa,taJp->tqJp", at, element.space).reshape(-1, 3, size)
        self.values = np.einsum("ab,pJu->apJbu", np.eye(4), of_child).reshape(-1, 3, 4 * size)
        self.weights = np.tile(weights / 24, 12)


def _tractions(degree: int, of_child: Array) -> tuple[Array, Array]:
    """The jumps and the outer tractions of four children, from the tractions of one: (3, degree + 1, 2, size)."""
    inner, outer = [], []
    size = of_child.shape[-1]
    for side in range(3):
        rows = np.zeros((degree + 1, 2, 4, size))
        rows[:, :, side] = of_child[side]
        rows[:, :, 3] = -of_child[side][::-1]
        inner.append(rows)
        for child in SIDES[side]:
            rows = np.zeros((degree + 1, 2, 4, size))
            rows[:, :, child] = of_child[side]
            outer.append(rows)
    return np.concatenate(inner).reshape(-1, 4 * size), np.array(outer).reshape(3, 2, degree + 1, 2, -1)


def restriction(degree: int, corners: Array) -> Array:
    """Bernstein coefficients of a polynomial on a triangle ↦ those on a part of it, (polynomials, polynomials).

    The part is given by the barycentric coordinates of its vertices, (3 vertices, 3).
    """
    at = np.array(indices(degree)).T / degree
    inside = bernstein(degree, corners.T @ at)
    return np.linalg.solve(bernstein(degree, at).T, inside.T)


@dataclass(frozen=True, eq=False)
class BalancingStresses:
    """Stresses on the divided reference triangle that balance a space of r loads.

    Attributes:
        free: a basis of those that balance the load 0, at the points, (points, 3, p).
        lifts: one for each load of a basis, (points, 3, r).
        weights: of the points, (points,).
        loads: ∫ d_i d'_j of any two loads of the basis on the reference triangle, (r, r, 2, 2).
    """

    free: Array
    lifts: Array
    weights: Array
    loads: Array

    @classmethod
    def of(cls, divided: DividedTriangle, zero: Array, balanced: Array, loads: Array, gram: Array) -> BalancingStresses:
        """Stresses w with zero·w = 0 and balanced·w in the span of the loads, every one of which can be balanced.

        Loads are the columns of ``loads``, with the products ``gram``, in each of the two directions.
        """
        admissible = null_space(zero, rcond=ROUNDING)
        onto = balanced @ admissible
        free = admissible @ null_space(onto, rcond=ROUNDING)
        lifts = admissible @ np.linalg.pinv(onto, rcond=ROUNDING) @ np.kron(loads, np.eye(2))
        products = np.einsum("vw,ai,bj->vawbij", gram, np.eye(2), np.eye(2)).reshape(2 * len(gram), -1, 2, 2)
        return cls(divided.values @ free, divided.values @ lifts, divided.weights, products)

    def constants(self, F: Array, compliance: Array, scale: Array) -> Array:
        """√λ for triangles x = F x̂ + b, (cells,).

        Args:
            F: (cells, 2, 2).
            compliance: A⁻¹ in Mandel form, (3, 3) or (cells, 3, 3).
            scale: ‖load‖² = scale × ∫ |F d|², (cells,).
        """
        J, E = abs(np.linalg.det(F)), basis(2)
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


@lru_cache
def balancing_in_cell(q: int) -> BalancingStresses:
    """Loads in P_q of the four children, orthogonal to P_q of the triangle; tractions are 0 on the three sides."""
    divided = DividedTriangle(q + 1)
    third = np.concatenate([restriction(q, corners) for corners in np.moveaxis(thirds(np.eye(3)), 2, 0).swapaxes(1, 2)])
    mass = np.kron(np.eye(4), triangle_mass(q) / 8)
    whole = np.vstack([restriction(q, corners) for corners in CHILDREN])
    rest = null_space(whole.T @ mass, rcond=ROUNDING)
    loads = np.kron(np.eye(4), third) @ rest
    zero = np.vstack([divided.inner, divided.outer.reshape(-1, divided.inner.shape[1])])
    return BalancingStresses.of(divided, zero, divided.divergence, loads, rest.T @ mass @ rest)


@lru_cache
def balancing_on_side(side: int) -> BalancingStresses:
    """Linear loads on the halves of a side, orthogonal to P1 of it; Div and tractions on the other sides are 0."""
    divided = DividedTriangle(2)
    unknowns = divided.inner.shape[1]
    others = np.delete(divided.outer, side, axis=0).reshape(-1, unknowns)
    zero = np.vstack([divided.inner, others, divided.divergence])
    # A linear function with the values c_0, c_1 has the Bernstein coefficients c_0, (c_0 + c_1)/2, c_1.
    raised = np.array([[1.0, 0.0], [0.5, 0.5], [0.0, 1.0]])
    # Values at the ends of the halves; those of the linear functions of the side, and what is orthogonal to them.
    mass = np.kron(np.eye(2), (np.ones((2, 2)) + np.eye(2)) / 6 / 2)
    linear = np.array([[1.0, 0.0], [0.5, 0.5], [0.5, 0.5], [0.0, 1.0]])
    rest = null_space(linear.T @ mass, rcond=ROUNDING)
    loads = np.kron(np.eye(2), raised) @ rest
    balanced = divided.outer[side].reshape(-1, unknowns)
    # |ê| t̂ on a half is its traction times its share 1/2 of the side: t on the side is twice that.
    return BalancingStresses.of(divided, zero, balanced, loads, 4 * (rest.T @ mass @ rest))

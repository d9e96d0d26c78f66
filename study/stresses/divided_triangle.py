"""Composite stresses on the reference triangle divided by the midpoints of its sides into four children.

Child i < 3 is x = (x̂ + v_i)/2, the middle one x = (v_0 + v_1 + v_2 − x̂)/2: with F = ±1/2 the Piola transformation
keeps coefficients, turns Div into ±2 Div and |ê| σν into ±1/2 |ê| σν.
"""

from __future__ import annotations

import numpy as np

from manufactured.tensors import Array
from study.fem.quadrature import simplex_rule
from study.stresses.alfeld import SIDES
from study.stresses.bernstein import bernstein, indices
from study.stresses.composite import composite

CHILDREN = np.stack([*((np.eye(3) + np.eye(3)[i]) / 2 for i in range(3)), (1 - np.eye(3)) / 2])
"""Vertices of the children in barycentric coordinates of the triangle, (4, 3 vertices, 3)."""


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
        values = np.zeros((4, len(of_child), 3, 4, size))
        for child in range(4):
            values[child, :, :, child] = of_child
        self.values = values.reshape(-1, 3, 4 * size)
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

    Args:
        degree: of the polynomial.
        corners: barycentric coordinates of the vertices of the part, (3 vertices, 3).
    """
    at = np.array(indices(degree)).T / degree
    inside = bernstein(degree, corners.T @ at)
    return np.linalg.solve(bernstein(degree, at).T, inside.T)

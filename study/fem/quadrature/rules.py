"""Quadrature on cells: what a rule consists of, and rules on (0, 1) and on simplices in barycentric coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTet, RefTri

from manufactured.tensors import Array, Points

GRADING = 8
"""s = c + L ξ^8 turns (s − c)^{2(α−2)}, α > 3/2, into a power of ξ of 0 or more."""


@dataclass(frozen=True, eq=False)
class CellRule:
    """Quadrature on some cells with the same number of points each.

    Attributes:
        cells: indices (n,).
        points: (d, n, q).
        weights: (n, q), summing to |T| over q.
    """

    cells: Array
    points: Points
    weights: Array


def gauss(count: int) -> tuple[Array, Array]:
    """Gauss–Legendre nodes and weights on (0, 1)."""
    x, w = np.polynomial.legendre.leggauss(count)
    return (x + 1) / 2, w / 2


def simplex_rule(dim: int, degree: int) -> tuple[Array, Array]:
    """Barycentric points (d+1, q) and weights (q,) of sum 1 of a rule exact to a degree, with q as small as is known.

    Triangles up to degree 19, tetrahedra up to 8. From degree 5 on the rules of scikit-fem 12 on tetrahedra are
    exact to one degree less than they are asked for (a test looks), and its rule of degree 4 has negative weights.
    """
    reference, weights = get_quadrature(RefTri, degree) if dim == 2 else get_quadrature(RefTet, degree + (degree > 3))
    return np.vstack([1 - reference.sum(axis=0), reference]), weights / weights.sum()


def duffy(along: int, across: int, grading: int = 1) -> tuple[Array, Array]:
    """Barycentric points (3, q) and weights (q,) of sum 1 of Duffy's rule on a triangle, graded to its first vertex.

    x = v_0 + ξ^g ((1−η)(v_1 − v_0) + η (v_2 − v_0)), dx = 2|T| g ξ^{2g−1} dξ dη, Gauss in ξ and η.

    Source: M. G. Duffy, Quadrature over a pyramid or cube of integrands with a singularity at a vertex,
    SIAM J. Numer. Anal. 19 (1982) 1260–1262.
    """
    (xi, wx), (eta, we) = gauss(along), gauss(across)
    far = xi[:, None] ** grading * np.ones_like(eta)
    points = np.array([1 - far, far * (1 - eta), far * eta])
    weights = np.multiply.outer(2 * grading * xi ** (2 * grading - 1) * wx, we)
    return points.reshape(3, -1), weights.ravel()


def placed(vertices: Points, simplices: Array, barycentric: Array) -> Points:
    """Points of simplices (k+1, n) with the same barycentric coordinates (k+1, q) in each, (d, n, q)."""
    return np.einsum("dvn,vq->dnq", vertices[:, simplices], barycentric)

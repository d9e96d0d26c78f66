"""Quadrature rules on (0, 1), on simplices in barycentric coordinates and on the facets of a part of the boundary."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np
from skfem import Mesh
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTet, RefTri

from manufactured.body import Part
from manufactured.tensors import Array, Points
from study.fem.mesh import MeshError, facet_measures

TOUCHING = 1e-9
"""Relative distance below which a vertex lies on a line."""
GRADING = 8
"""s = c + L ξ^8 turns (s − c)^{2(α−2)}, α > 3/2, into a power of ξ of 0 or more."""


@dataclass(frozen=True, eq=False)
class CellRule:
    """Quadrature on some cells (n,) with as many points (d, n, q) each; the weights (n, q) sum to |T| over q."""

    cells: Array
    points: Points
    weights: Array

    def parts(self, most: int) -> Iterator[CellRule]:
        """The same rule on no more than ``most`` cells each."""
        for here in (slice(first, first + most) for first in range(0, len(self.cells), most)):
            yield CellRule(self.cells[here], self.points[:, here], self.weights[here])


@dataclass(frozen=True, eq=False)
class FacetRule:
    """Quadrature on the facets (n,) of one part, with weights (n, q).

    Points are given by their local coordinates s along the part, (d−1, n, q), and by the values of the P1 functions of
    the facet's vertices, ``shapes``, (d, n, q).
    """

    facets: Array
    s: Array
    shapes: Array
    weights: Array


@lru_cache
def gauss(count: int) -> tuple[Array, Array]:
    """Gauss–Legendre nodes and weights on (0, 1)."""
    x, w = np.polynomial.legendre.leggauss(count)
    found = (x + 1) / 2, w / 2
    for part in found:
        part.setflags(write=False)
    return found


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


def facet_rule(mesh: Mesh, facets: Array, part: Part, rough: tuple[float, ...], points: int) -> FacetRule:
    """A rule on each facet, exact to the degree 2 points − 2 at least.

    In 2D Gauss's rule on both sides of the coordinates ``rough`` and graded to them.

    Raises:
        MeshError: rough coordinates are given in 3D.
    """
    if mesh.dim() == 2:
        return _segment_rule(mesh, facets, part, rough, points)
    if rough:
        raise MeshError(f"facets are cut in 2D only, got the rough coordinates {rough} on a face of a 3D body")
    barycentric, weights = duffy(points, points)
    s, _ = part.coordinates(placed(mesh.p, mesh.facets[:, facets], barycentric))
    shapes = np.repeat(barycentric[:, None], len(facets), axis=1)
    return FacetRule(facets, s, shapes, np.multiply.outer(facet_measures(mesh, facets), weights))


def _segment_rule(mesh: Mesh, facets: Array, part: Part, rough: tuple[float, ...], points: int) -> FacetRule:
    ends = np.stack([part.coordinates(mesh.p[:, v])[0][0] for v in mesh.facets[:, facets]])
    low, high = ends.min(axis=0), ends.max(axis=0)
    nodes = np.sort(np.vstack([low, high, *[np.clip(np.full_like(low, c), low, high) for c in rough]]), axis=0)
    xi, w = gauss(points)
    s, weights = [], []
    for left, right in pairwise(nodes):
        graded = [_close(end, rough, high - low)[:, None] for end in (left, right)]
        length = (right - left)[:, None]
        power = np.where(graded[0] | graded[1], GRADING, 1)
        local, jacobian = xi**power, power * xi ** (power - 1.0) * w
        local = np.where(graded[1] & ~graded[0], 1 - local, local)
        s.append(left[:, None] + length * local)
        weights.append(length * jacobian)
    place = np.concatenate(s, axis=1)
    first = (ends[1][:, None] - place) / (ends[1] - ends[0])[:, None]
    return FacetRule(facets, place[None], np.stack([first, 1 - first]), np.concatenate(weights, axis=1))


def _close(s: Array, rough: tuple[float, ...], length: Array) -> Array:
    """Which coordinates lie at a rough one, up to rounding."""
    return np.any([abs(s - c) <= TOUCHING * length for c in rough] or [np.zeros(s.shape, dtype=bool)], axis=0)

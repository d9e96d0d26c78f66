"""Quadrature on the cells of a mesh and on its contact facets, split where the solution is rough.

Cells crossed by a line along which the exact strain is singular or kinked for all times are cut
along it, and the rule is graded towards it; all others carry a standard rule.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from skfem import MeshTri
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTri

from manufactured.body import Part
from manufactured.tensors import Array, Points
from study.fem.mesh import MeshError, cell_volumes

GRADING = 8
"""s = c + L ξ^8 turns (s − c)^{2(α−2)}, α > 3/2, into a power of ξ of 0 or more."""


TOUCHING = 1e-9
"""Relative distance below which a vertex lies on a line."""


@dataclass(frozen=True)
class Line:
    """The line {x : direction·x = offset} (a plane in 3D) along which a strain is rough."""

    direction: tuple[float, ...]
    offset: float


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


def cell_rules(mesh: MeshTri, degree: int, lines: tuple[Line, ...], block: int = 4096) -> list[CellRule]:
    """Rules that cover every cell once, in blocks of cells that fit a cache.

    The degree is that of the rule on ordinary cells; split cells have enough points for the same
    accuracy away from the line.

    Raises:
        MeshError: two lines meet one cell.
    """
    crossed = np.zeros(mesh.t.shape[1], dtype=bool)
    rules = []
    for line in lines:
        distance = (np.array(line.direction) @ mesh.p - line.offset)[mesh.t]
        # Cells that touch the line with an edge or a vertex are singular there too.
        near = TOUCHING * (distance.max(axis=0) - distance.min(axis=0))
        meets = (distance.min(axis=0) <= near) & (distance.max(axis=0) >= -near)
        if (meets & crossed).any():
            raise MeshError("a cell meets two lines along which the solution is rough; take a finer level")
        here = np.flatnonzero(meets)
        crossed[here] = True
        if here.size:
            rules.append(_split(mesh, here, line, degree))
    regular = np.flatnonzero(~crossed)
    reference, weights = get_quadrature(RefTri, degree)
    barycentric = np.vstack([1 - reference.sum(axis=0), reference])
    volumes = cell_volumes(mesh)
    for start in range(0, regular.size, block):
        cells = regular[start : start + block]
        corners = mesh.p[:, mesh.t[:, cells]]
        points = np.einsum("dvn,vq->dnq", corners, barycentric)
        rules.append(CellRule(cells, points, volumes[cells, None] * weights / weights.sum()))
    return rules


def _split(mesh: MeshTri, cells: Array, line: Line, degree: int) -> CellRule:
    """Slabs between the sorted vertices and the line, Gauss along the line, graded Gauss towards it."""
    normal = np.array(line.direction)
    along = np.array([-normal[1], normal[0]])
    corners = mesh.p[:, mesh.t[:, cells]]
    s = np.einsum("d,dvn->vn", normal, corners) - line.offset
    r = np.einsum("d,dvn->vn", along, corners)
    order = np.argsort(s, axis=0)
    s, r = np.take_along_axis(s, order, 0), np.take_along_axis(r, order, 0)
    nodes = np.sort(np.vstack([s, np.clip(np.zeros_like(s[:1]), s[0], s[2])]), axis=0)

    def chord(x: Array, low: int, high: int) -> Array:
        """r on the edge from vertex low to vertex high at s = x, (n, q)."""
        length = s[high] - s[low]
        slope = np.divide(r[high] - r[low], length, out=np.zeros_like(length), where=length > 0)
        return r[low][:, None] + slope[:, None] * (x - s[low][:, None])

    xi, wx = _gauss(degree + GRADING)
    eta, we = _gauss(degree // 2 + 2)
    points, weights = [], []
    for left, right in pairwise(nodes):
        near_left = abs(left) <= abs(right)
        near, far = np.where(near_left, left, right)[:, None], np.where(near_left, right, left)[:, None]
        x = near + (far - near) * xi**GRADING
        jacobian = abs(far - near) * GRADING * xi ** (GRADING - 1) * wx
        long = chord(x, 0, 2)
        middle = (left + right)[:, None] / 2
        short = np.where(middle <= s[1][:, None], chord(x, 0, 1), chord(x, 1, 2))
        across = long[..., None] + (short - long)[..., None] * eta
        weights.append((jacobian * abs(short - long))[..., None] * we)
        points.append(normal[:, None, None, None] * (x + line.offset)[..., None] + along[:, None, None, None] * across)
    count = len(cells)
    return CellRule(
        cells,
        np.concatenate([p.reshape(2, count, -1) for p in points], axis=2),
        np.concatenate(
            [np.broadcast_to(w, p.shape[1:]).reshape(count, -1) for w, p in zip(weights, points, strict=True)], axis=1
        ),
    )


@dataclass(frozen=True, eq=False)
class FacetRule:
    """Quadrature on the facets of one part.

    Attributes:
        facets: indices (n,).
        s: local coordinates of the points along the part, (d−1, n, q).
        shapes: values of the P1 functions of the facet's vertices, (d, n, q).
        weights: (n, q).
    """

    facets: Array
    s: Array
    shapes: Array
    weights: Array


def facet_rule(mesh: MeshTri, facets: Array, part: Part, rough: tuple[float, ...], points: int) -> FacetRule:
    """Gauss's rule on each facet, on both sides of the coordinates ``rough`` and graded to them."""
    ends = np.stack([part.coordinates(mesh.p[:, v])[0][0] for v in mesh.facets[:, facets]])
    low, high = ends.min(axis=0), ends.max(axis=0)
    nodes = np.sort(np.vstack([low, high, *[np.clip(np.full_like(low, c), low, high) for c in rough]]), axis=0)
    xi, w = _gauss(points)
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


def _gauss(count: int) -> tuple[Array, Array]:
    """Gauss–Legendre nodes and weights on (0, 1)."""
    x, w = np.polynomial.legendre.leggauss(count)
    return (x + 1) / 2, w / 2

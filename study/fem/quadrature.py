"""Quadrature on the cells of a mesh and on its contact facets, adapted to where the solution is rough.

Cells crossed by a line along which the exact strain is singular or kinked for all times are cut along it, and the
rule is graded towards it; cells at a singular point carry Duffy's rule, graded towards the point; all others a
standard rule.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise

import numpy as np
from skfem import Mesh
from skfem.quadrature import get_quadrature
from skfem.refdom import RefTet, RefTri

from manufactured.body import Part
from manufactured.tensors import Array, Points
from study.fem.line import TOUCHING, Line
from study.fem.mesh import MeshError, barycentric_gradients, cell_volumes, facet_measures
from study.fem.sharing import shared

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


def cell_rules(
    mesh: Mesh,
    degree: int,
    lines: Sequence[Line],
    points: Sequence[tuple[float, ...]] = (),
    along: Sequence[Line] = (),
    *,
    block: int = 4096,
) -> list[CellRule]:
    """Rules that cover every cell once, in blocks of cells that fit a cache.

    The degree is that of the rule on ordinary cells; cells at a line or at a point have enough points
    for the same accuracy away from it.

    Args:
        mesh: the mesh.
        degree: up to 8 in 3D, 19 in 2D.
        lines: where the integrand is rough, in 2D.
        points: vertices of the mesh at which the integrand is singular, in 2D.
        along: at most two lines, not parallel, in 2D; points of ordinary cells get distances from them that many share.
        block: most ordinary cells in one rule.

    Raises:
        MeshError: from ``rough_cells``.
    """
    special = rough_cells(mesh, lines, points)
    made = [partial(_split, mesh, line=line, degree=degree) for line in lines]
    made += [partial(_fan, mesh, point=point, degree=degree) for point in points]
    rules = [rule(cells=cells) for cells, rule in zip(special, made, strict=True) if cells.size]
    ordinary = np.ones(mesh.t.shape[1], dtype=bool)
    ordinary[np.concatenate([*special, np.empty(0, dtype=int)])] = False
    return rules + _standard(mesh, np.flatnonzero(ordinary), degree, along, block)


def rough_cells(mesh: Mesh, lines: Sequence[Line], points: Sequence[tuple[float, ...]]) -> list[Array]:
    """The cells at each line and then at each point: those that need a rule of their own.

    Raises:
        MeshError: two lines or points meet one cell, a point is no vertex, or either is given in 3D.
    """
    names = [*map(str, lines), *(f"the point {tuple(point)}" for point in points)]
    if mesh.dim() != 2 and names:
        raise MeshError(
            f"cells are cut and graded in 2D only, this 3D solution is rough at {', '.join(names)}; take a contact "
            "face without `rough`, a material without `steps` and a solution without `singular`"
        )
    found = [_touching(mesh, line) for line in lines] + [_around(mesh, point) for point in points]
    owner = np.full(mesh.t.shape[1], -1)
    for i, cells in enumerate(found):
        taken = cells[owner[cells] >= 0]
        if taken.size:
            place = ", ".join(f"{x:.3g}" for x in mesh.p[:, mesh.t[:, taken[0]]].mean(axis=1))
            raise MeshError(
                f"the cell around ({place}) meets two lines or points at which the solution is rough, "
                f"{names[owner[taken[0]]]} and {names[i]}, and cells are cut for one only; take a finer level, or "
                "move them apart where they cross"
            )
        owner[cells] = i
    return found


def simplex_rule(dim: int, degree: int) -> tuple[Array, Array]:
    """Barycentric points (d+1, q) and weights (q,) of sum 1 of a rule exact to a degree, with q as small as is known.

    Triangles up to degree 19, tetrahedra up to 8. From degree 5 on the rules of scikit-fem 12 on tetrahedra are
    exact to one degree less than they are asked for (a test looks), and its rule of degree 4 has negative weights.
    """
    reference, weights = get_quadrature(RefTri, degree) if dim == 2 else get_quadrature(RefTet, degree + (degree > 3))
    return np.vstack([1 - reference.sum(axis=0), reference]), weights / weights.sum()


def _standard(mesh: Mesh, cells: Array, degree: int, along: Sequence[Line], block: int) -> list[CellRule]:
    """The standard rule on ordinary cells."""
    barycentric, weights = simplex_rule(mesh.dim(), degree)
    volumes = cell_volumes(mesh)[:, None]
    blocks = [cells[start : start + block] for start in range(0, cells.size, block)]
    if not along:
        return [CellRule(b, _place(mesh.p, mesh.t[:, b], barycentric), volumes[b] * weights) for b in blocks]
    gradients = barycentric_gradients(mesh)
    found = []
    for b in blocks:
        points, shares = shared(mesh.p[:, mesh.t[:, b]], gradients[b], barycentric, weights, along)
        found.append(CellRule(b, points, volumes[b] * shares))
    return found


def _place(vertices: Points, simplices: Array, barycentric: Array) -> Points:
    """Points of simplices (k+1, n) with the same barycentric coordinates (k+1, q) in each, (d, n, q)."""
    return np.einsum("dvn,vq->dnq", vertices[:, simplices], barycentric)


def _collapsed(along: int, across: int, grading: int = 1) -> tuple[Array, Array]:
    """Barycentric points (3, q) and weights (q,) of sum 1 of Duffy's rule on a triangle, graded to its first vertex.

    x = v_0 + ξ^g ((1−η)(v_1 − v_0) + η (v_2 − v_0)), dx = 2|T| g ξ^{2g−1} dξ dη, Gauss in ξ and η.

    Source: M. G. Duffy, Quadrature over a pyramid or cube of integrands with a singularity at a vertex,
    SIAM J. Numer. Anal. 19 (1982) 1260–1262.
    """
    (xi, wx), (eta, we) = _gauss(along), _gauss(across)
    far = xi[:, None] ** grading * np.ones_like(eta)
    points = np.array([1 - far, far * (1 - eta), far * eta])
    weights = np.multiply.outer(2 * grading * xi ** (2 * grading - 1) * wx, we)
    return points.reshape(3, -1), weights.ravel()


def _around(mesh: Mesh, point: tuple[float, ...]) -> Array:
    """Cells with a singular point as a vertex."""
    apart = np.linalg.norm(mesh.p - np.array(point)[:, None], axis=0)
    vertex = int(apart.argmin())
    here = np.flatnonzero((mesh.t == vertex).any(axis=0))
    if apart[vertex] > TOUCHING * np.sqrt(cell_volumes(mesh).sum()):
        raise MeshError(
            f"the solution is singular at {tuple(point)}, which is not a vertex of the mesh (the nearest is "
            f"{apart[vertex]:.3g} away); list it as a vertex of the body"
        )
    return here


def _fan(mesh: Mesh, cells: Array, point: tuple[float, ...], degree: int) -> CellRule:
    """Duffy's rule on cells with a vertex at a point, exact to the degree; r^{-1} is smooth along the rays."""
    simplices = mesh.t[:, cells]
    vertex = np.linalg.norm(mesh.p[:, simplices] - np.array(point)[:, None, None], axis=0).argmin(axis=0)
    simplices = np.take_along_axis(simplices, (vertex + np.arange(3)[:, None]) % 3, axis=0)
    barycentric, weights = _collapsed(GRADING * (degree + 2) // 2, degree + 8, GRADING)
    return CellRule(cells, _place(mesh.p, simplices, barycentric), cell_volumes(mesh)[cells, None] * weights)


def _touching(mesh: Mesh, line: Line) -> Array:
    """Cells that a line crosses or touches: at an edge or a vertex they are singular, too."""
    distance = (np.array(line.direction) @ mesh.p - line.offset)[mesh.t]
    near = TOUCHING * (distance.max(axis=0) - distance.min(axis=0))
    return np.flatnonzero((distance.min(axis=0) <= near) & (distance.max(axis=0) >= -near))


def _split(mesh: Mesh, cells: Array, line: Line, degree: int) -> CellRule:
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
    barycentric, weights = _collapsed(points, points)
    s, _ = part.coordinates(_place(mesh.p, mesh.facets[:, facets], barycentric))
    return FacetRule(
        facets,
        s,
        np.repeat(barycentric[:, None], len(facets), axis=1),
        np.multiply.outer(facet_measures(mesh, facets), weights),
    )


def _segment_rule(mesh: Mesh, facets: Array, part: Part, rough: tuple[float, ...], points: int) -> FacetRule:
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

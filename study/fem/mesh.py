"""Families of triangulations of a polygonal body, and the check that they fit its boundary parts.

A family turns a body and a level n into a mesh with about n cells along a side. None of them knows
where a contact zone begins or ends; every point where the boundary condition changes must be a
vertex (source, before (5.23)), otherwise the mesh is refused.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from scipy.spatial import Delaunay
from skfem import MeshTri

from manufactured.body import Body, Part
from manufactured.tensors import Array


class MeshError(ValueError):
    """A mesh does not fit the body."""


class MeshFamily(Protocol):
    """A regular family {T_h} of triangulations.

    ``serves`` says whether it can mesh a body.
    """

    @property
    def name(self) -> str: ...

    def serves(self, body: Body) -> bool: ...

    def __call__(self, body: Body, n: int) -> MeshTri: ...


@dataclass(frozen=True)
class OneDiagonal:
    """n × n quadrilaterals, each cut by the same diagonal."""

    name: str = "one-diagonal"

    def serves(self, body: Body) -> bool:
        return _is_quadrilateral(body)

    def __call__(self, body: Body, n: int) -> MeshTri:
        points = _map(body, _square(n))
        a, b, c, d = _quadrilaterals(n)
        return _mesh(points, np.hstack([[a, b, c], [a, c, d]]))


@dataclass(frozen=True)
class CrissCross:
    """n × n quadrilaterals, each cut by both diagonals."""

    name: str = "criss-cross"

    def serves(self, body: Body) -> bool:
        return _is_quadrilateral(body)

    def __call__(self, body: Body, n: int) -> MeshTri:
        points = _map(body, _square(n))
        a, b, c, d = _quadrilaterals(n)
        centres = (points[:, a] + points[:, b] + points[:, c] + points[:, d]) / 4
        m = points.shape[1] + np.arange(n * n)
        return _mesh(np.hstack([points, centres]), np.hstack([[a, b, m], [b, c, m], [c, d, m], [d, a, m]]))


@dataclass(frozen=True)
class Shaken:
    """One-diagonal meshes with every vertex moved by up to ``amplitude`` cells in each direction.

    Vertices on the boundary slide along it; ends of parts stay. Levels are independent of each other,
    so the meshes are neither nested nor symmetric.
    """

    seed: int = 2002
    amplitude: float = 0.2
    name: str = "shaken"

    def serves(self, body: Body) -> bool:
        return _is_quadrilateral(body)

    def __call__(self, body: Body, n: int) -> MeshTri:
        # Shaken before it is mapped, so that stretched bodies are shaken by cells, too.
        plain = _square(n)
        shift = np.random.default_rng([self.seed, n]).uniform(-1, 1, plain.shape) * self.amplitude / n
        shift[(plain == 0) | (plain == 1)] = 0
        points = _map(body, plain + shift)
        ends = np.linalg.norm(_map(body, plain)[:, :, None] - body.vertices[:, None, :], axis=0).argmin(axis=0)
        points[:, ends] = _map(body, plain)[:, ends]
        a, b, c, d = _quadrilaterals(n)
        return _mesh(points, np.hstack([[a, b, c], [a, c, d]]))


@dataclass(frozen=True)
class Unstructured:
    """Delaunay triangulations of points spread evenly at random, for any polygon.

    Points start on a jittered triangular lattice and are moved to the area-weighted mean of the
    centroids of the cells around them, ``sweeps`` times (Lloyd's iteration in the form of Du,
    Faber, Gunzburger, SIAM Review 41 (1999) 637–676, with centroids of the star).
    """

    seed: int = 2002
    sweeps: int = 8
    name: str = "unstructured"

    def serves(self, body: Body) -> bool:
        return True

    def __call__(self, body: Body, n: int) -> MeshTri:
        spacing = 1.15 * np.sqrt(body.measure) / n
        fixed = np.hstack([_divide(part, spacing) for part in body.parts])
        free = self._lattice(body, spacing, np.random.default_rng([self.seed, n]))
        points = np.hstack([fixed, free])
        for _ in range(self.sweeps):
            cells = _delaunay(body, points)
            points = np.hstack([fixed, _star_centroids(points, cells)[:, fixed.shape[1] :]])
        return _mesh(points, _delaunay(body, points))

    def _lattice(self, body: Body, spacing: float, rng: np.random.Generator) -> Array:
        low, high = body.vertices.min(axis=1), body.vertices.max(axis=1)
        rows = np.arange(low[1], high[1], spacing * np.sqrt(0.75))
        columns = np.arange(low[0] - spacing, high[0] + spacing, spacing)
        x, y = np.meshgrid(columns, rows)
        x[1::2] += spacing / 2
        points = np.vstack([x.ravel(), y.ravel()])
        points += rng.uniform(-0.3, 0.3, points.shape) * spacing
        keep = body.contains(points)
        for part in body.parts:
            s, depth = part.coordinates(points)
            near = (s[0] > -spacing) & (s[0] < part.measure + spacing) & (abs(depth) < 0.55 * spacing)
            keep &= ~near
        return points[:, keep]


FAMILIES: tuple[MeshFamily, ...] = (OneDiagonal(), CrissCross(), Shaken(), Unstructured())


def _is_quadrilateral(body: Body) -> bool:
    """Four corners, all convex: the bilinear map of the square is then one-to-one."""
    corners = body.corners
    if corners.shape[1] != 4:
        return False
    sides = np.roll(corners, -1, axis=1) - corners
    following = np.roll(sides, -1, axis=1)
    return bool((sides[0] * following[1] - sides[1] * following[0] > 0).all())


def _square(n: int) -> Array:
    """Vertices of the n × n grid on the unit square, row by row, (2, (n+1)²)."""
    x, y = (v.ravel() for v in np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, n + 1)))
    return np.array([x, y])


def _map(body: Body, reference: Array) -> Array:
    """The bilinear map of the unit square onto a quadrilateral body, (2, ...) → (2, ...)."""
    if not _is_quadrilateral(body):
        raise MeshError(
            f"a structured mesh needs a convex quadrilateral, this body has {body.corners.shape[1]} corners; "
            "use the unstructured family"
        )
    x, y = reference
    return body.corners @ np.array([(1 - x) * (1 - y), x * (1 - y), x * y, (1 - x) * y])


def _quadrilaterals(n: int) -> tuple[Array, Array, Array, Array]:
    """Counter-clockwise corners of the n² cells of the grid."""
    i, j = (v.ravel() for v in np.meshgrid(np.arange(n), np.arange(n)))
    a = j * (n + 1) + i
    return a, a + 1, a + n + 2, a + n + 1


def _divide(part: Part, spacing: float) -> Array:
    """Evenly spaced points of a part from its start, without its end."""
    count = max(1, round(part.measure / spacing))
    return part.point((np.arange(count) * part.measure / count)[None])


def _delaunay(body: Body, points: Array) -> Array:
    """Cells of the Delaunay triangulation that lie in Ω, (3, cells)."""
    cells = Delaunay(points.T).simplices.T
    a, b, c = (points[:, v] for v in cells)
    area = ((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]) / 2
    # Rounding may leave slivers between points of one straight part; they are not cells of Ω.
    keep = (abs(area) > 1e-6 * abs(area).mean()) & body.contains((a + b + c) / 3)
    return cells[:, keep]


def _star_centroids(points: Array, cells: Array) -> Array:
    """Area-weighted mean of the centroids of the cells around each point, (2, points)."""
    a, b, c = (points[:, v] for v in cells)
    area = abs((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0])
    weight = np.bincount(cells.ravel(), np.tile(area, 3), points.shape[1])
    centroid = (a + b + c) / 3
    moments = [np.bincount(cells.ravel(), np.tile(area * x, 3), points.shape[1]) for x in centroid]
    return np.array(moments) / np.maximum(weight, np.finfo(float).tiny)


def boundary_parts(mesh: MeshTri, body: Body) -> list[Array]:
    """The facets of the mesh on each part of the body, in the order of ``body.parts``.

    Raises:
        MeshError: an end of a part is not a vertex, or the facets do not cover the part exactly.
    """
    tolerance = 1e-8 * np.sqrt(body.measure)
    total = cell_volumes(mesh).sum()
    if abs(total - body.measure) > tolerance * np.sqrt(body.measure):
        raise MeshError(
            f"the cells cover {total:.9g}, the body has the area {body.measure:.9g}: cells overlap or are missing"
        )
    facets = mesh.boundary_facets()
    ends = mesh.facets[:, facets]
    for part in body.parts:
        distance = np.linalg.norm(mesh.p[:, np.unique(ends)] - part.start[:, None], axis=0).min()
        if distance > tolerance:
            raise MeshError(
                f"the boundary condition changes at {part.start.tolist()}, which is not a vertex of the mesh "
                f"(the nearest is {distance:.3g} away); take a level at which it is, or the unstructured family"
            )
    found = []
    for part in body.parts:
        on = part.contains(mesh.p, tolerance)
        mine = facets[on[ends].all(axis=0)]
        covered = np.linalg.norm(mesh.p[:, mesh.facets[0, mine]] - mesh.p[:, mesh.facets[1, mine]], axis=0).sum()
        if abs(covered - part.measure) > tolerance:
            raise MeshError(
                f"facets of total length {covered:.9g} lie on the part {part.kind.value} from {part.start.tolist()} "
                f"to {part.end.tolist()}, whose length is {part.measure:.9g}: the mesh is not one of this body"
            )
        found.append(mine)
    if sum(map(len, found)) != len(facets):
        raise MeshError(f"{len(facets) - sum(map(len, found))} boundary facets lie on no part of the body")
    return found


def size(mesh: MeshTri) -> float:
    """h = (d! |Ω| / number of cells)^{1/d}, which is 1/n on one-diagonal meshes of the unit square.

    In a quasi-uniform family it is equivalent to the largest diameter, whose random part on shaken
    meshes would otherwise bend every observed order.
    """
    return float((2 * cell_volumes(mesh).sum() / mesh.t.shape[1]) ** 0.5)


def cell_volumes(mesh: MeshTri) -> Array:
    """|T| of every cell, (cells,)."""
    a, b, c = (mesh.p[:, v] for v in mesh.t)
    return abs((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]) / 2


def _mesh(points: Array, cells: Array) -> MeshTri:
    return MeshTri(np.ascontiguousarray(points), np.ascontiguousarray(cells))

"""Structured meshes: the grid of n^d cubes on the unit cube, cut into simplices and mapped onto the body.

The map onto a convex quadrilateral or a parallelepiped is linear in every coordinate.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from itertools import permutations

import numpy as np
from skfem import Mesh

from manufactured.body import Body, Part
from manufactured.tensors import Array, Points
from study.fem.mesh.geometry import nearest, on_segment, simplicial_mesh
from study.fem.mesh.meshed_body import MeshError, require_plane


@dataclass(frozen=True)
class OneDiagonal:
    """n^d parallelepipeds, each cut into d! simplices along the same diagonal (``kuhn``)."""

    name: str = "one-diagonal"

    def serves(self, body: Body) -> bool:
        return has_grids(body)

    def __call__(self, body: Body, n: int) -> Mesh:
        return simplicial_mesh(mapped(body, grid_vertices(n, body.dim)), kuhn(n, body.dim))


@dataclass(frozen=True)
class CrissCross:
    """n × n quadrilaterals, each cut by both diagonals."""

    name: str = "criss-cross"

    def serves(self, body: Body) -> bool:
        return body.dim == 2 and has_grids(body)

    def __call__(self, body: Body, n: int) -> Mesh:
        require_plane(self, body)
        points, a = mapped(body, grid_vertices(n, 2)), lowest_corners(n, 2)
        b, c, d = a + 1, a + n + 2, a + n + 1
        centres = (points[:, a] + points[:, b] + points[:, c] + points[:, d]) / 4
        m = points.shape[1] + np.arange(n * n)
        return simplicial_mesh(np.hstack([points, centres]), np.hstack([[a, b, m], [b, c, m], [c, d, m], [d, a, m]]))


@dataclass(frozen=True)
class Alternating:
    """n × n quadrilaterals, each cut by one diagonal, neighbours by different ones: vertices are of two kinds."""

    name: str = "alternating"

    def serves(self, body: Body) -> bool:
        return body.dim == 2 and has_grids(body)

    def __call__(self, body: Body, n: int) -> Mesh:
        require_plane(self, body)
        a = lowest_corners(n, 2)
        b, c, d = a + 1, a + n + 2, a + n + 1
        odd = np.indices((n, n)).sum(axis=0).ravel() % 2 == 1
        rising = np.hstack([[a, b, c], [a, c, d]])
        falling = np.hstack([[a, b, d], [b, c, d]])
        return simplicial_mesh(mapped(body, grid_vertices(n, 2)), np.where(np.tile(odd, 2), falling, rising))


@dataclass(frozen=True)
class Shaken:
    """One-diagonal meshes with every vertex moved by up to 2/d ``amplitude`` cells in each direction.

    Vertices slide in the faces, on the edges between parts and on the interfaces they lie on; corners of parts stay.
    Levels are independent of each other, so the meshes are neither nested nor symmetric. A simplex of the grid on the
    unit cube keeps 1 − 4 ``amplitude`` of its volume at least, in every dimension.
    """

    seed: int = 2002
    amplitude: float = 0.2
    name: str = "shaken"

    def serves(self, body: Body) -> bool:
        return has_grids(body)

    def __call__(self, body: Body, n: int) -> Mesh:
        # The grid is shaken before it is mapped, so that vertices of stretched bodies move in proportion to the cells.
        plain = grid_vertices(n, body.dim)
        amplitude = self.amplitude * 2 / body.dim
        shift = np.random.default_rng([self.seed, n]).uniform(-1, 1, plain.shape) * amplitude / n
        shift[(plain == 0) | (plain == 1)] = 0
        resting = mapped(body, plain)
        ends = [*body.vertices.T]
        for line in _kept_lines(body):
            ends += [*line.T]
            on = np.flatnonzero(on_segment(resting, line))
            if on.size > 1:
                along = plain[:, on[-1]] - plain[:, on[0]]
                along /= np.linalg.norm(along)
                shift[:, on] = np.multiply.outer(along, along @ shift[:, on])
        points = mapped(body, plain + shift)
        fixed = [np.linalg.norm(resting - end[:, None], axis=0).argmin() for end in ends]
        points[:, fixed] = resting[:, fixed]
        return simplicial_mesh(points, kuhn(n, body.dim))


def _kept_lines(body: Body) -> Iterator[Array]:
    """Segments (d, 2) that meshes have to keep: edges of parts in 3D, interfaces in 2D."""
    if body.dim == 3:
        for part in body.parts:
            yield from (part.corners[:, [i - 1, i]] for i in range(part.corners.shape[1]))
    yield from (interface.corners for interface in body.interfaces)


def grid_vertices(n: int, dim: int) -> Points:
    """Vertices of the grid, the first axis fastest, (d, (n+1)^d)."""
    return np.array([x.ravel("F") for x in np.meshgrid(*[np.linspace(0, 1, n + 1)] * dim, indexing="ij")])


def lowest_corners(n: int, dim: int) -> Array:
    """The numbers of the vertices at the lowest corners of the cubes, the first axis fastest, (n^d,)."""
    steps = (n + 1) ** np.arange(dim)
    return sum(step * i.ravel("F") for step, i in zip(steps, np.indices((n,) * dim), strict=True))


def kuhn(n: int, dim: int) -> Array:
    """Positively oriented simplices of the grid, (d+1, d! n^d): paths from corner to corner along the axes.

    Source: H. W. Kuhn, Some combinatorial lemmas in topology, IBM J. Res. Dev. 4 (1960) 518–524.
    """
    first, steps = lowest_corners(n, dim), (n + 1) ** np.arange(dim)
    cells = []
    for order in permutations(range(dim)):
        path = np.concatenate([[0], np.cumsum(steps[list(order)])])
        if np.linalg.det(np.eye(dim)[list(order)]) < 0:
            path[[-2, -1]] = path[[-1, -2]]
        cells.append(first + path[:, None])
    return np.hstack(cells)


@lru_cache
def has_grids(body: Body) -> bool:
    """Whether the grid can be mapped onto the body so that its lines follow the interfaces."""
    images = _images(body)
    return images is not None and all(_is_grid_line(images, interface) for interface in body.interfaces)


def mapped(body: Body, reference: Points) -> Points:
    """Images of points of the unit cube, (d, ...) → (d, ...); MeshError if the body is of neither kind."""
    images = _images(body)
    if images is None:
        wanted = "convex quadrilateral" if body.dim == 2 else "parallelepiped"
        mend = "use the unstructured family" if body.dim == 2 else "no family meshes other polyhedra"
        raise MeshError(f"a structured mesh needs a {wanted}, this body has {body.corners.shape[1]} corners; {mend}")
    shapes = np.ones((1, *reference.shape[1:]))
    for x in reference:
        shapes = np.concatenate([shapes * (1 - x), shapes * x])
    return images @ shapes


def _images(body: Body) -> Points | None:
    """Images (d, 2^d) of the corners of the unit cube, the first axis fastest; None if there is no such map."""
    corners = body.corners
    if corners.shape[1] != 2**body.dim:
        return None
    if body.dim == 3:
        return _parallelepiped(body)
    sides = np.roll(corners, -1, axis=1) - corners
    following = np.roll(sides, -1, axis=1)
    convex = (sides[0] * following[1] - sides[1] * following[0] > 0).all()
    return corners[:, [0, 1, 3, 2]] if convex else None


def _parallelepiped(body: Body) -> Points | None:
    corners, tolerance = body.corners, 1e-9 * float(np.ptp(body.vertices, axis=1).max())
    first = corners[:, :1]
    normals = np.array([part.normal for part in body.parts if part.contains(first, tolerance)])
    normals = normals[np.sort(np.unique(np.round(normals, 9) + 0.0, axis=0, return_index=True)[1])]
    if len(normals) != 3:
        return None
    # An edge runs from the first corner to the only other one in the planes of two faces.
    off = abs(normals @ (corners - first)) > tolerance
    ends = [np.flatnonzero(~np.delete(off, k, axis=0).any(axis=0))[1:] for k in range(3)]
    if any(end.size != 1 for end in ends):
        return None
    edges = (corners - first)[:, [int(end[0]) for end in ends]]
    if np.linalg.det(edges) < 0:
        edges = edges[:, [1, 0, 2]]
    images = first + edges @ grid_vertices(1, 3)
    apart = np.linalg.norm(images[:, :, None] - corners[:, None, :], axis=0)
    volume = np.linalg.det(images[:, [1, 2, 4]] - images[:, :1])
    fills = apart.min(axis=1).max() <= tolerance and abs(volume - body.measure) <= 1e-9 * volume
    return images if fills else None


def _is_grid_line(images: Points, interface: Part) -> bool:
    """Whether an interface joins two opposite sides of a quadrilateral, dividing both in the same ratio."""
    for sides in ((images[:, :2], images[:, 2:]), (images[:, ::2], images[:, 1::2])):
        for ends in (interface.corners, interface.corners[:, ::-1]):
            pairs = [(ends[:, [i]], side) for i, side in enumerate(sides)]
            low, high = (nearest(end, side) for end, side in pairs)
            if abs(low - high) < 1e-9 and all(on_segment(end, side) for end, side in pairs):
                return True
    return False

"""Meshes of triangles or tetrahedra: geometry, mesh families, and the check that a mesh fits a body.

A mesh family makes a mesh of a body for a level n, with about n cells along a side. The mesh does not depend on the
position of the contact zone. Every point at which the boundary condition changes must be a vertex (paper, before
(5.23)), and every interface between materials must be a union of facets. Other meshes are refused.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise, permutations
from math import factorial
from typing import ClassVar

import numpy as np
import scipy.sparse as sps
from scipy.spatial import Delaunay
from scipy.spatial.distance import cdist
from skfem import Mesh, MeshTet, MeshTri
from skfem.mapping import MappingAffine

from manufactured.body import Body, Kind, Part
from manufactured.tensors import Array, Points

FIT_TOLERANCE = 1e-8
"""Relative tolerance of the check that a mesh fits a body: for distances to a boundary part, for areas and for lengths.

Distances are relative to |Ω|^{1/d}.
"""


class MeshError(ValueError):
    """Raised if a mesh does not fit the body, or cannot be made for it."""


class MeshFamily(ABC):
    """Base class of mesh families: objects that make a mesh of a body for every level.

    Mesh families are the regular families {T_h} of triangulations of the paper. A call with a body and a level n
    returns the mesh of this level, which has about n cells along a side. Everything that the study knows about a family
    is an attribute of its class.

    Attributes:
        meshes: a description of the meshes in a few words, for the documentation.
        least_angle: a lower bound in degrees for the angles of all cells, on all plane bodies of the catalogue. Some of
            these are sheared, so that it is less than on a square.
        density: the number of cells of a plane mesh, divided by the number of cells of the one-diagonal mesh of the
            same level. Estimates of time and memory use it.
        uniform: whether all cells of a mesh have about the same size.
        irregular: whether the cells of one level are not scaled copies of the cells of another level. The observed
            order of an error e is then the slope of log e against log l instead of log h, where l is the leading term
            of the interpolation error.
        random: whether vertices are moved at random, such that single orders depend on chance.
        superclose: whether ‖Π^h u − u^h‖ has a higher order than ‖u − u^h‖, because neighbouring triangles form
            parallelograms.
    """

    meshes: ClassVar[str]
    least_angle: ClassVar[float]
    density: ClassVar[int] = 1
    uniform: ClassVar[bool] = True
    irregular: ClassVar[bool] = False
    random: ClassVar[bool] = False
    superclose: ClassVar[bool] = False

    @property
    @abstractmethod
    def name(self) -> str:
        """The name of the family in commands and tables."""

    @abstractmethod
    def serves(self, body: Body) -> bool:
        """Return whether the family can mesh the body."""

    @abstractmethod
    def __call__(self, body: Body, n: int) -> Mesh:
        """Return the mesh of level n; raise MeshError if the family cannot mesh the body at this level."""


def require_plane(family: MeshFamily, body: Body) -> None:
    """Raise MeshError unless the body is two-dimensional.

    Args:
        family: the mesh family, whose name is in the message.
        body: the body.
    """
    if body.dim != 2:
        raise MeshError(
            f"the mesh family {family.name} is for 2D bodies, got a body of dimension {body.dim}; use one-diagonal"
        )


def simplicial_mesh(points: Points, cells: Array) -> Mesh:
    """Return the mesh with given vertices (d, n) and cells, which are given by vertex numbers, (d+1, cells)."""
    kind = MeshTri if len(points) == 2 else MeshTet
    return kind(np.ascontiguousarray(points), np.ascontiguousarray(cells))


# ``mesh.mapping()`` is not used, because scikit-fem would store its result in the mesh. The mesh and the mapping would
# then refer to each other, and Python would free their memory late.


def size(mesh: Mesh) -> float:
    """Return the mesh size h = (d! |Ω| / number of cells)^{1/d}, which is 1/n on one-diagonal meshes of the unit cube.

    In a quasi-uniform family this is the largest diameter up to a constant factor. The largest diameter itself is not
    used, because it varies at random on shaken meshes, which would disturb the observed orders.
    """
    d = mesh.dim()
    mean = cell_volumes(mesh).mean()
    return float((factorial(d) * mean) ** (1 / d))


def cell_volumes(mesh: Mesh) -> Array:
    """Return the volume |T| of every cell, (cells,)."""
    # The mapping also computes inverse Jacobians, which do not exist for cells of volume 0; NumPy would warn.
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(abs(MappingAffine(mesh).detA) / factorial(mesh.dim()))


def facet_measures(mesh: Mesh, facets: Array | slice) -> Array:
    """Return the lengths (2D) or areas (3D) of facets, given by their numbers, (n,) → (n,)."""
    return np.asarray(MappingAffine(mesh).detB[facets] / factorial(mesh.dim() - 1))


def barycentric_gradients(mesh: Mesh) -> Array:
    """Return the gradients of the P1 basis functions (barycentric coordinates λ_i) on every cell, (cells, d+1, d)."""
    inner = MappingAffine(mesh).invA
    gradients = np.concatenate([-inner.sum(axis=0, keepdims=True), inner])
    return np.ascontiguousarray(np.moveaxis(gradients, 2, 0))


def affine_maps(points: Points, cells: Array) -> Array:
    """Return the matrices F of the affine maps x = F x̂ + b from the reference simplex to cells, (cells, d, d).

    Args:
        points: the vertices, (d, n).
        cells: the numbers of the vertices of the cells, (d+1, cells).
    """
    corners = points[:, cells]
    return np.moveaxis(corners[:, 1:] - corners[:, :1], 2, 0)


def barycentric(vertices: Points, simplices: Array, points: Points) -> Array:
    """Return barycentric coordinates of q points in each of n simplices, (d+1, n, q).

    Args:
        vertices: vertices of a mesh, (d, vertices).
        simplices: vertex numbers of the simplices, (d+1, n).
        points: the points, (d, n, q).
    """
    inverse = np.linalg.inv(affine_maps(vertices, simplices))
    away = points - vertices[:, simplices[0], None]
    inner = np.einsum("nij,jnq->inq", inverse, away)
    return np.concatenate([1 - inner.sum(axis=0, keepdims=True), inner])


def determinants(points: Points, cells: Array) -> Array:
    """Return d! times the signed volumes of cells: vertices (d, n), vertex numbers (d+1, cells) → (cells,)."""
    return np.linalg.det(affine_maps(points, cells))


def with_midpoints(mesh: Mesh) -> sps.csr_array:
    """Return the matrix that interpolates vertex values of a P1 function to the vertices of ``mesh.refined()``.

    The v + e vertices of the uniformly refined mesh are the v old vertices, then the midpoints of the e edges. The
    matrix has the shape (v + e, v).
    """
    edges = mesh.facets if mesh.dim() == 2 else mesh.edges
    count = mesh.p.shape[1]
    halves = np.full(edges.size, 0.5)
    starts = np.arange(0, edges.size + 1, 2)
    midpoints = sps.csr_array((halves, edges.T.ravel(), starts), shape=(edges.shape[1], count))
    return sps.csr_array(sps.vstack([sps.eye_array(count), midpoints]))


def nearest(points: Points, segment: Array) -> Array:
    """Return the points of a segment that are nearest to given points, as parameters from 0 (start) to 1 (end), (n,).

    Args:
        points: the given points, (d, n).
        segment: the two ends of the segment as columns, (d, 2).
    """
    along = segment[:, 1] - segment[:, 0]
    return np.clip(along @ (points - segment[:, :1]) / (along @ along), 0, 1)


def distance(points: Points, segment: Array) -> Array:
    """Return the distance of each of n points, (d, n), from a segment with the two ends (d, 2); the result is (n,)."""
    foot = segment[:, :1] + np.multiply.outer(segment[:, 1] - segment[:, 0], nearest(points, segment))
    return np.linalg.norm(points - foot, axis=0)


def on_segment(points: Points, segment: Array) -> Array:
    """Return for each of n points, (d, n), whether it lies on a segment up to round-off; the result is (n,).

    Args:
        points: the points, (d, n).
        segment: the two ends of the segment as columns, (d, 2).
    """
    return distance(points, segment) <= 1e-9 * np.linalg.norm(segment[:, 1] - segment[:, 0])


# Structured meshes: the unit cube is divided into a grid of n^d cubes and these into simplices. The mesh is then mapped
# onto the body by a map that is linear in every coordinate.


class Structured(MeshFamily):
    """Base class of the families of structured meshes, in which cubes are divided into simplices.

    At level n in dimension d, the unit cube is divided into n^d cubes, and each of them into ``density`` · d!
    simplices. The grid is then mapped to the body.

    Attributes:
        plane: whether the family meshes 2D bodies only.
    """

    plane: ClassVar[bool] = False

    def serves(self, body: Body) -> bool:
        return has_grids(body) and (body.dim == 2 or not self.plane)


@dataclass(frozen=True)
class OneDiagonal(Structured):
    """Structured meshes of n^d parallelepipeds, each divided into d! simplices that share one diagonal."""

    name: str = "one-diagonal"
    meshes = "squares cut by parallel diagonals, or cubes cut into six tetrahedra that share a diagonal"
    least_angle = 26
    superclose = True

    def __call__(self, body: Body, n: int) -> Mesh:
        return simplicial_mesh(mapped(body, grid_vertices(n, body.dim)), kuhn(n, body.dim))


@dataclass(frozen=True)
class CrissCross(Structured):
    """Structured meshes of n × n quadrilaterals, each divided by both diagonals."""

    name: str = "criss-cross"
    meshes = "squares cut by both diagonals"
    least_angle = 26
    density = 2
    plane = True

    def __call__(self, body: Body, n: int) -> Mesh:
        require_plane(self, body)
        points = mapped(body, grid_vertices(n, 2))
        corners = squares(n)
        centres = points[:, corners].mean(axis=1)
        middle = points.shape[1] + np.arange(n * n)
        sides = zip(corners, np.roll(corners, -1, axis=0), strict=True)
        cells = [[start, end, middle] for start, end in sides]
        return simplicial_mesh(np.hstack([points, centres]), np.hstack(cells))


@dataclass(frozen=True)
class Alternating(Structured):
    """Structured meshes of n × n quadrilaterals, each divided by one diagonal.

    The direction of the diagonal alternates, so every inner vertex belongs to four or to eight cells.
    """

    name: str = "alternating"
    meshes = "squares cut by one diagonal, whose direction alternates"
    least_angle = 26
    plane = True

    def __call__(self, body: Body, n: int) -> Mesh:
        require_plane(self, body)
        a, b, c, d = squares(n)
        odd = np.indices((n, n)).sum(axis=0).ravel() % 2 == 1
        rising = np.hstack([[a, b, c], [a, c, d]])
        falling = np.hstack([[a, b, d], [b, c, d]])
        cells = np.where(np.tile(odd, 2), falling, rising)
        return simplicial_mesh(mapped(body, grid_vertices(n, 2)), cells)


@dataclass(frozen=True)
class Shaken(Structured):
    """One-diagonal meshes whose vertices are moved at random.

    Every coordinate of a vertex changes by up to 2/d · ``amplitude`` times the width of a cube of the grid, in
    dimension d; ``seed`` is the seed of the random numbers. Vertices on faces of the body, on edges between boundary
    parts and on interfaces stay on them; corners of parts do not move. The random numbers of two levels are
    independent, so the meshes of different levels are not nested. Before the grid is mapped from the unit cube to the
    body, every simplex keeps at least the fraction 1 − 4 · ``amplitude`` of its volume, in every dimension.
    """

    seed: int = 2002
    amplitude: float = 0.2
    name: str = "shaken"
    meshes = "one-diagonal meshes with vertices moved at random"
    least_angle = 12
    irregular = random = True

    def __call__(self, body: Body, n: int) -> Mesh:
        # The grid on the unit cube is shaken, not its image, so that vertices of stretched cells move in proportion.
        plain = grid_vertices(n, body.dim)
        amplitude = self.amplitude * 2 / body.dim
        rng = np.random.default_rng([self.seed, n])
        shift = rng.uniform(-1, 1, plain.shape) * amplitude / n
        shift[(plain == 0) | (plain == 1)] = 0
        resting = mapped(body, plain)
        # Sides of boundary parts and interfaces must remain unions of facets, so vertices on them slide along them.
        lines = [interface.corners for interface in body.interfaces]
        for part in body.parts:
            following = np.roll(part.corners, -1, axis=1)
            lines += [np.transpose(ends) for ends in zip(part.corners.T, following.T, strict=True)]
        for line in lines:
            on = np.flatnonzero(on_segment(resting, line))
            if on.size > 1:
                along = plain[:, on[-1]] - plain[:, on[0]]
                along /= np.linalg.norm(along)
                shift[:, on] = np.outer(along, along @ shift[:, on])
        points = mapped(body, plain + shift)
        ends = np.hstack([body.vertices, *lines])
        fixed = cdist(ends.T, resting.T).argmin(axis=1)
        points[:, fixed] = resting[:, fixed]
        return simplicial_mesh(points, kuhn(n, body.dim))


def grid_vertices(n: int, dim: int) -> Points:
    """Return the vertices of a grid of n^d cubes on the unit cube, (d, (n+1)^d); x1 varies fastest."""
    ticks = np.linspace(0, 1, n + 1)
    coordinates = np.meshgrid(*[ticks] * dim, indexing="ij")
    return np.array([x.ravel("F") for x in coordinates])


def lowest_corners(n: int, dim: int) -> Array:
    """Return for every cube of the grid the number of its vertex with the smallest coordinates, (n^d,).

    The vertices are numbered as ``grid_vertices`` lists them.
    """
    return np.flatnonzero((grid_vertices(n, dim) < 1).all(axis=0))


def squares(n: int) -> Array:
    """Return the vertex numbers of every square of a plane n × n grid, (4, n²).

    The vertices are listed counter-clockwise from the lower left one, and numbered as by ``grid_vertices``.
    """
    return lowest_corners(n, 2) + np.array([[0], [1], [n + 2], [n + 1]])


def kuhn(n: int, dim: int) -> Array:
    """Divide every cube of a grid into d! simplices; return their vertex numbers, positively oriented, (d+1, d! n^d).

    The grid has n^d cubes, in dimension d = ``dim``. Each simplex belongs to an order of the axes. Its vertices lie on
    the path along the axes in this order from the lowest to the highest corner of the cube.

    Source: H. W. Kuhn, Some combinatorial lemmas in topology, IBM J. Res. Dev. 4 (1960) 518–524.
    """
    first = lowest_corners(n, dim)
    steps = (n + 1) ** np.arange(dim)
    cells = []
    for order in permutations(range(dim)):
        path = np.concatenate([[0], np.cumsum(steps[list(order)])])
        if np.linalg.det(np.eye(dim)[list(order)]) < 0:
            path[[-2, -1]] = path[[-1, -2]]
        cells.append(first + path[:, None])
    return np.hstack(cells)


def has_grids(body: Body) -> bool:
    """Return whether a grid on the unit cube can be mapped onto a body such that interfaces are lines of constant x_i.

    x_i is a coordinate of the cube. If the interface is at x_i = a, it consists of edges of the grid with n cells along
    a side only if n a is an integer; ``boundary_parts`` refuses the mesh for other n.
    """
    images = _images(body)
    return images is not None and all(_is_grid_line(images, interface) for interface in body.interfaces)


def mapped(body: Body, reference: Points) -> Points:
    """Map points of the unit cube to the body, (d, ...) → (d, ...).

    Raises:
        MeshError: the body is neither a convex quadrilateral nor a parallelepiped.
    """
    images = _images(body)
    if images is None:
        wanted = "convex quadrilateral" if body.dim == 2 else "parallelepiped"
        mend = "use the unstructured family" if body.dim == 2 else "no family meshes other polyhedra"
        raise MeshError(f"a structured mesh needs a {wanted}, got a body with {body.corners.shape[1]} corners; {mend}")
    shapes = np.ones((1, *reference.shape[1:]))
    for x in reference:
        shapes = np.concatenate([shapes * (1 - x), shapes * x])
    return images @ shapes


@lru_cache
def _images(body: Body) -> Points | None:
    """Return the corners of the body in the order of the corners of the unit cube, (d, 2^d).

    The first coordinate of the cube varies fastest. If the body is neither a convex quadrilateral nor a parallelepiped,
    the result is None.
    """
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
    """Return the corners of a parallelepiped as ``_images`` does, or None if the body is none."""
    first, *others = body.corners.T
    # In this order the search returns the edges e_1, e_2, e_3 for the unit cube.
    for ends in permutations(reversed(others), 3):
        edges = np.transpose(ends - first)
        if abs(np.linalg.det(edges) - body.measure) <= 1e-9 * body.measure:
            images = first[:, None] + edges @ grid_vertices(1, 3)
            if cdist(images.T, body.corners.T).min(axis=1).max() <= 1e-9 * body.extent:
                return images
    return None


def _is_grid_line(images: Points, interface: Part) -> bool:
    """Return whether an interface joins opposite sides of a quadrilateral and divides both sides in the same ratio.

    Args:
        images: the corners of the quadrilateral, in the order of ``_images``.
        interface: the interface.
    """
    for sides in ((images[:, :2], images[:, 2:]), (images[:, ::2], images[:, 1::2])):
        for ends in (interface.corners, interface.corners[:, ::-1]):
            pairs = [(ends[:, [i]], side) for i, side in enumerate(sides)]
            low, high = (nearest(end, side) for end, side in pairs)
            if abs(low - high) < 1e-9 and all(on_segment(end, side) for end, side in pairs):
                return True
    return False


# Delaunay triangulations of polygons, uniform or refined towards points at which the solution is singular.


@dataclass(frozen=True)
class Unstructured(MeshFamily):
    """Delaunay triangulations of random, evenly distributed points, for any polygon.

    Points in the interior start on a triangular lattice, each moved at random; ``seed`` is the seed of the random
    numbers. Then ``sweeps`` times, every point moves to the area-weighted mean of the centroids of the cells around it
    (Lloyd's iteration in the form of Du, Faber, Gunzburger, SIAM Review 41 (1999) 637–676). Points on the boundary and
    on interfaces are evenly spaced and fixed.
    """

    seed: int = 2002
    sweeps: int = 8
    name: str = "unstructured"
    meshes = "Delaunay triangulations of evenly distributed points"
    least_angle = 20
    irregular = True

    def serves(self, body: Body) -> bool:
        return body.dim == 2

    def __call__(self, body: Body, n: int) -> Mesh:
        require_plane(self, body)
        spacing = 1.15 * np.sqrt(body.measure) / n
        boundary = [_divide(part, body, spacing) for part in body.parts]
        # The start of an interface lies on the boundary and is already among the boundary points.
        inside = [_divide(interface, body, spacing)[:, 1:] for interface in body.interfaces]
        fixed = np.hstack([*boundary, *inside])
        rng = np.random.default_rng([self.seed, n])
        points = np.hstack([fixed, _lattice(body, spacing, rng)])
        for _ in range(self.sweeps):
            centroids = _star_centroids(points, _delaunay(body, points))
            points = np.hstack([fixed, centroids[:, fixed.shape[1] :]])
        return simplicial_mesh(points, _delaunay(body, points))


@dataclass(frozen=True)
class Graded(MeshFamily):
    """Unstructured meshes that are refined towards the points c of ``body.refine``.

    First an unstructured mesh is made. Then its vertices x with |x − c| < R are moved by the map x ↦ c + (x − c)(|x −
    c|/R)^{e−1}. The size of cells becomes h ϱ^{1−1/e} at the distance ϱ from c, and h^e at c. P1 functions then
    approximate |x − c|^λ in H¹ with order 1 if 1/e < λ. The exponent e = 5/2 is sufficient for λ ≥ 1/2, which covers
    re-entrant corners and changes of the boundary condition.

    Attributes:
        exponent: the exponent e.
        reach: the radius R divided by the distance from c to the nearest other part, interface or point of
            ``body.refine``.
        name: the name in commands and tables.

    Sources: I. Babuška, R. B. Kellogg, J. Pitkäranta, Direct and inverse error estimates for finite elements with mesh
    refinements, Numer. Math. 33 (1979) 447–471; T. Apel, Anisotropic finite elements: local estimates and applications,
    Teubner 1999.
    """

    exponent: float = 2.5
    reach: float = 0.5
    name: str = "graded"
    meshes = "unstructured meshes refined towards points at which the solution is singular"
    least_angle = 8
    uniform = False
    irregular = True

    def serves(self, body: Body) -> bool:
        return body.dim == 2 and len(body.refine) > 0

    def __call__(self, body: Body, n: int) -> Mesh:
        if not self.serves(body):
            raise MeshError(
                f"a graded mesh needs a 2D body with points to refine towards, got dimension {body.dim} and "
                f"{len(body.refine)} points; list points in `refine`, or use the unstructured family"
            )
        mesh = Unstructured()(body, n)
        points = mesh.p.copy()
        for point in body.refine:
            centre = np.array(point)[:, None]
            radius = self.radius(body, point)
            away = mesh.p - centre
            share = np.linalg.norm(away, axis=0) / radius
            inside = share < 1
            factor = share[inside] ** (self.exponent - 1)
            points[:, inside] = centre + away[:, inside] * factor
        if (determinants(points, mesh.t) * determinants(mesh.p, mesh.t) <= 0).any():
            raise MeshError(f"grading inverts cells of the mesh of level {n}; take a finer level")
        return simplicial_mesh(points, mesh.t)

    def radius(self, body: Body, point: tuple[float, ...]) -> float:
        """Return the radius R around a point of ``body.refine`` within which vertices are moved.

        It is ``reach`` times the distance to the nearest part, interface or other point of ``body.refine``. Parts and
        interfaces that contain the point are ignored.
        """
        centre = np.array(point)
        tolerance = 1e-8 * np.sqrt(body.measure)
        lines = [part for part in (*body.parts, *body.interfaces) if not part.contains(centre, tolerance)]
        distances = [distance(centre[:, None], part.corners)[0] for part in lines]
        distances += [np.linalg.norm(centre - other) for other in body.refine if other != point]
        return self.reach * float(min(distances))


def _lattice(body: Body, spacing: float, rng: np.random.Generator) -> Array:
    """Return the interior points of a random mesh, (2, n): a triangular lattice with every point moved at random.

    Points near the boundary or an interface are left out.
    """
    low = body.vertices.min(axis=1)
    high = body.vertices.max(axis=1)
    rows = np.arange(low[1], high[1], spacing * np.sqrt(0.75))
    columns = np.arange(low[0] - spacing, high[0] + spacing, spacing)
    x, y = np.meshgrid(columns, rows)
    x[1::2] += spacing / 2
    points = np.vstack([x.ravel(), y.ravel()])
    points += rng.uniform(-0.3, 0.3, points.shape) * spacing
    keep = body.contains(points)
    for part in (*body.parts, *body.interfaces):
        (s,), depth = part.coordinates(points)
        beside = (s > -spacing) & (s < part.measure + spacing)
        keep &= ~(beside & (abs(depth) < 0.55 * spacing))
    return points[:, keep]


def _divide(part: Part, body: Body, spacing: float) -> Array:
    """Return evenly spaced points on a part or interface, from its start on; the end is not included, (2, n).

    If interfaces end on the part, each piece between these points is divided separately.
    """
    ends = [end for interface in body.interfaces if interface is not part for end in interface.corners.T]
    tolerance = 1e-9 * part.measure
    on_part = [part.coordinates(end)[0].item() for end in ends if part.contains(end, tolerance)]
    stops = [0.0]
    for s in (*sorted(on_part), part.measure):
        if s - stops[-1] > tolerance:
            stops.append(s)
    pieces = []
    for low, high in pairwise(stops):
        length = high - low
        count = max(1, round(length / spacing))
        pieces.append(low + np.arange(count) * length / count)
    return part.point(np.concatenate(pieces)[None])


def _delaunay(body: Body, points: Array) -> Array:
    """Return the cells of the Delaunay triangulation that lie in Ω, (3, cells)."""
    cells = Delaunay(points.T).simplices.T
    area = abs(determinants(points, cells)) / 2
    # Round-off may produce very thin cells between points on one straight side, so they are removed.
    centroids = points[:, cells].mean(axis=1)
    keep = (area > 1e-6 * area.mean()) & body.contains(centroids)
    return cells[:, keep]


def _star_centroids(points: Array, cells: Array) -> Array:
    """Return for each point the area-weighted mean of the centroids of the cells around it, (2, points)."""
    start, first, second = np.moveaxis(points[:, cells], 1, 0)
    first = first - start
    second = second - start
    area = abs(first[0] * second[1] - first[1] * second[0])
    weighted = area * points[:, cells].mean(axis=1)
    *moments, areas = (np.bincount(cells.ravel(), np.tile(x, 3), points.shape[1]) for x in (*weighted, area))
    return moments / np.maximum(areas, np.finfo(float).tiny)


FAMILIES: tuple[MeshFamily, ...] = (OneDiagonal(), CrissCross(), Shaken(), Unstructured(), Graded())
"""The mesh families of the study, each with its default parameters."""


# A body together with its mesh, and the check that both fit.


@dataclass(frozen=True, eq=False)
class MeshedBody:
    """A body, a mesh of it, and the facets of the mesh on every part of the boundary."""

    mesh: Mesh
    body: Body

    @cached_property
    def parts(self) -> list[Array]:
        """The numbers of the facets on each boundary part; raises MeshError if the mesh does not fit the body."""
        return boundary_parts(self.mesh, self.body)

    def facets(self, part: Part) -> Array:
        """Return the numbers of the mesh facets on one part of the boundary of the body, (n,)."""
        return self.parts[self.body.parts.index(part)]

    def on(self, kind: Kind) -> list[tuple[Part, Array]]:
        """Return all boundary parts of one kind, such as contact, each with the numbers of its facets, (n,)."""
        return [(part, facets) for part, facets in zip(self.body.parts, self.parts, strict=True) if part.kind is kind]

    @property
    def cells(self) -> int:
        """The number of cells of the mesh."""
        return int(self.mesh.t.shape[1])

    @cached_property
    def volumes(self) -> Array:
        """The volumes |T| of the cells, (cells,)."""
        return cell_volumes(self.mesh)


def boundary_parts(mesh: Mesh, body: Body) -> list[Array]:
    """Return the numbers of the boundary facets on each part of the body, in the order of ``body.parts``.

    Raises:
        MeshError: the mesh does not fit the body. Its dimension or its area is wrong, a corner of a part is not a
            vertex, facets do not cover a part exactly, or an interface is not a union of facets.
    """
    if mesh.dim() != body.dim:
        raise MeshError(f"a mesh of dimension {mesh.dim()} was given for a body of dimension {body.dim}")
    total = cell_volumes(mesh).sum()
    if abs(total - body.measure) > FIT_TOLERANCE * body.measure:
        what = "area" if body.dim == 2 else "volume"
        raise MeshError(
            f"the cells cover {total:.9g}, but the body has the {what} {body.measure:.9g}: cells overlap or are "
            "missing, or the mesh belongs to another body"
        )
    length = body.measure ** (1 / body.dim)
    facets = mesh.boundary_facets()
    border = mesh.p[:, np.unique(mesh.facets[:, facets])]
    distances = cdist(body.vertices.T, border.T).min(axis=1)
    for vertex, off in zip(body.vertices.T, distances, strict=True):
        if off > FIT_TOLERANCE * length:
            mend = "take a level at which it is" + (", or the unstructured family" if body.dim == 2 else "")
            raise MeshError(
                f"the boundary condition changes at {vertex.tolist()}, which is not a vertex of the mesh "
                f"(the nearest is {off:.3g} away); {mend}"
            )
    of_parts = [_covering(mesh, facets, part, length) for part in body.parts]
    left_out = len(facets) - sum(map(len, of_parts))
    if left_out:
        raise MeshError(
            f"{left_out} boundary facets of the mesh lie on no part of the body, or on two: "
            "the mesh belongs to another body, or parts overlap"
        )
    for interface in body.interfaces:
        _covering(mesh, np.arange(mesh.facets.shape[1]), interface, length)
    return of_parts


def _covering(mesh: Mesh, facets: Array, part: Part, length: float) -> Array:
    """Return which of the given facets lie on a boundary part; raise MeshError if they do not cover the part.

    Args:
        mesh: the mesh.
        facets: the numbers of boundary facets.
        part: the boundary part.
        length: the length to which the tolerance is relative.
    """
    on = part.contains(mesh.p, FIT_TOLERANCE * length)
    on_part = facets[on[mesh.facets[:, facets]].all(axis=0)]
    covered = facet_measures(mesh, on_part).sum()
    if abs(covered - part.measure) > FIT_TOLERANCE * length ** (mesh.dim() - 1):
        what = "length" if mesh.dim() == 2 else "area"
        mend = (
            "take a level at which edges of the mesh follow it, or the unstructured family"
            if part.kind is Kind.INTERFACE
            else "the mesh is not one of this body, or its facets do not end where the part does"
        )
        raise MeshError(
            f"facets of total {what} {covered:.9g} lie on the part {part.kind.value} with the corners "
            f"{part.corners.T.tolist()}, whose {what} is {part.measure:.9g}: {mend}"
        )
    return on_part


@dataclass(frozen=True, eq=False)
class Skin:
    """The triangles of a mesh that a picture shows: all cells in 2D, the boundary facets in 3D.

    Attributes:
        vertices: numbers of the vertices on the surface, (v,).
        triangles: the corners of the triangles, as indices into the array ``vertices``, (3, k); in 3D they are
            counter-clockwise seen from outside.
        cells: the cell of the mesh to which each triangle belongs, (k,).
    """

    vertices: Array
    triangles: Array
    cells: Array

    @classmethod
    def of(cls, mesh: Mesh) -> Skin:
        """Return all cells of a 2D mesh, or the boundary facets of a 3D mesh."""
        if mesh.dim() == 2:
            return cls(np.arange(mesh.p.shape[1]), mesh.t, np.arange(mesh.t.shape[1]))
        facets = mesh.boundary_facets()
        cells = mesh.f2t[0, facets]
        corners = mesh.facets[:, facets]
        fourth = mesh.t[:, cells].sum(axis=0) - corners.sum(axis=0)
        # The orientation is chosen such that the corners run counter-clockwise if seen from outside. The fourth vertex
        # of the cell lies inside.
        seen_from_inside = determinants(mesh.p, np.vstack([corners, fourth])) > 0
        outer = np.where(seen_from_inside, corners[[0, 2, 1]], corners)
        vertices, triangles = np.unique(outer, return_inverse=True)
        return cls(vertices, triangles.reshape(outer.shape), cells)

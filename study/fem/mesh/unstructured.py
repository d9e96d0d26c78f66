"""Delaunay triangulations of polygons, and the same refined towards singular points."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.spatial import Delaunay
from skfem import Mesh

from manufactured.body import Body, Part
from manufactured.tensors import Array
from study.fem.mesh.geometry import determinants, distance, simplicial_mesh
from study.fem.mesh.meshed_body import MeshError, require_plane


@dataclass(frozen=True)
class Unstructured:
    """Delaunay triangulations of points spread evenly at random, for any polygon.

    Points start on a jittered triangular lattice and are moved to the area-weighted mean of the centroids of the cells
    around them, ``sweeps`` times (Lloyd's iteration in the form of Du, Faber, Gunzburger, SIAM Review 41 (1999)
    637–676, with centroids of the star). Points on the boundary and on interfaces are evenly spaced and stay.
    """

    seed: int = 2002
    sweeps: int = 8
    name: str = "unstructured"

    def serves(self, body: Body) -> bool:
        return body.dim == 2

    def __call__(self, body: Body, n: int) -> Mesh:
        boundary, inside, free = self.points(body, n)
        fixed = np.hstack([boundary, inside])
        points = np.hstack([fixed, free])
        for _ in range(self.sweeps):
            cells = _delaunay(body, points)
            points = np.hstack([fixed, _star_centroids(points, cells)[:, fixed.shape[1] :]])
        return simplicial_mesh(points, _delaunay(body, points))

    def points(self, body: Body, n: int) -> tuple[Array, Array, Array]:
        """Those on the boundary, on interfaces inside, and others, which are not in their last places yet, (2, …)."""
        require_plane(self, body)
        spacing = 1.15 * np.sqrt(body.measure) / n
        boundary = [_divide(part, spacing, _stops(part, body)) for part in body.parts]
        # The start of an interface lies on the boundary.
        inside = [_divide(interface, spacing, _stops(interface, body))[:, 1:] for interface in body.interfaces]
        free = _lattice(body, spacing, np.random.default_rng([self.seed, n]))
        return np.hstack(boundary), np.hstack([np.empty((2, 0)), *inside]), free


@dataclass(frozen=True)
class Graded:
    """Unstructured meshes drawn towards the points c of ``body.refine``.

    x ↦ c + (x − c)(|x − c|/R)^{e−1} for |x − c| < R makes cells of the size h ϱ^{1−1/e} at the distance ϱ from c and
    h^e at c itself. P1 functions then approximate |x − c|^λ in H¹ with the order 1 if 1/e < λ: e = 5/2 serves the
    exponents λ ≥ 1/2 of re-entrant corners and of changes of the boundary condition.

    Sources: I. Babuška, R. B. Kellogg, J. Pitkäranta, Direct and inverse error estimates for finite elements with
    mesh refinements, Numer. Math. 33 (1979) 447–471; T. Apel, Anisotropic finite elements: local estimates and
    applications, Teubner 1999.
    """

    exponent: float = 2.5
    reach: float = 0.5
    name: str = "graded"

    def serves(self, body: Body) -> bool:
        return body.dim == 2 and len(body.refine) > 0

    def __call__(self, body: Body, n: int) -> Mesh:
        if not self.serves(body):
            raise MeshError(
                "a graded mesh needs a 2D body with points to refine towards; list them in `refine`, "
                "or use the unstructured family"
            )
        mesh = Unstructured()(body, n)
        points = mesh.p.copy()
        for point in body.refine:
            centre, radius = np.array(point)[:, None], self.radius(body, point)
            share = np.linalg.norm(mesh.p - centre, axis=0) / radius
            inside = share < 1
            points[:, inside] = centre + (mesh.p - centre)[:, inside] * share[inside] ** (self.exponent - 1)
        if (determinants(points, mesh.t) * determinants(mesh.p, mesh.t) <= 0).any():
            raise MeshError(f"grading turns cells over at the level {n}; take a finer one")
        return simplicial_mesh(points, mesh.t)

    def radius(self, body: Body, point: tuple[float, ...]) -> float:
        """R = ``reach`` × the distance to the parts and interfaces that c is not on, and to other points."""
        centre = np.array(point)
        tolerance = 1e-8 * np.sqrt(body.measure)
        lines = [part for part in (*body.parts, *body.interfaces) if not part.contains(centre, tolerance)]
        distances = [distance(centre[:, None], part.corners)[0] for part in lines]
        distances += [np.linalg.norm(centre - other) for other in body.refine if other != point]
        return self.reach * float(min(distances))


def _lattice(body: Body, spacing: float, rng: np.random.Generator) -> Array:
    """Points of a jittered triangular lattice in Ω, away from the boundary and from interfaces, (2, n)."""
    low, high = body.vertices.min(axis=1), body.vertices.max(axis=1)
    rows = np.arange(low[1], high[1], spacing * np.sqrt(0.75))
    columns = np.arange(low[0] - spacing, high[0] + spacing, spacing)
    x, y = np.meshgrid(columns, rows)
    x[1::2] += spacing / 2
    points = np.vstack([x.ravel(), y.ravel()])
    points += rng.uniform(-0.3, 0.3, points.shape) * spacing
    keep = body.contains(points)
    for part in (*body.parts, *body.interfaces):
        s, depth = part.coordinates(points)
        near = (s[0] > -spacing) & (s[0] < part.measure + spacing) & (abs(depth) < 0.55 * spacing)
        keep &= ~near
    return points[:, keep]


def _stops(part: Part, body: Body) -> list[float]:
    """Coordinates inside a part at which an interface ends."""
    ends = [end for interface in body.interfaces if interface is not part for end in interface.corners.T]
    tolerance = 1e-9 * part.measure
    found = sorted(float(part.coordinates(end)[0][0]) for end in ends if part.contains(end, tolerance))
    inner = [s for s in found if tolerance < s < part.measure - tolerance]
    return [s for i, s in enumerate(inner) if i == 0 or s - inner[i - 1] > tolerance]


def _divide(part: Part, spacing: float, stops: list[float]) -> Array:
    """Points of a part from its start, without its end, evenly spaced between its ends and stops."""
    pieces = []
    for low, high in pairwise([0.0, *stops, part.measure]):
        count = max(1, round((high - low) / spacing))
        pieces.append(low + np.arange(count) * (high - low) / count)
    return part.point(np.concatenate(pieces)[None])


def _delaunay(body: Body, points: Array) -> Array:
    """Cells of the Delaunay triangulation that lie in Ω, (3, cells)."""
    cells = Delaunay(points.T).simplices.T
    area = abs(determinants(points, cells)) / 2
    # Rounding may leave slivers between points of one straight part; they are not cells of Ω.
    keep = (area > 1e-6 * area.mean()) & body.contains(points[:, cells].mean(axis=1))
    return cells[:, keep]


def _star_centroids(points: Array, cells: Array) -> Array:
    """Area-weighted mean of the centroids of the cells around each point, (2, points)."""
    a, b, c = (points[:, v] for v in cells)
    area = abs((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0])
    weight = np.bincount(cells.ravel(), np.tile(area, 3), points.shape[1])
    centroid = (a + b + c) / 3
    moments = [np.bincount(cells.ravel(), np.tile(area * x, 3), points.shape[1]) for x in centroid]
    return np.array(moments) / np.maximum(weight, np.finfo(float).tiny)

"""The body Ω, its boundary parts Γ1, Γ2, Γ3 = ∪ Γ3,i and the time interval [0, T].

The dimension d ∈ {2, 3} is that of the corners: a polygon bounded by segments, or a polyhedron bounded by flat
convex polygons. What holds for both is written once, with the vector |S| ν of a piece S of the boundary,

    |S| ν = Σ over the simplices (c_0, c_i, …, c_{i+d−2}) of its fan of a/(d−1)!,   a·x = det [x, c_i − c_0, …].
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from math import factorial

import numpy as np
from numpy.typing import NDArray

from manufactured.tensors import Array, Points

NDBool = NDArray[np.bool_]
Point = tuple[float, ...]
Line = tuple[tuple[float, ...], float]
"""(direction, offset) of {x : direction·x = offset}."""

ROUNDING = 1e-9
"""Relative distance below which points of a body are the same and corners lie in one plane."""


class BodyError(ValueError):
    """A body or its boundary parts are not what the problem needs."""


class Kind(Enum):
    """What a part carries: the boundary condition (2.3), (2.4) or (2.5), or a change of the material inside."""

    CLAMPED = "Γ1"
    LOADED = "Γ2"
    CONTACT = "Γ3"
    INTERFACE = "interface"


@dataclass(frozen=True, eq=False)
class Part:
    """A flat piece of ∂Ω with one boundary condition: a segment in 2D, a convex polygon in 3D.

    Its local coordinates are s ∈ R^{d−1} along the part, from its first corner, and y, the distance into the body.
    The first axis of s points from the first corner to the last, and the axes of (s, y) are right-handed. On the
    bottom of the unit cube with the corners (0,0), (0,1), (1,1), (1,0) this is s = (x, y).

    Attributes:
        kind: the condition.
        corners: (d, c). In 2D c = 2 and Ω lies to the left of start → end; in 3D c ≥ 3 and the corners run
            counter-clockwise seen from outside.

    Raises:
        BodyError: the corners are not finite, repeated, not in one plane or not those of a convex polygon.
    """

    kind: Kind
    corners: Array

    def __post_init__(self) -> None:
        dim, count = self.corners.shape
        if dim not in (2, 3) or count < dim or (dim == 2 and count > 2):
            raise BodyError(
                f"corners of the shape {(dim, count)} make no part: give two corners in 2D, shape (2, 2), "
                "or three and more in 3D, shape (3, c)"
            )
        if not np.isfinite(self.corners).all():
            raise BodyError(f"a vertex of the body is not a finite number: {self._given}")
        if (np.linalg.norm(np.roll(self.corners, -1, axis=1) - self.corners, axis=0) == 0).any():
            raise BodyError(f"a boundary part has an edge of length 0, {self._given}; list every vertex once")
        if self.measure == 0:
            raise BodyError(f"a boundary part has the area 0: {self._given}")
        diameter = float(np.ptp(self.corners, axis=1).max())
        if abs(self.coordinates(self.corners)[1]).max() > ROUNDING * diameter:
            raise BodyError(f"a boundary part is not flat: {self._given}; cut it into triangles")
        if not self.contains(self.corners, ROUNDING * diameter).all():
            raise BodyError(f"a boundary part is not convex: {self._given}; cut it into convex parts")

    @property
    def _given(self) -> list[list[float]]:
        return [[float(f"{c:.9g}") for c in corner] for corner in self.corners.T]

    @property
    def dim(self) -> int:
        return len(self.corners)

    @property
    def start(self) -> Array:
        """The first corner, (d,), the origin of s."""
        return self.corners[:, 0]

    @property
    def end(self) -> Array:
        """The last corner, (d,), on the first axis of s; in 2D the other end."""
        return self.corners[:, -1]

    def line(self, c: float) -> Line:
        """{s = c} across a body in the plane."""
        return tuple(map(float, self.tangent)), float(self.tangent @ self.start) + c

    @cached_property
    def vector(self) -> Array:
        """|S| ν, (d,)."""
        return np.sum([fan_vector(simplex) for simplex in self.fan], axis=0)

    @cached_property
    def fan(self) -> tuple[Array, ...]:
        """The simplices (d, d) from the first corner that make up the part."""
        dim, count = self.corners.shape
        return tuple(self.corners[:, [0, *range(i, i + dim - 1)]] for i in range(1, count - dim + 2))

    @cached_property
    def measure(self) -> float:
        """Length (2D) or area (3D)."""
        return float(np.linalg.norm(self.vector))

    @cached_property
    def tangent(self) -> Array:
        """Unit vector from the first corner to the last, the first axis of s, (d,)."""
        along = self.end - self.start
        return along / np.linalg.norm(along)

    @cached_property
    def normal(self) -> Array:
        """ν, the unit **outward** normal, (d,)."""
        return self.vector / self.measure

    @cached_property
    def frame(self) -> Array:
        """Orthonormal, right-handed columns (tangents, inward normal −ν), (d, d): local axes (s, y) of the lifting."""
        further = [] if self.dim == 2 else [np.cross(self.tangent, self.normal)]
        return np.column_stack([self.tangent, *further, -self.normal])

    @cached_property
    def outline(self) -> Array:
        """The corners in the coordinates s, (d−1, c)."""
        return self.coordinates(self.corners)[0]

    @cached_property
    def sides(self) -> tuple[Array, Array]:
        """Outward unit normals n_k (d−1, k) and offsets b_k (k,): the part is {n_k·s ≤ b_k for all k}."""
        if self.dim == 2:
            return np.array([[-1.0, 1.0]]), np.array([0.0, self.measure])
        # In the axes s the corners run clockwise, so that outside is to the left.
        edges = np.roll(self.outline, -1, axis=1) - self.outline
        normals = np.array([-edges[1], edges[0]]) / np.linalg.norm(edges, axis=0)
        return normals, np.einsum("ik,ik->k", normals, self.outline)

    def coordinates(self, x: Points) -> tuple[Array, Array]:
        """Local coordinates: s ∈ R^{d−1} along the part from its start, y = distance into the body.

        (d, ...) → (d−1, ...), (...).
        """
        local = np.tensordot(self.frame.T, x - self.start.reshape((-1,) + (1,) * (x.ndim - 1)), axes=1)
        return local[:-1], local[-1]

    def point(self, s: Array) -> Points:
        """The point of the part with local coordinate s: (d−1, ...) → (d, ...)."""
        origin = self.start.reshape((-1,) + (1,) * (np.ndim(s) - 1))
        return origin + np.tensordot(self.frame[:, :-1], s, axes=1)

    def covers(self, s: Array, tolerance: float) -> NDBool:
        """Whether local coordinates are those of points of the closed part: (d−1, ...) → (...)."""
        normals, offsets = self.sides
        beyond = np.moveaxis(np.tensordot(normals.T, s, axes=1), 0, -1) - offsets
        return np.asarray((beyond <= tolerance).all(axis=-1))

    def contains(self, x: Points, tolerance: float) -> NDBool:
        """Whether points lie on the closed part: (d, ...) → (...)."""
        s, y = self.coordinates(x)
        return (abs(y) <= tolerance) & self.covers(s, tolerance)

    def sample(self, rng: np.random.Generator, count: int) -> Points:
        """Random points of the part, evenly distributed, (d, count)."""
        return self.point(_scatter(rng, self.outline, lambda s: self.covers(s, 0.0), count))


@dataclass(frozen=True, eq=False)
class Body:
    """A polygon or polyhedron Ω with boundary parts, and the final time T.

    Attributes:
        parts: the pieces of ∂Ω; in 2D in counter-clockwise order, each starting where the last one ends.
        T: final time.
        refine: vertices of Ω towards which graded meshes refine: re-entrant corners, ends of Γ1.
        interfaces: segments of the kind ``Kind.INTERFACE`` that cut a polygon Ω from boundary to boundary, along
            which the material changes. Every mesh has to respect them.

    Raises:
        BodyError: fewer than d + 1 parts, gaps between them, inward normals, no Γ1 (Korn's inequality (2.17)
            needs meas Γ1 > 0), no Γ3, T ≤ 0, a point of ``refine`` that is no vertex, an interface that does not
            cut Ω.
    """

    parts: tuple[Part, ...]
    T: float = 1.0
    refine: tuple[Point, ...] = ()
    interfaces: tuple[Part, ...] = ()

    def __post_init__(self) -> None:
        self._check_parts()
        for kind, why in ((Kind.CLAMPED, "Korn's inequality (2.17)"), (Kind.CONTACT, "the Signorini condition (2.5)")):
            if not self.of(kind):
                raise BodyError(f"the body has no part {kind.value}, which {why} needs")
        if not (np.isfinite(self.T) and self.T > 0):
            raise BodyError(f"the final time must be positive, got T = {self.T}")
        for point in self.refine:
            self._check_refined(point)
        for i, interface in enumerate(self.interfaces):
            self._check_interface(interface)
            for other in self.interfaces[:i]:
                _check_apart(interface, other)

    def _check_parts(self) -> None:
        """Whether the parts bound a set from outside."""
        if len({part.dim for part in self.parts}) > 1:
            raise BodyError(f"parts of the dimensions {[part.dim for part in self.parts]} bound no body")
        if any(part.kind is Kind.INTERFACE for part in self.parts):
            raise BodyError("an interface lies inside the body: give it as one of `interfaces`, not of the parts")
        if len(self.parts) < 3 or len(self.parts) <= self.dim:
            raise BodyError(
                "a polygon needs three boundary parts or more, a polyhedron four or more, "
                f"got {len(self.parts)} in {self.dim if self.parts else 'no'} dimensions"
            )
        if self.dim == 2:
            for i, (part, after) in enumerate(zip(self.parts, self.parts[1:] + self.parts[:1], strict=True)):
                if not np.allclose(part.end, after.start):
                    ends, starts = part.end.tolist(), after.start.tolist()
                    raise BodyError(f"part {i} ends at {ends} but the next starts at {starts}")
        if self.measure <= 0:
            raise BodyError(
                f"the parts enclose {'the area' if self.dim == 2 else 'the volume'} {self.measure:.6g}; "
                "list corners counter-clockwise, in 3D seen from outside"
            )
        self._check_closed()

    def _check_closed(self) -> None:
        """∫ ν = 0 and ∫ x ⊗ ν = |Ω| 1 over ∂Ω, the divergence theorem for constant and linear fields."""
        total = np.sum([part.vector for part in self.parts], axis=0)
        fans = [simplex for part in self.parts for simplex in part.fan]
        moments = np.sum([np.outer(simplex.mean(axis=1), fan_vector(simplex)) for simplex in fans], axis=0)
        scale = float(np.ptp(self.vertices, axis=1).max())
        surface = sum(part.measure for part in self.parts)
        if (
            abs(total).max() > ROUNDING * surface
            or abs(moments - self.measure * np.eye(self.dim)).max() > ROUNDING * surface * scale
        ):
            raise BodyError(
                f"the parts do not enclose the body: ∫ν over all of them is {np.round(total, 9).tolist()} and ∫x⊗ν is "
                f"{np.round(moments, 9).tolist()}, expected 0 and |Ω| times the unit matrix; a part is missing, "
                "doubled or has its corners clockwise seen from outside"
            )

    def _check_refined(self, point: Point) -> None:
        given = np.array(point, dtype=float)
        scale = float(np.ptp(self.vertices, axis=1).max())
        if given.shape != (self.dim,) or abs(self.vertices - given[:, None]).max(axis=0).min() > ROUNDING * scale:
            raise BodyError(
                f"meshes cannot be refined towards {tuple(point)}: it is none of the vertices "
                f"{[tuple(v) for v in self.vertices.T.tolist()]} of the body; list it as one"
            )

    def _check_interface(self, interface: Part) -> None:
        if interface.kind is not Kind.INTERFACE:
            raise BodyError(f"an interface has the kind {Kind.INTERFACE}, got {interface.kind}")
        if self.dim != 2 or interface.dim != 2:
            raise BodyError("interfaces are segments in a 2D body; a 3D body has none")
        tolerance = ROUNDING * interface.measure
        for end in interface.corners.T:
            if not any(part.contains(end, tolerance) for part in self.parts):
                raise BodyError(f"the interface ends at {end.tolist()}, expected a point of the boundary")
        inner = interface.point(interface.measure * np.linspace(0, 1, 101)[None, 1:-1])
        if not self.contains(inner).all() or any(part.contains(inner, tolerance).any() for part in self.parts):
            raise BodyError(
                f"the interface from {interface.start.tolist()} to {interface.end.tolist()} leaves the body or touches "
                "its boundary between its ends; cut it there"
            )

    @property
    def dim(self) -> int:
        return self.parts[0].dim

    @cached_property
    def vertices(self) -> Points:
        """The different corners of the parts in the order of their first appearance, (d, k); in 2D their starts."""
        corners = np.hstack([part.corners for part in self.parts])
        apart = np.linalg.norm(corners[:, :, None] - corners[:, None, :], axis=0)
        first = (apart <= ROUNDING * apart.max()).argmax(axis=1)
        return corners[:, first == np.arange(len(first))]

    @cached_property
    def measure(self) -> float:
        """|Ω| = ∫ x·ν / d over ∂Ω: area (2D) or volume (3D)."""
        return float(sum(part.vector @ part.start for part in self.parts) / self.dim)

    @cached_property
    def corners(self) -> Points:
        """Vertices at which the normals of the parts span R^d, (d, number of corners)."""
        reach = ROUNDING * float(np.ptp(self.vertices, axis=1).max())
        turns = []
        for vertex in self.vertices.T:
            normals = [part.normal for part in self.parts if part.contains(vertex, reach)]
            turns.append(len(normals) >= self.dim and np.linalg.svd(normals)[1][-1] > 1e-12)
        return self.vertices[:, turns]

    def of(self, kind: Kind) -> tuple[Part, ...]:
        """The parts that carry a condition."""
        return tuple(part for part in self.parts if part.kind is kind)

    def contains(self, x: Points) -> NDBool:
        """Whether points lie in Ω: (d, ...) → (...).

        They do if a ray from them crosses ∂Ω an odd number of times. Its direction is a fixed one that no part of
        a body in use is parallel to.
        """
        ray = np.array([1.0, np.sqrt(2) / 17, np.sqrt(3) / 29])[: self.dim]
        inside = np.zeros(x.shape[1:], dtype=bool)
        for part in self.parts:
            s, y = part.coordinates(x)
            *along, into = part.frame.T @ ray
            if into != 0:
                far = -y / into
                inside ^= (far > 0) & part.covers(s + np.multiply.outer(np.array(along), far), 0.0)
        return inside

    def sample(self, rng: np.random.Generator, count: int) -> Points:
        """Random points of Ω, (d, count)."""
        return _scatter(rng, self.vertices, self.contains, count)


def _check_apart(interface: Part, other: Part) -> None:
    """Refuse interfaces of which each has its ends on different sides of the other."""
    sides = [one.coordinates(two.corners)[1] for one, two in ((interface, other), (other, interface))]
    if all(np.prod(side) < -ROUNDING * abs(side).max() ** 2 for side in sides):
        raise BodyError(
            f"the interfaces from {interface.start.tolist()} and from {other.start.tolist()} cross; "
            "they may meet on the boundary only"
        )


def fan_vector(simplex: Array) -> Array:
    """|S| ν of a simplex S with the corners (d, d): ν outward if they run as those of a ``Part``."""
    dim = len(simplex)
    edges = simplex[:, 1:] - simplex[:, :1]
    cofactors = [np.linalg.det(np.column_stack([unit, edges])) for unit in np.eye(dim)]
    return np.array(cofactors) / factorial(dim - 1)


def _scatter(rng: np.random.Generator, corners: Points, inside: Callable[[Points], NDBool], count: int) -> Points:
    """Random points of a set, evenly distributed, out of the smallest box around its corners, (k, count)."""
    low, high = corners.min(axis=1), corners.max(axis=1)
    points = np.empty((len(corners), 0))
    while points.shape[1] < count:
        trial = rng.uniform(low[:, None], high[:, None], (len(corners), 2 * count))
        points = np.hstack([points, trial[:, inside(trial)]])
    return points[:, :count]


def polygon(
    vertices: Sequence[tuple[float, float]],
    kinds: Sequence[Kind],
    T: float = 1.0,
    refine: Sequence[tuple[float, float]] = (),
    interfaces: Sequence[tuple[tuple[float, float], tuple[float, float]]] = (),
) -> Body:
    """The polygon with the given counter-clockwise vertices; ``kinds[i]`` holds from vertex i to i+1.

    A boundary condition may change within a side: list the point as a vertex. Interfaces are pairs of points.
    """
    if len(vertices) != len(kinds):
        raise BodyError(f"{len(vertices)} vertices need {len(vertices)} kinds, got {len(kinds)}")
    ends = list(zip(vertices, [*vertices[1:], *vertices[:1]], strict=True))
    return Body(
        tuple(Part(kind, _columns(pair)) for kind, pair in zip(kinds, ends, strict=True)),
        T,
        tuple(tuple(float(c) for c in point) for point in refine),
        tuple(Part(Kind.INTERFACE, _columns(pair)) for pair in interfaces),
    )


def unit_square(T: float = 1.0) -> Body:
    """(0,1)²: clamped on top, loaded on both sides, Γ3 the bottom with s = x."""
    return polygon([(0, 0), (1, 0), (1, 1), (0, 1)], [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED], T)


def box(
    lengths: tuple[float, float, float] = (1.0, 1.0, 1.0),
    T: float = 1.0,
    *,
    left: Kind = Kind.LOADED,
    right: Kind = Kind.LOADED,
    front: Kind = Kind.LOADED,
    back: Kind = Kind.LOADED,
    bottom: Kind = Kind.CONTACT,
    top: Kind = Kind.CLAMPED,
) -> Body:
    """(0,X) × (0,Y) × (0,Z) for the lengths (X, Y, Z), by default loaded on its sides, Γ3 the bottom.

    Left and right are x = 0 and X, front and back y = 0 and Y, bottom and top z = 0 and Z, in this order. Local
    coordinates s: bottom (x, y), left (y, z), front (z, x); opposite faces have the two swapped.
    """
    parts = []
    for face, kind in enumerate((left, right, front, back, bottom, top)):
        axis, far = divmod(face, 2)
        first, second = ((axis + 2) % 3, (axis + 1) % 3) if far else ((axis + 1) % 3, (axis + 2) % 3)
        corners = np.zeros((3, 4))
        corners[axis] = far * lengths[axis]
        corners[second, 1:3] = lengths[second]
        corners[first, 2:4] = lengths[first]
        parts.append(Part(kind, corners))
    return Body(tuple(parts), T)


def _columns(points: Sequence[tuple[float, float]]) -> Array:
    """(d, number of points)."""
    return np.array(points, dtype=float).T

"""The body Ω of the contact problem, with its boundary parts and the time interval [0, T].

The boundary consists of the clamped part Γ1, the loaded part Γ2 and the contact part Γ3, which may have several pieces
Γ3,i. In 2D a body is a polygon bounded by segments, in 3D a polyhedron bounded by flat convex polygons.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from itertools import combinations
from math import factorial

import numpy as np
from numpy.typing import NDArray

from manufactured.arguments import checked
from manufactured.tensors import Array, Hyperplane, Points, mapped

# A flat part of the boundary of a body, or an interface inside it.
#
# Formulas that hold in 2D and in 3D use the vector |S| ν of a part S: its length or area times its outward normal. S is
# divided into the simplices (c_0, c_i, …, c_{i+d−2}) that share its first corner c_0 (a fan). Then
#
#     |S| ν = Σ_i a_i/(d−1)!,   where the vector a_i is given by a_i·x = det [x, c_i − c_0, …].

NDBool = NDArray[np.bool_]

CORNER_ROUNDING = 1e-9
"""Relative distance below which two points count as equal, and below which corners count as lying in one plane."""


class BodyError(ValueError):
    """Raised if a body or its boundary parts do not fit the contact problem."""


class Kind(Enum):
    """The role of a part: clamped (2.3), loaded (2.4), contact (2.5), a roller, or an interface between two materials.

    A roller, for example a line of symmetry, has no tangential traction, and its normal displacement is 0 or
    prescribed. It is not part of the paper. Exact solutions have no rollers; the command `study bound`, which bounds
    the error of a computed displacement if the exact solution is not known, accepts them.
    """

    CLAMPED = "Γ1"
    LOADED = "Γ2"
    CONTACT = "Γ3"
    ROLLER = "roller"
    INTERFACE = "interface"


@dataclass(frozen=True, eq=False)
@checked(BodyError)
class Part:
    """A flat piece of the boundary with one boundary condition: a segment in 2D, a convex polygon in 3D.

    Local coordinates are s ∈ R^{d−1} along the part, with the origin at its first corner, and y, the distance from the
    part into the body. The first axis of s points from the first corner to the last one, and the axes of (s, y) are
    right-handed. On the bottom of the unit cube with the corners (0,0), (0,1), (1,1), (1,0) this is s = (x, y).

    Attributes:
        kind: the boundary condition.
        corners: the c corners, (d, c). In 2D c = 2, and the body lies to the left of the direction from the first to
            the second corner. In 3D c ≥ 3, and the corners are counter-clockwise seen from outside.
        displacement: the prescribed displacement at the corners, (d, c), of a segment; it is linear in between. On a
            roller only its normal component is prescribed. None means 0.

    Raises:
        BodyError: the corners are no finite numbers, are repeated, do not lie in one plane, or form no convex polygon.
    """

    kind: Kind
    corners: Array
    displacement: Array | None = None

    def __post_init__(self) -> None:
        dim, count = self.corners.shape if self.corners.ndim == 2 else (0, 0)
        if dim not in (2, 3) or count < dim or (dim == 2 and count > 2):
            raise BodyError(
                f"a boundary part cannot have corners of the shape {self.corners.shape}: give two in 2D, shape (2, 2), "
                "or three or more in 3D, shape (3, c)"
            )
        if (np.linalg.norm(np.roll(self.corners, -1, axis=1) - self.corners, axis=0) == 0).any():
            raise BodyError(f"a boundary part has an edge of length 0, {self._given}; list every vertex once")
        if self.measure == 0:
            raise BodyError(f"a boundary part has the area 0: {self._given}")
        diameter = float(np.ptp(self.corners, axis=1).max())
        if abs(self.coordinates(self.corners)[1]).max() > CORNER_ROUNDING * diameter:
            raise BodyError(f"a boundary part is not flat: {self._given}; cut it into triangles")
        if not self.contains(self.corners, CORNER_ROUNDING * diameter).all():
            raise BodyError(f"a boundary part is not convex: {self._given}; cut it into convex parts")

    @property
    def _given(self) -> list[list[float]]:
        return [[float(f"{c:.9g}") for c in corner] for corner in self.corners.T]

    @property
    def dim(self) -> int:
        return len(self.corners)

    @property
    def start(self) -> Array:
        """The first corner, (d,), which is the origin of the coordinate s."""
        return self.corners[:, 0]

    @property
    def end(self) -> Array:
        """The last corner, (d,), which lies on the first axis of the coordinates s."""
        return self.corners[:, -1]

    def line(self, c: float) -> Hyperplane:
        """Return the line {x : direction·x = offset} perpendicular to the segment at s = c, as (direction, offset).

        Args:
            c: the coordinate s along the segment.
        """
        return tuple(map(float, self.tangent)), float(self.tangent @ self.start) + c

    @cached_property
    def vector(self) -> Array:
        """The length or area of the part times its outward unit normal, (d,)."""
        return np.sum([fan_vector(simplex) for simplex in self.fan], axis=0)

    @cached_property
    def fan(self) -> tuple[Array, ...]:
        """Simplices that make up the part, as arrays of their corners, (d, d); all contain the first corner."""
        dim, count = self.corners.shape
        return tuple(self.corners[:, [0, *range(i, i + dim - 1)]] for i in range(1, count - dim + 2))

    @cached_property
    def measure(self) -> float:
        """The length (2D) or area (3D) of the part."""
        return float(np.linalg.norm(self.vector))

    @cached_property
    def tangent(self) -> Array:
        """The unit vector from the first corner to the last one, the first axis of the local coordinates s, (d,)."""
        along = self.end - self.start
        return along / np.linalg.norm(along)

    @cached_property
    def normal(self) -> Array:
        """The **outward** unit normal ν, (d,)."""
        return self.vector / self.measure

    @cached_property
    def frame(self) -> Array:
        """The axes of the local coordinates (s, y) as columns, (d, d): the tangents, then the inward normal −ν."""
        further = [] if self.dim == 2 else [np.cross(self.tangent, self.normal)]
        return np.column_stack([self.tangent, *further, -self.normal])

    @cached_property
    def outline(self) -> Array:
        """The corners of the part in its local coordinates s, (d−1, c)."""
        return self.coordinates(self.corners)[0]

    @cached_property
    def sides(self) -> tuple[Array, Array]:
        """The part as a set of inequalities {s : n_k·s ≤ b_k for all k}.

        Returns:
            The outward unit normals n_k of its sides, (d−1, k), and the offsets b_k, (k,).
        """
        if self.dim == 2:
            return np.array([[-1.0, 1.0]]), np.array([0.0, self.measure])
        # In the coordinates s the corners run clockwise, so a left turn from an edge leads outside.
        edges = np.roll(self.outline, -1, axis=1) - self.outline
        normals = np.array([-edges[1], edges[0]]) / np.linalg.norm(edges, axis=0)
        return normals, np.einsum("ik,ik->k", normals, self.outline)

    def coordinates(self, x: Points) -> tuple[Array, Array]:
        """Return the local coordinates of points (d, ...): s along the part, (d−1, ...), and the depth y, (...)."""
        local = mapped(self.frame.T, (x.T - self.start).T)
        return local[:-1], local[-1]

    def point(self, s: Array) -> Points:
        """Return the points of the part that have given local coordinates s: (d−1, ...) → (d, ...)."""
        return (mapped(self.frame[:, :-1], s).T + self.start).T

    def covers(self, s: Array, tolerance: float) -> NDBool:
        """Return for points with local coordinates s whether they lie on the part or its boundary: (d−1, ...) → (...).

        Args:
            s: the local coordinates, (d−1, ...).
            tolerance: the distance from the part up to which a point counts as lying on it.
        """
        normals, offsets = self.sides
        beyond = np.moveaxis(mapped(normals.T, s), 0, -1) - offsets
        return np.asarray((beyond <= tolerance).all(axis=-1))

    def contains(self, x: Points, tolerance: float) -> NDBool:
        """Return whether points lie on the part or its boundary, up to a distance ``tolerance``: (d, ...) → (...)."""
        s, y = self.coordinates(x)
        return (abs(y) <= tolerance) & self.covers(s, tolerance)

    def grid(self, shares: Array) -> Array:
        """Return the points of a grid that lie on the part, in local coordinates, (d−1, n).

        Args:
            shares: the positions of the grid lines along each axis as fractions, from 0 to 1, of the extent of the part
                along this axis.
        """
        low, high = self.outline.min(axis=1), self.outline.max(axis=1)
        # Both ends are exact, so that no end of the grid lies beyond the part by rounding.
        axes = np.multiply.outer(low, 1 - shares) + np.multiply.outer(high, shares)
        points = np.array([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")])
        return points[:, self.covers(points, 0.0)]

    def prescribed(self, x: Points) -> Points:
        """Return the prescribed displacement at points of the segment, (2, n) → (2, n); 0 if none is given.

        It is interpolated linearly between the corners.
        """
        if self.displacement is None:
            return np.zeros_like(x)
        along, _ = self.coordinates(x)
        share = along[0] / self.measure
        start, end = self.displacement.T
        return start[:, None] + np.multiply.outer(end - start, share)

    def sample(self, rng: np.random.Generator, count: int) -> Points:
        """Return uniformly distributed random points of the part, (d, count)."""
        return self.point(scattered(rng, self.outline, lambda s: self.covers(s, 0.0), count))


def fan_vector(simplex: Array) -> Array:
    """Return the length (2D) or area (3D) of a segment or triangle times its unit normal, (d,).

    The normal points outwards if the corners are ordered as in ``Part``.

    Args:
        simplex: the d corners as columns, (d, d).
    """
    dim = len(simplex)
    edges = simplex[:, 1:] - simplex[:, :1]
    cofactors = [np.linalg.det(np.column_stack([unit, edges])) for unit in np.eye(dim)]
    return np.array(cofactors) / factorial(dim - 1)


def scattered(rng: np.random.Generator, corners: Points, inside: Callable[[Points], NDBool], count: int) -> Points:
    """Return uniformly distributed random points of a set in R^k, (k, count).

    Args:
        rng: the random number generator.
        corners: c points whose convex hull contains the set, such as its corners, (k, c). Points are drawn from the
            smallest box that contains them.
        inside: function that returns whether points lie in the set.
        count: the number of points.
    """
    low, high = corners.min(axis=1), corners.max(axis=1)
    points = np.empty((len(corners), 0))
    while points.shape[1] < count:
        trial = rng.uniform(low[:, None], high[:, None], (len(corners), 2 * count))
        points = np.hstack([points, trial[:, inside(trial)]])
    return points[:, :count]


# A body: a polygon or polyhedron with boundary parts.

SLENDER = 1000.0
"""Limit of slenderness: a body is refused if (largest extent)^d divided by its area or volume exceeds this number.

The constant of Korn's inequality grows with this ratio.
"""
HELD = 1e-3
"""Rollers exclude rigid motions if the matrix of their conditions has no singular value below this number.

The rows of the matrix are the normal displacements on the rollers for each rigid motion, with lengths relative to the
size of the body.
"""


@dataclass(frozen=True, eq=False)
@checked(BodyError)
class Body:
    """A polygon or polyhedron Ω with boundary conditions on its parts, and the final time T of the problem.

    A body may have no contact part Γ3. Then it serves only to bound the error of a computed displacement (command
    `study bound`), because an ``ExactSolution`` needs Γ3.

    Attributes:
        parts: the parts of the boundary ∂Ω; in 2D in counter-clockwise order, each starting at the end of the previous
            part. The parts of each hole follow in clockwise order.
        T: the final time.
        refine: vertices of Ω towards which graded meshes refine, such as re-entrant corners and ends of Γ1.
        interfaces: segments of the kind ``Kind.INTERFACE`` that cut a polygon Ω from boundary to boundary. The material
            changes along them, and every mesh must contain them as edges.

    Raises:
        BodyError: one of these conditions is violated:

            * There are at least d + 1 parts, without gaps and with outward normals. Holes are listed clockwise, lie
              inside the outline and do not meet.
            * Γ1 or rollers exclude rigid motions, as Korn's inequality (2.17) needs. Rollers are parallel to an axis.
            * T > 0.
            * The body is not too thin: (largest extent)^d is at most 1000 times its area or volume (``SLENDER``).
            * The points of ``refine`` are vertices.
            * Interfaces cut Ω and do not cross.
    """

    parts: tuple[Part, ...]
    T: float = 1.0
    refine: tuple[tuple[float, ...], ...] = ()
    interfaces: tuple[Part, ...] = ()

    def __post_init__(self) -> None:
        _check_parts(self)
        _check_closed(self)
        _check_held(self)
        if self.extent**self.dim > SLENDER * self.measure:
            raise BodyError(
                f"the body is {self.extent:g} across and measures {self.measure:.3g}: so thin that rounding errors "
                f"hide its deformation; {self.extent:g}^{self.dim} divided by its measure may be at most {SLENDER:g}"
            )
        if self.T <= 0:
            raise BodyError(f"the final time must be positive, got T = {self.T}")
        for point in self.refine:
            _check_refined(self, point)
        for interface in self.interfaces:
            _check_interface(self, interface)
        for interface, other in combinations(self.interfaces, 2):
            _check_apart(interface, other)

    @property
    def dim(self) -> int:
        return self.parts[0].dim

    @cached_property
    def vertices(self) -> Points:
        """The vertices of the body: the corners of all parts without repetition, (d, k).

        In 2D they are the starts of the parts, in the order of the parts.
        """
        corners = np.hstack([part.corners for part in self.parts])
        differences = corners[:, :, None] - corners[:, None, :]
        apart = np.linalg.norm(differences, axis=0)
        same = apart <= CORNER_ROUNDING * apart.max()
        first = same.argmax(axis=1)
        return corners[:, first == np.arange(len(first))]

    @cached_property
    def extent(self) -> float:
        """The longest side of the box around the body, parallel to the axes."""
        return float(np.ptp(self.vertices, axis=1).max())

    @cached_property
    def loops(self) -> list[tuple[Part, ...]]:
        """The parts of the outline of a polygon, then the parts of each hole; a loop ends where it began."""
        loops, first = [], 0
        for number, part in enumerate(self.parts, start=1):
            if _is_same(part.end, self.parts[first].start, self):
                loops.append(self.parts[first:number])
                first = number
        return loops

    @property
    def is_moved(self) -> bool:
        """Whether a displacement other than 0 may be prescribed on the boundary: a part has a ``displacement``."""
        return any(part.displacement is not None for part in self.parts)

    @cached_property
    def measure(self) -> float:
        """The area (2D) or volume (3D) of the body, computed from its boundary as ∫ x·ν / d."""
        return float(sum(part.vector @ part.start for part in self.parts) / self.dim)

    @cached_property
    def corners(self) -> Points:
        """The corners of the body, (d, corners): vertices where the normals of the parts span R^d.

        A vertex within a straight side, at which only the boundary condition changes, is not a corner.
        """
        reach = CORNER_ROUNDING * self.extent
        turns = []
        for vertex in self.vertices.T:
            normals = [part.normal for part in self.parts if part.contains(vertex, reach)]
            turns.append(np.linalg.matrix_rank(normals, tol=1e-12) == self.dim)
        return self.vertices[:, turns]

    def of(self, kind: Kind) -> tuple[Part, ...]:
        """Return the boundary parts of one kind, in the order of ``parts``; () if there are none."""
        return tuple(part for part in self.parts if part.kind is kind)

    def contains(self, x: Points) -> NDBool:
        """Return whether points lie in Ω: (d, ...) → (...).

        A point lies in Ω if a ray from it crosses ∂Ω an odd number of times. All rays have the same direction, chosen
        so that usual boundary parts are not parallel to it.
        """
        ray = np.array([1.0, np.sqrt(2) / 17, np.sqrt(3) / 29])[: self.dim]
        inside = np.zeros(x.shape[1:], dtype=bool)
        for part in self.parts:
            s, y = part.coordinates(x)
            *along, into = part.frame.T @ ray
            if into != 0:
                far = -y / into
                reached = s + np.multiply.outer(np.array(along), far)
                inside ^= (far > 0) & part.covers(reached, 0.0)
        return inside

    def sample(self, rng: np.random.Generator, count: int) -> Points:
        """Return uniformly distributed random points of the body, (d, count)."""
        return scattered(rng, self.vertices, self.contains, count)


def _check_parts(body: Body) -> None:
    """Refuse parts of different dimensions, too few parts, gaps between parts, and inward normals."""
    if len({part.dim for part in body.parts}) > 1:
        raise BodyError(
            f"the parts have the dimensions {[part.dim for part in body.parts]}; give parts of the same dimension"
        )
    if any(part.kind is Kind.INTERFACE for part in body.parts):
        raise BodyError("an interface lies inside the body: give it as one of `interfaces`, not of the parts")
    if len(body.parts) < 3 or len(body.parts) <= body.dim:
        raise BodyError(
            "a polygon needs three boundary parts or more, a polyhedron four or more, "
            f"got {len(body.parts)} in {body.dim if body.parts else 'no'} dimensions"
        )
    if body.dim == 2:
        closing = [loop[-1] for loop in body.loops]
        for i, (part, after) in enumerate(zip(body.parts, body.parts[1:] + body.parts[:1], strict=True)):
            if part not in closing and not _is_same(part.end, after.start, body):
                ends, starts = part.end.tolist(), after.start.tolist()
                raise BodyError(f"part {i} ends at {ends} but the next starts at {starts}")
        for hole in body.loops[1:]:
            _check_hole(body, hole)
    if body.measure <= 0:
        raise BodyError(
            f"the parts enclose {'the area' if body.dim == 2 else 'the volume'} {body.measure:.6g}; "
            "list corners counter-clockwise, in 3D seen from outside"
        )


def _is_same(end: Points, start: Points, body: Body) -> bool:
    """Return whether two points are equal up to rounding errors of the size of a body."""
    return bool(abs(end - start).max() <= CORNER_ROUNDING * body.extent)


def _check_hole(body: Body, hole: tuple[Part, ...]) -> None:
    """Refuse a hole that is listed counter-clockwise, leaves the body, or meets another loop."""
    name = f"the hole that starts at {hole[0].start.tolist()}"
    if sum(part.vector @ part.start for part in hole) >= 0:
        raise BodyError(f"{name} is listed counter-clockwise: list it clockwise")
    others = [part for part in body.parts if part not in hole]
    for part in hole:
        beside = part.corners.mean(axis=1) - CORNER_ROUNDING * part.measure * part.normal
        inside = body.contains(beside[:, None]).all()
        if not inside or any(_meet(part, other) for other in others):
            raise BodyError(f"{name} does not lie inside the outline, apart from other holes: move or shrink it")


def _check_held(body: Body) -> None:
    """Refuse bodies that can move without deforming, and rollers that are not parallel to an axis.

    A rigid motion of the plane is a + b (−x_2, x_1). Rollers exclude it if the conditions at their ends determine the
    three numbers.
    """
    rollers = body.of(Kind.ROLLER)
    for part in rollers:
        if np.sort(abs(part.normal))[-2] > CORNER_ROUNDING:
            raise BodyError(
                f"the ROLLER side from {part.start.tolist()} to {part.end.tolist()} is not parallel to an axis: turn "
                "the coordinates such that all ROLLER sides are"
            )
    if body.of(Kind.CLAMPED):
        return
    conditions = [[0.0, 0.0, 0.0]]
    for part in rollers:
        for x in (part.corners.T - body.vertices[:, 0]) / body.extent:
            rotation = part.normal[1] * x[0] - part.normal[0] * x[1]
            conditions.append([*part.normal, rotation])
    if body.dim != 2 or np.linalg.matrix_rank(conditions, tol=HELD) < 3:
        raise BodyError(
            "no side of the body is CLAMPED, so it could move without deforming: give one of its sides the kind CLAMPED"
            ", or give sides in both directions the kind ROLLER"
        )


def _check_closed(body: Body) -> None:
    """Refuse parts that do not enclose a body.

    Parts that enclose a body satisfy ∫ ν = 0 and ∫ x ⊗ ν = |Ω| 1, the divergence theorem for constant and linear
    fields.
    """
    simplices = [simplex for part in body.parts for simplex in part.fan]
    vectors = [fan_vector(simplex) for simplex in simplices]
    total = np.sum(vectors, axis=0)
    moments = np.sum([np.outer(x.mean(axis=1), vector) for x, vector in zip(simplices, vectors, strict=True)], axis=0)
    beyond = abs(moments - body.measure * np.eye(body.dim)).max()
    tolerance = CORNER_ROUNDING * sum(part.measure for part in body.parts)
    if abs(total).max() > tolerance or beyond > tolerance * body.extent:
        raise BodyError(
            f"the parts do not enclose the body: ∫ν over all of them is {np.round(total, 9).tolist()} and ∫x⊗ν is "
            f"{np.round(moments, 9).tolist()}, expected 0 and |Ω| times the unit matrix; a part is missing, "
            "doubled or has its corners clockwise seen from outside"
        )


def _check_refined(body: Body, point: tuple[float, ...]) -> None:
    """Refuse a point for mesh refinement that is not a vertex of the body."""
    given = np.array(point, dtype=float)
    if (
        given.shape != (body.dim,)
        or abs(body.vertices - given[:, None]).max(axis=0).min() > CORNER_ROUNDING * body.extent
    ):
        raise BodyError(
            f"meshes cannot be refined towards {tuple(point)}, which is not one of the vertices "
            f"{[tuple(v) for v in body.vertices.T.tolist()]} of the body; list it as a vertex"
        )


def _check_interface(body: Body, interface: Part) -> None:
    """Refuse an interface that does not cut the body from boundary to boundary."""
    if interface.kind is not Kind.INTERFACE:
        raise BodyError(f"an interface has the kind {Kind.INTERFACE}, got {interface.kind}")
    if body.dim != 2 or interface.dim != 2:
        raise BodyError("interfaces are segments in a 2D body; a 3D body has none")
    tolerance = CORNER_ROUNDING * interface.measure
    for end in interface.corners.T:
        if not any(part.contains(end, tolerance) for part in body.parts):
            raise BodyError(f"the interface ends at {end.tolist()}, expected a point of the boundary")
    inner = interface.point(interface.measure * np.linspace(0, 1, 101)[None, 1:-1])
    if not body.contains(inner).all() or any(part.contains(inner, tolerance).any() for part in body.parts):
        raise BodyError(
            f"the interface from {interface.start.tolist()} to {interface.end.tolist()} leaves the body or touches "
            "its boundary between its ends; divide it there"
        )


def _meet(part: Part, other: Part) -> bool:
    """Return whether two segments cross or touch."""
    reach = CORNER_ROUNDING * part.measure
    touch = part.contains(other.corners, reach).any() or other.contains(part.corners, reach).any()
    return bool(touch) or _cross(part, other)


def _cross(part: Part, other: Part) -> bool:
    """Return whether two segments cross, that is, whether each has its ends on different sides of the other."""
    sides = [part.coordinates(other.corners)[1], other.coordinates(part.corners)[1]]
    return all(np.prod(side) < -CORNER_ROUNDING * abs(side).max() ** 2 for side in sides)


def _check_apart(interface: Part, other: Part) -> None:
    """Raise BodyError if two interfaces cross."""
    if _cross(interface, other):
        raise BodyError(
            f"the interfaces from {interface.start.tolist()} and from {other.start.tolist()} cross; "
            "they may meet on the boundary only"
        )


# Functions that make bodies: polygons, the unit square and boxes.


@checked(BodyError)
def polygon(
    vertices: Sequence[tuple[float, float]],
    kinds: Sequence[Kind],
    T: float = 1.0,
    refine: Sequence[tuple[float, float]] = (),
    interfaces: Sequence[tuple[tuple[float, float], tuple[float, float]]] = (),
    holes: Sequence[tuple[Sequence[tuple[float, float]], Sequence[Kind]]] = (),
) -> Body:
    """Return a polygon with a boundary condition on every side, perhaps with holes.

    Args:
        vertices: the vertices, counter-clockwise. If the boundary condition changes within a straight side, list the
            point as a vertex.
        kinds: the boundary condition on the side from vertex i to vertex i + 1, for every i. Each is a ``Kind`` or its
            name, such as "contact".
        T: the final time.
        refine: vertices towards which graded meshes are refined.
        interfaces: pairs of points; the material changes along the segments between them.
        holes: for each hole its vertices, clockwise, and the kinds of its sides. In ``Body.parts`` the sides of the
            holes follow the sides of the outline.

    Raises:
        BodyError: there is not one kind for each vertex, or the parts do not form a ``Body``.

    >>> sides = [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED]
    >>> polygon([(0, 0), (1, 0), (0, 1)], sides).measure
    0.5
    """
    parts: list[Part] = []
    for corners, of_sides in ((vertices, kinds), *holes):
        if len(corners) != len(of_sides):
            raise BodyError(f"{len(corners)} vertices need {len(corners)} kinds, got {len(of_sides)}")
        following = [*corners[1:], *corners[:1]]
        for kind, *ends in zip(of_sides, corners, following, strict=True):
            parts.append(Part(kind, np.transpose(ends)))
    return Body(
        tuple(parts),
        T,
        tuple(refine),
        tuple(Part(Kind.INTERFACE, np.transpose(pair)) for pair in interfaces),
    )


@checked(BodyError)
def unit_square(T: float = 1.0) -> Body:
    """Return the unit square: clamped on top, loaded on its left and right, with contact at the bottom.

    The coordinate s along the bottom is x.
    """
    return polygon([(0, 0), (1, 0), (1, 1), (0, 1)], [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED], T)


@checked(BodyError)
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
    """Return the box (0,X) × (0,Y) × (0,Z) with a boundary condition on every face.

    By default it is clamped on top and loaded on its sides, with contact at the bottom. The faces left and right are
    x = 0 and x = X, front and back y = 0 and y = Y, bottom and top z = 0 and z = Z. The coordinates (s1, s2) along a
    face are (x, y) on the bottom, (y, z) on the left, (z, x) on the front, and in reverse order on the opposite faces.

    Args:
        lengths: the lengths (X, Y, Z) of the sides.
        T: the final time.
        left, right, front, back, bottom, top: the boundary condition on each face.
    """
    parts = []
    for face, kind in enumerate((left, right, front, back, bottom, top)):
        axis, far = divmod(face, 2)
        first, second = (axis + 1) % 3, (axis + 2) % 3
        if far:
            first, second = second, first
        corners = np.zeros((3, 4))
        corners[axis] = far * lengths[axis]
        corners[second, 1:3] = lengths[second]
        corners[first, 2:4] = lengths[first]
        parts.append(Part(kind, corners))
    return Body(tuple(parts), T)

"""A body: a polygon or polyhedron with boundary parts."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from manufactured.arguments import checked
from manufactured.body.html import picture
from manufactured.body.part import ROUNDING, BodyError, Kind, NDBool, Part, fan_vector, scattered
from manufactured.tensors import Points

SLENDER = 1000.0
"""Limit of slenderness: a body is refused if (largest extent)^d divided by its area or volume exceeds this number.

The constant of Korn's inequality grows with this ratio.
"""
HELD = 1e-3
"""Rollers hold a body if their conditions, for lengths relative to its size, have singular values above this number."""


@dataclass(frozen=True, eq=False)
@checked(BodyError)
class Body:
    """A polygon or polyhedron Ω with boundary conditions on its parts, and the final time T of the problem.

    Attributes:
        parts: the parts of the boundary ∂Ω; in 2D in counter-clockwise order, each starting at the end of the previous
            part. The parts of each hole follow in clockwise order.
        T: the final time.
        refine: vertices of Ω towards which graded meshes refine, such as re-entrant corners and ends of Γ1.
        interfaces: segments of the kind ``Kind.INTERFACE`` that cut a polygon Ω from boundary to boundary. The material
            changes along them, and every mesh must contain them as edges.

    Raises:
        BodyError: there are fewer than d + 1 parts, gaps between parts, or inward normals; a rigid motion is possible,
            because there is neither a clamped part Γ1 nor rollers that exclude it (Korn's inequality (2.17) needs meas
            Γ1 > 0 or such rollers); a roller is not parallel to an axis; T ≤ 0; the body is too thin; a point of
            ``refine`` is not a vertex; or an interface does not cut Ω. A body may have no contact part Γ3: ``study
            bound`` serves it, but an ``ExactSolution`` needs Γ3.
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
        for i, interface in enumerate(self.interfaces):
            _check_interface(self, interface)
            for other in self.interfaces[:i]:
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
        same = apart <= ROUNDING * apart.max()
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
        """Whether displacements are prescribed on parts of the boundary."""
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
        reach = ROUNDING * self.extent
        turns = []
        for vertex in self.vertices.T:
            normals = [part.normal for part in self.parts if part.contains(vertex, reach)]
            turns.append(np.linalg.matrix_rank(normals, tol=1e-12) == self.dim)
        return self.vertices[:, turns]

    def of(self, kind: Kind) -> tuple[Part, ...]:
        """Return the boundary parts of one kind: clamped, loaded or contact."""
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

    def _repr_html_(self) -> str:
        """Return HTML for notebooks: a picture with the boundary parts, and the final time."""
        return f"{picture((*self.parts, *self.interfaces))}<p>T = {self.T:g}</p>"


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
    return bool(abs(end - start).max() <= ROUNDING * body.extent)


def _check_hole(body: Body, hole: tuple[Part, ...]) -> None:
    """Refuse a hole that is listed counter-clockwise, leaves the body, or meets another loop."""
    name = f"the hole that starts at {hole[0].start.tolist()}"
    if sum(part.vector @ part.start for part in hole) >= 0:
        raise BodyError(f"{name} is listed counter-clockwise: list it clockwise")
    others = [part for part in body.parts if part not in hole]
    for part in hole:
        beside = part.corners.mean(axis=1) - ROUNDING * part.measure * part.normal
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
        if np.sort(abs(part.normal))[-2] > ROUNDING:
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
    tolerance = ROUNDING * sum(part.measure for part in body.parts)
    if abs(total).max() > tolerance or beyond > tolerance * body.extent:
        raise BodyError(
            f"the parts do not enclose the body: ∫ν over all of them is {np.round(total, 9).tolist()} and ∫x⊗ν is "
            f"{np.round(moments, 9).tolist()}, expected 0 and |Ω| times the unit matrix; a part is missing, "
            "doubled or has its corners clockwise seen from outside"
        )


def _check_refined(body: Body, point: tuple[float, ...]) -> None:
    """Refuse a point for mesh refinement that is not a vertex of the body."""
    given = np.array(point, dtype=float)
    if given.shape != (body.dim,) or abs(body.vertices - given[:, None]).max(axis=0).min() > ROUNDING * body.extent:
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
    tolerance = ROUNDING * interface.measure
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
    reach = ROUNDING * part.measure
    touch = part.contains(other.corners, reach).any() or other.contains(part.corners, reach).any()
    return bool(touch) or _cross(part, other)


def _cross(part: Part, other: Part) -> bool:
    """Return whether two segments cross, that is, whether each has its ends on different sides of the other."""
    sides = [part.coordinates(other.corners)[1], other.coordinates(part.corners)[1]]
    return all(np.prod(side) < -ROUNDING * abs(side).max() ** 2 for side in sides)


def _check_apart(interface: Part, other: Part) -> None:
    """Raise BodyError if two interfaces cross."""
    if _cross(interface, other):
        raise BodyError(
            f"the interfaces from {interface.start.tolist()} and from {other.start.tolist()} cross; "
            "they may meet on the boundary only"
        )

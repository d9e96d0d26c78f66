"""Functions that make bodies: polygons, the unit square and boxes."""

from collections.abc import Sequence

import numpy as np

from manufactured.arguments import checked
from manufactured.body.domain import Body
from manufactured.body.part import BodyError, Kind, Part


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
        holes: for each hole its vertices, clockwise, and the kinds of its sides. The numbers of its sides follow those
            of the sides before.

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

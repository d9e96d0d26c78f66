"""A flat part of the boundary of a body, or an interface inside it.

Formulas that hold in 2D and in 3D use the vector |S| ν of a part S: its length or area times its outward normal. S is
divided into the simplices (c_0, c_i, …, c_{i+d−2}) that share its first corner c_0 (a fan). Then

    |S| ν = Σ_i a_i/(d−1)!,   where the vector a_i is given by a_i·x = det [x, c_i − c_0, …].
"""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from math import factorial

import numpy as np
from numpy.typing import NDArray

from manufactured.arguments import checked
from manufactured.tensors import Array, Hyperplane, Points, mapped

NDBool = NDArray[np.bool_]

ROUNDING = 1e-9
"""Relative distance below which two points count as equal, and below which corners count as lying in one plane."""


class BodyError(ValueError):
    """Raised if a body or its boundary parts do not fit the contact problem."""


class Kind(Enum):
    """The role of a part: clamped (2.3), loaded (2.4), contact (2.5), or an interface between two materials.

    A roller, for example a line of symmetry, has no normal displacement and no tangential traction; it is not part of
    the paper, and `study bound` serves it.
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
        """The first corner, (d,), which is the origin of the coordinate s."""
        return self.corners[:, 0]

    @property
    def end(self) -> Array:
        """The last corner, (d,), which lies on the first axis of the coordinates s."""
        return self.corners[:, -1]

    def line(self, c: float) -> Hyperplane:
        """Return (direction, offset) of the line direction·x = offset that is perpendicular to the segment at s = c."""
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
        """The unit vector from the first corner to the last one, which is the first axis of s, (d,)."""
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
        """Return for local coordinates s whether the point lies on the part or its boundary: (d−1, ...) → (...)."""
        normals, offsets = self.sides
        beyond = np.moveaxis(mapped(normals.T, s), 0, -1) - offsets
        return np.asarray((beyond <= tolerance).all(axis=-1))

    def contains(self, x: Points, tolerance: float) -> NDBool:
        """Return whether points lie on the part or its boundary, up to a distance ``tolerance``: (d, ...) → (...)."""
        s, y = self.coordinates(x)
        return (abs(y) <= tolerance) & self.covers(s, tolerance)

    def prescribed(self, x: Points) -> Points:
        """Return the prescribed displacement at points of the segment, (d, n) → (d, n)."""
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
    """Return the length or area of a simplex with corners (d, d), times its normal.

    The normal points outwards if the corners are ordered as in ``Part``.
    """
    dim = len(simplex)
    edges = simplex[:, 1:] - simplex[:, :1]
    cofactors = [np.linalg.det(np.column_stack([unit, edges])) for unit in np.eye(dim)]
    return np.array(cofactors) / factorial(dim - 1)


def scattered(rng: np.random.Generator, corners: Points, inside: Callable[[Points], NDBool], count: int) -> Points:
    """Return uniformly distributed random points of a set in R^k, (k, count).

    Args:
        rng: the random number generator.
        corners: the corners of the set, (k, c). Points are drawn from the smallest box that contains them.
        inside: function that returns whether points lie in the set.
        count: the number of points.
    """
    low, high = corners.min(axis=1), corners.max(axis=1)
    points = np.empty((len(corners), 0))
    while points.shape[1] < count:
        trial = rng.uniform(low[:, None], high[:, None], (len(corners), 2 * count))
        points = np.hstack([points, trial[:, inside(trial)]])
    return points[:, :count]

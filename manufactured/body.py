"""The body Ω, its boundary parts Γ1, Γ2, Γ3 = ∪ Γ3,i and the time interval [0, T]."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from manufactured.tensors import Array, Points

NDBool = NDArray[np.bool_]


class BodyError(ValueError):
    """A body or its boundary parts are not what the problem needs."""


class Kind(Enum):
    """The boundary condition a part carries: (2.3), (2.4) or (2.5)."""

    CLAMPED = "Γ1"
    LOADED = "Γ2"
    CONTACT = "Γ3"


@dataclass(frozen=True, eq=False)
class Part:
    """A straight piece of ∂Ω with one boundary condition.

    Attributes:
        kind: the condition.
        start, end: its end points, (d,); Ω lies to the left of start → end.
    """

    kind: Kind
    start: Array
    end: Array

    @property
    def length(self) -> float:
        return float(np.linalg.norm(self.end - self.start))

    @cached_property
    def tangent(self) -> Array:
        """Unit vector from start to end, (d,)."""
        return (self.end - self.start) / self.length

    @cached_property
    def normal(self) -> Array:
        """ν, the unit **outward** normal, (d,)."""
        return np.array([self.tangent[1], -self.tangent[0]])

    @cached_property
    def frame(self) -> Array:
        """Orthonormal columns (tangent, inward normal −ν), (d, d): local axes (s, y) of the lifting."""
        return np.column_stack([self.tangent, -self.normal])

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

    def contains(self, x: Points, tolerance: float) -> NDBool:
        """Whether points lie on the closed part: (d, ...) → (...)."""
        s, y = self.coordinates(x)
        return (abs(y) <= tolerance) & (s[0] >= -tolerance) & (s[0] <= self.length + tolerance)

    def sample(self, rng: np.random.Generator, count: int) -> Points:
        """Random points of the open part, (d, count)."""
        return self.point(rng.uniform(0, self.length, (1, count)))


@dataclass(frozen=True, eq=False)
class Body:
    """A polygon Ω with boundary parts, and the final time T.

    Attributes:
        parts: the pieces of ∂Ω in counter-clockwise order, each starting where the last one ends.
        T: final time.

    Raises:
        BodyError: fewer than three parts, gaps between them, clockwise order, no Γ1 (Korn's
            inequality (2.17) needs meas Γ1 > 0), no Γ3, or T ≤ 0.
    """

    parts: tuple[Part, ...]
    T: float = 1.0

    def __post_init__(self) -> None:
        if not all(np.isfinite([*part.start, *part.end]).all() for part in self.parts):
            raise BodyError("a vertex of the body is not a finite number")
        if any(part.length == 0 for part in self.parts):
            raise BodyError("a boundary part has length 0; list every vertex once")
        if len(self.parts) < 3:
            raise BodyError(f"a polygon needs three boundary parts or more, got {len(self.parts)}")
        for i, (part, after) in enumerate(zip(self.parts, self.parts[1:] + self.parts[:1], strict=True)):
            if not np.allclose(part.end, after.start):
                raise BodyError(f"part {i} ends at {part.end.tolist()} but the next starts at {after.start.tolist()}")
        if self.area <= 0:
            raise BodyError(f"the parts enclose the area {self.area:.6g}; list them counter-clockwise")
        for kind, why in ((Kind.CLAMPED, "Korn's inequality (2.17)"), (Kind.CONTACT, "the Signorini condition (2.5)")):
            if not any(part.kind is kind for part in self.parts):
                raise BodyError(f"the body has no part {kind.value}, which {why} needs")
        if not (np.isfinite(self.T) and self.T > 0):
            raise BodyError(f"the final time must be positive, got T = {self.T}")

    @property
    def dim(self) -> int:
        return 2

    @cached_property
    def vertices(self) -> Points:
        """Starts of the parts, (d, number of parts)."""
        return np.column_stack([part.start for part in self.parts])

    @cached_property
    def area(self) -> float:
        x, y = self.vertices
        return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) / 2)

    @cached_property
    def corners(self) -> Points:
        """Vertices at which the boundary changes direction, (d, number of corners)."""
        before = self.parts[-1:] + self.parts[:-1]
        turns = [
            abs(np.cross(np.append(a.tangent, 0), np.append(b.tangent, 0))[2]) > 1e-12
            for a, b in zip(before, self.parts, strict=True)
        ]
        return self.vertices[:, turns]

    def of(self, kind: Kind) -> tuple[Part, ...]:
        """The parts that carry a condition."""
        return tuple(part for part in self.parts if part.kind is kind)

    def contains(self, x: Points) -> NDBool:
        """Whether points lie in Ω, by the crossing number: (2, ...) → (...)."""
        inside = np.zeros(x.shape[1:], dtype=bool)
        for part in self.parts:
            (ax, ay), (bx, by) = part.start, part.end
            if ay != by:
                crosses = (ay > x[1]) != (by > x[1])
                inside ^= crosses & (x[0] < ax + (x[1] - ay) * (bx - ax) / (by - ay))
        return inside

    def sample(self, rng: np.random.Generator, count: int) -> Points:
        """Random points of Ω, (d, count)."""
        low, high = self.vertices.min(axis=1), self.vertices.max(axis=1)
        points = np.empty((2, 0))
        while points.shape[1] < count:
            trial = rng.uniform(low[:, None], high[:, None], (2, 2 * count))
            points = np.hstack([points, trial[:, self.contains(trial)]])
        return points[:, :count]


def polygon(vertices: Sequence[tuple[float, float]], kinds: Sequence[Kind], T: float = 1.0) -> Body:
    """The polygon with the given counter-clockwise vertices; ``kinds[i]`` holds from vertex i to i+1.

    A boundary condition may change within a side: list the point as a vertex.
    """
    if len(vertices) != len(kinds):
        raise BodyError(f"{len(vertices)} vertices need {len(vertices)} kinds, got {len(kinds)}")
    ends = [np.array(v, dtype=float) for v in vertices]
    return Body(tuple(Part(k, a, b) for k, a, b in zip(kinds, ends, ends[1:] + ends[:1], strict=True)), T)


def unit_square(T: float = 1.0) -> Body:
    """(0,1)²: clamped on top, loaded on both sides, Γ3 the bottom with s = x."""
    return polygon([(0, 0), (1, 0), (1, 1), (0, 1)], [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED], T)

"""A polygon or polyhedron with boundary parts."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from manufactured.body.domain_checks import check
from manufactured.body.part import ROUNDING, Kind, NDBool, Part, scattered
from manufactured.tensors import Points


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
    refine: tuple[tuple[float, ...], ...] = ()
    interfaces: tuple[Part, ...] = ()

    def __post_init__(self) -> None:
        check(self)

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
        return scattered(rng, self.vertices, self.contains, count)

"""Gap and contact pressure on the faces of Γ3 over time, computed and exact."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from study.ledger.facets import Facets
from study.ledger.packing import Packed

Array = NDArray[np.float64]
CONTACT = 1e-8
"""A node counts as in contact where its pressure exceeds this fraction of the largest pressure on the face."""


@dataclass(frozen=True, eq=False)
class FaceHistory:
    """What the plane and space have in common.

    Attributes:
        number: i of Γ3,i.
        normal: ν, outward, (d,).
        s: coordinates of the nodes on the face, (nodes,) in the plane and (2, nodes) in space.
        x: the nodes, (d, nodes).
        gap, gap_exact: −u_ν, (times, nodes).
        pressure, pressure_exact: −σ_ν, (times, nodes).
    """

    number: int
    normal: Array
    s: Array
    x: Array
    gap: Array
    gap_exact: Array
    pressure: Array
    pressure_exact: Array

    @property
    def contact_threshold(self) -> float:
        """A node with a larger pressure is in contact."""
        return CONTACT * float(self.pressure.max(initial=0.0))

    @property
    def touching(self) -> NDArray[np.bool_]:
        """When which nodes are in contact, (times, nodes)."""
        return np.asarray(self.pressure > self.contact_threshold)


def common_fields(record: Mapping[str, Any]) -> dict[str, Any]:
    """The attributes of ``FaceHistory`` from one entry of ``faces``."""
    names = [field.name for field in fields(FaceHistory)]
    return {"number": int(record["face"])} | {name: values(record[name]) for name in names if name != "number"}


def values(entry: Any) -> Array:
    """Numbers that are packed, or written as they are."""
    return Packed.read(entry).values if isinstance(entry, Mapping) else np.array(entry, dtype=float)


@dataclass(frozen=True, eq=False)
class Segment(FaceHistory):
    """A face of Γ3 in the plane.

    Attributes:
        zone_times: times at which the exact contact zone is known.
        zone: at each of them, the intervals [s0, s1] of the exact zone.
        line: positions at which exact values are known between the nodes, too, (points,).
        line_gap, line_pressure: these values, (times, points).
    """

    zone_times: Array
    zone: list[list[tuple[float, float]]]
    line: Array
    line_gap: Array
    line_pressure: Array

    @classmethod
    def of(cls, record: Mapping[str, Any]) -> Segment:
        """From one entry of ``faces``."""
        zone, line = record["zone_exact"], record["line"]
        return cls(
            **common_fields(record),
            zone_times=np.array(zone["times"], dtype=float),
            zone=[[(float(a), float(b)) for a, b in intervals] for intervals in zone["intervals"]],
            line=np.array(line["s"], dtype=float),
            line_gap=Packed.read(line["gap"]).values,
            line_pressure=Packed.read(line["pressure"]).values,
        )

    @property
    def spacing(self) -> float:
        """The mean distance of neighbouring nodes, the length of a cell."""
        return float(np.ptp(self.s)) / (len(self.s) - 1)

    def computed_zone(self, instant: int) -> list[tuple[float, float]]:
        """The part of the face whose nearest node is in contact: intervals between midpoints of nodes."""
        middle = (self.s[1:] + self.s[:-1]) / 2
        ends = np.concatenate([self.s[:1], middle, self.s[-1:]])
        change = np.flatnonzero(np.diff(self.touching[instant], prepend=False, append=False))
        return [(float(ends[a]), float(ends[b])) for a, b in zip(change[::2], change[1::2], strict=True)]

    def point(self, s: Array) -> Array:
        """The points at positions s, (2, ...)."""
        return np.array([np.interp(s, self.s, component) for component in self.x])


@dataclass(frozen=True, eq=False)
class Polygon(FaceHistory):
    """A face of Γ3 in space.

    Attributes:
        facets: the triangles between its nodes; those with a corner on Γ1, which is no node, are left out.
        nodes: which of the vertices of the picture the nodes are, (nodes,).
        level: ψ at the nodes and at the midpoints between them, (times, nodes + edges): the exact zone is {ψ ≥ 0}.
    """

    facets: Facets
    nodes: NDArray[np.int64]
    level: Array

    @classmethod
    def of(cls, record: Mapping[str, Any], cells: NDArray[np.int64]) -> Polygon:
        """From one entry of ``faces`` and the cells of the picture."""
        nodes = np.array(record["nodes"], dtype=np.int64)
        level = values(record["level_exact"])
        return cls(**common_fields(record), facets=Facets.between(nodes, cells), nodes=nodes, level=level)

    @property
    def inside(self) -> NDArray[np.bool_]:
        """When which nodes are in the exact zone, (times, nodes)."""
        return np.asarray(self.level[:, : len(self.nodes)] >= 0)

"""A face of Γ3 in the plane: a line segment with positions s along it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from study.ledger.packing import Packed
from study.present.picture.face_history import Array, FaceHistory, common_fields


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

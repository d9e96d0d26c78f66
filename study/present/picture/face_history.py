"""Gap and contact pressure on one face of Γ3 over time, computed and exact."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

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

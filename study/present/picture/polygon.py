"""A face of Γ3 in space: a plane polygon that the triangles of the mesh cover."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from study.ledger.facets import Facets
from study.present.picture.face_history import Array, FaceHistory, common_fields, values


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

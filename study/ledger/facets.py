"""The triangles of a contact face in space, numbered alike by what writes its data file and by what reads it.

A file lists the nodes of the face; the level function ψ of its exact contact zone is stored at these and at the
midpoints of the edges between them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Facets:
    """Those triangles of a surface all of whose corners are nodes of the face.

    Attributes:
        cells: their indices among the triangles of the surface, (k,).
        corners: indices into the nodes, (3, k).
        edges: the two ends of each edge, the lower first, in lexicographic order, (2, e).
        quarters: the four triangles into which the midpoints of its edges divide each of them, (3, 4k); midpoint i has
            the index (number of nodes) + i.
    """

    cells: Numbers
    corners: Numbers
    edges: Numbers
    quarters: Numbers

    @classmethod
    def between(cls, nodes: Numbers, surface: Numbers) -> Facets:
        """From the vertices that are nodes, (n,), and the triangles of the surface, (3, m)."""
        number = np.full(surface.max() + 1, -1)
        number[nodes] = np.arange(len(nodes))
        cells = np.flatnonzero((number[surface] >= 0).all(axis=0))
        a, b, c = corners = number[surface[:, cells]]
        pairs = np.sort([[*b, *c, *a], [*c, *a, *b]], axis=0)
        edges, opposite = np.unique(pairs, axis=1, return_inverse=True)
        p, q, r = len(nodes) + opposite.reshape(3, -1)
        return cls(cells, corners, edges, np.hstack([[a, r, q], [b, p, r], [c, q, p], [p, q, r]]))

    def refined(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values at the nodes followed by their means at the midpoints of edges, (..., n) → (..., n + e)."""
        return np.concatenate([values, values[..., self.edges].mean(axis=-2)], axis=-1)

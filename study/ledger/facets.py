"""The triangles of a surface whose corners are all among given nodes, and their division into quarters."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Facets:
    """Triangles of a surface with all corners among the nodes.

    Attributes:
        cells: their numbers in the surface, (k,).
        corners: their corners as positions in the list of nodes, (3, k).
        edges: the two ends of each edge, the lower first, in lexicographic order, (2, e).
        quarters: the triangles into which the midpoints of edges divide them, (3, 4k); midpoints come after the nodes.
    """

    cells: Numbers
    corners: Numbers
    edges: Numbers
    quarters: Numbers

    @classmethod
    def between(cls, nodes: Numbers, surface: Numbers) -> Facets:
        """From nodes, (n,), and the triangles of a surface, (3, m), both numbers of vertices."""
        number = np.full(surface.max() + 1, -1)
        number[nodes] = np.arange(len(nodes))
        cells = np.flatnonzero((number[surface] >= 0).all(axis=0))
        a, b, c = corners = number[surface[:, cells]]
        pairs = np.sort([[*b, *c, *a], [*c, *a, *b]], axis=0)
        edges, opposite = np.unique(pairs, axis=1, return_inverse=True)
        p, q, r = len(nodes) + opposite.reshape(3, -1)
        return cls(cells, corners, edges, np.hstack([[a, r, q], [b, p, r], [c, q, p], [p, q, r]]))

    def refined(self, values: NDArray[Any]) -> NDArray[Any]:
        """Values of P1 functions at the nodes, then at the midpoints, (..., n) → (..., n + e)."""
        return np.concatenate([values, values[..., self.edges].mean(axis=-2)], axis=-1)

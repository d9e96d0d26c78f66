"""What a quadrature rule on cells or on facets consists of."""

from __future__ import annotations

from dataclasses import dataclass

from manufactured.tensors import Array, Points


@dataclass(frozen=True, eq=False)
class CellRule:
    """Quadrature on some cells with the same number of points each.

    Attributes:
        cells: indices (n,).
        points: (d, n, q).
        weights: (n, q), summing to |T| over q.
    """

    cells: Array
    points: Points
    weights: Array


@dataclass(frozen=True, eq=False)
class FacetRule:
    """Quadrature on the facets of one part.

    Attributes:
        facets: indices (n,).
        s: local coordinates of the points along the part, (d−1, n, q).
        shapes: values of the P1 functions of the facet's vertices, (d, n, q).
        weights: (n, q).
    """

    facets: Array
    s: Array
    shapes: Array
    weights: Array

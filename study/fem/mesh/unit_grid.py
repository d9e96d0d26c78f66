"""The grid of n^d cubes on the unit cube, and its division into simplices."""

from __future__ import annotations

from itertools import permutations

import numpy as np

from manufactured.tensors import Array, Points


def vertices(n: int, dim: int) -> Points:
    """Vertices of the grid, the first axis fastest, (d, (n+1)^d)."""
    return np.array([x.ravel("F") for x in np.meshgrid(*[np.linspace(0, 1, n + 1)] * dim, indexing="ij")])


def lowest_corners(n: int, dim: int) -> Array:
    """The numbers of the vertices at the lowest corners of the cubes, the first axis fastest, (n^d,)."""
    steps = (n + 1) ** np.arange(dim)
    return sum(step * i.ravel("F") for step, i in zip(steps, np.indices((n,) * dim), strict=True))


def kuhn(n: int, dim: int) -> Array:
    """Positively oriented simplices of the grid, (d+1, d! n^d): paths from corner to corner along the axes.

    Source: H. W. Kuhn, Some combinatorial lemmas in topology, IBM J. Res. Dev. 4 (1960) 518–524.
    """
    first, steps = lowest_corners(n, dim), (n + 1) ** np.arange(dim)
    cells = []
    for order in permutations(range(dim)):
        path = np.concatenate([[0], np.cumsum(steps[list(order)])])
        if np.linalg.det(np.eye(dim)[list(order)]) < 0:
            path[[-2, -1]] = path[[-1, -2]]
        cells.append(first + path[:, None])
    return np.hstack(cells)

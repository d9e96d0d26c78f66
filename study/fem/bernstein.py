"""Quadratic Bernstein polynomials on a triangle: λ_i² for the vertices, then 2 λ_a λ_b for the edges."""

from __future__ import annotations

import numpy as np

from manufactured.tensors import Array

EDGES = ((0, 1), (1, 2), (0, 2))
"""The vertices of the edges of a cell, in the order of the mesh."""


def values(barycentric: Array) -> Array:
    """The six polynomials at points (3, q), (6, q)."""
    return np.array([*(x * x for x in barycentric), *(2 * barycentric[a] * barycentric[b] for a, b in EDGES)])


def gradients(barycentric: Array, slopes: Array) -> Array:
    """Their gradients at the same points (3, q) of every cell, from ∇λ_i (cells, 3, 2): (q, cells, 6, 2)."""
    outer = np.multiply.outer
    return np.stack(
        [
            *(2 * outer(barycentric[i], slopes[:, i]) for i in range(3)),
            *(2 * (outer(barycentric[a], slopes[:, b]) + outer(barycentric[b], slopes[:, a])) for a, b in EDGES),
        ],
        axis=2,
    )

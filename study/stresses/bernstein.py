"""The Bernstein polynomials B_α(λ) = |α|!/α! λ^α in barycentric coordinates λ, and their mass matrices."""

from __future__ import annotations

from math import factorial, prod

import numpy as np

from manufactured.tensors import Array
from study.fem.quadrature import simplex_rule


def indices(degree: int, variables: int = 3) -> list[tuple[int, ...]]:
    """Return the multi-indices α ≥ 0 with |α| = degree, in descending lexicographic order."""
    if variables == 1:
        return [(degree,)]
    return [(first, *rest) for first in range(degree, -1, -1) for rest in indices(degree - first, variables - 1)]


def bernstein(degree: int, barycentric: Array) -> Array:
    """Return the Bernstein polynomials at barycentric coordinates, (v, ...) → (polynomials, ...), as in ``indices``."""
    return np.array(
        [
            factorial(degree)
            / prod(map(factorial, alpha))
            * prod(x**a for x, a in zip(barycentric, alpha, strict=True))
            for alpha in indices(degree, len(barycentric))
        ]
    )


def interval_mass(degree: int, other: int) -> Array:
    """Return the integrals ∫_0^1 B_i B_j of Bernstein polynomials of two degrees, (degree + 1, other + 1)."""
    x, w = np.polynomial.legendre.leggauss((degree + other) // 2 + 1)
    first, second = (bernstein(k, np.array([1 - x, 1 + x]) / 2) for k in (degree, other))
    return (first * w / 2) @ second.T


def triangle_mass(degree: int) -> Array:
    """Return the means of the products B_α B_β on a triangle, (polynomials, polynomials)."""
    barycentric, weights = simplex_rule(2, 2 * degree)
    at = bernstein(degree, barycentric)
    return (at * weights) @ at.T

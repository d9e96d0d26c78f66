"""The Sobolev–Slobodeckij seminorm on intervals, |v|_ϱ² = ∬ |v(x) − v(y)|² |x − y|^{−1−2ϱ} dx dy, 0 < ϱ < 1."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from manufactured.tensors import Array
from study.fem.quadrature import gauss

PANELS, POINTS = 64, 3
"""Equal panels of (0, 1), and Gauss points in each; the second variable has one more, so that no points coincide."""


def composite_gauss(panels: int, points: int) -> tuple[Array, Array]:
    """Return Gauss's rule on equal panels of (0, 1): nodes and weights, (panels · points,)."""
    x, w = gauss(points)
    return ((np.arange(panels)[:, None] + x) / panels).ravel(), np.tile(w / panels, panels)


FIRST, SECOND = composite_gauss(PANELS, POINTS), composite_gauss(PANELS, POINTS + 1)
"""The rules for both variables."""


def seminorm(first: Array, second: Array, rho: float) -> Array:
    """Return the seminorm |v|_ϱ on (0, 1) for values at the nodes of ``FIRST`` (..., n) and of ``SECOND`` (..., m) →
    (...).

    For a Lipschitz v and ϱ ≤ 1/2 the integrand is bounded, and the error is a few per mille if v has ten details.
    """
    (x, wx), (y, wy) = FIRST, SECOND
    kernel = np.multiply.outer(wx, wy) * abs(x[:, None] - y) ** (-1 - 2 * rho)
    squares = first**2 @ kernel.sum(axis=1) + second**2 @ kernel.sum(axis=0)
    return np.sqrt(np.maximum(squares - 2 * np.einsum("...i,ij,...j->...", first, kernel, second, optimize=True), 0.0))


@lru_cache
def gram(panels: int, rho: float) -> Array:
    """Return the matrix of |v|_ϱ² for the hat functions of equal panels of (0, 1), (panels + 1, panels + 1)."""
    nodes = np.linspace(0, 1, panels + 1)
    (x, wx), (y, wy) = composite_gauss(panels, POINTS), composite_gauss(panels, POINTS + 1)
    hats = [np.maximum(0, 1 - panels * abs(nodes[:, None] - z)) for z in (x, y)]
    kernel = np.multiply.outer(wx, wy) * abs(x[:, None] - y) ** (-1 - 2 * rho)
    mixed = hats[0] @ kernel @ hats[1].T
    squares = [(hat * weights) @ hat.T for hat, weights in zip(hats, (kernel.sum(1), kernel.sum(0)), strict=True)]
    found: Array = squares[0] + squares[1] - mixed - mixed.T
    return found

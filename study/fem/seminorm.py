"""The Sobolev–Slobodeckij seminorm |v|_ϱ of a function v on an interval, for 0 < ϱ < 1:

v|_ϱ² = ∬ |v(x) − v(y)|² |x − y|^{−1−2ϱ} dx dy.
"""

from functools import lru_cache

import numpy as np

from manufactured.tensors import Array
from study.fem.quadrature import PointsAndWeights, gauss

PANELS, POINTS = 64, 3
"""The quadrature of the double integral: number of equal panels of (0, 1), and number of Gauss points in each panel.

The rule in y has one more point in each panel than the rule in x, so that x = y does not occur.
"""


def composite_gauss(panels: int, points: int) -> PointsAndWeights:
    """Return nodes and weights of the Gauss rule repeated on equal panels of (0, 1), (panels · points,) each."""
    x, w = gauss(points)
    return ((np.arange(panels)[:, None] + x) / panels).ravel(), np.tile(w / panels, panels)


FIRST, SECOND = composite_gauss(PANELS, POINTS), composite_gauss(PANELS, POINTS + 1)
"""The quadrature rules of the double integral, in x and in y."""


def _kernel(first: PointsAndWeights, second: PointsAndWeights, rho: float) -> Array:
    """Return the products of the weights of two quadrature rules with |x − y|^{−1−2ϱ} at all pairs of nodes, (n, m)."""
    (x, wx), (y, wy) = first, second
    return np.asarray(np.multiply.outer(wx, wy) * abs(x[:, None] - y) ** (-1 - 2 * rho))


def seminorm(first: Array, second: Array, rho: float) -> Array:
    """Return the Sobolev–Slobodeckij seminorm |v|_ϱ of functions v on (0, 1), (...).

    For a Lipschitz v and ϱ ≤ 1/2 the integrand is bounded. The relative error is a few per mille if v has about ten
    oscillations.

    Args:
        first: the values of v at the nodes of ``FIRST``, (..., n).
        second: the values of v at the nodes of ``SECOND``, (..., m).
        rho: the order ϱ.
    """
    kernel = _kernel(FIRST, SECOND, rho)
    squares = first**2 @ kernel.sum(axis=1) + second**2 @ kernel.sum(axis=0)
    return np.sqrt(np.maximum(squares - 2 * np.einsum("...i,ij,...j->...", first, kernel, second, optimize=True), 0.0))


@lru_cache
def gram(panels: int, rho: float) -> Array:
    """Return the matrix G with |v|_ϱ² = cᵀ G c for piecewise linear functions v on equal panels of (0, 1).

    Args:
        panels: the number n of panels; c contains the values of v at their n + 1 ends, so G is (n + 1, n + 1).
        rho: the order ϱ of the Sobolev–Slobodeckij seminorm.
    """
    nodes = np.linspace(0, 1, panels + 1)
    rules = composite_gauss(panels, POINTS), composite_gauss(panels, POINTS + 1)
    hats = [np.maximum(0, 1 - panels * abs(nodes[:, None] - x)) for x, _ in rules]
    kernel = _kernel(*rules, rho)
    mixed = hats[0] @ kernel @ hats[1].T
    squares = [(hat * weights) @ hat.T for hat, weights in zip(hats, (kernel.sum(1), kernel.sum(0)), strict=True)]
    found: Array = squares[0] + squares[1] - mixed - mixed.T
    return found

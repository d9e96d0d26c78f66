"""Gauss's quadrature rule on the panels of an interval."""

import numpy as np

from manufactured.tensors import Array


def composite_gauss(ends: Array, points: int) -> tuple[Array, Array]:
    """Return nodes and weights of Gauss's rule on every panel of an interval, (panels · points,) each.

    Args:
        ends: the increasing ends of the panels, (panels + 1,).
        points: the number of Gauss points on each panel.
    """
    x, w = np.polynomial.legendre.leggauss(points)
    half = np.diff(ends)[:, None] / 2
    return (ends[:-1, None] + half * (1 + x)).ravel(), (half * w).ravel()

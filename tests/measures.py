"""How close arrays are, how thin triangles, and Gauss's rule."""

import numpy as np


def close(found, expected, tolerance):
    """Whether arrays differ by at most a part of the largest absolute value that is expected."""
    return abs(found - expected).max() <= tolerance * abs(expected).max()


def smallest_angle(corners):
    """The smallest angle of triangles (2, 3, n)."""
    sides = np.roll(corners, -1, axis=1) - corners
    unit = sides / np.linalg.norm(sides, axis=0)
    return np.arccos((-unit * np.roll(unit, 1, axis=1)).sum(axis=0)).min()


def gauss(n):
    """The points and weights of Gauss's rule on [0, 1]."""
    x, weights = np.polynomial.legendre.leggauss(n)
    return (1 + x) / 2, weights / 2

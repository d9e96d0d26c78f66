"""How close arrays are, and how thin triangles."""

import numpy as np


def close(found, expected, tolerance):
    """Whether arrays differ by at most a part of the largest absolute value that is expected."""
    return abs(found - expected).max() <= tolerance * abs(expected).max()


def smallest_angle(corners):
    """The smallest angle of triangles (2, 3, n)."""
    sides = np.roll(corners, -1, axis=1) - corners
    unit = sides / np.linalg.norm(sides, axis=0)
    return np.arccos((-unit * np.roll(unit, 1, axis=1)).sum(axis=0)).min()

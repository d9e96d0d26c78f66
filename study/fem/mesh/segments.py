"""Distances of points to a segment."""

from __future__ import annotations

import numpy as np

from manufactured.tensors import Array, Points


def nearest(points: Points, segment: Array) -> Array:
    """Where on a segment (d, 2), from 0 at its start to 1 at its end, the nearest points to others (d, n) lie, (n,)."""
    along = segment[:, 1] - segment[:, 0]
    return np.clip(along @ (points - segment[:, :1]) / (along @ along), 0, 1)


def distance(points: Points, segment: Array) -> Array:
    """Distances of points (d, n) to a segment (d, 2), (n,)."""
    foot = segment[:, :1] + np.multiply.outer(segment[:, 1] - segment[:, 0], nearest(points, segment))
    return np.linalg.norm(points - foot, axis=0)


def on_segment(points: Points, segment: Array) -> Array:
    """Whether points (d, n) lie on a segment (d, 2) up to rounding, (n,)."""
    return distance(points, segment) <= 1e-9 * np.linalg.norm(segment[:, 1] - segment[:, 0])

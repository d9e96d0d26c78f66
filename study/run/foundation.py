"""A rigid foundation as a meshed body, for codes that know contact between two bodies only."""

from __future__ import annotations

from typing import Any

import numpy as np

from manufactured.tensors import Array
from study.ledger.errors import UsageError

MARGIN, DEPTH = 0.25, 0.25
"""By how much a slab is longer than its face at each end, and how thick it is, relative to the length of the face."""


def require_segments(segments: int, dim: int) -> None:
    """Raise UsageError for a foundation in space, or of fewer than one segment."""
    if dim != 2:
        raise UsageError("--foundation meshes foundations in the plane only; leave it out for a body in space")
    if segments < 1:
        raise UsageError(f"--foundation must be 1 or more, got {segments}")


def slab(face: Array, normal: Array, segments: int) -> dict[str, Any]:
    """Two triangles for each of so many equal segments below a straight face.

    Args:
        face: vertices of the face, (n, 2).
        normal: ν, out of the body and into the slab, (2,).
        segments: of the side that touches the body, with its margins.

    Raises:
        UsageError: in space, or fewer than one segment.
    """
    require_segments(segments, face.shape[1])
    # With the body below, the axes (along, −ν) are right-handed.
    along = np.array([-normal[1], normal[0]])
    s = face @ along
    length = float(np.ptp(s))
    origin = face[s.argmin()] - MARGIN * length * along
    steps = np.linspace(0, (1 + 2 * MARGIN) * length, segments + 1)
    near = origin + np.multiply.outer(steps, along)
    first = np.arange(segments)
    far, count = near + DEPTH * length * normal, segments + 1
    lower = np.stack([first, first + 1, first + count + 1], axis=1)
    upper = np.stack([first, first + count + 1, first + count], axis=1)
    cells = np.concatenate([lower, upper])
    corners = np.concatenate([near, far])[cells]
    turned = np.linalg.det(corners[:, 1:] - corners[:, :1]) < 0
    cells[turned] = cells[turned][:, [0, 2, 1]]
    return {
        "vertices": np.concatenate([near, far]),
        "cells": cells,
        "facets": np.stack([first, first + 1], axis=1),
    }

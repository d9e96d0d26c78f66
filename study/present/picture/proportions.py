"""How large displacements, pressures and the foundation are drawn, as fractions of the body's longest side."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from study.present.picture.face_history import Array

DISPLACEMENT = 0.12
"""The largest displacement."""
ARROW = 0.2
"""The arrow of the largest pressure."""
FOUNDATION = 0.05
"""The thickness of the foundation."""


def magnification(vertices: Array, displacements: Iterable[Array]) -> float:
    """The factor of displacements, rounded down to two digits so that it can be stated.

    From vertices and displacements, (d, vertices) each.
    """
    largest = max(float(np.linalg.norm(displacement, axis=0).max()) for displacement in displacements)
    if largest == 0:
        return 1.0
    exact = DISPLACEMENT * float(np.ptp(vertices, axis=1).max()) / largest
    unit = 10.0 ** (math.floor(math.log10(exact)) - 1)
    return float(f"{math.floor(exact / unit) * unit:.2g}")

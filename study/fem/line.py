"""Lines in the plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from study.fem.mesh import MeshError

TOUCHING = 1e-9
"""Relative distance below which a vertex lies on a line."""


@dataclass(frozen=True)
class Line:
    """{x : direction·x = offset}; the direction is a unit vector.

    Raises:
        MeshError: it is not.
    """

    direction: tuple[float, ...]
    offset: float

    def __post_init__(self) -> None:
        length = float(np.linalg.norm(self.direction))
        if abs(length - 1) > TOUCHING:
            raise MeshError(
                f"the direction {self.direction} of a line has the length {length:.9g}, expected 1; "
                "divide it and the offset by its length"
            )

    def __str__(self) -> str:
        terms = " + ".join(f"{c:.4g} x{i}" for i, c in enumerate(self.direction, start=1) if abs(c) > TOUCHING)
        return f"{{{terms} = {self.offset:.4g}}}"

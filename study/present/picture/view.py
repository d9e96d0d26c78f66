"""How a body is seen: projected onto the drawing, and how large displacements, pressures, gaps and stresses are."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from study.present.picture.faces import Array
from study.present.picture.picture import Picture

DISPLACEMENT = 0.12
"""The largest displacement."""
ARROW = 0.2
"""The arrow of the largest pressure, and the depth of the largest gap."""
FOUNDATION = 0.05
"""The thickness of the foundation."""
BRIGHTEST = 0.95
"""Stresses above this quantile share the last colour: peaks at fronts and corners would leave the rest alike."""


def end_of_colours(stresses: Array) -> float:
    """The stress from which on all have the last colour."""
    return float(np.quantile(stresses, BRIGHTEST)) or float(np.max(stresses)) or 1.0


def shade(shares: Array) -> Array:
    """Where a stress lies in its colours, from its share of their end: the root shows contact beside large loads."""
    return np.asarray(np.sqrt(np.clip(shares, 0, 1)))


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


ASIDE = np.array([0.35, 0.55, 0.25])
"""By how much: so that three sides of a box are seen."""


@dataclass(frozen=True, eq=False)
class View:
    """A parallel projection.

    Attributes:
        axes: orthonormal rows, (d, d): the directions drawn to the right and upwards and, in space, that to the eye.
    """

    axes: Array

    @classmethod
    def of(cls, picture: Picture) -> View:
        """The identity in the plane; a solid is seen obliquely from outside of its contact faces, and from above.

        The direction to the eye is the sum of their normals with every component increased in absolute value. The third
        axis is upright. A body on a floor is turned upside down, since a body seen from below looks hollow.
        """
        if len(picture.vertices) == 2:
            return cls(np.eye(2))
        normal = np.sum([face.normal for face in picture.faces], axis=0)
        side = np.where(normal > 0, 1, -1)
        towards = side * (abs(normal) + ASIDE)
        towards /= np.linalg.norm(towards)
        right = np.cross([0, 0, side[2]], towards)
        right /= np.linalg.norm(right)
        return cls(np.array([right, np.cross(towards, right), towards]))

    def flat(self, x: Array) -> Array:
        """Points in the drawing, (d, n) → (2, n)."""
        return self.axes[:2] @ x

    def order(self, x: Array, cells: NDArray[np.int64], shades: NDArray[np.int64]) -> NDArray[np.int64]:
        """The triangles that face the eye, the farthest first (painter's algorithm); x are the corners, (d, n).

        In the plane, where none hides another, all of them, sorted by shade.
        """
        if len(x) == 2:
            return np.argsort(shades, kind="stable")
        a, b, c = (self.flat(x)[:, corner] for corner in cells)
        (p, q), (r, s) = b - a, c - a
        facing = np.flatnonzero(p * s - q * r > 0)
        depth = (self.axes[2] @ x)[cells].mean(axis=0)
        return facing[np.argsort(depth[facing], kind="stable")]

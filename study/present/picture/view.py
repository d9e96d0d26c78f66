"""From coordinates of the body to those of a drawing: the identity in the plane, a parallel projection in space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from study.present.picture.face_history import Array
from study.present.picture.picture import Picture

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

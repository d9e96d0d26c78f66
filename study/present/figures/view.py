"""From a body to the page: as it is in the plane, a fixed parallel projection in space."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from study.present.figures.pictures import Array, Picture

ASIDE = np.array([0.35, 0.55, 0.25])
"""How far the eye moves from the normal of a contact face along the axes, so that it sees three sides of a box."""


@dataclass(frozen=True, eq=False)
class View:
    """A parallel projection.

    Attributes:
        axes: orthonormal rows, what is drawn to the right, what upwards and, in space, what points to the eye, (d, d).
    """

    axes: Array

    @classmethod
    def of(cls, picture: Picture) -> View:
        """The plane itself; a solid is seen obliquely from outside of its contact faces, and from above.

        The eye looks along the sum of their normals, moved aside on the same side of each axis, or on the negative one.
        The third axis is upright: a body on a floor is turned upside down, as what is seen from below looks hollow.
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
        """Points on the page, (d, n) → (2, n)."""
        return self.axes[:2] @ x

    def order(self, x: Array, cells: NDArray[np.int64], shades: NDArray[np.int64]) -> NDArray[np.int64]:
        """The triangles with corners among the points x that face the eye, the farthest first: the painter's order.

        In the plane, where none hides another, all of them, those of one shade together.
        """
        if len(x) == 2:
            return np.argsort(shades, kind="stable")
        a, b, c = (self.flat(x)[:, corner] for corner in cells)
        (p, q), (r, s) = b - a, c - a
        facing = np.flatnonzero(p * s - q * r > 0)
        depth = (self.axes[2] @ x)[cells].mean(axis=0)
        return facing[np.argsort(depth[facing], kind="stable")]

"""Contact data whose lifting is confined to the strip above one piece of Γ3.

Pieces of one straight side carry details of different sizes. Each is lifted to a depth in proportion to its details,
and one lifting must not reach above the next piece: it ends at the lines s = 0 and s = |Γ3,i|, where its data have to
vanish so smoothly that no strain jumps there.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from manufactured.contact import ContactFace
from manufactured.exact.contribution import ContributionAtPoints
from manufactured.modes import Modes
from manufactured.tensors import Array, Points, Tensors, Vectors


@dataclass(frozen=True, eq=False)
class StripFace(ContactFace):
    """A contact face in the plane whose lifting is cut off at the ends of its piece."""

    def at(self, x: Points) -> InStrip:  # type: ignore[override]
        along = np.real(self.part.coordinates(x)[0][0])
        inside = (along >= 0) & (along <= self.part.measure)
        return InStrip(super().at(x[:, inside]), inside)


class InStrip:
    """A field at given points, set to zero at points outside the strip."""

    def __init__(self, field: ContributionAtPoints, inside: Array) -> None:
        self.field, self.inside = field, inside

    def displacement(self, time: Array | complex, rate: bool = False) -> Vectors:
        """u (or u̇), (d, ...)."""
        return self._everywhere(self.field.displacement(time, rate), 1)

    def strain(self, time: Array | complex, rate: bool = False) -> Tensors:
        """ε(u) (or ε(u̇)), Mandel (D, ...)."""
        return self._everywhere(self.field.strain(time, rate), 1)

    def strain_gradient(self, time: Array | complex, rate: bool = False) -> Array:
        """∂_j ε(u) (or of u̇), (D, d, ...)."""
        return self._everywhere(self.field.strain_gradient(time, rate), 2)

    def modes(self) -> Modes:
        """ε(u) as a sum of products."""
        found = self.field.modes()
        return replace(found, points=np.flatnonzero(self.inside)[found.points])

    def _everywhere(self, values: Array, inner: int) -> Array:
        """Values with the points of the strip behind ``inner`` axes → at all points."""
        found = np.zeros((*values.shape[:inner], *self.inside.shape, *values.shape[inner + 1 :]), dtype=values.dtype)
        found[(slice(None),) * inner + (self.inside,)] = values
        return found

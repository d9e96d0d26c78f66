"""Contact data whose displacement is confined to the strip above one part of Γ3.

The parts of one straight side have details of different sizes, and the displacement of each part reaches to a depth in
proportion to its details. The displacement of one part must not reach into the strip above the next part. It is set to
zero beyond the lines s = 0 and s = |Γ3,i|, where the contact data must vanish so smoothly that no strain jumps.
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
    """A contact face in 2D whose displacement is zero beyond the ends of its part."""

    def at(self, x: Points) -> InStrip:  # type: ignore[override]
        along = np.real(self.part.coordinates(x)[0][0])
        inside = (along >= 0) & (along <= self.part.measure)
        return InStrip(super().at(x[:, inside]), inside)


class InStrip:
    """A displacement field at fixed points that is zero at points outside the strip."""

    def __init__(self, field: ContributionAtPoints, inside: Array) -> None:
        self.field, self.inside = field, inside

    def displacement(self, time: Array | complex, rate: bool = False) -> Vectors:
        """Return u, or u̇ if ``rate``, (d, ...)."""
        return self._everywhere(self.field.displacement(time, rate), 1)

    def strain(self, time: Array | complex, rate: bool = False) -> Tensors:
        """Return ε(u), or ε(u̇) if ``rate``, in Mandel form, (D, ...)."""
        return self._everywhere(self.field.strain(time, rate), 1)

    def strain_gradient(self, time: Array | complex, rate: bool = False) -> Array:
        """Return the derivatives ∂_j ε(u), or ∂_j ε(u̇) if ``rate``, (D, d, ...)."""
        return self._everywhere(self.field.strain_gradient(time, rate), 2)

    def modes(self) -> Modes:
        """Return ε(u) as a sum of products."""
        found = self.field.modes()
        return replace(found, points=np.flatnonzero(self.inside)[found.points])

    def _everywhere(self, values: Array, inner: int) -> Array:
        """Extend values at points of the strip by 0 to all points; the axis of points comes after ``inner`` axes."""
        found = np.zeros((*values.shape[:inner], *self.inside.shape, *values.shape[inner + 1 :]), dtype=values.dtype)
        found[(slice(None),) * inner + (self.inside,)] = values
        return found

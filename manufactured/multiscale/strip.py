"""A contact face whose displacement is confined to the strip above it.

One straight side is divided into parts whose details have different sizes. The displacement of each part reaches to a
depth in proportion to its details, and must not reach into the strip above the next part. So it is set to zero beyond
the ends s = 0 and s = |Γ3,i| of the part. There the contact data must vanish so smoothly that no strain jumps.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from manufactured.contact import ContactFace
from manufactured.exact.domain import ContributionAtPoints
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
    """A displacement field at fixed points that is zero at points outside a strip above the contact face."""

    def __init__(self, field: ContributionAtPoints, inside: Array) -> None:
        self.field, self.inside = field, inside

    def displacement(self, time: Array | complex, rate: bool = False) -> Vectors:
        """Return the displacement u, or the velocity u̇ if ``rate`` is true, (d, ...)."""
        return self._everywhere(self.field.displacement(time, rate), 1)

    def strain(self, time: Array | complex, rate: bool = False) -> Tensors:
        """Return the strain ε(u), or its rate if ``rate`` is true, in Mandel form, (D, ...)."""
        return self._everywhere(self.field.strain(time, rate), 1)

    def strain_gradient(self, time: Array | complex, rate: bool = False) -> Array:
        """Return the derivatives ∂_j of the strain, or of its rate if ``rate`` is true, (D, d, ...)."""
        return self._everywhere(self.field.strain_gradient(time, rate), 2)

    def modes(self) -> Modes:
        """Return the strain ε(u) as a sum of products of functions of the point and of time."""
        found = self.field.modes()
        return replace(found, points=np.flatnonzero(self.inside)[found.points])

    def _everywhere(self, values: Array, inner: int) -> Array:
        """Return values at all points: the given values in the strip, and 0 outside.

        The axis of the points follows the first ``inner`` axes.
        """
        found = np.zeros((*values.shape[:inner], *self.inside.shape, *values.shape[inner + 1 :]), dtype=values.dtype)
        found[(slice(None),) * inner + (self.inside,)] = values
        return found

"""Strains as sums of products of a function of the point and a function of the face coordinate s and time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from manufactured.tensors import Array


@dataclass(frozen=True, eq=False)
class Modes:
    """A strain at points x_p, ε(x_p, t) = Σ_k E_k φ_k(x_p) T_k(s_{j(p)}, t), zero at the points not listed.

    Many points share a coordinate s_j along the face. Only the T_k depend on time, so few values change with time.

    Attributes:
        tensors: E_k, Mandel (K, D).
        points: positions p of the points at which the strain does not vanish for all times, increasing, (n,).
        shapes: φ_k(x_p), (K, n).
        places: j(p), (n,).
        count: the number J of different s_j.
        amplitudes: the function (t, rate) ↦ T_k(s_j, t), or ∂_t T_k(s_j, t) if ``rate`` is true, (K, J); for n times
            (K, J, n).
    """

    tensors: Array
    points: Array
    shapes: Array
    places: Array
    count: int
    amplitudes: Callable[[Array | float, bool], Array]

    def among(self, first: int, stop: int) -> Modes:
        """Return the strain at the points first, …, stop − 1, counted from zero."""
        # The positions increase, so a slice without a copy is enough.
        chosen = slice(*np.searchsorted(self.points, (first, stop)))
        return replace(
            self, points=self.points[chosen] - first, shapes=self.shapes[:, chosen], places=self.places[chosen]
        )


def at_each(time: Array | complex, of: Callable[[Any], Array]) -> Array:
    """Evaluate a field at one time, or at n times one after the other, which become the last axis."""
    if not (isinstance(time, np.ndarray) and time.ndim):
        return of(time)
    found = [of(one) for one in time]
    # Fine meshes need one time at once, and a copy would cost noticeable time.
    return found[0][..., None] if len(found) == 1 else np.stack(found, axis=-1)

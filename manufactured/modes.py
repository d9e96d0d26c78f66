"""Strains as sums of products of a field that time does not change and a function of place along a face and time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from manufactured.tensors import Array


@dataclass(frozen=True, eq=False)
class Modes:
    """A strain at points x_p, ε(x_p, t) = Σ_k E_k φ_k(x_p) T_k(s_{j(p)}, t), zero at the points not listed.

    Many points share a coordinate s_j along the face, so the T_k, which are all that changes with time, are few.

    Attributes:
        tensors: E_k, Mandel (K, D).
        points: positions p of the points at which the strain does not vanish for all times, increasing, (n,).
        shapes: φ_k(x_p), (K, n).
        places: j(p), (n,).
        count: the number J of different s_j.
        amplitudes: (t, whether of the rate) ↦ T_k(s_j, t) or ∂_t T_k(s_j, t), (K, J); (K, J, n) for n times, which
            are found faster together where J is small.
    """

    tensors: Array
    points: Array
    shapes: Array
    places: Array
    count: int
    amplitudes: Callable[[Array | float, bool], Array]

    def among(self, first: int, stop: int) -> Modes:
        """The same strain at the points first, …, stop − 1, counted from zero."""
        # The positions increase, so that nothing is copied.
        chosen = slice(*np.searchsorted(self.points, (first, stop)))
        return replace(
            self, points=self.points[chosen] - first, shapes=self.shapes[:, chosen], places=self.places[chosen]
        )


def at_each(time: Array | complex, of: Callable[[Any], Array]) -> Array:
    """A field at one time, or at n, the last axis, one after the other."""
    if not (isinstance(time, np.ndarray) and time.ndim):
        return of(time)
    found = [of(one) for one in time]
    # One time is what fine meshes ask for, where a copy is felt.
    return found[0][..., None] if len(found) == 1 else np.stack(found, axis=-1)

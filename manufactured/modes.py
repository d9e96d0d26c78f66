"""Strains as sums of products: a function of the point times a function of the face coordinate and of time."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from manufactured.tensors import Array, Time


@dataclass(frozen=True, eq=False)
class Modes:
    """A strain at points x_p, written as a sum of products ε(x_p, t) = Σ_k E_k φ_k(x_p) T_k(s_{j(p)}, t).

    Each of the K terms has a constant tensor E_k, a function φ_k of the point, and a function T_k of the time t and of
    the coordinate s_{j(p)} of the point along the contact face. Only the T_k, called amplitudes, depend on time. Many
    points have the same coordinate s_j, so few values change with time. At points that are not listed in ``points`` the
    strain is zero.

    Attributes:
        tensors: the constant tensors E_k in Mandel form, (K, D).
        points: the numbers p of the points at which the strain is not always zero, increasing, (n,).
        shapes: the functions φ_k at these points, (K, n).
        places: j(p), the number of the coordinate s_j of each of these points, (n,).
        count: the number J of different coordinates s_j.
        amplitudes: the function (t, rate) ↦ T_k(s_j, t), or ∂_t T_k(s_j, t) if ``rate`` is true, (K, J). For m times it
            returns (K, J, m).
    """

    tensors: Array
    points: Array
    shapes: Array
    places: Array
    count: int
    amplitudes: Callable[[Time, bool], Array]

    def among(self, first: int, stop: int) -> Modes:
        """Return the strain at the points with the numbers first, …, stop − 1, which are numbered again from 0."""
        # The point numbers increase, so the chosen points are one slice and no array is copied.
        chosen = slice(*np.searchsorted(self.points, (first, stop)))
        return replace(
            self, points=self.points[chosen] - first, shapes=self.shapes[:, chosen], places=self.places[chosen]
        )


def pointwise(field: Callable[[Any, bool], Array], rows: int, count: int) -> Modes:
    """Return any strain or force, given by its values at all points, in the form of ``Modes``.

    It is for fields that are no sum of a few products (function of the point) × (function of time). There is one term
    for every component of the field, with φ_k = 1; its amplitudes are the values of the component at all points.

    Args:
        field: the function (t, rate) ↦ values, (rows, ...), or their time derivative if ``rate`` is true.
        rows: the number of components.
        count: the number of points.
    """
    places = np.arange(count)

    def amplitudes(time: Time, rate: bool) -> Array:
        return field(time, rate).reshape(rows, count, *np.shape(time))

    return Modes(np.eye(rows), places, np.ones((rows, count)), places, count, amplitudes)


def at_each(time: Time, of: Callable[[Any], Array]) -> Array:
    """Evaluate a field at one time, or at several times one by one; the times become the last axis of the result.

    Args:
        time: one time, or several times (n,).
        of: the field, as a function from one time to an array.
    """
    if not (isinstance(time, np.ndarray) and time.ndim):
        return of(time)
    found = [of(one) for one in time]
    # Usually there is one time. Then np.stack would copy the array, which takes noticeable time on fine meshes.
    return found[0][..., None] if len(found) == 1 else np.stack(found, axis=-1)

"""‖u(t) − u_h(t)‖_V bounded from both sides without u, by another trajectory ũ and a bound y of ‖u(t) − ũ(t)‖_V:

    d(t) − y(t) ≤ ‖u(t) − u_h(t)‖_V ≤ d(t) + y(t),     d = ‖ũ − u_h‖_V.

With ũ = u_h smoothed in time this is an upper bound; with a ũ closer to u the lower end is positive as well
(``study.bound.trajectory``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from manufactured.tensors import Array
from study.bound.gronwall import Interval
from study.bound.observed_order import order_interval


@dataclass(frozen=True, eq=False)
class Enclosure:
    """The bounds of ‖u(t) − u_h(t)‖_V over [0, T].

    Attributes:
        h: mesh size of u_h.
        times: the knots of ũ after 0, (n,).
        distance: d at the times, (n,).
        bound: y at the times, (n,).
        error: the true error where it is known, else not a number, (n,).
        intervals: how y came about, one interval up to each time.
        start: bound of the error at t = 0.
        between: bound of the error over the interval up to each time, (n,).
    """

    h: float
    times: Array
    distance: Array
    bound: Array
    error: Array
    intervals: tuple[Interval, ...]
    start: float
    between: Array

    @property
    def highest(self) -> float:
        """A bound of the error over all of [0, T], between the times as well."""
        return max(self.start, float(self.between.max()))

    def bound_at(self, times: Array) -> Array:
        """Bounds at any times of (0, T]: those of the intervals the times lie in, (m,)."""
        return self.between[np.searchsorted(self.times[:-1], times)]

    @property
    def lower(self) -> Array:
        """max(d − y, 0), (n,)."""
        return np.maximum(self.distance - self.bound, 0.0)

    @property
    def upper(self) -> Array:
        """d + y, (n,)."""
        return self.distance + self.bound

    @property
    def lowest(self) -> float:
        """A lower bound of max_t ‖u(t) − u_h(t)‖_V."""
        return float(self.lower.max())

    @property
    def contains(self) -> bool:
        """Whether the known error lies inside at all times."""
        return bool(((self.lower <= self.error) & (self.error <= self.upper)).all())


def order(coarse: Enclosure, fine: Enclosure) -> tuple[float, float]:
    """An interval that contains the observed order log(E/E')/log(h/h') of E = max_t ‖u(t) − u_h(t)‖_V."""
    ends = (coarse.lowest, coarse.highest), (fine.lowest, fine.highest)
    return order_interval(*ends, math.log(coarse.h / fine.h))

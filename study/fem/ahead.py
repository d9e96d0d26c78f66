"""Amplitudes of an exact strain at times that are known before, many at a time.

On a coarse mesh a formula has some hundred places along a face, so that evaluating it costs calls, not arithmetic.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from manufactured.modes import Modes
from manufactured.tensors import Array

TIMES, ENTRIES = 16, 1 << 18
"""Times of a block, fewer if it had more entries than that: with so many places there is nothing to gain."""
RECENT = 8
"""Blocks, or single times, at hand: two trajectories side by side and their errors ask for the same ones soon."""


class Ahead:
    """(t, whether of the rate) ↦ the amplitudes of all modes at t, each (K, J)."""

    def __init__(self, modes: Sequence[Modes]) -> None:
        # Not the modes, whose shapes at all points are most of what a fine mesh takes.
        self._amplitudes = [part.amplitudes for part in modes]
        self._length = min(TIMES, ENTRIES // max(len(part.tensors) * part.count for part in modes))
        self._foreseen: list[Array] = []
        self._single = lru_cache(RECENT)(self._at)
        self._many = lru_cache(RECENT)(self._block)

    def foresee(self, times: Array) -> None:
        """These times, increasing, (n,), will be asked for in their order, or none of them."""
        if self._length > 1:
            self._foreseen.append(times)

    def __call__(self, time: float, rate: bool) -> list[Array]:
        for n, times in enumerate(self._foreseen):
            i = bisect_left(times, time)
            if i < len(times) and times[i] == time:
                first = i - i % self._length
                return [part[i - first] for part in self._many(n, first, rate)]
        return self._single(time, rate)

    def _at(self, time: float, rate: bool) -> list[Array]:
        return [amplitudes(time, rate) for amplitudes in self._amplitudes]

    def _block(self, n: int, first: int, rate: bool) -> list[Array]:
        """Those of some times of a sequence, each (times, K, J)."""
        times = self._foreseen[n][first : first + self._length]
        return [np.ascontiguousarray(np.moveaxis(found(times, rate), -1, 0)) for found in self._amplitudes]

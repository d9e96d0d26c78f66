"""What an exact solution gives at times that are known before, many at a time.

On a coarse mesh a formula has some hundred places along a face, and a sum over cells some thousand terms, so that
finding them costs calls, not arithmetic.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Sequence
from typing import Generic, TypeVar

import numpy as np

from manufactured.tensors import Array

V = TypeVar("V")
TIMES, ENTRIES = 16, 1 << 20
"""Times of a block, fewer where its largest array would not stay in a cache: there is nothing to gain with so many
entries."""
RECENT = 4
"""Blocks, or single times, at hand: two trajectories side by side and their errors ask for the same ones soon."""


def block_length(entries: int) -> int:
    """How many times are taken together where one of them takes so many entries."""
    return max(1, min(TIMES, ENTRIES // entries))


def in_blocks(times: Array, entries: int) -> list[Array]:
    """All times in their order, as many together as ``block_length`` says."""
    length = block_length(entries)
    return [times[first : first + length] for first in range(0, len(times), length)]


class Ahead(Generic[V]):
    """The values of a function of time that was found for a block of times."""

    def __init__(self, length: int) -> None:
        self._length = length
        self._foreseen: list[Array] = []
        self._recent: dict[tuple[float, ...], Sequence[V]] = {}

    def foresee(self, *sequences: Array) -> None:
        """Of each sequence all times, increasing, (n,), will be asked for in their order, or none of them."""
        self._foreseen += sequences

    def __call__(self, time: float, find: Callable[[Array], Sequence[V]]) -> V:
        """What ``find``, from times (n,) to n values, has for a time."""
        times, i = self._block(time)
        key = tuple(times)
        if key not in self._recent:
            if len(self._recent) == RECENT:
                del self._recent[next(iter(self._recent))]
            self._recent[key] = find(times)
        return self._recent[key][i]

    def _block(self, time: float) -> tuple[Array, int]:
        """The times that are found together with one of them, and its position."""
        for times in self._foreseen:
            i = bisect_left(times, time)
            if i < len(times) and times[i] == time:
                first = i - i % self._length
                return times[first : first + self._length], i - first
        return np.array([time]), 0

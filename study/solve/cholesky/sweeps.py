"""What is compiled of a sparse Cholesky factorisation: the assembly of its fronts, and both substitutions.

Each substitution reads L once.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numba import njit

from manufactured.tensors import Array
from study.solve.cholesky.dissection import Integers


class Panel(NamedTuple):
    """Some columns of L, in blocks (supernodes) of consecutive columns with the same rows below the block.

    A column is stored from its diagonal down: its part of the triangle of its block, then the rows below.

    Attributes:
        starts: where the blocks begin among the columns of L, with the end of the last, (blocks + 1,).
        borders: where their rows below begin in ``rows``, with the end of the last, (blocks + 1,).
        rows: indices of the rows below.
        entries: the columns, one after the other.
    """

    starts: Integers
    borders: Integers
    rows: Integers
    entries: Array

    @classmethod
    def of(cls, start: int, blocks: Sequence[tuple[Array, Integers, Array]]) -> Panel:
        """From the lower triangle (k, k) of each block, its rows below (b,) and its entries there (b, k)."""
        sizes = [len(diagonal) for diagonal, _, _ in blocks]
        entries = [
            np.concatenate([part for j in range(len(diagonal)) for part in (diagonal[j:, j], below[:, j])])
            for diagonal, _, below in blocks
        ]
        return cls(
            start + np.concatenate([[0], np.cumsum(sizes)]),
            np.concatenate([[0], np.cumsum([len(rows) for _, rows, _ in blocks])]),
            np.concatenate([rows for _, rows, _ in blocks]),
            np.concatenate(entries),
        )


@njit(cache=True)
def add(front: Array, at: Integers, remainder: Array) -> None:
    """Add a Schur complement (b, b) to a front at some of its unknowns, increasing, (b,): lower triangles alone."""
    for j in range(len(at)):
        for i in range(j, len(at)):
            front[at[i], at[j]] += remainder[i, j]


@njit(cache=True, fastmath={"reassoc", "nsz", "contract"})
def forward(starts: Integers, borders: Integers, rows: Integers, entries: Array, y: Array) -> None:
    """y ← L⁻¹ y for the columns of a panel."""
    p = 0
    below = np.empty(np.max(np.diff(borders)))
    for block in range(len(starts) - 1):
        end, first = starts[block + 1], borders[block]
        count = borders[block + 1] - first
        below[:count] = 0.0
        for j in range(starts[block], end):
            # Slices, because an index that might be negative would keep loops from being vectorised.
            column, rest = entries[p : p + end - j], y[j:end]
            value = rest[0] / column[0]
            rest[0] = value
            for i in range(1, end - j):
                rest[i] -= column[i] * value
            p += end - j
            column = entries[p : p + count]
            for i in range(count):
                below[i] += column[i] * value
            p += count
        for i in range(count):
            y[rows[first + i]] -= below[i]


@njit(cache=True, fastmath={"reassoc", "nsz", "contract"})
def backward(starts: Integers, borders: Integers, rows: Integers, entries: Array, x: Array) -> None:
    """x ← L⁻ᵀ x for the columns of a panel."""
    p = len(entries)
    below = np.empty(np.max(np.diff(borders)))
    for block in range(len(starts) - 2, -1, -1):
        end, first = starts[block + 1], borders[block]
        count = borders[block + 1] - first
        for i in range(count):
            below[i] = x[rows[first + i]]
        for j in range(end - 1, starts[block] - 1, -1):
            p -= count
            column, total = entries[p : p + count], 0.0
            for i in range(count):
                total += column[i] * below[i]
            p -= end - j
            column, rest = entries[p : p + end - j], x[j:end]
            for i in range(1, end - j):
                total += column[i] * rest[i]
            rest[0] = (rest[0] - total) / column[0]

"""The substitutions with a sparse Cholesky factor, compiled; each reads L once, for all right sides (m, n)."""

from __future__ import annotations

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


@njit(cache=True)
def _most(borders: Integers) -> int:
    """The largest number of rows below a block. NumPy's functions would take seconds to compile."""
    found = 0
    for block in range(len(borders) - 1):
        found = max(found, borders[block + 1] - borders[block])
    return found


@njit(cache=True, fastmath={"reassoc", "nsz", "contract"})
def forward(starts: Integers, borders: Integers, rows: Integers, entries: Array, ys: Array) -> None:
    """y ← L⁻¹ y for the columns of a panel and every y, (m, n)."""
    p = 0
    below = np.empty(_most(borders))
    for block in range(len(starts) - 1):
        end, first, place = starts[block + 1], borders[block], p
        count = borders[block + 1] - first
        for k in range(len(ys)):
            y, p = ys[k], place
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
def backward(starts: Integers, borders: Integers, rows: Integers, entries: Array, xs: Array) -> None:
    """x ← L⁻ᵀ x for the columns of a panel and every x, (m, n)."""
    p = len(entries)
    below = np.empty(_most(borders))
    for block in range(len(starts) - 2, -1, -1):
        end, first, place = starts[block + 1], borders[block], p
        count = borders[block + 1] - first
        for k in range(len(xs)):
            x, p = xs[k], place
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

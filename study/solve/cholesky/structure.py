"""Where L has entries, found before any of them is computed: the rows below every block of columns.

What is eliminated with a block borders on the unknowns of its own columns and on those that earlier blocks have left to
it; the block of the first of these is its parent, to whose front it leaves its Schur complement (J. W. H. Liu, The role
of elimination trees in sparse factorization, SIAM J. Matrix Anal. Appl. 11 (1990) 134–172).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sps
from numba import njit

from study.solve.cholesky.dissection import Integers


class Structure(NamedTuple):
    """Blocks of consecutive columns of L that have the same rows below the block.

    Attributes:
        starts: where the blocks begin among the columns, with the end of the last, (blocks + 1,).
        borders: where their rows below begin in ``rows``, with the end of the last, (blocks + 1,).
        rows: indices of the rows below, increasing in each block.
        parents: the block whose front takes what a block leaves, the number of blocks if it leaves nothing, (blocks,).
        children: the last of the blocks that leave something to a block, −1 if none does, (blocks,).
        siblings: the one before with the same parent, −1 if there is none, (blocks,).
    """

    starts: Integers
    borders: Integers
    rows: Integers
    parents: Integers
    children: Integers
    siblings: Integers

    @classmethod
    def of(cls, lower: sps.csc_array, starts: Integers) -> Structure:
        """That of a matrix in its order of elimination, given its lower triangle."""
        return cls(starts, *_found(lower.indptr, lower.indices, starts))

    @property
    def widths(self) -> Integers:
        """The columns of each block, (blocks,)."""
        return np.diff(self.starts)

    @property
    def below(self) -> Integers:
        """The rows below each block, (blocks,)."""
        return np.diff(self.borders)

    @property
    def entries(self) -> Integers:
        """The entries of each block, (blocks,): a triangle and the rows below."""
        return self.widths * (self.widths + 1) // 2 + self.widths * self.below


@njit(cache=True)
def _found(
    indptr: Integers, indices: Integers, starts: Integers
) -> tuple[Integers, Integers, Integers, Integers, Integers]:
    """Borders, rows, parents, children and siblings."""
    count, size = len(starts) - 1, starts[-1]
    owner, seen = np.empty(size, np.int64), np.full(size, -1)
    for i in range(count):
        for column in range(starts[i], starts[i + 1]):
            owner[column] = i
    parents, children, siblings = np.full(count, count), np.full(count, -1), np.full(count, -1)
    borders, rows = np.zeros(count + 1, np.int64), np.empty(2 * size, np.int64)
    for i in range(count):
        end, stop = starts[i + 1], borders[i]
        # At most all unknowns that follow.
        if stop + size - end > len(rows):
            more = np.empty(2 * len(rows) + size, np.int64)
            for p in range(stop):
                more[p] = rows[p]
            rows = more
        for p in range(indptr[starts[i]], indptr[end]):
            row = indices[p]
            if row >= end and seen[row] != i:
                seen[row], rows[stop] = i, row
                stop += 1
        child = children[i]
        while child >= 0:
            for p in range(borders[child], borders[child + 1]):
                row = rows[p]
                if row >= end and seen[row] != i:
                    seen[row], rows[stop] = i, row
                    stop += 1
            child = siblings[child]
        rows[borders[i] : stop].sort()
        borders[i + 1] = stop
        if stop > borders[i]:
            parent = owner[rows[borders[i]]]
            parents[i], siblings[i], children[parent] = parent, children[parent], i
    return borders, rows[: borders[count]].copy(), parents, children, siblings

"""One sparse Cholesky factorisation of a symmetric positive definite matrix, for many right-hand sides.

Multifrontal: the unknowns of a block are eliminated from one small dense matrix, the front, which collects the entries
of S in their columns and the Schur complements that earlier blocks left on its unknowns; what it leaves itself goes to
the front of the first unknown it borders on (J. W. H. Liu, The multifrontal method for sparse matrix solution: theory
and practice, SIAM Review 34 (1992) 82–109). All arithmetic is done by dense kernels.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import scipy.sparse as sps
from scipy.linalg.blas import dsyrk, dtrsm
from scipy.linalg.lapack import dpotrf

from manufactured.tensors import Array
from study.solve.cholesky import sweeps
from study.solve.cholesky.dissection import Integers, nested_dissection
from study.solve.cholesky.sweeps import Panel

PANEL = 1 << 22
"""Entries of L that are packed together: few enough that packing takes little memory, many enough to be few."""


class Cholesky:
    """S = Pᵀ L Lᵀ P for an order P that keeps L sparse and puts the unknowns ``last`` at its end.

    The trailing block of L is then the Cholesky factor of the Schur complement of S on these unknowns.

    Attributes:
        order: the unknowns in the order of the rows of L, (n,).
        panels: the columns of L.
        trailing: the block of L that belongs to ``last``, (c, c).
    """

    def __init__(self, S: sps.csc_array, last: Sequence[int] | Integers = ()) -> None:
        self.order, starts = nested_dissection(S, np.asarray(last, dtype=np.int64))
        self.trailing = np.zeros((0, 0))
        self.panels = []
        blocks: list[Block] = []
        begin = held = 0
        for end, block in zip(starts[1:], _blocks(_lower(S, self.order), starts), strict=True):
            blocks.append(block)
            held += block.diagonal.size + block.below.size
            if held > PANEL or end == len(self.order):
                self.panels.append(Panel.of(begin, blocks))
                blocks, begin, held = [], end, 0
        if len(last):
            self.trailing = block.diagonal

    def __call__(self, b: Array) -> Array:
        """S⁻¹ b, (n,)."""
        return self.backward(self.forward(b))

    def forward(self, b: Array) -> Array:
        """y = L⁻¹ P b."""
        y = b[self.order]
        for panel in self.panels:
            sweeps.forward(*panel, y)
        return y

    def backward(self, y: Array) -> Array:
        """Pᵀ L⁻ᵀ y."""
        x = y.copy()
        for panel in reversed(self.panels):
            sweeps.backward(*panel, x)
        u = np.empty_like(x)
        u[self.order] = x
        return u


class Block(NamedTuple):
    """Columns of L that are eliminated together.

    Attributes:
        diagonal: the lower triangle of L on these unknowns, (k, k).
        border: the positions of the later unknowns with entries in these columns, increasing, (b,).
        below: L on the border, (b, k).
    """

    diagonal: Array
    border: Integers
    below: Array


def _lower(S: sps.csc_array, order: Integers) -> sps.csc_array:
    """The lower triangle of S with its unknowns in an order; the whole of S is not kept beside L in that order."""
    lower = sps.csc_array(sps.tril(sps.csr_array(S)[order][:, order]))
    lower.sort_indices()
    return lower


def _blocks(lower: sps.csc_array, starts: Integers) -> Iterator[Block]:
    """The columns of L of a matrix, given its lower triangle; ``starts`` are those of the blocks."""
    owner = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    left: list[list[tuple[Integers, Array]]] = [[] for _ in starts[1:]]
    for i, (start, end) in enumerate(pairwise(starts.tolist())):
        block, remainder = _eliminate(lower, start, end, left[i])
        left[i] = []
        if len(block.border):
            left[owner[block.border[0]]].append((block.border, remainder))
        yield block


def _eliminate(lower: sps.csc_array, start: int, end: int, left: list[tuple[Integers, Array]]) -> tuple[Block, Array]:
    """The columns of L from ``start`` to ``end``, and the Schur complement on their border (its lower triangle).

    Raises:
        LinAlgError: S is not positive definite.
    """
    entries = slice(lower.indptr[start], lower.indptr[end])
    rows = lower.indices[entries]
    met = np.unique(np.concatenate([rows, *(border for border, _ in left)]))
    unknowns = np.concatenate([np.arange(start, end), met[np.searchsorted(met, end) :]])
    k = end - start
    front = np.zeros((len(unknowns), len(unknowns)), order="F")
    columns = np.repeat(np.arange(k), np.diff(lower.indptr[start : end + 1]))
    front[np.searchsorted(unknowns, rows), columns] = lower.data[entries]
    for border, remainder in left:
        sweeps.add(front, np.searchsorted(unknowns, border), remainder)
    diagonal, failed = dpotrf(front[:k, :k], lower=1)
    if failed:
        raise np.linalg.LinAlgError("the matrix is not positive definite, so it has no Cholesky factor")
    if k == len(unknowns):
        return Block(diagonal, unknowns[k:], np.zeros((0, k))), np.zeros((0, 0))
    below = dtrsm(1.0, diagonal, front[k:, :k], side=1, lower=1, trans_a=1)
    remainder = dsyrk(-1.0, below, beta=1.0, c=front[k:, k:], lower=1)
    return Block(diagonal, unknowns[k:], below), remainder

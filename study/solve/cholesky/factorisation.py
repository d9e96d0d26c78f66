"""One sparse Cholesky factorisation of a symmetric positive definite matrix, for many right-hand sides.

Multifrontal: the unknowns of a block are eliminated from one dense matrix, the front, which collects the entries of S
in their columns and the Schur complements that earlier blocks left on its unknowns; what it leaves itself goes to the
front of the first unknown it borders on (J. W. H. Liu, The multifrontal method for sparse matrix solution: theory and
practice, SIAM Review 34 (1992) 82–109). Large fronts are treated by BLAS and LAPACK. Small ones, which are most, would
cost more calls than arithmetic: they are eliminated in runs by compiled code (``fronts``).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np
import scipy.sparse as sps
from scipy.linalg.blas import dsyrk, dtrsm
from scipy.linalg.lapack import dpotrf

from manufactured.tensors import Array
from study.solve.cholesky import fronts, sweeps
from study.solve.cholesky.analysis import Analysis
from study.solve.cholesky.dissection import Integers
from study.solve.cholesky.sweeps import Panel

PANEL = 1 << 22
"""Entries of L that are stored together: few enough that there is room for them in one piece, many enough to be few."""
SMALL = 128
"""Unknowns of a front up to which compiled code eliminates."""
REFUSAL = "the matrix is not positive definite, so it has no Cholesky factor"

Eliminated = Callable[[int, int, Array], None]
"""(first block, the block after the last, where the entries of their columns go) ↦ nothing."""


class Cholesky:
    """S = Pᵀ L Lᵀ P for an order P that keeps L sparse and puts the unknowns ``last`` at its end.

    The trailing block of L is then the Cholesky factor of the Schur complement of S on these unknowns.

    Attributes:
        order: the unknowns in the order of the rows of L, (n,).
        panels: the columns of L.
        trailing: the block of L that belongs to ``last``, (c, c).

    Raises:
        LinAlgError: S is not positive definite.
    """

    def __init__(self, S: sps.csc_array, last: Sequence[int] | Integers = ()) -> None:
        analysis = Analysis.of(S, np.asarray(last, dtype=np.int64))
        self.order = analysis.order
        self.panels = list(_Elimination(analysis, S.data).panels())
        self.trailing = np.zeros((len(last), len(last)))
        # The last block has no rows below it: its columns are a triangle.
        triangle = np.triu_indices(len(last))
        entries = self.panels[-1].entries
        self.trailing.T[triangle] = entries[entries.size - triangle[0].size :]

    def __call__(self, b: Array) -> Array:
        """S⁻¹ b, (n,), or of several b, (m, n)."""
        return self.backward(self.forward(b))

    def forward(self, b: Array) -> Array:
        """y = L⁻¹ P b, (n,) or (m, n)."""
        y = np.take(b, self.order, axis=-1)
        for panel in self.panels:
            sweeps.forward(*panel, y.reshape(-1, len(self.order)))
        return y

    def backward(self, y: Array) -> Array:
        """Pᵀ L⁻ᵀ y, (n,) or (m, n)."""
        x = y.copy()
        for panel in reversed(self.panels):
            sweeps.backward(*panel, x.reshape(-1, len(self.order)))
        u = np.empty_like(x)
        u[..., self.order] = x
        return u


class _Elimination:
    """The elimination of a matrix, given its values (entries,)."""

    def __init__(self, analysis: Analysis, values: Array) -> None:
        self.structure = structure = analysis.structure
        self.columns = analysis.indptr, analysis.indices, values[analysis.places]
        self.place = np.empty(len(analysis.order), dtype=np.int64)
        # What blocks have left to others that are not eliminated yet.
        self.left: dict[int, Array] = {}
        count = len(structure.parents)
        self.small = structure.widths + structure.below <= SMALL
        self.eldest = np.arange(count + 1)
        np.minimum.at(self.eldest, structure.parents, np.arange(count))

    def panels(self) -> Iterator[Panel]:
        """The columns of L.

        Raises:
            LinAlgError: S is not positive definite.
        """
        structure, first, count = self.structure, 0, len(self.structure.parents)
        ends = np.concatenate([[0], np.cumsum(structure.entries)])
        while first < count:
            last = min(max(int(np.searchsorted(ends, ends[first] + PANEL)), first + 1), count)
            entries = np.empty(ends[last] - ends[first])
            for begin, end, eliminated in self._parts(first, last):
                eliminated(begin, end, entries[ends[begin] - ends[first] : ends[end] - ends[first]])
            borders = structure.borders[first : last + 1]
            rows = structure.rows[borders[0] : borders[-1]]
            yield Panel(structure.starts[first : last + 1], borders - borders[0], rows, entries)
            first = last

    def _parts(self, first: int, last: int) -> Iterator[tuple[int, int, Eliminated]]:
        """Runs of small blocks whose children are in the run, and others, one by one: where they begin and end."""
        begin = first
        while begin < last:
            end = begin
            while end < last and self.small[end] and self.eldest[end] >= begin:
                end += 1
            yield (begin, end, self._run) if end > begin else (begin, begin + 1, self._single)
            begin = max(end, begin + 1)

    def _run(self, begin: int, end: int, entries: Array) -> None:
        """Eliminate blocks with small fronts."""
        structure, below = self.structure, self.structure.below[begin:end]
        offsets = np.concatenate([[0], np.cumsum(below**2)])
        remainders = np.empty(offsets[-1])
        if not fronts.eliminate(begin, end, structure, *self.columns, self.place, entries, remainders, offsets):
            raise np.linalg.LinAlgError(REFUSAL)
        for i in np.flatnonzero((structure.parents[begin:end] >= end) & (below > 0)):
            part = remainders[offsets[i] : offsets[i + 1]]
            self.left[begin + int(i)] = part.reshape(below[i], below[i]).copy()

    def _single(self, block: int, end: int, entries: Array) -> None:
        """Eliminate a block with a large front."""
        structure, k = self.structure, int(self.structure.widths[block])
        size = k + int(structure.below[block])
        front = np.zeros((size, size))
        fronts.assemble(front, block, structure, *self.columns, self.place)
        child = structure.children[block]
        while child >= 0:
            rows = structure.rows[structure.borders[child] : structure.borders[child + 1]]
            fronts.add(front, rows, self.left.pop(child), self.place)
            child = structure.siblings[child]
        # Of a front, the columns are stored: its transpose is the matrix as LAPACK has it.
        matrix = front.T
        diagonal, failed = dpotrf(matrix[:k, :k], lower=1)
        if failed:
            raise np.linalg.LinAlgError(REFUSAL)
        below = np.zeros((0, k), order="F")
        if size > k:
            below = dtrsm(1.0, diagonal, matrix[k:, :k], side=1, lower=1, trans_a=1)
            self.left[block] = dsyrk(-1.0, below, beta=1.0, c=matrix[k:, k:], lower=1).T
        fronts.pack(diagonal, below, entries)

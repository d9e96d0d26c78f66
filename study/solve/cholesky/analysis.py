"""What of a factorisation does not depend on numbers: the order of elimination, and where S and L have entries.

Trajectories with other steps, and with or without contact, have matrices with one graph, so that it is found once.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import scipy.sparse as sps

from study.solve.cholesky.dissection import Dissection, Integers, halves, ordered
from study.solve.cholesky.structure import Structure


class Analysis(NamedTuple):
    """S in its order of elimination, but for its values.

    Attributes:
        order: the unknowns in this order, (n,).
        structure: the blocks of L.
        indptr, indices: the lower triangle of S in this order, by columns with increasing rows.
        places: where its entries are among those of S, (entries,).
    """

    order: Integers
    structure: Structure
    indptr: Integers
    indices: Integers
    places: Integers

    @classmethod
    def of(cls, S: sps.csc_array, last: Integers) -> Analysis:
        """That of a matrix with a symmetric pattern in which the unknowns ``last`` are the last block."""
        return _graph(S.indptr.tobytes(), S.indices.tobytes(), S.indices.dtype.name).analysis(last)


class _Graph:
    """A symmetric pattern by its rows; keeps the analysis with the unknowns that were last asked for at the end."""

    def __init__(self, indptr: Integers, indices: Integers) -> None:
        self._indptr, self._indices = indptr, indices
        self._node, self._depth = halves(self._places())
        self._found: tuple[bytes, Analysis] | None = None

    def _places(self) -> sps.csr_array:
        """The pattern with the place of each entry as its value; of a large one nobody should keep these."""
        places = np.arange(len(self._indices), dtype=self._indices.dtype)
        return sps.csr_array((places, self._indices, self._indptr), shape=(len(self._indptr) - 1,) * 2)

    def analysis(self, last: Integers) -> Analysis:
        """With these at the end."""
        key = last.tobytes()
        if self._found is None or self._found[0] != key:
            # Not both at a time: they are large.
            self._found = None
            self._found = key, self._analysed(ordered(self._node, self._depth, last))
        return self._found[1]

    def _analysed(self, dissection: Dissection) -> Analysis:
        order, starts = dissection
        lower = sps.csc_array(sps.tril(self._places()[order][:, order]))
        lower.sort_indices()
        return Analysis(order, Structure.of(lower, starts), lower.indptr, lower.indices, lower.data)


@lru_cache(maxsize=1)
def _graph(starts: bytes, columns: bytes, kind: str) -> _Graph:
    """The graph with these indices."""
    return _Graph(np.frombuffer(starts, kind), np.frombuffer(columns, kind))

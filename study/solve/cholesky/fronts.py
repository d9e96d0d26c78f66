"""What is compiled of the elimination: the assembly of fronts, and all of it where fronts are small.

Arrays are copied by loops: an assignment to a slice is as fast, but takes seconds to compile.

A front is a dense matrix on the unknowns of a block and the rows below it; of its lower triangle column c is stored in
the row c, from c on.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from manufactured.tensors import Array
from study.solve.cholesky.dissection import Integers
from study.solve.cholesky.structure import Structure


@njit(cache=True)
def assemble(
    front: Array, block: int, structure: Structure, indptr: Integers, indices: Integers, data: Array, place: Integers
) -> None:
    """Enter the columns of S of a block into its front, zero before, and the places of its unknowns into ``place``."""
    begin, end = structure.starts[block], structure.starts[block + 1]
    for column in range(begin, end):
        place[column] = column - begin
    first = structure.borders[block]
    for p in range(first, structure.borders[block + 1]):
        place[structure.rows[p]] = end - begin + p - first
    for column in range(begin, end):
        for p in range(indptr[column], indptr[column + 1]):
            front[column - begin, place[indices[p]]] = data[p]


@njit(cache=True)
def add(front: Array, rows: Integers, remainder: Array, place: Integers) -> None:
    """Add the Schur complement (b, b) that a block leaves on its rows (b,)."""
    places = place[rows]
    for a in range(len(rows)):
        column, values = front[places[a]], remainder[a]
        for b in range(a, len(rows)):
            column[places[b]] += values[b]


@njit(cache=True)
def pack(diagonal: Array, below: Array, entries: Array) -> None:
    """The columns of a block one after the other, from L on its unknowns (k, k), and below them (b, k)."""
    k, at = len(diagonal), 0
    for j in range(k):
        for i in range(j, k):
            entries[at + i - j] = diagonal[i, j]
        at += k - j
        for i in range(len(below)):
            entries[at + i] = below[i, j]
        at += len(below)


@njit(cache=True)
def eliminate(
    first: int,
    last: int,
    structure: Structure,
    indptr: Integers,
    indices: Integers,
    data: Array,
    place: Integers,
    entries: Array,
    remainders: Array,
    offsets: Integers,
) -> bool:
    """Eliminate the blocks from ``first`` to before ``last``, with their children; False if a pivot is not positive.

    Fills the entries of their columns, one after the other, and in ``remainders``, between ``offsets``, (blocks + 1,),
    the Schur complements that they leave, (b, b) each.
    """
    starts, borders, rows, at = structure.starts, structure.borders, structure.rows, 0
    for block in range(first, last):
        k, b = starts[block + 1] - starts[block], borders[block + 1] - borders[block]
        front = np.zeros((k + b, k + b))
        assemble(front, block, structure, indptr, indices, data, place)
        child = structure.children[block]
        while child >= 0:
            of_child = rows[borders[child] : borders[child + 1]]
            left = remainders[offsets[child - first] : offsets[child - first + 1]]
            add(front, of_child, left.reshape((len(of_child), len(of_child))), place)
            child = structure.siblings[child]
        if not _factorise(front, k):
            return False
        for j in range(k):
            for i in range(j, k + b):
                entries[at + i - j] = front[j, i]
            at += k + b - j
        for a in range(b):
            start = offsets[block - first] + a * b
            for i in range(a, b):
                remainders[start + i] = front[k + a, k + i]
    return True


@njit(cache=True, fastmath={"contract"})
def _factorise(front: Array, k: int) -> bool:
    """Eliminate the first k unknowns of a front in place; False if a pivot is not positive."""
    size = len(front)
    for j in range(k):
        pivot = front[j, j]
        if not pivot > 0:
            return False
        scale = 1 / np.sqrt(pivot)
        column = front[j, j:]
        for i in range(size - j):
            column[i] *= scale
        for c in range(j + 1, k):
            factor, target, source = front[j, c], front[c, c:], front[j, c:]
            for i in range(size - c):
                target[i] -= factor * source[i]
    # Four columns at a time, so that the rest of the front is read and written a quarter as often.
    whole = k - k % 4
    for c in range(k, size):
        target, length = front[c, c:], size - c
        for j in range(0, whole, 4):
            f0, f1, f2, f3 = front[j, c], front[j + 1, c], front[j + 2, c], front[j + 3, c]
            s0, s1, s2, s3 = front[j, c:], front[j + 1, c:], front[j + 2, c:], front[j + 3, c:]
            for i in range(length):
                target[i] -= f0 * s0[i] + f1 * s1[i] + f2 * s2[i] + f3 * s3[i]
        for j in range(whole, k):
            factor, source = front[j, c], front[j, c:]
            for i in range(length):
                target[i] -= factor * source[i]
    return True

"""Nested dissection of the graph of a sparse matrix: an order of elimination with little fill, found without a mesh.

A set of unknowns without which the rest falls into two halves is eliminated after both of them, and each half is
treated in the same way (A. George, Nested dissection of a regular finite element mesh, SIAM J. Numer. Anal. 10 (1973)
345–363). Halves are cut across that axis of some coordinates which leaves the smallest such set, and the coordinates
come from the graph: the distances of all vertices to a few that are far apart, reduced to their principal components
(D. Harel, Y. Koren, Graph drawing by high-dimensional embedding, J. Graph Algorithms Appl. 8 (2004) 195–214).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy.sparse as sps
from numba import njit
from numpy.typing import NDArray

from manufactured.tensors import Array

Integers = NDArray[np.int64]

PIVOTS = 10
"""Vertices from which distances in the graph are taken."""
AXES = 6
"""Principal components that are kept. The longest axis alone makes L 2 % larger in the plane and 15 % in space. More
than six, cuts off the middle, or separators from the other half gain 2 % for half as much time again."""
LEAF = 32
"""Unknowns in a part that is not divided any further. With 128, dense blocks of parts are half of what a solve reads;
parts of fewer than 32 save little and cost time to eliminate."""


class Dissection(NamedTuple):
    """An order of elimination.

    Attributes:
        order: the unknowns in the order in which they are eliminated, (n,).
        starts: where the blocks of unknowns that are eliminated together begin in ``order``, with n at the end.
    """

    order: Integers
    starts: Integers


def ordered(node: Integers, depth: Integers, last: Integers) -> Dissection:
    """The order in which a node of the tree of ``halves`` follows both of its halves, with ``last`` at the end."""
    deepest = int(depth.max())
    # Leaves below a node have consecutive numbers: the node follows the last of them.
    below = ((node + 1) << (deepest - depth)) - 1
    rank = below * (deepest + 1) + deepest - depth
    rank[last] = rank.max() + 1
    order = np.argsort(rank, kind="stable")
    changes = np.flatnonzero(np.diff(rank[order])) + 1
    return Dissection(order, np.concatenate([[0], changes, [len(order)]]))


def halves(graph: sps.csr_array) -> tuple[Integers, Integers]:
    """The node of the tree of halves that each unknown is eliminated with, and its depth, (n,) both.

    The root is 1, the halves of a node i are 2i and 2i + 1; a separator stays with the node that it halves. A part is
    cut at its median along an axis, and unknowns with the same coordinate are in the order of their numbers.
    """
    x = _embedding(graph)
    ranks = np.empty(x.shape, dtype=np.int64)
    for rank, row in zip(ranks, x, strict=True):
        rank[np.argsort(row, kind="stable")] = np.arange(x.shape[1])
    found: tuple[Integers, Integers] = _halved(graph.indptr, graph.indices, ranks, LEAF)
    return found


@njit(cache=True)
def _halved(indptr: Integers, indices: Integers, ranks: Integers, leaf: int) -> tuple[Integers, Integers]:
    """As ``halves``; ``ranks`` has the places of the unknowns along each axis, (axes, n)."""
    size = len(indptr) - 1
    node, depth = np.ones(size, np.int64), np.zeros(size, np.int64)
    active, rights, keys = np.arange(size), np.empty(size, np.int64), np.empty(size, np.int64)
    # Parts that wait, one of each depth and one more: at 64 the numbers of nodes would end, too.
    waiting, parts = np.zeros((64, 2), np.int64), 1
    waiting[0, 1] = size
    while parts:
        parts -= 1
        low, high = waiting[parts, 0], waiting[parts, 1]
        if high - low <= leaf:
            continue
        part, left = active[low:high], 2 * node[active[low]]
        best, chosen = size + 1, 0
        for axis in range(len(ranks)):
            separators = _cut(indptr, indices, part, ranks[axis], node, left, keys[low:high])
            if separators < best:
                best, chosen = separators, axis
        # The nodes are now those of the last axis.
        if chosen < len(ranks) - 1:
            _cut(indptr, indices, part, ranks[chosen], node, left, keys[low:high])
        kept = beyond = 0
        for q in range(low, high):
            vertex = active[q]
            if node[vertex] > left:
                rights[beyond] = vertex
                beyond += 1
            elif _meets(node, left + 1, indices[indptr[vertex] : indptr[vertex + 1]]):
                node[vertex] = left // 2
                continue
            else:
                active[low + kept] = vertex
                kept += 1
            depth[vertex] += 1
        for q in range(beyond):
            active[low + kept + q] = rights[q]
        waiting[parts, 0], waiting[parts, 1] = low, low + kept
        waiting[parts + 1, 0], waiting[parts + 1, 1] = low + kept, low + kept + beyond
        parts += 2
    return node, depth


@njit(cache=True)
def _meets(node: Integers, other: int, neighbours: Integers) -> bool:
    """Whether one of some unknowns belongs to a node."""
    for vertex in neighbours:  # noqa: SIM110  compiled
        if node[vertex] == other:
            return True
    return False


@njit(cache=True)
def _cut(
    indptr: Integers, indices: Integers, part: Integers, rank: Integers, node: Integers, left: int, keys: Integers
) -> int:
    """Give half of a part, by some ranks, to the node ``left`` and the rest to the next; how many separate them."""
    for q in range(len(part)):
        keys[q] = rank[part[q]]
    middle = _smallest(keys, len(part) // 2)
    for vertex in part:
        node[vertex] = left + (rank[vertex] >= middle)
    count = 0
    for vertex in part:
        if node[vertex] == left and _meets(node, left + 1, indices[indptr[vertex] : indptr[vertex + 1]]):
            count += 1
    return count


@njit(cache=True)
def _smallest(keys: Integers, k: int) -> int:
    """The k-th smallest, from 0, of different keys, which are put in another order: Hoare's quickselect."""
    low, high = 0, len(keys) - 1
    while low < high:
        pivot, i, j = keys[(low + high) // 2], low, high
        while i <= j:
            while keys[i] < pivot:
                i += 1
            while keys[j] > pivot:
                j -= 1
            if i <= j:
                keys[i], keys[j] = keys[j], keys[i]
                i, j = i + 1, j - 1
        if k <= j:
            high = j
        elif k >= i:
            low = i
        else:
            break
    return keys[k]


def _embedding(graph: sps.csr_array) -> Array:
    """Coordinates of the vertices of a graph, (AXES, n), the longest axis first."""
    start = int(_distances(graph.indptr, graph.indices, 0).argmax())
    nearest = np.full(graph.shape[0], np.inf)
    distances = np.empty((PIVOTS, graph.shape[0]))
    for row in distances:
        row[:] = _distances(graph.indptr, graph.indices, start)
        nearest = np.minimum(nearest, row)
        start = int(nearest.argmax())
    centred = distances - distances.mean(axis=1, keepdims=True)
    _, directions = np.linalg.eigh(centred @ centred.T)
    return directions[:, : -AXES - 1 : -1].T @ centred


@njit(cache=True)
def _distances(indptr: Integers, indices: Integers, start: int) -> Integers:
    """Edges on a shortest path from a vertex to every other, (n,); more than on any of these where there is no path."""
    size = len(indptr) - 1
    distances, queue = np.full(size, size), np.empty(size, np.int64)
    distances[start], queue[0] = 0, start
    done, found = 0, 1
    while done < found:
        vertex = queue[done]
        done += 1
        for neighbour in indices[indptr[vertex] : indptr[vertex + 1]]:
            if distances[neighbour] == size:
                distances[neighbour], queue[found] = distances[vertex] + 1, neighbour
                found += 1
    beyond = distances[queue[found - 1]] + 1
    for vertex in range(size):
        distances[vertex] = min(distances[vertex], beyond)
    return distances

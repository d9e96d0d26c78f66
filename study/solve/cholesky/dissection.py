"""Nested dissection of the graph of a sparse matrix: an order of elimination with little fill, found without a mesh.

A set of unknowns without which the rest falls into two halves is eliminated after both of them, and each half is
treated in the same way (A. George, Nested dissection of a regular finite element mesh, SIAM J. Numer. Anal. 10 (1973)
345–363). Halves are cut along the longest axis of coordinates that come from the graph: the distances of all vertices
to a few that are far apart, reduced to their principal components (D. Harel, Y. Koren, Graph drawing by
high-dimensional embedding, J. Graph Algorithms Appl. 8 (2004) 195–214).
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
import scipy.sparse as sps
from numpy.typing import NDArray
from scipy.sparse.csgraph import breadth_first_order

from manufactured.tensors import Array

Integers = NDArray[np.int64]

PIVOTS = 10
"""Vertices from which distances in the graph are taken."""
AXES = 3
"""Principal components that are kept."""
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


def nested_dissection(S: sps.sparray, last: Integers) -> Dissection:
    """The order for a matrix with a symmetric pattern in which the unknowns ``last`` are the last block."""
    graph = sps.csr_array(S)
    node, depth = _halves(graph.indptr.tobytes(), graph.indices.tobytes(), graph.indices.dtype.name)
    deepest = int(depth.max())
    # Leaves below a node have consecutive numbers: the node follows the last of them.
    below = ((node + 1) << (deepest - depth)) - 1
    rank = below * (deepest + 1) + deepest - depth
    rank[last] = rank.max() + 1
    order = np.argsort(rank, kind="stable")
    changes = np.flatnonzero(np.diff(rank[order])) + 1
    return Dissection(order, np.concatenate([[0], changes, [len(order)]]))


@lru_cache(maxsize=1)
def _halves(starts: bytes, columns: bytes, kind: str) -> tuple[Integers, Integers]:
    """``_tree`` of a pattern: trajectories with other steps, and with or without contact, have matrices of the same."""
    indptr, indices = np.frombuffer(starts, kind), np.frombuffer(columns, kind)
    graph = sps.csr_array((np.ones(len(indices)), indices, indptr), shape=(len(indptr) - 1,) * 2)
    return _tree(graph, _embedding(graph))


def _tree(graph: sps.csr_array, x: Array) -> tuple[Integers, Integers]:
    """The node of the tree of halves that each unknown is eliminated with, and its depth, (n,) both.

    The root is 1, the halves of a node i are 2i and 2i + 1; a separator stays with the node that it halves. All parts
    of one depth are cut at a time, each at its median along its longest axis.
    """
    node = np.ones(graph.shape[0], dtype=np.int64)
    depth = np.zeros_like(node)
    start, end = sps.coo_array(sps.tril(graph, -1)).coords
    active = np.arange(len(node))
    while True:
        _, part, sizes = np.unique(node[active], return_inverse=True, return_counts=True)
        active = active[sizes[part] > LEAF]
        if not len(active):
            return node, depth
        right = np.zeros(len(node), dtype=bool)
        right[active] = _right_halves(node[active], x[:, active])
        divided = np.zeros(len(node), dtype=bool)
        divided[active] = True
        inside = divided[start] & (node[start] == node[end])
        start, end = start[inside], end[inside]
        cut = right[start] != right[end]
        divided[np.where(right[start], end, start)[cut]] = False
        active = active[divided[active]]
        node[active] = 2 * node[active] + right[active]
        depth[active] += 1


def _right_halves(node: Integers, x: Array) -> NDArray[np.bool_]:
    """Whether the points x, (axes, n), lie beyond the median of their part along its longest axis, (n,)."""
    _, part, sizes = np.unique(node, return_inverse=True, return_counts=True)
    starts = np.cumsum(sizes) - sizes
    grouped = x[:, np.argsort(part, kind="stable")]
    extents = np.maximum.reduceat(grouped, starts, axis=1) - np.minimum.reduceat(grouped, starts, axis=1)
    along = np.lexsort((x[extents.argmax(axis=0)[part], np.arange(len(part))], part))
    right = np.empty(len(part), dtype=bool)
    right[along] = np.arange(len(part)) - np.repeat(starts, sizes) >= np.repeat(sizes // 2, sizes)
    return right


def _embedding(graph: sps.csr_array) -> Array:
    """Coordinates of the vertices of a graph, (AXES, n), the longest axis first."""
    start = int(_distances(graph, 0).argmax())
    nearest = np.full(graph.shape[0], np.inf)
    distances = np.empty((PIVOTS, graph.shape[0]))
    for row in distances:
        row[:] = _distances(graph, start)
        nearest = np.minimum(nearest, row)
        start = int(nearest.argmax())
    centred = distances - distances.mean(axis=1, keepdims=True)
    _, directions = np.linalg.eigh(centred @ centred.T)
    return directions[:, : -AXES - 1 : -1].T @ centred


def _distances(graph: sps.csr_array, start: int) -> Array:
    """Edges on a shortest path from a vertex to every other, (n,); more than on any of these where there is no path."""
    order, predecessors = breadth_first_order(graph, start)
    position = np.empty(graph.shape[0], dtype=np.int64)
    position[order] = np.arange(len(order))
    # Breadth first, predecessors come in the order of the vertices: a distance is one range of the order.
    before = position[predecessors[order[1:]]]
    ends = [1]
    while ends[-1] < len(order):
        ends.append(1 + int(np.searchsorted(before, ends[-1])))
    distances = np.full(graph.shape[0], float(len(ends)))
    distances[order] = np.repeat(np.arange(len(ends)), np.diff(ends, prepend=0))
    return distances

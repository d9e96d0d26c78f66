"""What is done vertex by vertex: coordinates in which K^h = {v : Nv ≤ 0} is a box, and rigid motions."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import scipy.sparse as sps

from manufactured.tensors import Array, Points
from study.solve.cholesky.dissection import Integers

INDEPENDENT = 1e-8
"""Sine of the angle between normals at a vertex below which they are refused as the same one."""


def rigid_motions(x: Points) -> Array:
    """Translations and infinitesimal rotations at points x, (d, vertices) → (d·vertices, d(d + 1)/2)."""
    d, count = x.shape
    motions = [np.tile(unit[:, None], count) for unit in np.eye(d)]
    centred = x - x.mean(axis=1, keepdims=True)
    for i, j in combinations(range(d), 2):
        rotation = np.zeros((d, count))
        rotation[i], rotation[j] = -centred[j], centred[i]
        motions.append(rotation)
    return np.array([motion.T.ravel() for motion in motions]).T


def local_bases(N: sps.csr_array, d: int) -> tuple[Array, Integers]:
    """For each vertex a regular matrix that begins with its rows of N, and which unknown a row of N becomes.

    Returns:
        (n/d, d, d) and (m,): row i of N is row ``unknown[i] % d`` of the matrix of vertex ``unknown[i] // d``.

    Raises:
        ValueError: a row has entries at several vertices or none, or the rows of a vertex are not linearly independent.
    """
    N = sps.csr_array(N)
    vertices = np.full(N.shape[0], -1)
    for i, (start, end) in enumerate(zip(N.indptr[:-1], N.indptr[1:], strict=True)):
        at = np.unique(N.indices[start:end][N.data[start:end] != 0] // d)
        if len(at) != 1:
            raise ValueError(
                f"row {i} of N has entries at {len(at)} vertices: give one normal at one vertex in each row"
            )
        vertices[i] = at[0]
    blocks = np.tile(np.eye(d), (N.shape[1] // d, 1, 1))
    unknowns = np.empty(N.shape[0], dtype=np.int64)
    for vertex in np.unique(vertices):
        rows = np.flatnonzero(vertices == vertex)
        normals = N[rows][:, d * vertex : d * (vertex + 1)].toarray()
        blocks[vertex] = _completed(normals)
        unknowns[rows] = d * vertex + np.arange(len(rows))
    return blocks, unknowns


def _completed(normals: Array) -> Array:
    """The rows with an orthonormal basis of what is orthogonal to them, (r, d) → (d, d)."""
    count = len(normals)
    units = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    _, sizes, orthonormal = np.linalg.svd(units)
    if count > normals.shape[1] or sizes.min() < INDEPENDENT:
        raise ValueError(f"the normals {units.tolist()} at a vertex are linearly dependent: keep one row for each")
    return np.vstack([normals, orthonormal[count:]])


def block_diagonal(blocks: Array) -> sps.bsr_array:
    """(n/d, d, d) → (n, n)."""
    count = len(blocks)
    return sps.bsr_array((blocks, np.arange(count), np.arange(count + 1)))

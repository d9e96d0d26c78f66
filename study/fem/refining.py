"""Meshes that are refined where a field has details, to integrate it, and how V^h goes over into functions on them.

A solution with details of many sizes needs fine quadrature in few places. Cells are divided there (red, green and blue
refinement, in which every cell is made of cells), so that V^h is contained in the P1 functions on the finer mesh: loads
and errors of V^h are those of V^h on that mesh, and nothing is approximated but integrals.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.sparse as sps
from scipy.spatial import cKDTree
from skfem import Mesh

from manufactured.tensors import Array, Points
from study.fem.space import Space

MOST = 40
"""Refinements after which a size that is never small enough is refused."""


def refined(mesh: Mesh, wanted: Callable[[Points], Array]) -> tuple[Mesh, sps.csr_array]:
    """A mesh whose cells are at most as long as wanted in their place, and P1 nodal values there from those here.

    Args:
        wanted: corners of the cells (2, 3, cells) → the longest side allowed, (cells,).

    Raises:
        ValueError: some size is not reached.
    """
    inclusion = sps.csr_array(sps.eye_array(mesh.p.shape[1]))
    for _ in range(MOST):
        corners = mesh.p[:, mesh.t]
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=0).max(axis=0)
        large = np.flatnonzero(sides > wanted(corners) * (1 + 1e-9))
        if not large.size:
            return mesh, inclusion
        finer = mesh.refined(large)
        inclusion = sps.csr_array(midpoint_values(mesh, finer) @ inclusion)
        mesh = finer
    raise ValueError(f"{MOST} refinements leave {large.size} cells larger than wanted; ask for sizes above 0")


def midpoint_values(mesh: Mesh, finer: Mesh) -> sps.csr_array:
    """P1 nodal values on a mesh from those before one refinement: means of the ends of the edges that were cut."""
    old, new = mesh.p.shape[1], finer.p.shape[1]
    middles = mesh.p[:, mesh.facets].mean(axis=1)
    distance, edge = cKDTree(middles.T).query(finer.p[:, old:].T)
    if not (np.array_equal(finer.p[:, :old], mesh.p) and np.all(distance < 1e-12)):
        raise ValueError("the finer mesh is not a refinement whose new vertices are midpoints of edges")
    ends = mesh.facets[:, edge]
    rows = np.concatenate([np.arange(old), np.tile(np.arange(old, new), 2)])
    columns = np.concatenate([np.arange(old), ends.ravel()])
    values = np.concatenate([np.ones(old), np.full(ends.size, 0.5)])
    return sps.csr_array((values, (rows, columns)), shape=(new, old))


def inclusion_of(space: Space, finer: Space, nodal: sps.csr_array) -> sps.csr_array:
    """V^h on a mesh → V^h on a finer one, free values from free values, for the inclusion of nodal values."""
    return sps.csr_array(sps.kron(nodal, sps.eye_array(space.dim), format="csr")[finer.free][:, space.free])

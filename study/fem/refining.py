"""Locally refined meshes for quadrature, and the matrix that embeds V^h in the P1 functions on such a mesh.

A solution with details of many sizes needs fine quadrature in a few places. Cells are divided there by red, green and
blue refinement. Every cell is then a union of finer cells, so each function of V^h is also a P1 function on the finer
mesh. Loads and errors of functions in V^h can thus be computed on the finer mesh, where only the quadrature is
approximate.
"""

from collections.abc import Callable

import numpy as np
import scipy.sparse as sps
from scipy.spatial import cKDTree
from skfem import Mesh

from manufactured.tensors import Array, Points
from study.fem.mesh import with_midpoints
from study.fem.space import Space

MOST = 40
"""Largest number of successive refinements of a mesh."""


def refined(mesh: Mesh, wanted: Callable[[Points], Array]) -> tuple[Mesh, sps.csr_array]:
    """Refine a mesh until its cells are small enough; return also the matrix that interpolates P1 functions to it.

    Args:
        mesh: a mesh of triangles.
        wanted: function from the corners of cells (2, 3, cells) to the largest permitted length of their sides,
            (cells,).

    Returns:
        The refined mesh, and the matrix from vertex values on the given mesh to vertex values on the refined one.

    Raises:
        ValueError: cells are still too large after ``MOST`` refinements.
    """
    inclusion = sps.csr_array(sps.eye_array(mesh.p.shape[1]))
    for _ in range(MOST):
        corners = mesh.p[:, mesh.t]
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=0).max(axis=0)
        large = np.flatnonzero(sides > wanted(corners) * (1 + 1e-9))
        if not large.size:
            return mesh, inclusion
        finer = mesh.refined(large)
        old = mesh.p.shape[1]
        distance, edge = cKDTree(mesh.p[:, mesh.facets].mean(axis=1).T).query(finer.p[:, old:].T)
        if not (np.array_equal(finer.p[:, :old], mesh.p) and np.all(distance < 1e-12)):
            raise ValueError("the finer mesh must have the old vertices first, then midpoints of old edges")
        inclusion = sps.csr_array(with_midpoints(mesh)[np.concatenate([np.arange(old), old + edge])] @ inclusion)
        mesh = finer
    raise ValueError(
        f"{large.size} cells are still larger than wanted after {MOST} refinements; ask for a positive, larger size"
    )


def inclusion_of(space: Space, finer: Space, nodal: sps.csr_array) -> sps.csr_array:
    """Return the matrix that embeds the displacements V^h in the space on a finer mesh, (finer dofs, dofs).

    Args:
        space: the space V^h.
        finer: the space on the finer mesh.
        nodal: the matrix for scalar functions that ``refined`` returns.
    """
    return sps.csr_array(sps.kron(nodal, sps.eye_array(space.dim), format="csr")[finer.free][:, space.free])

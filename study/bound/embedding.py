"""P1 displacements as displacements of degree 2 on the same mesh or on a refinement of it."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sps
from skfem import Mesh

from study.bound.discretisation import Discretisation
from study.bound.refusal import BoundError
from study.fem.space import Space


def prolongation(space: Space, discretisation: Discretisation) -> sps.csr_array:
    """The matrix from P1 to degree 2 on the same mesh or one that is uniformly refined some times, (dofs, n_dofs).

    Raises:
        BoundError: the mesh of degree 2 is another one.
    """
    mesh, refined = space.mesh, sps.csr_array(sps.eye_array(space.mesh.p.shape[1]))
    while mesh.t.shape[1] < discretisation.mesh.t.shape[1]:
        refined = sps.csr_array(_with_midpoints(mesh) @ refined)
        mesh = mesh.refined()
    if not np.array_equal(mesh.p, discretisation.mesh.p):
        raise BoundError("the mesh of ũ is no refinement of the mesh of u_h")
    scalar = _with_midpoints(discretisation.mesh) @ refined
    full = sps.csr_array(sps.kron(scalar, sps.eye_array(2)))
    return sps.csr_array(full[discretisation.displacements.free][:, space.free])


def _with_midpoints(mesh: Mesh) -> sps.csr_array:
    """Vertex values of a P1 function ↦ those at the vertices and the midpoints of the edges."""
    count, edges = mesh.p.shape[1], mesh.facets.shape[1]
    rows = np.repeat(np.arange(edges), 2)
    midpoints = sps.csr_array((np.full(2 * edges, 0.5), (rows, mesh.facets.T.ravel())), shape=(edges, count))
    return sps.csr_array(sps.vstack([sps.eye_array(count), midpoints]))

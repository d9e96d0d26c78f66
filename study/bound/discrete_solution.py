"""u_h, the displacement whose error is bounded: Problem 5.1 on P1, linear in time between the nodes of a scheme.

It is compared with displacements of degree 2 on the same mesh or on a refinement of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sps
from skfem import Mesh

from manufactured.tensors import Array
from study.bound.discretisation import Discretisation
from study.bound.refusal import BoundError
from study.fem.space import Space
from study.solve.evolution import Scheme, SemiDiscrete


@dataclass(frozen=True, eq=False)
class DiscreteSolution:
    """u_h ∈ V^h of P1, by its values at equally spaced times from 0 to T, (steps + 1, n_dofs)."""

    space: Space
    nodes: Array
    T: float

    @property
    def steps(self) -> int:
        return len(self.nodes) - 1

    def at(self, time: float) -> Array:
        """u_h(t), (n_dofs,)."""
        place = time / self.T * self.steps
        # The time of a node belongs to the interval after it, also where rounding puts it before.
        low = min(int(place + 1e-9), self.steps - 1)
        share = place - low
        return (1 - share) * self.nodes[low] + share * self.nodes[low + 1]


def compute(discretisation: Discretisation, scheme: Scheme, steps: int) -> DiscreteSolution:
    """Problem 5.1 from the data alone, with the load (P f, ·)_V and u_0^h = Π^h u_0."""
    data = discretisation.data
    space = Space(discretisation.mesh, data.body)
    J = prolongation(space, discretisation)

    def load(time: float) -> Array:
        return J.T @ discretisation.load(time)

    problem = SemiDiscrete.of(space, data.law, load, space.interpolate(data.start(discretisation.mesh.p)))
    return DiscreteSolution(space, np.array([state.u for state in scheme.march(problem, steps)]), data.body.T)


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

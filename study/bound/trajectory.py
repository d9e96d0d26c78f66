"""Displacements in time: u_h, whose error is bounded, and more accurate displacements ũ(t) ∈ K.

u_h is P1 and linear in time between the nodes of a time scheme. ũ has degree 2, lives on the same mesh or on a
refinement of it, and is differentiable in time. Nodes d_0, …, d_N ∈ K of any time scheme are the control points of a
quadratic B-spline with knots at the midpoints of the steps,

    ũ(t_{j−1/2}) = (d_{j−1} + d_j)/2,    ũ̇(t_{j−1/2}) = (d_j − d_{j−1})/k,    ũ̇ linear in between,

and a straight line on the first and the last half step. All points of the spline are convex combinations of nodes, so
ũ(t) ∈ K for every t, however inaccurate the nodes are. At the knots ũ and ũ̇ are the value and the difference quotient
of the midpoint scheme.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial

import numpy as np
import scipy.sparse as sps
from skfem import Mesh

from manufactured.body import Body
from manufactured.tensors import Array
from study.bound.discretisation import Discretisation
from study.bound.problem import BoundError
from study.fem.mesh import barycentric_gradients
from study.fem.mesh import size as mesh_size
from study.fem.quadratic import EDGES
from study.fem.space import Space
from study.solve.evolution import Scheme, SemiDiscrete, remainder
from study.solve.signorini import Signorini
from study.solve.steps import step_size
from study.solve.tableau import MIDPOINT

ON_NODE = 1e-5
"""Distance in barycentric coordinates up to which a point of a mesh counts as a node of its refinement."""


@dataclass(frozen=True, eq=False)
class DiscreteSolution:
    """The P1 solution u_h, by its values at equally spaced times from 0 to T, (steps + 1, n_dofs)."""

    space: Space
    nodes: Array
    T: float

    @property
    def h(self) -> float:
        """The mesh size."""
        return self.space.h

    @property
    def times(self) -> Array:
        """The times of the nodes, (steps + 1,)."""
        return step_size(self.T, self.steps) * np.arange(self.steps + 1)

    @property
    def steps(self) -> int:
        """The number of steps."""
        return len(self.nodes) - 1

    def at(self, time: float) -> Array:
        """Return the value u_h(t), (n_dofs,)."""
        place = time / self.T * self.steps
        # The time of a node belongs to the interval after it, also where rounding puts it before.
        low = min(int(place + 1e-9), self.steps - 1)
        share = place - low
        return (1 - share) * self.nodes[low] + share * self.nodes[low + 1]

    def on(self, fine: Discretisation) -> Callable[[float], Array]:
        """Return the function t ↦ u_h(t) by coefficients of degree 2 on the mesh or a refinement of it, (dofs,)."""
        J = prolongation(self.space, fine)
        return lambda time: J @ self.at(time)


@dataclass(frozen=True, eq=False)
class GivenDisplacement:
    """A displacement u_h on a triangulation of the body, linear between increasing times.

    ``study.bound.given.given`` checks the arrays of a file and returns one.

    Attributes:
        mesh: the triangulation.
        body: the body.
        degree: 1, or 2 with nodes at the vertices and then at the midpoints of the edges of ``mesh``.
        times: from 0 to T, (k,).
        nodes: nodal values, node by node with two components each, (k, 2 · number of nodes).
        steps: the number of intervals from which the number of time steps of ũ is computed.
        remarks: sentences on changes of the input and on penetration.
        offset: bound of ‖u_file − u_h‖_V at all times if u_h is the nearest field that vanishes on Γ1, otherwise 0.
    """

    mesh: Mesh
    body: Body
    degree: int
    times: Array
    nodes: Array
    steps: int
    remarks: tuple[str, ...] = ()
    offset: float = 0.0

    @property
    def T(self) -> float:
        """The last time."""
        return float(self.times[-1])

    @cached_property
    def h(self) -> float:
        """The mesh size."""
        return mesh_size(self.mesh)

    def at(self, time: float) -> Array:
        """Return the nodal values at a time, (2 · number of nodes,)."""
        low = int(np.clip(np.searchsorted(self.times, time, side="right") - 1, 0, len(self.times) - 2))
        share = (time - self.times[low]) / (self.times[low + 1] - self.times[low])
        return np.asarray((1 - share) * self.nodes[low] + share * self.nodes[low + 1])

    def on(self, fine: Discretisation) -> Callable[[float], Array]:
        """Return the function t ↦ u_h(t) by coefficients of degree 2 on the mesh or a refinement of it, (dofs,)."""
        J = sps.csr_array(sps.kron(on_refinement(self.mesh, self.degree, fine.mesh), sps.eye_array(2)))
        J = sps.csr_array(J[fine.displacements.free])
        return lambda time: J @ self.at(time)


Computed = DiscreteSolution | GivenDisplacement
"""A displacement u_h, linear in time between its nodes. Functions from ``known_error`` take values of ``at``."""


def compute(discretisation: Discretisation, scheme: Scheme, steps: int) -> DiscreteSolution:
    """Return the solution of Problem 5.1 from the data alone, with the load (P f, ·)_V and u_0^h = Π^h u_0."""
    data, space = discretisation.data, Space(discretisation.mesh, discretisation.data.body)
    J, start = prolongation(space, discretisation), space.interpolate(data.start(space.mesh.p))
    problem = SemiDiscrete.of(space, data.law, lambda time: J.T @ discretisation.load(time), start)
    return DiscreteSolution(space, np.array([state.u for state in scheme.march(problem, steps)]), data.body.T)


def prolongation(space: Space, discretisation: Discretisation) -> sps.csr_array:
    """Return the matrix from P1 to degree 2 on the same mesh or a uniform refinement of it, (dofs, n_dofs).

    Raises:
        BoundError: the mesh of degree 2 is not such a refinement.
    """
    full = sps.csr_array(sps.kron(on_refinement(space.mesh, 1, discretisation.mesh), sps.eye_array(2)))
    return sps.csr_array(full[discretisation.displacements.free][:, space.free])


def on_refinement(mesh: Mesh, degree: int, fine: Mesh) -> sps.csr_array:
    """Return the matrix from nodal values on a mesh to Bernstein coefficients of degree 2 on a uniform refinement.

    Nodes are the vertices and, for degree 2, the midpoints of the edges. A uniform refinement lists the children of all
    cells in the order of the cells, four times for each refinement. Barycentric coordinates of its nodes are multiples
    of a power of 1/2, so that the weights are exact.

    Args:
        degree: degree of the function on ``mesh``, 1 or 2.
        fine: the mesh itself or a uniform refinement of it.

    Raises:
        BoundError: ``fine`` is not such a refinement.
    """
    cells, vertices = mesh.t.shape[1], fine.p.shape[1]
    numbers = np.vstack([fine.t, vertices + fine.t2f])
    nodes = np.hstack([fine.p, fine.p[:, fine.facets].mean(axis=1)])
    _, first = np.unique(numbers, return_index=True)
    parents = first % numbers.shape[1] % cells
    from_corner = nodes - mesh.p[:, mesh.t[0, parents]]
    places = np.einsum("nid,dn->in", barycentric_gradients(mesh)[parents], from_corner)
    places[0] += 1
    parts = 2.0 * np.sqrt(fine.t.shape[1] / cells)
    exact = np.rint(parts * places) / parts
    if len(first) != nodes.shape[1] or not (abs(exact - places).max() < ON_NODE and exact.min() >= 0):
        raise BoundError("the mesh of ũ is no refinement of the mesh of u_h")
    if degree == 1:
        values, of_nodes = exact, mesh.t[:, parents]
    else:
        values = np.array([*(2 * exact**2 - exact), *(4 * exact[a] * exact[b] for a, b in EDGES)])
        of_nodes = np.vstack([mesh.t, mesh.p.shape[1] + mesh.t2f])[:, parents]
    count = mesh.p.shape[1] + (mesh.facets.shape[1] if degree == 2 else 0)
    places_in_matrix = np.tile(np.arange(len(first)), len(values)), of_nodes.ravel()
    at_nodes = sps.csr_array((values.ravel(), places_in_matrix), shape=(len(first), count))
    # With the coefficient c of an edge, the value at its midpoint is c/2 + (a + b)/4, a and b those at the ends.
    at_ends = at_nodes[fine.facets[0]] + at_nodes[fine.facets[1]]
    return sps.csr_array(sps.vstack([at_nodes[:vertices], 2.0 * at_nodes[vertices:] - 0.5 * at_ends]))


@dataclass(frozen=True)
class SmoothedInTime:
    """The displacement ũ is u_h itself, smoothed in time; this gives the bound from u_h alone."""

    name: str = "bound"

    def discretisation(self, coarse: Discretisation) -> Discretisation:
        return coarse

    def nodes(self, fine: Discretisation, computed: Computed) -> Iterator[tuple[float, Array]]:
        u_h = computed.on(fine)
        for time in computed.times.tolist():
            yield time, u_h(time)


@dataclass(frozen=True)
class Refined:
    """The displacement ũ solves Problem 5.1 in degree 2 by the midpoint scheme.

    The mesh of u_h is refined uniformly ``refinements`` times, and each step of u_h is divided into ``shorter`` steps.
    """

    refinements: int = 1
    shorter: int = 4
    name: str = "enclosure"

    def discretisation(self, coarse: Discretisation) -> Discretisation:
        return Discretisation(coarse.data, coarse.mesh.refined(self.refinements)) if self.refinements else coarse

    def nodes(self, fine: Discretisation, computed: Computed) -> Iterator[tuple[float, Array]]:
        data, V, steps = fine.data, fine.displacements, self.shorter * computed.steps
        stress = data.law.A.at(V.points)(data.initial(V.points))
        # The best approximation of u_0 in ‖·‖_V among the functions with N v ≤ 0.
        start, _ = Signorini(fine.M, V.N, V.free_points)(V.functional(stress))
        for state in MIDPOINT.march(quadratic_problem(fine, start), steps):
            yield state.time, state.u


Trajectory = SmoothedInTime | Refined
"""A way to compute ũ. ``name`` is the entry in the column ``trajectory`` of ``bounds.csv``."""


def quadratic_problem(discretisation: Discretisation, u0: Array) -> SemiDiscrete:
    """Return Problem 5.1 on displacements of degree 2 with the load (P f, ·)_V."""
    G, V = discretisation.data.law.G, discretisation.displacements
    factor = G.factor(V.points)
    return SemiDiscrete(
        M=discretisation.M,
        reference=V.form(G.reference, factor),
        remainder=remainder(V, G, factor),
        N=V.N,
        load=discretisation.load,
        u0=u0,
        T=discretisation.data.body.T,
        solver=partial(Signorini, x=V.free_points),
        growth=discretisation.data.law.growth,
    )


@dataclass(frozen=True, eq=False)
class Parabola:
    """The displacement ũ between two knots a < b, by its Bernstein coefficients in time, (dofs,) each."""

    a: float
    b: float
    start: Array
    control: Array
    end: Array

    def at(self, time: float) -> Array:
        """Return ũ(t) for a ≤ t ≤ b."""
        x = (time - self.a) / (self.b - self.a)
        return (1 - x) ** 2 * self.start + 2 * x * (1 - x) * self.control + x**2 * self.end

    def blossom(self, s: float, t: float) -> Array:
        """Return the middle Bernstein coefficient of the parabola restricted to the interval between two times."""
        x, y = ((time - self.a) / (self.b - self.a) for time in (s, t))
        return (1 - x) * (1 - y) * self.start + (x * (1 - y) + y * (1 - x)) * self.control + x * y * self.end

    def rate(self, end: bool) -> Array:
        """Return the velocity ũ̇ at a, or at b if ``end`` is true."""
        difference = self.end - self.control if end else self.control - self.start
        return 2 * difference / (self.b - self.a)


def spline(nodes: Iterable[tuple[float, Array]]) -> Iterator[Parabola]:
    """Yield the pieces of the quadratic B-spline with the control points (t_j, d_j), equally spaced in time."""
    iterator = iter(nodes)
    before, old = next(iterator)
    knot, point = before, old
    for time, new in iterator:
        middle, here = (before + time) / 2, (old + new) / 2
        # The first half step is a straight line: its control point lies between its ends.
        control = (point + here) / 2 if knot == before else old
        yield Parabola(knot, middle, point, control, here)
        before, old, knot, point = time, new, middle, here
    yield Parabola(knot, before, point, (point + old) / 2, old)

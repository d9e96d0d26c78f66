"""Displacements in time: the displacement u_h whose error is bounded, and a more accurate admissible displacement ũ.

u_h is piecewise linear in space, and linear in time between the nodes of a time scheme. ũ has degree 2 in space, on the
same mesh or on a refinement of it, and is differentiable in time. It is a quadratic B-spline in time. Its control
points are the values d_0, …, d_N ∈ K that any time scheme computes, and its knots are the midpoints of the steps:

    ũ(t_{j−1/2}) = (d_{j−1} + d_j)/2,    ũ̇(t_{j−1/2}) = (d_j − d_{j−1})/k,    ũ̇ linear in between.

On the first and the last half step ũ is a straight line. All points of the spline are convex combinations of control
points, so ũ(t) is admissible for every t, however inaccurate the control points are. At the knots ũ and ũ̇ are the
value and the difference quotient of the midpoint scheme.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Annotated

import numpy as np
import scipy.sparse as sps
from scipy.interpolate import make_interp_spline
from skfem import Mesh

from manufactured.arguments import Count, checked
from manufactured.body import Body
from manufactured.modes import at_each
from manufactured.tensors import Array
from study.bound.discretisation import Discretisation
from study.bound.problem import BoundError
from study.fem.mesh import barycentric
from study.fem.mesh import size as mesh_size
from study.fem.space import EDGES, Displacements, Quadratic, Space, nodes_of, numbers_of
from study.solve.evolution import Scheme, SemiDiscrete, remainder
from study.solve.signorini import Signorini
from study.solve.tableau import MIDPOINT

ON_NODE = 1e-5
"""A node counts as a node of a uniform refinement up to this distance in barycentric coordinates."""


@dataclass(frozen=True, eq=False)
class Computed:
    """A displacement u_h that is linear in time between stored values, computed here or by another program.

    ``compute`` makes it here, and ``study.bound.given.given`` from the arrays of another program.

    Attributes:
        mesh: the mesh.
        body: the body.
        degree: the polynomial degree in space, 1 or 2.
        times: the times from 0 to T, (k,).
        nodes: the displacements at the nodes, two components for each node in turn, (k, 2 · number of nodes). Nodes are
            the vertices and, for degree 2, then the midpoints of the edges.
        steps: a number of time steps, usually the number of intervals between ``times``. The second, more accurate
            displacement has a multiple of this number of time steps.
        remarks: sentences for the user on changes of the input and on penetration of the foundation.
        offset: 0 if u_h is the displacement of the file. If its values on Γ1 were replaced, a bound of the distance
            ‖u_file − u_h‖_V at all times.
    """

    mesh: Mesh
    body: Body
    degree: int
    times: Array
    nodes: Array
    steps: int
    remarks: tuple[str, ...] = ()
    offset: float = 0.0

    @cached_property
    def h(self) -> float:
        """The mesh size of the displacement."""
        return mesh_size(self.mesh)

    @property
    def level(self) -> int:
        """The level of the mesh: |Ω|^½/h, rounded to an integer, and at least 1.

        |Ω|^½ is the side of a square with the same area as the body, and h the mesh size.
        """
        return max(1, round(math.sqrt(self.body.measure) / self.h))

    @property
    def T(self) -> float:
        """The final time."""
        return float(self.times[-1])

    @cached_property
    def space(self) -> Displacements:
        """The finite element displacements of degree ``degree`` on the mesh; their nodes are ordered as ``nodes``."""
        return (Space if self.degree == 1 else Quadratic)(self.mesh, self.body)

    @property
    def at_vertices(self) -> Array:
        """The displacements u_h of the vertices at the k stored times, (k, 2, vertices)."""
        at_nodes = self.nodes.reshape(len(self.times), -1, 2)
        return at_nodes[:, : self.mesh.p.shape[1]].swapaxes(1, 2)

    @cached_property
    def at(self) -> Callable[[float], Array]:
        """Function from any time to the nodal values of u_h, linearly interpolated in time, (number of values,)."""
        return make_interp_spline(self.times, self.nodes, k=1)

    def on(self, fine: Discretisation) -> Callable[[float], Array]:
        """Return the function t ↦ u_h(t) on a finer mesh.

        The values of the function are coefficients of degree 2 on the mesh of ``fine``, (dofs,). This mesh is the mesh
        of u_h or a uniform refinement of it.
        """
        J = sps.csr_array(on_refinement(self.mesh, self.degree, fine.mesh)[fine.displacements.free])
        return lambda time: J @ self.at(time)


def compute(discretisation: Discretisation, scheme: Scheme, steps: int) -> Computed:
    """Solve the semi-discrete problem (Problem 5.1) by a time scheme, from the data alone.

    The load is projected onto piecewise polynomials, and the initial value is the nodal interpolant of u_0.

    Args:
        discretisation: the data of the problem and the mesh.
        scheme: the time scheme.
        steps: the number of time steps.

    Returns:
        The piecewise linear displacement u_h at the time nodes.
    """
    data = discretisation.data
    space = Space(discretisation.mesh, data.body)
    J = prolongation(space, discretisation)
    start = space.interpolate(data.start(space.mesh.p))
    problem = SemiDiscrete.of(space, data.law, lambda times: J.T @ at_each(times, discretisation.load), start)
    nodes = np.array([space.coefficients(state.u).ravel() for state in scheme.march(problem, steps)])
    times = np.linspace(0.0, data.body.T, steps + 1)
    return Computed(space.mesh, space.body, 1, times, nodes, steps)


def prolongation(space: Space, discretisation: Discretisation) -> sps.csr_array:
    """Return the matrix from P1 displacements to coefficients of degree 2 on the same or a finer mesh.

    The shape is (dofs of degree 2, dofs of degree 1).

    Args:
        space: the P1 displacements.
        discretisation: the displacements of degree 2 and their mesh.

    Raises:
        BoundError: the mesh of degree 2 is no uniform refinement of the mesh of degree 1.
    """
    full = on_refinement(space.mesh, 1, discretisation.mesh)
    return sps.csr_array(full[discretisation.displacements.free][:, space.free])


def on_refinement(mesh: Mesh, degree: int, fine: Mesh) -> sps.csr_array:
    """Return the matrix from nodal values on a mesh to Bernstein coefficients of degree 2 on a uniform refinement.

    The values are displacements, with two components for each node in turn. Nodes are the vertices and, for degree 2,
    the midpoints of the edges. A uniform refinement lists the children of all cells in the order of the cells, four
    times for each refinement. The barycentric coordinates of nodes are multiples of a power of 1/2, so the entries of
    the matrix are exact.

    Args:
        mesh: the coarse mesh.
        degree: the degree of the function on the coarse mesh, 1 or 2.
        fine: the coarse mesh itself or a uniform refinement of it.

    Raises:
        BoundError: ``fine`` is not such a refinement.
    """
    cells = mesh.t.shape[1]
    vertices = fine.p.shape[1]
    nodes = nodes_of(fine)
    count = nodes.shape[1]
    # For each node a cell of the fine mesh that has it, and the coarse cell in which this cell lies.
    _, first = np.unique(numbers_of(fine), return_index=True)
    parents = first % fine.t.shape[1] % cells
    places = barycentric(mesh.p, mesh.t[:, parents], nodes[:, :, None])[..., 0]
    parts = 2.0 * np.sqrt(fine.t.shape[1] / cells)
    exact = np.rint(parts * places) / parts
    if not (abs(exact - places).max() < ON_NODE and exact.min() >= 0):
        raise BoundError("the mesh of ũ is no refinement of the mesh of u_h")
    values = exact
    columns = mesh.t[:, parents]
    width = mesh.p.shape[1]
    if degree == 2:
        on_edges = [4 * exact[a] * exact[b] for a, b in EDGES]
        values = np.vstack([2 * exact**2 - exact, on_edges])
        columns = numbers_of(mesh)[:, parents]
        width += mesh.facets.shape[1]
    rows = np.tile(np.arange(count), len(values))
    at_nodes = sps.csr_array((values.ravel(), (rows, columns.ravel())), shape=(count, width))
    # On an edge with the values a and b at its ends and the middle Bernstein coefficient c, the value at the midpoint
    # is c/2 + (a + b)/4. This equation is solved for c.
    at_ends = at_nodes[fine.facets[0]] + at_nodes[fine.facets[1]]
    middle = 2.0 * at_nodes[vertices:] - 0.5 * at_ends
    coefficients = sps.vstack([at_nodes[:vertices], middle])
    return sps.csr_array(sps.kron(coefficients, sps.eye_array(2)))


@dataclass(frozen=True)
class SmoothedInTime:
    """Takes the computed displacement u_h itself, smoothed in time, as the displacement ũ from which bounds follow.

    The error bound then follows from u_h alone. ``name`` is the entry in the column ``trajectory`` of ``bounds.csv``.
    """

    name: str = "bound"

    def discretisation(self, coarse: Discretisation) -> Discretisation:
        return coarse

    def nodes(self, fine: Discretisation, computed: Computed) -> Iterator[tuple[float, Array]]:
        u_h = computed.on(fine)
        for time in computed.times.tolist():
            yield time, u_h(time)


@dataclass(frozen=True)
@checked(BoundError)
class Refined:
    """Computes the displacement ũ, from which error bounds of u_h follow, in degree 2 with shorter time steps than u_h.

    ũ is the solution of the semi-discrete problem (Problem 5.1) by the midpoint scheme.

    Attributes:
        refinements: how often the mesh of u_h is refined uniformly.
        shorter: the number of time steps of ũ in one time step of u_h.
        name: the entry in the column ``trajectory`` of ``bounds.csv``.

    Raises:
        BoundError: ``refinements`` is not between 0 and 20, or ``shorter`` is less than 1.
    """

    refinements: Annotated[int, 0, 20] = 1
    shorter: Count = 4
    name: str = "enclosure"

    def discretisation(self, coarse: Discretisation) -> Discretisation:
        return Discretisation(coarse.data, coarse.mesh.refined(self.refinements)) if self.refinements else coarse

    def nodes(self, fine: Discretisation, computed: Computed) -> Iterator[tuple[float, Array]]:
        data = fine.data
        G = data.law.G
        V = fine.displacements
        stress = data.law.A.at(V.points)(data.initial(V.points))
        # The initial value must be admissible (N v ≤ 0). Among these functions it is the best approximation of u_0 in
        # ‖·‖_V.
        start, _ = Signorini(fine.M, V.N, V.free_points)(V.functional(stress))
        factor = G.factor(V.points)
        problem = SemiDiscrete(
            M=fine.M,
            reference=V.form(G.reference, factor),
            remainder=remainder(V, G, factor),
            N=V.N,
            load=partial(at_each, of=fine.load),
            u0=start,
            T=data.body.T,
            solver=partial(Signorini, x=V.free_points),
            growth=data.law.growth,
        )
        for state in MIDPOINT.march(problem, self.shorter * computed.steps):
            yield state.time, state.u


Trajectory = SmoothedInTime | Refined
"""The ways to compute the displacement ũ from which bounds of the error of a computed displacement follow.

``name`` is the entry in the column ``trajectory`` of ``bounds.csv``.
"""


@dataclass(frozen=True, eq=False)
class Parabola:
    """A displacement ũ on the time interval between two knots a < b, where it is a parabola in time.

    Attributes:
        a, b: the knots.
        start, control, end: the three Bernstein coefficients of the parabola in time, (dofs,) each.
    """

    a: float
    b: float
    start: Array
    control: Array
    end: Array

    def at(self, time: float) -> Array:
        """Return the displacement ũ(t) at a time a ≤ t ≤ b, (dofs,)."""
        return self.blossom(time, time)

    def blossom(self, s: float, t: float) -> Array:
        """Return the middle Bernstein coefficient of the parabola restricted to the time interval from s to t, (dofs,).

        Args:
            s, t: the ends of the time interval; s = t gives the value at this time.
        """
        x, y = ((time - self.a) / (self.b - self.a) for time in (s, t))
        left = (1 - x) * self.start + x * self.control
        right = (1 - x) * self.control + x * self.end
        return (1 - y) * left + y * right

    def rate(self, end: bool) -> Array:
        """Return the velocity, the time derivative of the parabola, at a, or at b if ``end`` is true, (dofs,)."""
        difference = self.end - self.control if end else self.control - self.start
        return 2 * difference / (self.b - self.a)


def spline(nodes: Iterable[tuple[float, Array]]) -> Iterator[Parabola]:
    """Yield the quadratic B-spline with the given control points, as one parabola for each time interval between knots.

    Args:
        nodes: pairs of a time t_j and the control point d_j; the times are equally spaced.
    """
    iterator = iter(nodes)
    before, old = next(iterator)
    knot = before
    point = old
    for time, new in iterator:
        middle = (before + time) / 2
        here = (old + new) / 2
        # The first half step is a straight line, so its control point is the mean of its ends.
        control = (point + here) / 2 if knot == before else old
        yield Parabola(knot, middle, point, control, here)
        before = time
        old = new
        knot = middle
        point = here
    yield Parabola(knot, before, point, (point + old) / 2, old)

"""‖u(t) − u_h(t)‖_V enclosed from both sides without u, by a better trajectory ũ and its bound y:

    d(t) − y(t) ≤ ‖u(t) − u_h(t)‖_V ≤ d(t) + y(t),     d = ‖ũ − u_h‖_V.

u_h is Problem 5.1 on P1 by any time scheme, linear in time between its nodes. ũ is either u_h itself, smoothed in time
(``Itself``), which gives the plain bound, or the solution of Problem 5.1 in degree 2 on a refined mesh with shorter
steps of the midpoint scheme (``Better``), which gives the enclosure.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import chain, pairwise
from typing import Protocol

import numpy as np
import scipy.sparse as sps
from skfem import Mesh

from manufactured.tensors import Array
from study.bound.discretisation import BoundError, Setting
from study.bound.majorant import Interval, Majorant, Piece, spline
from study.fem.line import Line
from study.fem.quadrature import cell_rules
from study.fem.space import Space
from study.solve.evolution import Scheme, SemiDiscrete
from study.solve.signorini import Signorini
from study.solve.tableau import MIDPOINT
from study.statements.enclosure.claims import order_interval

INITIAL_DEGREE = 6
"""Degree of the rule for ‖u_0 − ũ(0)‖_V."""


@dataclass(frozen=True, eq=False)
class Computed:
    """u_h: P1 displacements at the nodes of a time scheme, linear in between.

    Attributes:
        space: V^h.
        nodes: the values, (steps + 1, n_dofs).
        T: final time.
    """

    space: Space
    nodes: Array
    T: float

    @property
    def steps(self) -> int:
        return len(self.nodes) - 1

    def at(self, time: float) -> Array:
        """u_h(t), (n_dofs,)."""
        place = time / self.T * self.steps
        low = min(int(place + 1e-9), self.steps - 1)
        share = place - low
        return (1 - share) * self.nodes[low] + share * self.nodes[low + 1]


def compute(setting: Setting, scheme: Scheme, steps: int) -> Computed:
    """Problem 5.1 from the data alone, with u_0^h = Π^h u_0."""
    data = setting.data
    space = Space(setting.mesh, data.body)
    J = _embedding(space, setting)

    def load(time: float) -> Array:
        return J.T @ setting.functional(setting.snapshot(time).loads)

    problem = SemiDiscrete.of(space, data.law, load, space.interpolate(data.start(setting.mesh.p)))
    return Computed(space, np.array([state.u for state in scheme.march(problem, steps)]), data.body.T)


class Trajectory(Protocol):
    """A way to ũ: the setting it lives in and its nodes."""

    @property
    def name(self) -> str: ...
    def setting(self, coarse: Setting) -> Setting: ...
    def nodes(self, setting: Setting, computed: Computed) -> Iterator[tuple[float, Array]]: ...


@dataclass(frozen=True)
class Itself:
    """ũ = u_h, smoothed in time: the bound needs nothing but the computed displacement."""

    name: str = "bound"

    def setting(self, coarse: Setting) -> Setting:
        return coarse

    def nodes(self, setting: Setting, computed: Computed) -> Iterator[tuple[float, Array]]:
        J = _embedding(computed.space, setting)
        for j, node in enumerate(computed.nodes):
            yield computed.T * j / computed.steps, J @ node


@dataclass(frozen=True)
class Better:
    """Degree 2 on the mesh refined some times, ``shorter`` steps of the midpoint scheme in each step of u_h.

    The start is the best approximation of u_0 in V and the cone.
    """

    refinements: int = 1
    shorter: int = 4
    name: str = "enclosure"

    def setting(self, coarse: Setting) -> Setting:
        return Setting(coarse.data, coarse.mesh.refined(self.refinements)) if self.refinements else coarse

    def nodes(self, setting: Setting, computed: Computed) -> Iterator[tuple[float, Array]]:
        def load(time: float) -> Array:
            return setting.functional(setting.snapshot(time).loads)

        problem = setting.problem(load, _start(setting))
        for state in MIDPOINT.march(problem, self.shorter * computed.steps):
            yield state.time, state.u


def _start(setting: Setting) -> Array:
    """The function of the cone nearest to u_0 in V."""
    data, V = setting.data, setting.displacements
    stress = data.law.A.at(V.points)(data.initial(V.points))
    return Signorini(setting.M, V.N)(V.functional(stress))[0]


@dataclass(frozen=True, eq=False)
class Enclosure:
    """The bounds of ‖u(t) − u_h(t)‖_V over [0, T].

    Attributes:
        h: mesh size of u_h.
        times: the knots after 0, (n,).
        distance: d at the times, (n,).
        bound: y at the times, (n,).
        error: the true error where it is known, else not a number, (n,).
        intervals: how y came about, one interval up to each time.
        start: bound of the error at t = 0.
        between: bound of the error over the interval up to each time, (n,).
    """

    h: float
    times: Array
    distance: Array
    bound: Array
    error: Array
    intervals: tuple[Interval, ...]
    start: float
    between: Array

    @property
    def highest(self) -> float:
        """A bound of the error over all of [0, T], between the times as well."""
        return max(self.start, float(self.between.max()))

    def bound_at(self, times: Array) -> Array:
        """Bounds at any times of (0, T]: those of the intervals the times lie in, (m,)."""
        return self.between[np.searchsorted(self.times[:-1], times)]

    @property
    def lower(self) -> Array:
        """max(d − y, 0), (n,)."""
        return np.maximum(self.distance - self.bound, 0.0)

    @property
    def upper(self) -> Array:
        """d + y, (n,)."""
        return self.distance + self.bound

    @property
    def lowest(self) -> float:
        """A lower bound of max_t ‖u(t) − u_h(t)‖_V."""
        return float(self.lower.max())

    @property
    def contains(self) -> bool:
        """Whether the known error lies inside at all times."""
        return bool(((self.lower <= self.error) & (self.error <= self.upper)).all())


def enclose(
    coarse: Setting,
    computed: Computed,
    trajectory: Trajectory,
    error: Callable[[float, Array], float] | None = None,
    progress: Callable[[float], object] = lambda time: None,
) -> Enclosure:
    """The bounds for one computed displacement.

    Args:
        coarse: the setting of u_h.
        computed: u_h.
        trajectory: where ũ comes from.
        error: (t, u_h(t)) ↦ ‖u(t) − u_h(t)‖_V, where the exact solution is known.
        progress: told every time that is done.
    """
    fine = trajectory.setting(coarse)
    J = _prolongation(computed.space, fine)
    pieces = spline(trajectory.nodes(fine, computed))
    first = next(pieces)
    start = _initial_error(fine, first.start)
    intervals, distances, errors, between = [], [], [], []
    for piece, interval in Majorant(fine)(chain([first], pieces), start):
        u = computed.at(piece.b)
        distances.append(fine.norm(piece.end - J @ u))
        errors.append(error(piece.b, u) if error else math.nan)
        intervals.append(interval)
        between.append(interval.inside + _farthest(fine, piece, computed, J))
        progress(piece.b)
    return Enclosure(
        h=computed.space.h,
        times=np.array([interval.b for interval in intervals]),
        distance=np.array(distances),
        bound=np.array([interval.at_b for interval in intervals]),
        error=np.array(errors),
        intervals=tuple(intervals),
        start=start + fine.norm(first.start - J @ computed.nodes[0]),
        between=np.array(between),
    )


def order(coarse: Enclosure, fine: Enclosure) -> tuple[float, float]:
    """An interval that contains the observed order log(E/E')/log(h/h') of E = max_t ‖u(t) − u_h(t)‖_V."""
    ends = (coarse.lowest, coarse.highest), (fine.lowest, fine.highest)
    return order_interval(*ends, math.log(coarse.h / fine.h))


def _farthest(setting: Setting, piece: Piece, computed: Computed, J: sps.csr_array) -> float:
    """A bound of ‖ũ(t) − u_h(t)‖_V on a piece: the largest of the Bernstein coefficients in time.

    A node of u_h can only lie in the middle of a piece, where the parabola is cut.
    """
    middle = piece.at((piece.a + piece.b) / 2)
    ends = [piece.start, middle, piece.end]
    controls = [(piece.start + piece.control) / 2, (piece.control + piece.end) / 2]
    times = [piece.a, (piece.a + piece.b) / 2, piece.b]
    values = [J @ computed.at(time) for time in times]
    differences = [v - w for v, w in zip(ends, values, strict=True)]
    differences += [c - (v + w) / 2 for c, (v, w) in zip(controls, pairwise(values), strict=True)]
    return max(setting.norm(d) for d in differences)


def _initial_error(setting: Setting, start: Array) -> float:
    """‖u_0 − ũ(0)‖_V by quadrature that respects where u_0 is rough."""
    data, V = setting.data, setting.displacements
    total = 0.0
    lines = [Line(direction, offset) for direction, offset in data.lines]
    for rule in cell_rules(setting.mesh, INITIAL_DEGREE, lines, data.points):
        difference = data.initial(rule.points) - V.strain_at(start, rule.cells, rule.points)
        stress = data.law.A.at(rule.points)(difference)
        total += float(np.einsum("Inq,Inq,nq->", stress, difference, rule.weights))
    return math.sqrt(total)


def _embedding(space: Space, setting: Setting) -> sps.csr_array:
    """P1 on a mesh into degree 2 on the same mesh, (dofs, n_dofs)."""
    return _into(space, setting, sps.csr_array(sps.eye_array(space.mesh.p.shape[1])))


def _prolongation(space: Space, setting: Setting) -> sps.csr_array:
    """P1 on a mesh into degree 2 on a refinement of it, (dofs, n_dofs)."""
    mesh, refined = space.mesh, sps.csr_array(sps.eye_array(space.mesh.p.shape[1]))
    while mesh.t.shape[1] < setting.mesh.t.shape[1]:
        refined = sps.csr_array(_with_middles(mesh) @ refined)
        mesh = mesh.refined()
    if not np.array_equal(mesh.p, setting.mesh.p):
        raise BoundError("the mesh of ũ is no refinement of the mesh of u_h")
    return _into(space, setting, refined)


def _with_middles(mesh: Mesh) -> sps.csr_array:
    """Vertex values of a P1 function ↦ those at the vertices and the middles of the edges."""
    count, edges = mesh.p.shape[1], mesh.facets.shape[1]
    rows = np.repeat(np.arange(edges), 2)
    middles = sps.csr_array((np.full(2 * edges, 0.5), (rows, mesh.facets.T.ravel())), shape=(edges, count))
    return sps.csr_array(sps.vstack([sps.eye_array(count), middles]))


def _into(space: Space, setting: Setting, refined: sps.csr_array) -> sps.csr_array:
    """The coefficients of degree 2 from vertex values of the same mesh, after its refinements."""
    scalar = _with_middles(setting.mesh) @ refined
    full = sps.csr_array(sps.kron(scalar, sps.eye_array(2)))
    return sps.csr_array(full[setting.displacements.free][:, space.free])

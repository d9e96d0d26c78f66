"""Lower and upper bounds of the error ‖u(t) − u_h(t)‖_V of a displacement u_h for an unknown exact solution u.

A second displacement ũ is computed (``study.bound.trajectory``), and an upper bound y of its error ‖u(t) − ũ(t)‖_V
(``study.bound.terms``). The distance d = ‖ũ − u_h‖_V can be computed exactly. The triangle inequality gives

    d(t) − y(t) ≤ ‖u(t) − u_h(t)‖_V ≤ d(t) + y(t).

If ũ is much closer to u than u_h is, y is smaller than d and the lower bound is positive. ũ may also be u_h itself,
smoothed in time; then only the upper bound is useful.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain, pairwise
from typing import Any

import numpy as np

from manufactured.case import Case
from manufactured.tensors import Array, Hyperplane, Points, Tensors
from study.bound.discretisation import Discretisation
from study.bound.problem import SMALLEST, Moduli, require_finite, require_ordered, require_visible
from study.bound.remainders import Evidence
from study.bound.terms import Interval, Majorant, Shares
from study.bound.trajectory import Computed, Parabola, Trajectory, spline
from study.fem.error_norm import ErrorNorm
from study.fem.quadrature import Line, cell_rules
from study.fem.space import Space

POOR = 0.5
"""If sampling of the data causes more than this fraction of an error bound, a message says at which place."""
SAME_TIME = 1e-9
"""Two times count as equal if they differ by less than this fraction of a time interval between knots."""
RAISED = 4
"""Increase of the degree of the standard quadrature rule when the error is computed from a known exact solution.

On coarse meshes, the standard rule has a relative error of 3 % (level 2) to 0.1 % (level 8). At small times, error and
bound differ by a few per cent only, so this is not accurate enough.
"""
INITIAL_DEGREE = 6
"""Degree of the quadrature rule for the initial error ‖u_0 − ũ(0)‖_V."""


@dataclass(frozen=True, eq=False)
class Enclosure:
    """Lower and upper bounds of the error ‖u(t) − u_h(t)‖_V over [0, T].

    They are computed from a more accurate displacement ũ, which is a spline in time.

    Attributes:
        h: the mesh size of u_h.
        times: the times of the knots of the spline ũ, without 0, (n,).
        distance: the distance d = ‖ũ − u_h‖_V at these times, (n,).
        bound: the bound y of ‖u − ũ‖_V at these times, (n,).
        error: the error of u_h at these times if the exact solution is known, otherwise NaN, (n,).
        intervals: for each time interval between knots, the terms from which y is computed.
        start: a bound of the error of u_h at t = 0.
        initial: the squared initial distance ‖u_0 − ũ(0)‖² on each cell of the mesh of ũ, computed from samples of u_0,
            (cells,).
        between: for each time interval between knots, an upper bound of the error of u_h at all of its times, (n,).
        evidence: whether the bounds are guaranteed or estimated, and why.
        norm: an interval that contains max_t ‖u(t)‖_V.
        products: the products in V of the pair (ũ, u_h), summed over these times, (2, 2).
        on_cells: for static problems the squared distance ‖ũ − u_h‖² on every cell of u_h, (cells of u_h,). It
            estimates the error on a single cell, which is not bounded.
    """

    h: float
    times: Array
    distance: Array
    bound: Array
    error: Array
    intervals: tuple[Interval, ...]
    start: float
    initial: Array
    between: Array
    evidence: Evidence
    norm: tuple[float, float]
    products: Array
    on_cells: Array = field(default_factory=lambda: np.empty(0))

    def __post_init__(self) -> None:
        """Raise BoundError unless all bounds are finite, because maxima and minima taken later could hide a NaN."""
        names = "distance", "bound", "start", "between"
        require_finite({f"the {name} of the enclosure": getattr(self, name) for name in names})
        if not np.isnan(self.error).all():
            require_finite({"the known error": self.error})
        require_ordered(self.lower, self.upper)
        require_ordered(*self.norm)

    @property
    def highest(self) -> float:
        """An upper bound of the error of u_h over all of [0, T], including times between knots."""
        return max(self.start, float(self.between.max()))

    def bound_at(self, times: Array) -> Array:
        """Return upper bounds of the error of u_h at given times in (0, T], (m,) → (m,).

        Each is the bound for the whole time interval between knots that contains the time.
        """
        return self.between[np.searchsorted(self.times[:-1], times)]

    def shares(self, moduli: Moduli) -> Shares:
        """Return the contributions of each cell and of the time steps to the error bound ``highest``.

        The contributions come from the initial error and from all time intervals before the bound is largest. Each is
        multiplied by the factor by which errors decay until then. The part due to u_0 between sample points is divided
        among the cells like the sampled initial error. The increase due to smoothing u_h in time counts as a
        contribution of the time steps.
        """
        last = int(self.between.argmax()) if self.highest > self.start else -1
        found = Shares(self.initial, 0.0).scaled_to(self.intervals[0].at_a)
        for one in self.intervals[: last + 1]:
            found = moduli.decay(one.b - one.a) * found + one.shares
        return found + Shares(0 * self.initial, self.highest - found.total)

    @property
    def factor(self) -> tuple[float, float]:
        """The factor s for which u_h/s fits ũ best, and the relative distance ‖u_h/s − ũ‖/‖ũ‖ that remains.

        The factor of a Galerkin solution is 1 on every mesh, because its error is orthogonal to it.
        """
        (better, mixed), (_, given) = self.products.tolist()
        if not mixed or not better * given:
            return math.nan, 1.0
        return given / mixed, math.sqrt(max(0.0, 1 - mixed**2 / (better * given)))

    @property
    def lower(self) -> Array:
        """The lower bound max(d − y, 0) of the error of u_h at ``times``, (n,)."""
        return np.maximum(self.distance - self.bound, 0.0)

    @property
    def upper(self) -> Array:
        """The upper bound d + y of the error of u_h at ``times``, (n,)."""
        return self.distance + self.bound

    @property
    def lowest(self) -> float:
        """A lower bound of the largest error max_t ‖u(t) − u_h(t)‖_V."""
        return float(self.lower.max())

    @property
    def contains(self) -> bool:
        """Whether the known error lies between the lower and the upper bound at all times."""
        return bool(((self.lower <= self.error) & (self.error <= self.upper)).all())


def relative(error: tuple[Any, Any], norm: tuple[float, float]) -> tuple[Any, Any]:
    """Return an interval that contains the quotient of an error and a norm, which are known as intervals.

    If the norm may be 0, the interval ends at ∞. The ends of the error are numbers, or arrays for several errors.
    """
    return (error[0] / norm[1] if norm[1] > 0 else 0.0), (error[1] / norm[0] if norm[0] > 0 else math.inf)


def enclose(
    coarse: Discretisation,
    computed: Computed,
    trajectory: Trajectory,
    error: Callable[[float, Array], float] | None = None,
    progress: Callable[[float], object] = lambda time: None,
) -> Enclosure:
    """Return lower and upper bounds of the error of a computed displacement u_h.

    Args:
        coarse: the problem on the mesh of u_h.
        computed: the displacement u_h.
        trajectory: how the displacement ũ is computed from which the bounds follow.
        error: the function (t, u_h(t)) ↦ ‖u(t) − u_h(t)‖_V if the exact solution is known.
        progress: a function that is called with each time up to which the bounds are computed.

    Raises:
        BoundError: the nodes of ũ are not equally spaced in time; the mesh of ũ is not a refinement of the mesh of u_h;
            or the data are so large or so small that their squares overflow or underflow.
    """
    fine = trajectory.discretisation(coarse)
    u_h, pieces = computed.on(fine), spline(trajectory.nodes(fine, computed))
    first = next(pieces)
    initial = squared_distances(fine, fine.data.initial, first.start, fine.data.lines)
    start = math.sqrt(float(initial.sum())) + fine.sampling.missed_at_start()
    intervals: list[Interval] = []
    rows: list[tuple[float, ...]] = []
    products = np.zeros((2, 2))
    low, high = max(0.0, float(fine.norm(first.start)) - start), 0.0
    for piece, interval in Majorant(fine)(chain([first], pieces), start):
        true, at_b = error(piece.b, computed.at(piece.b)) if error else math.nan, u_h(piece.b)
        inside = interval.inside + largest_distance(fine, piece, computed.times, u_h)
        rows.append((piece.b, interval.at_b, float(fine.norm(piece.end - at_b)), true, inside))
        products += fine.products(piece.end, at_b)
        low = max(low, float(fine.norm(piece.end)) - interval.at_b)
        high = max(high, interval.inside + float(fine.norm(np.array([piece.start, piece.control, piece.end])).max()))
        intervals.append(interval)
        progress(piece.b)
    times, bounds, distances, errors, between = np.array(rows).T.copy()
    # A message names the place where the samples of the data are too coarse. It is given only if the data between
    # sample points contribute most of the bound y.
    worst = max(intervals, key=lambda one: one.missed / (one.b - one.a))
    poor = sum(one.missed for one in intervals) > POOR * intervals[-1].at_b
    evidence = Evidence(fine.sampling.reasons, fine.sampling.worst(worst.a, worst.b) if poor else "")
    loaded = bool(initial.any() or any(fine.load(time).any() for time in times))
    found = Enclosure(
        h=computed.h,
        times=times,
        distance=distances,
        bound=bounds,
        error=errors,
        intervals=tuple(intervals),
        start=start + fine.norm(first.start - u_h(0.0)),
        initial=initial,
        between=between,
        evidence=evidence,
        norm=(low, high),
        products=products,
    )
    require_visible(found.highest, loaded or bool(computed.nodes.any()))
    # Squares of small data may have underflowed to 0 at single times, so the bound is at least SMALLEST.
    return replace(found, bound=np.maximum(bounds, SMALLEST)) if found.highest > 0 else found


def known_error(case: Case | None, computed: Computed) -> Callable[[float, Array], float] | None:
    """Return the function (t, u_h(t)) ↦ ‖u(t) − u_h(t)‖_V, or None if the exact solution is unknown."""
    if case is None:
        return None
    space = Space(computed.mesh, computed.body)
    v_norm = ErrorNorm(case.solution, space, raised=RAISED)
    return lambda time, u: v_norm.distance(v_norm.sample(time), u[space.free])


def largest_distance(fine: Discretisation, piece: Parabola, nodes: Array, u_h: Callable[[float], Array]) -> float:
    """Return a bound of the distance ‖ũ(t) − u_h(t)‖_V over one time interval, on which ũ is a parabola in time.

    Each part of the interval on which u_h is linear is considered separately. There ũ − u_h is a parabola in Bernstein
    form, and the norm is at most the largest norm of its coefficients.

    Args:
        fine: the spaces on the mesh of ũ.
        piece: the parabola ũ.
        nodes: the times between which u_h is linear.
        u_h: the function t ↦ u_h(t).
    """
    k, middle = piece.b - piece.a, (piece.a + piece.b) / 2
    low, high = np.searchsorted(nodes, [piece.a + SAME_TIME * k, piece.b - SAME_TIME * k])
    inside = nodes[low:high]
    cuts = np.unique([piece.a, middle, piece.b, *inside[abs(inside - middle) > SAME_TIME * k]]).tolist()
    differences = [piece.at(time) - u_h(time) for time in cuts]
    differences += [piece.blossom(c, d) - (u_h(c) + u_h(d)) / 2 for c, d in pairwise(cuts)]
    return float(fine.norm(np.array(differences)).max())


def squared_distances(
    discretisation: Discretisation, strain: Callable[[Points], Tensors], v: Array, rough: Sequence[Hyperplane]
) -> Array:
    """Return the squared energy norm of the difference of two strains ε and ε(v) on every cell, (cells,).

    The squared norm is ∫_T A(ε − ε(v))·(ε − ε(v)).

    Args:
        discretisation: the mesh and the space of v.
        strain: the function from points to the strain ε, (2, ...) → (3, ...).
        v: a displacement of degree 2, (dofs,).
        rough: the lines (direction, offset) at which ε is not smooth; quadrature points are graded towards these lines.
    """
    data, V = discretisation.data, discretisation.displacements
    squares = np.zeros(discretisation.mesh.t.shape[1])
    lines = [Line(*line) for line in rough]
    for rule in cell_rules(discretisation.mesh, INITIAL_DEGREE, lines, data.points):
        difference = strain(rule.points) - V.strain_at(v, rule.cells, rule.points)
        stress = data.law.A.at(rule.points)(difference)
        np.add.at(squares, rule.cells, np.einsum("Inq,Inq,nq->n", stress, difference, rule.weights))
    return squares


def order_interval(coarse: tuple[float, float], fine: tuple[float, float], ratio: float) -> tuple[float, float]:
    """Return the interval of the order log(E/E')/log(h/h') of two errors E and E' that are known as intervals.

    If the lower bound of an error is 0, an end of the result is infinite.

    Args:
        coarse: an interval that contains the error E ≥ 0 on the mesh of size h.
        fine: an interval that contains the error E' ≥ 0 on the mesh of size h' < h.
        ratio: the logarithm log(h/h') of the ratio of both mesh sizes.
    """
    low = math.log(coarse[0] / fine[1]) / ratio if coarse[0] > 0 else -math.inf
    high = math.log(coarse[1] / fine[0]) / ratio if fine[0] > 0 else math.inf
    return low, high

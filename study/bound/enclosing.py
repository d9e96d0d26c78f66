"""Lower and upper bounds of the error ‖u(t) − u_h(t)‖_V, although the solution u is unknown.

A second displacement ũ is computed (``study.bound.trajectory``), and a bound y of its error ‖u(t) − ũ(t)‖_V
(``study.bound.terms``). The distance d = ‖ũ − u_h‖_V is known exactly, and the triangle inequality gives

    d(t) − y(t) ≤ ‖u(t) − u_h(t)‖_V ≤ d(t) + y(t).

If ũ is closer to u than u_h is, y is smaller than d and the lower bound is positive. If ũ is u_h itself, smoothed in
time, only the upper bound says something.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import chain, pairwise

import numpy as np

from manufactured.case import Case
from manufactured.tensors import Array, Hyperplane, Points, Tensors
from study.bound.discretisation import Discretisation
from study.bound.problem import SMALLEST, Moduli, require_finite, require_visible
from study.bound.remainders import Evidence
from study.bound.terms import Interval, Majorant, Shares
from study.bound.trajectory import Computed, DiscreteSolution, Parabola, Trajectory, spline
from study.fem.error_norm import ErrorNorm
from study.fem.quadrature import Line, cell_rules

POOR = 0.5
"""Fraction of y due to remainders of data above which the output says where the samples are too coarse."""
SAME_TIME = 1e-9
"""Difference of two times, relative to the length of a piece, up to which they count as equal."""
RAISED = 4
"""Added to the degree of the standard quadrature for a known error. On coarse meshes the standard rule has a relative
error of 3 % (n = 2) to 0.1 % (n = 8), and bounds at small times differ by a few per cent only."""
INITIAL_DEGREE = 6
"""Degree of the quadrature rule for ‖u_0 − ũ(0)‖_V."""


@dataclass(frozen=True, eq=False)
class Enclosure:
    """Lower and upper bounds of ‖u(t) − u_h(t)‖_V over [0, T].

    Attributes:
        h: mesh size of u_h.
        times: the knots of ũ after 0, (n,).
        distance: d at the times, (n,).
        bound: y at the times, (n,).
        error: the true error if the exact solution is known, otherwise NaN, (n,).
        intervals: the terms of y, one interval up to each time.
        start: bound of the error at t = 0.
        initial: ‖u_0 − ũ(0)‖² on the cells of ũ, from samples of u_0, (cells,).
        between: bound of the error on the interval that ends at each time, (n,).
        evidence: whether the bounds are guaranteed or estimated, and why.
        norm: an interval that contains max_t ‖u(t)‖_V.
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

    def __post_init__(self) -> None:
        """Raise BoundError unless all bounds are finite; a NaN would be lost in maxima and minima."""
        names = "distance", "bound", "start", "between"
        require_finite({f"the {name} of the enclosure": getattr(self, name) for name in names})
        if not np.isnan(self.error).all():
            require_finite({"the known error": self.error})

    @property
    def highest(self) -> float:
        """A bound of the error over all of [0, T], including times between knots."""
        return max(self.start, float(self.between.max()))

    def bound_at(self, times: Array) -> Array:
        """Return bounds of the error at m times in (0, T], (m,): the bounds on the pieces that contain the times."""
        return self.between[np.searchsorted(self.times[:-1], times)]

    def shares(self, moduli: Moduli) -> Shares:
        """Return the contributions of the cells and of time to ``highest``, the bound of the error.

        They are the shares of the initial error and of all pieces up to the time at which the bound is largest; each
        has decayed until then. The remainder of u_0 is divided in proportion to the sampled initial error. The increase
        due to smoothing in time belongs to time.
        """
        last = int(self.between.argmax()) if self.highest > self.start else -1
        found = Shares(self.initial, 0.0).scaled_to(self.intervals[0].at_a)
        for one in self.intervals[: last + 1]:
            found = moduli.decay(one.b - one.a) * found + one.shares
        return found + Shares(0 * self.initial, self.highest - found.total)

    @property
    def lower(self) -> Array:
        """Lower bound max(d − y, 0) of the error at the times, (n,)."""
        return np.maximum(self.distance - self.bound, 0.0)

    @property
    def upper(self) -> Array:
        """Upper bound d + y of the error at the times, (n,)."""
        return self.distance + self.bound

    @property
    def lowest(self) -> float:
        """A lower bound of max_t ‖u(t) − u_h(t)‖_V."""
        return float(self.lower.max())

    @property
    def relative(self) -> tuple[float, float]:
        """Interval that contains max_t ‖u(t) − u_h(t)‖_V / max_t ‖u(t)‖_V; the upper end is ∞ if u may be 0."""
        return relative((self.lowest, self.highest), self.norm)

    @property
    def contains(self) -> bool:
        """Whether the known error lies in the enclosure at all times."""
        return bool(((self.lower <= self.error) & (self.error <= self.upper)).all())


def relative(error: tuple[float, float], norm: tuple[float, float]) -> tuple[float, float]:
    """Return an interval that contains error / norm, from intervals of both. It ends at ∞ if the norm may be 0."""
    return (error[0] / norm[1] if norm[1] > 0 else 0.0), (error[1] / norm[0] if norm[0] > 0 else math.inf)


def enclose(
    coarse: Discretisation,
    computed: Computed,
    trajectory: Trajectory,
    error: Callable[[float, Array], float] | None = None,
    progress: Callable[[float], object] = lambda time: None,
) -> Enclosure:
    """Return lower and upper bounds of the error of a computed displacement on the mesh of ``coarse``.

    Args:
        error: function (t, u_h(t)) ↦ ‖u(t) − u_h(t)‖_V if the exact solution is known.
        progress: called with each knot after its bound is computed.

    Raises:
        BoundError: the nodes of ũ are not equally spaced in time; its mesh is not a refinement of the mesh of u_h; or
            the data are so large or so small that their squares overflow or underflow.
    """
    return enclose_several(coarse, [computed], trajectory, error, progress)[0]


def enclose_several(
    coarse: Discretisation,
    computed: Sequence[Computed],
    trajectory: Trajectory,
    error: Callable[[float, Array], float] | None = None,
    progress: Callable[[float], object] = lambda time: None,
) -> list[Enclosure]:
    """Return the bounds of the errors of several displacements on one mesh; ũ and y are computed once.

    Args:
        computed: displacements on the mesh of ``coarse``. The first one decides the time steps of ũ.
        error, progress: as in ``enclose``.

    Raises:
        BoundError: as in ``enclose``.
    """
    fine = trajectory.discretisation(coarse)
    fields, pieces = [u_h.on(fine) for u_h in computed], spline(trajectory.nodes(fine, computed[0]))
    first = next(pieces)
    initial = squared_distances(fine, fine.data.initial, first.start, fine.data.lines)
    start = math.sqrt(float(initial.sum())) + fine.sampling.missed_at_start()
    intervals: list[Interval] = []
    rows: list[list[tuple[float, ...]]] = [[] for _ in computed]
    low, high = max(0.0, float(fine.norm(first.start)) - start), 0.0
    for piece, interval in Majorant(fine)(chain([first], pieces), start):
        for u_h, given, found in zip(fields, computed, rows, strict=True):
            true = error(piece.b, given.at(piece.b)) if error else math.nan
            between = interval.inside + largest_distance(fine, piece, given.times, u_h)
            found.append((float(fine.norm(piece.end - u_h(piece.b))), true, between))
        low = max(low, float(fine.norm(piece.end)) - interval.at_b)
        high = max(high, interval.inside + float(fine.norm(np.array([piece.start, piece.control, piece.end])).max()))
        intervals.append(interval)
        progress(piece.b)
    times, bounds = (np.array([getattr(one, name) for one in intervals]) for name in ("b", "at_b"))
    # Where the data are seen poorly counts if what samples may miss is most of y.
    worst = max(intervals, key=lambda one: one.missed / (one.b - one.a))
    poor = sum(one.missed for one in intervals) > POOR * intervals[-1].at_b
    evidence = Evidence(fine.sampling.reasons, fine.sampling.worst(worst.a, worst.b) if poor else "")
    loaded = bool(initial.any() or any(fine.load(time).any() for time in times))
    result = []
    for u_h, given, found in zip(fields, computed, rows, strict=True):
        distances, errors, between = np.array(found).T.copy()
        at_0 = start + fine.norm(first.start - u_h(0.0))
        one = Enclosure(
            given.h,
            times,
            distances,
            bounds,
            errors,
            tuple(intervals),
            at_0,
            initial,
            between,
            evidence,
            (low, high),
        )
        require_visible(fine.data, one.highest, loaded or bool(given.nodes.any()))
        # Squares may have vanished at single times.
        result.append(replace(one, bound=np.maximum(bounds, SMALLEST)) if one.highest > 0 else one)
    return result


def known_error(case: Case | None, computed: DiscreteSolution) -> Callable[[float, Array], float] | None:
    """Return the function (t, u_h(t)) ↦ ‖u(t) − u_h(t)‖_V, or None if the exact solution is unknown."""
    if case is None:
        return None
    v_norm = ErrorNorm(case.solution, computed.space, raised=RAISED)
    return lambda time, u: v_norm.distance(v_norm.sample(time), u)


def largest_distance(fine: Discretisation, piece: Parabola, nodes: Array, u_h: Callable[[float], Array]) -> float:
    """Return a bound of ‖ũ(t) − u_h(t)‖_V on a piece: the largest norm of the Bernstein coefficients in time.

    Args:
        nodes: times between which u_h is linear. The parabola is divided at these times and in the middle of the piece.
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
    """Return the integrals ∫_T A(ε − ε(v))·(ε − ε(v)) over the cells, (cells,).

    Args:
        strain: function from points to ε, (2, ...) → (3, ...).
        v: displacement of degree 2, (dofs,).
        rough: lines (direction, offset) at which ε is not smooth, for graded quadrature.
    """
    data, V = discretisation.data, discretisation.displacements
    squares = np.zeros(discretisation.mesh.t.shape[1])
    lines = [Line(direction, offset) for direction, offset in rough]
    for rule in cell_rules(discretisation.mesh, INITIAL_DEGREE, lines, data.points):
        difference = strain(rule.points) - V.strain_at(v, rule.cells, rule.points)
        stress = data.law.A.at(rule.points)(difference)
        np.add.at(squares, rule.cells, np.einsum("Inq,Inq,nq->n", stress, difference, rule.weights))
    return squares


def order_interval(coarse: tuple[float, float], fine: tuple[float, float], ratio: float) -> tuple[float, float]:
    """Return the interval of the order log(E/E')/ratio; an end is infinite if a lower bound is 0.

    Args:
        coarse, fine: intervals that contain the errors E and E' ≥ 0 on meshes of sizes h > h'.
        ratio: log(h/h').
    """
    low = math.log(coarse[0] / fine[1]) / ratio if coarse[0] > 0 else -math.inf
    high = math.log(coarse[1] / fine[0]) / ratio if fine[0] > 0 else math.inf
    return low, high

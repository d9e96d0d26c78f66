"""Bounds of how much the data change between sample points, and the decision whether an error bound is guaranteed.

*Guaranteed*: the error bound holds for the data between all quadrature points and times, because ranges of the formulas
are bounded. Rounding, and the floating-point eigenvalues in the constants, are not enclosed. *Estimated*: some datum is
known at sample points only, and its change between the points is not bounded.

The terms of the error bound use the data at quadrature points in space. In time they use four points of each interval
[a, b] of length k on which the displacement ũ is a parabola. On a cell T with centre z and half widths r, let F be the
Taylor polynomial of the datum f(·, t) at z of degree j − 1 ≤ 3. Then

    |f − F| ≤ Σ_{|α| = j} r^α sup_{T×[a,b]} |∂^α f|/α!  =: e_T,    or  e_T = half the range of f for j = 0.

The smallest e_T over all j is used; if f has kinks, a low j is best. Every step of the computation is exact for F: the
rules integrate products of degree 6, and their weights are positive. So for each norm of the samples a term |T|^{1/2}
e_T bounds the effect of the difference f − F. The remainder (f − F) − P(f − F) need not be orthogonal to rigid motions
and is bounded by 2 C_Ω |T|^{1/2} e_T, with C_Ω of ``study.bound.problem``. In time

    |f − (parabola through a, a + k/2 and b)|       ≤ (1 + Λ₃) min_j (k/2)^j |∂_t^j f|/j! =: p_T,   j ≤ 3,
    |f − (cubic through a, a + k/4, a + k/2 and b)| ≤ (1 + Λ₄) min_j (k/2)^j |∂_t^j f|/j! =: q_T,   j ≤ 4,

where Λ₃ and Λ₄ are the Lebesgue constants of these points; for j = 0 the derivative is replaced by half the range. On
edges of Γ2 the same bounds hold with the arc length as variable, on each subinterval of an edge with a separate
quadrature rule.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import sympy as sp

from manufactured.body import CORNER_ROUNDING, Kind
from manufactured.data import Data, Expressions, gradient
from manufactured.factor import UNIFORM, x1, x2
from manufactured.law import Linear
from manufactured.symbols import t
from manufactured.tensors import Array
from study.bound.problem import LoadConstants, load_constants, place, require_finite
from study.bound.ranges import ACROSS, ARC, Boxes, Intervals, Pair, RangeError, along_side, require_known
from study.fem.quadrature import Line, rough_cells
from study.stresses.loads import EDGE_PARTS, LeftOut
from study.stresses.oscillation import Oscillation
from study.stresses.stress_space import StressSpace

ORDER = 4
"""Order of the Taylor expansions of the data, which is one more than the highest degree of the Taylor polynomials."""
CACHED = 64
"""Number of time intervals for which bounds of the data between sample points are cached."""
Sides = Mapping[sp.Symbol, Pair | Intervals]
"""The type of boxes around cells or parts of edges: for each coordinate, their lower and upper ends, (boxes,) each."""
POOR = 0.5
"""Limit of the fraction of an error bound that is due to unknown changes of the loads between sample points.

Above this fraction a message names the point where the change is largest.
"""

GUARANTEED, ESTIMATED = "guaranteed", "estimated"
PARABOLA_FACTOR, CUBIC_FACTOR = 2.2513, 4.0559
"""The factors 1 + Λ in bounds of the interpolation error in time, with the Lebesgue constant Λ of the nodes.

The nodes are 0, k/2 and k for the parabola, and 0, k/4, k/2 and k for the cubic, in a time interval of length k.
"""


def proportional(squares: Array) -> Array:
    """Divide √(Σ s_i) into n parts that are proportional to the squares s_i: (n,) → (n,)."""
    return np.asarray(squares / max(np.sqrt(squares.sum()), np.finfo(float).tiny))


@dataclass(frozen=True)
class Evidence:
    """States whether an error bound is guaranteed or only estimated, and why.

    Attributes:
        reasons: the reasons why the bound is only estimated; empty if it is guaranteed.
        poorly_seen: a text that names the datum, point and time at which samples are too coarse; empty if they suffice.
    """

    reasons: tuple[str, ...]
    poorly_seen: str = ""

    @property
    def kind(self) -> str:
        return ESTIMATED if self.reasons else GUARANTEED

    @property
    def sentences(self) -> list[str]:
        """Sentences for the user: whether the bound is guaranteed, why not, and how to improve it."""
        sentences = [f"estimated: {reason}; what lies between its samples is not bounded" for reason in self.reasons]
        if not sentences:
            sentences.append("guaranteed: also between quadrature points and times; rounding is not enclosed")
        if self.poorly_seen:
            sentences.append(f"{self.poorly_seen}: take finer levels or more --steps for a narrower interval")
        return sentences


def in_space(sides: Sides, formulas: Sequence[sp.Expr], a: float, b: float) -> Array:
    """Return for each box a bound of the Euclidean norm |f − F| of the data f minus a polynomial F in space, (boxes,).

    The bound holds on the box and at all times a ≤ t ≤ b. For each component of f it is the smallest of five bounds:
    for the Taylor polynomials F of the degrees 0 to 3 at the centre of the box, and half the range of the component,
    for a constant F in the middle of the range.

    Args:
        sides: the boxes: for each coordinate, their lower and upper ends.
        formulas: the components of the data, such as the body force.
        a, b: the ends of the time interval.
    """
    bounds = _by_order(sides, tuple(sides), formulas, a, b)
    # Unlike a root of a sum of squares, ``hypot`` neither overflows nor underflows.
    return np.asarray(np.hypot.reduce(bounds.min(axis=1)))


def in_time(sides: Sides, formulas: Sequence[sp.Expr], a: float, b: float) -> Array:
    """Return for each box bounds of the data minus their interpolants in time by a parabola and by a cubic, (2, boxes).

    The bounds hold on the box and at all times a ≤ t ≤ b. With the length k = b − a, the parabola interpolates at a, a
    + k/2 and b, and the cubic also at a + k/4.

    Args:
        sides: the boxes: for each coordinate, their lower and upper ends.
        formulas: the components of the data, such as the body force.
        a, b: the ends of the time interval.
    """
    bounds = _by_order(sides, (t,), formulas, a, b)
    parabola = PARABOLA_FACTOR * bounds[:, :ORDER].min(axis=1)
    cubic = CUBIC_FACTOR * bounds.min(axis=1)
    return np.asarray(np.hypot.reduce([parabola, cubic], axis=1))


def _by_order(sides: Sides, variables: tuple[sp.Symbol, ...], formulas: Sequence[sp.Expr], a: float, b: float) -> Array:
    """Return bounds of formulas minus their Taylor polynomials of degree −1 to 3, (1 + formulas, ORDER + 1, boxes).

    The boxes extend from a to b in time. For the degree j − 1 the bound is Σ_{|α| = j} r^α sup |∂^α f|/α!, where r are
    half the widths of the boxes, or half the range of f for j = 0. The bounds of the first formula, 0, are 0.
    """
    count = len(next(iter(sides.values()))[0])
    boxes = Boxes({**sides, t: (np.full(count, a), np.full(count, b))}, variables, ORDER)
    radii = np.array([np.ptp(boxes.sides[variable], axis=0) / 2 for variable in variables])
    keys = np.array(boxes.keys)
    orders = keys.sum(axis=1)
    powers = np.prod(radii ** keys[..., None], axis=1)
    bounds = np.zeros((1 + len(formulas), ORDER + 1, count))
    for bound, formula in zip(bounds[1:], formulas, strict=True):
        series = boxes(formula)
        # Where a box has no width, nothing changes, even if there is no bound of the derivative.
        sizes = np.where(powers == 0, 0.0, series.largest) * powers
        bound[0] = np.ptp(series.values, axis=0) / 2
        for order in range(1, ORDER + 1):
            bound[order] = sizes[orders == order].sum(axis=0)
    return bounds


def strain_of_start(expressions: Expressions) -> tuple[sp.Expr, ...]:
    """Return formulas for the three Mandel components of the strain ε(u_0) of the initial displacement.

    Args:
        expressions: the formulas of the data, among them those of u_0.
    """
    e_11, slope, other_slope, e_22 = gradient(expressions.start, (x1, x2))
    return e_11, e_22, (slope + other_slope) / sp.sqrt(2)


@dataclass(frozen=True, eq=False)
class Missed:
    """Bounds of the loads minus their samples, on one time interval between knots of the more accurate displacement.

    The error bound samples the loads at quadrature points and at a few times.

    Attributes:
        cells: for every cell, the increase of its oscillation, which makes the oscillation valid between the samples,
            too, (cells,). The oscillation bounds the work of the loads that the discrete stresses do not balance.
        everywhere: a bound, in the dual norm, of the other effects of the differences, for which there are no bounds on
            single cells: differences in space may do work on rigid motions of a cell, and in time the loads differ
            from the cubic that interpolates them.
        in_cells: the part of ``everywhere`` that is due to differences in space, so that a finer mesh would reduce it.
            It is divided among the cells, (cells,), to decide which to refine.
    """

    cells: Array
    everywhere: float
    in_cells: Array


@dataclass(frozen=True, eq=False)
class Sampling:
    """Decides whether the error bound is guaranteed, and bounds the change of the data between sample points.

    Attributes:
        data: the problem.
        space: the composite stresses on the mesh, at whose quadrature points the loads and the initial strain are
            sampled.
    """

    data: Data
    space: StressSpace

    @cached_property
    def reasons(self) -> tuple[str, ...]:
        """The reasons why the error bound is only estimated; empty if it is guaranteed."""
        data = self.data
        law = data.law
        reasons = []
        if not isinstance(data.formulas_of, Expressions):
            reasons.append("f_0, f_2 and u_0 are known at points and times only, not as formulas")
        else:
            try:
                for formula in (*_loads(data.formulas_of), *strain_of_start(data.formulas_of)):
                    require_known(formula)
            except RangeError as error:
                reasons.append(str(error))
        if law.A.factor is not UNIFORM or law.G.factor is not UNIFORM:
            reasons.append("A or G varies in x, and norms with it are quadratures")
        if not isinstance(law.G, Linear):
            reasons.append(f"the term of the nonlinear G of {law.name} is a quadrature")
        lines = [Line(*line) for line in data.lines]
        if rough_cells(self.space.mesh, lines, data.points).any():
            reasons.append(
                "cells at the lines and points where the data are rough have graded rules, which are not exact"
            )
        return tuple(reasons)

    @cached_property
    def constants(self) -> LoadConstants:
        """The constants C_Ω and C_Γ that bound the work of body forces and of tractions (``load_constants``)."""
        assert isinstance(self.data.law.A, Linear)
        return load_constants(self.data.body, self.data.law.A)

    def missed(self, oscillation: Oscillation, a: float, b: float) -> Missed:
        """Return bounds of the loads f_0 and f_2 minus their samples in the time interval a ≤ t ≤ b.

        If the error bound is only estimated, the bounds are zero. They are zero for cubic polynomials, too, and
        ``constants`` are then not computed.

        Args:
            oscillation: the function that computes the oscillation of a load on each cell from norms of the load.
            a, b: the ends of the time interval.
        """
        cells = self.space.cells
        nothing = Missed(np.zeros(cells), 0.0, np.zeros(cells))
        if self.reasons:
            return nothing
        force, surface = self._remainders(a, b)
        if not (force.any() or surface.any()):
            return nothing
        C = self.constants
        e, p, q = force
        e_Γ, p_Γ, q_Γ = surface
        rest = C.volume * np.linalg.norm(2 * e + q) + C.surface * np.linalg.norm(2 * e_Γ + q_Γ)
        on_edges = C.surface * proportional((2 * e_Γ) ** 2)
        in_cells = C.volume * proportional((2 * e) ** 2)
        in_cells += np.bincount(self.space.mesh.f2t[0], on_edges, cells)
        return Missed(oscillation(LeftOut(e + p, e + p, e_Γ + p_Γ)), float(rest), in_cells)

    def missed_at_start(self) -> float:
        """Return a bound of the error in the distance ‖u_0 − ũ(0)‖_V that is due to sampling the initial value u_0.

        ũ is the more accurate displacement. If the error bound is only estimated, the result is zero.
        """
        if self.reasons:
            return 0.0
        e = in_space(self._cells, strain_of_start(self._expressions), 0.0, 0.0)
        require_finite({"what samples of ε(u_0) miss": e})
        norm = np.linalg.norm(np.sqrt(self.space.volumes) * e)
        return float(2 * np.sqrt(self.data.law.A.lipschitz) * norm)

    def evidence(self, missed: float, bound: float, a: float, b: float) -> Evidence:
        """Return whether the error bound is guaranteed.

        If more than the fraction ``POOR`` of the error bound is due to changes of the loads between sample points, the
        result names the load and the point at which it changes most for a ≤ t ≤ b.

        Args:
            missed: the part of the error bound that is due to these changes; 0 if they are not bounded.
            bound: the error bound.
            a, b: the ends of the time interval with the largest changes.
        """
        if not missed > POOR * bound:
            return Evidence(self.reasons)
        force, surface = (2 * e + q for e, _, q in self._remainders(a, b))
        mesh = self.space.mesh
        if self.constants.volume * force.max() >= self.constants.surface * surface.max(initial=0.0):
            load = "f_0"
            vertices = mesh.t[:, force.argmax()]
        else:
            load = "f_2"
            vertices = mesh.facets[:, surface.argmax()]
        at = mesh.p[:, vertices].mean(axis=1)
        return Evidence((), f"{load} is seen poorly near x = {place(at)}, {a:.3g} ≤ t ≤ {b:.3g}")

    @property
    def _expressions(self) -> Expressions:
        assert isinstance(self.data.formulas_of, Expressions)
        return self.data.formulas_of

    @cached_property
    def _cells(self) -> Sides:
        corners = self.space.mesh.p[:, self.space.mesh.t]
        ends = np.stack([corners.min(axis=1), corners.max(axis=1)], axis=1)
        return dict(zip((x1, x2), ends, strict=True))

    @cached_property
    def _loaded(self) -> Sequence[tuple[Array, Sides, list[sp.Expr]]]:
        """For each part of Γ2: its edges, the subintervals of these edges, and f_2 as formulas in the arc length."""
        body = self.data.body
        mesh = self.space.mesh
        loads = dict(self._expressions.loads)
        loaded = []
        for part, edges in self.space.on(Kind.LOADED):
            (along,), _ = part.coordinates(mesh.p[:, mesh.facets[:, edges]])
            low, high = np.sort(along, axis=0)
            cuts = np.linspace(low, high, EDGE_PARTS + 1)
            formulas = along_side(part, loads.get(body.parts.index(part), ()), ACROSS)
            # Rounding moves samples off the side. Conditions that change across the side are undecided on it.
            width = np.full(cuts[1:].size, CORNER_ROUNDING * abs(body.vertices).max())
            sides = {ARC: (cuts[:-1].ravel(), cuts[1:].ravel()), ACROSS: (-width, width)}
            loaded.append((edges, sides, formulas))
        return loaded

    @cached_property
    def _remainders(self) -> Callable[[float, float], tuple[Array, Array]]:
        """Function from the ends of a time interval to the L² norms of the bounds e, p and q of the loads.

        The result is a pair: the norms for f_0 on each cell, (3, cells), and the norms for f_2 on each edge,
        (3, edges).
        """
        # Results are cached, because several callers need the same intervals. If the loads do not depend on time, all
        # intervals have the same result.
        cached = lru_cache(maxsize=CACHED)(self._compute_remainders)
        if any(formula.has(t) for formula in _loads(self._expressions)):
            return cached
        return lambda a, b: cached(0.0, 0.0)

    def _compute_remainders(self, a: float, b: float) -> tuple[Array, Array]:
        """Return the L² norms of the bounds e, p and q for a ≤ t ≤ b, in the form that ``_remainders`` describes."""

        def all_three(sides: Sides, formulas: Sequence[sp.Expr]) -> Array:
            return np.array([in_space(sides, formulas, a, b), *in_time(sides, formulas, a, b)])

        force = all_three(self._cells, self._expressions.force)
        surface = np.zeros((3, len(self.space.lengths)))
        for edges, sides, formulas in self._loaded:
            # The root mean square over the subintervals of an edge; times the root of the length below, it is the L²
            # norm.
            of_parts = all_three(sides, formulas).reshape(3, EDGE_PARTS, -1)
            surface[:, edges] = np.sqrt(np.mean(of_parts**2, axis=1))
        for name, bounds in (("f_0", force), ("f_2", surface)):
            require_finite({f"what samples of {name} in space miss": bounds[0]})
            require_finite({f"what samples of {name} in time miss": bounds[1:]})
        return force * np.sqrt(self.space.volumes), surface * np.sqrt(self.space.lengths)


def _loads(expressions: Expressions) -> tuple[sp.Expr, ...]:
    """Return the formulas for all components of the loads f_0 and f_2."""
    return (*expressions.force, *(formula for _, load in expressions.loads for formula in load))

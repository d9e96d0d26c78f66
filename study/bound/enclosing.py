"""Lower and upper bounds of the error ‖u(t) − u_h(t)‖_V of a displacement u_h for an unknown exact solution u.

A second displacement ũ is computed (``study.bound.trajectory``), and an upper bound y of its error ‖u(t) − ũ(t)‖_V
(``study.bound.terms``). The distance d = ‖ũ − u_h‖_V can be computed exactly. The triangle inequality gives

    d(t) − y(t) ≤ ‖u(t) − u_h(t)‖_V ≤ d(t) + y(t).

If ũ is much closer to u than u_h is, y is smaller than d and the lower bound is positive. ũ may also be u_h itself,
smoothed in time; then only the upper bound is useful.

Static linear elasticity: lower and upper bounds of the error of u_h in the energy norm ‖v‖² = (Gε(v), ε(v))_Q.

Let ũ ∈ K be any displacement that does not penetrate the foundation. Let the stress σ̃ balance the projected loads f̃,
with σ̃_τ = 0 (no friction) and σ̃_ν ≤ 0 (no pulling) on Γ3. Testing as in ``study.bound.terms`` gives for the error
e = u − ũ

    ‖e‖² ≤ R ‖e‖ + c,    R = (Σ_T (‖σ̃ − Gε(ũ)‖_{G⁻¹,T} + η_T)²)^½ + remainder of the data,   c = ∫_{Γ3} σ̃_ν ũ_ν,

where η_T bounds the loads that the projection leaves out on a cell T. So ‖e‖ ≤ y = R/2 + (R²/4 + c)^½. This is the
bound of Prager and Synge with contact. Without a contact side c is 0, and the bound is y = R, as in textbooks.

**Rollers and prescribed displacements.** On rollers, for example lines of symmetry, e_ν = 0 and σ̃_τ = 0, so that the
rollers add nothing to the work of σ̃ on e. If a displacement is prescribed, u and ũ have the same values on Γ1 (and the
same normal components on rollers), so e vanishes there and the proof is unchanged. ũ has these values exactly, because
they are linear on each side. Rigid motions are excluded by ``Body``, and the constants of ``study.bound.problem`` are
computed with the same boundary conditions, τ_τ = 0 on rollers. The topology of the body is used nowhere, so holes
change nothing: σ̃ is found by its tractions and not by a stress function.

**The energy ‖u‖².** Without contact, and with nothing prescribed, (u, ũ) = f(ũ) in the energy inner product. So
‖u‖² = ‖ũ‖² + 2 (e, ũ) + ‖e‖² = 2 f(ũ) − ‖ũ‖² + ‖e‖². The work f̃(ũ) of the projected loads differs from f(ũ) by the
samples only, because ũ is of degree 2 and f − P f is orthogonal to such functions. If δ bounds the dual norm of the
loads minus their samples,

    2 f̃(ũ) − ‖ũ‖² − 2 δ ‖ũ‖ ≤ ‖u‖² ≤ 2 f̃(ũ) − ‖ũ‖² + y² + 2 δ ‖ũ‖.

If ũ is the Galerkin solution, f̃(ũ) = ‖ũ‖². With contact or prescribed displacements, ‖ũ‖ − y ≤ ‖u‖ ≤ ‖ũ‖ + y is used.

With ũ = u_h this is an upper bound of the error of u_h. With a displacement ũ of degree 2 on a refined mesh and
d = ‖ũ − u_h‖ it gives both ends, d − y ≤ ‖u − u_h‖ ≤ d + y.

Source: W. Prager, J. L. Synge, Approximations in elasticity based on the concept of function space, Quart. Appl. Math.
5 (1947) 241–269.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import chain, pairwise
from typing import Any

import numpy as np

from manufactured.body import Kind
from manufactured.case import Case
from manufactured.tensors import Array, Hyperplane, Points, Tensors
from study.bound.discretisation import Discretisation
from study.bound.problem import SMALLEST_BOUND, BoundError, Moduli, require_finite, require_ordered, require_visible
from study.bound.remainders import Evidence, Missed, proportional
from study.bound.terms import Interval, Majorant, Shares
from study.bound.trajectory import Computed, Parabola, Trajectory, on_refinement, prolongation, spline
from study.fem.error_norm import ErrorNorm
from study.fem.quadrature import Line, cell_rules
from study.fem.space import Space, form
from study.solve.multigrid import contact_solver
from study.solve.signorini import Signorini

RAISED = 4
"""Increase of the degree of the standard quadrature rule when the error is computed from a known exact solution.

On coarse meshes, the standard rule has a relative error of 3 % (level 2) to 0.1 % (level 8). At small times, error and
bound differ by a few per cent only, so this is not accurate enough.
"""
INITIAL_DEGREE = 6
"""Degree of the quadrature rule for the distance ‖u_0 − ũ(0)‖_V of a displacement ũ(0) from the initial value u_0."""


@dataclass(frozen=True, eq=False)
class Enclosure:
    """Lower and upper bounds of the error ‖u(t) − u_h(t)‖_V over [0, T] of a computed displacement u_h.

    They are computed from a second, usually more accurate displacement ũ, which is a quadratic spline in time. With the
    distance d = ‖ũ − u_h‖_V and a bound y of ‖u − ũ‖_V, the error lies between d − y and d + y.

    Attributes:
        h: the mesh size of u_h.
        times: the times of the knots of the spline ũ, without t = 0, (n,).
        distance: the distance d at these times, (n,).
        bound: the bound y at these times, (n,).
        error: the error of u_h at these times if the exact solution is known, otherwise NaN, (n,).
        intervals: for each time interval between knots, the quantities from which y is computed.
        start: a bound of the error ‖u_0 − u_h(0)‖_V of u_h at t = 0.
        initial: the squared distance ‖u_0 − ũ(0)‖² of ũ(0) from the initial value u_0 on each cell of the mesh of ũ,
            computed from samples of u_0, (cells,).
        between: for each time interval between knots, an upper bound of the error of u_h at all of its times, (n,).
        evidence: whether the bounds are guaranteed or estimated, and why.
        norm: an interval that contains max_t ‖u(t)‖_V.
        products: the inner products in V of any two of the pair (ũ, u_h), each summed over ``times``, (2, 2). They show
            whether u_h is a multiple of ũ.
        on_cells: for static problems the squared distance ‖ũ − u_h‖² on every cell of u_h, (cells of u_h,). It is only
            an estimate of the squared error there: no bound is known for the error on a single cell.
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

        The contributions come from the initial error and from all time intervals up to the one with the largest bound.
        Each is multiplied by the factor by which errors decay until then. The part due to the initial value u_0 between
        its sample points is divided among the cells like the sampled initial error. The increase due to smoothing the
        computed displacement in time counts as a contribution of the time steps.

        Args:
            moduli: the moduli of the elasticity, which give the factor.
        """
        count = int(self.between.argmax()) + 1 if self.highest > self.start else 0
        shares = Shares(self.initial, 0.0).scaled_to(self.intervals[0].at_a)
        for interval in self.intervals[:count]:
            shares = moduli.decay(interval.b - interval.a) * shares + interval.shares
        return Shares(shares.cells, shares.time + self.highest - shares.total)

    @property
    def factor(self) -> tuple[float, float]:
        """The factor s for which u_h/s fits the more accurate displacement ũ best, and the remaining distance.

        The distance is relative, ‖u_h/s − ũ‖/‖ũ‖, with squared norms summed over all times. For a Galerkin solution u_h
        of a static problem without contact, s = 1 on every mesh, because its error is orthogonal to u_h.
        """
        (better, mixed), (_, given) = self.products.tolist()
        if not mixed or not better * given:
            return math.nan, 1.0
        cosine_squared = mixed**2 / (better * given)
        return given / mixed, math.sqrt(max(0.0, 1 - cosine_squared))

    @property
    def lower(self) -> Array:
        """The lower bound max(d − y, 0) of the error of u_h at ``times``, (n,), for d = ``distance``, y = ``bound``."""
        return np.maximum(self.distance - self.bound, 0.0)

    @property
    def upper(self) -> Array:
        """The upper bound d + y of the error of u_h at ``times``, with d = ``distance`` and y = ``bound``, (n,)."""
        return self.distance + self.bound

    @property
    def lowest(self) -> float:
        """A lower bound of the largest error max_t ‖u(t) − u_h(t)‖_V."""
        return float(self.lower.max())

    @property
    def contains(self) -> bool:
        """Whether the known error of u_h lies between the lower and the upper bound at all ``times``."""
        return bool(((self.lower <= self.error) & (self.error <= self.upper)).all())


def relative(error: tuple[Any, Any], norm: tuple[float, float]) -> tuple[Any, Any]:
    """Return an interval that contains the quotient error/norm, where both are only known to lie in intervals.

    If the norm may be 0, the interval ends at ∞.

    Args:
        error: the lower and the upper end of the interval of the error; numbers, or arrays for several errors.
        norm: the lower and the upper end of the interval of the norm.
    """
    low = error[0] / norm[1] if norm[1] > 0 else 0.0
    high = error[1] / norm[0] if norm[0] > 0 else math.inf
    return low, high


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
        trajectory: how a second displacement ũ is computed, from which the bounds follow.
        error: the function (t, u_h(t)) ↦ ‖u(t) − u_h(t)‖_V if the exact solution is known.
        progress: a function that is called with each time up to which the bounds are computed.

    Raises:
        BoundError: the nodes of ũ are not equally spaced in time; the mesh of ũ is not a refinement of the mesh of u_h;
            or the data are so large or so small that their squares overflow or underflow.
    """
    fine = trajectory.discretisation(coarse)
    u_h = computed.on(fine)
    pieces = spline(trajectory.nodes(fine, computed))
    first = next(pieces)
    initial = squared_distances(fine, fine.data.initial, first.start, fine.data.lines)
    start = math.sqrt(float(initial.sum())) + fine.sampling.missed_at_start()
    intervals: list[Interval] = []
    distances = []
    errors = []
    between = []
    low = [0.0, fine.norm(first.start) - start]
    high = []
    products = np.zeros((2, 2))
    for piece, interval in Majorant(fine)(chain([first], pieces), start):
        at_b = u_h(piece.b)
        norms = fine.norm(np.array([piece.start, piece.control, piece.end]))
        intervals.append(interval)
        distances.append(fine.norm(piece.end - at_b))
        errors.append(error(piece.b, computed.at(piece.b)) if error else math.nan)
        between.append(interval.inside + largest_distance(fine, piece, computed.times, u_h))
        low.append(norms[-1] - interval.at_b)
        high.append(norms.max() + interval.inside)
        products += fine.products(piece.end, at_b)
        progress(piece.b)
    times = np.array([interval.b for interval in intervals])
    bounds = np.array([interval.at_b for interval in intervals])
    worst = max(intervals, key=lambda interval: interval.missed / (interval.b - interval.a))
    missed = sum(interval.missed for interval in intervals)
    loaded = initial.any() or any(fine.load(time).any() for time in times)
    enclosure = Enclosure(
        h=computed.h,
        times=times,
        distance=np.array(distances),
        bound=bounds,
        error=np.array(errors),
        intervals=tuple(intervals),
        start=start + fine.norm(first.start - u_h(0.0)),
        initial=initial,
        between=np.array(between),
        evidence=fine.sampling.evidence(missed, bounds[-1], worst.a, worst.b),
        norm=(float(max(low)), float(max(high))),
        products=products,
    )
    require_visible(enclosure.highest, bool(loaded or computed.nodes.any()))
    # Squares of small data may have underflowed to 0 at single times, so the bound is at least SMALLEST_BOUND.
    return replace(enclosure, bound=np.maximum(bounds, SMALLEST_BOUND)) if enclosure.highest > 0 else enclosure


def known_error(case: Case | None, computed: Computed) -> Callable[[float, Array], float] | None:
    """Return the function (t, u_h(t)) ↦ ‖u(t) − u_h(t)‖_V, or None if the exact solution is unknown.

    Args:
        case: the case with the exact solution u, or None.
        computed: the displacement u_h, of degree 1.
    """
    if case is None:
        return None
    space = Space(computed.mesh, computed.body)
    v_norm = ErrorNorm(case.solution, space, raised=RAISED)
    return lambda time, u: v_norm.distance(v_norm.sample(time), u[space.free])


def largest_distance(fine: Discretisation, piece: Parabola, nodes: Array, u_h: Callable[[float], Array]) -> float:
    """Return a bound of the distance ‖ũ(t) − u_h(t)‖_V of two displacements over one time interval.

    On the interval ũ is a parabola in time, and u_h is piecewise linear. Each part on which u_h is linear is considered
    separately. There ũ − u_h is a parabola in Bernstein form, and the norm is at most the largest norm of its
    coefficients.

    Args:
        fine: the finite element spaces on the mesh of ũ.
        piece: the parabola ũ on the interval.
        nodes: the times between which u_h is linear.
        u_h: the function t ↦ u_h(t).
    """
    inside = nodes[(nodes > piece.a) & (nodes < piece.b)]
    cuts = np.unique([piece.a, (piece.a + piece.b) / 2, piece.b, *inside]).tolist()
    differences = [piece.at(time) - u_h(time) for time in cuts]
    for c, d in pairwise(cuts):
        differences.append(piece.blossom(c, d) - (u_h(c) + u_h(d)) / 2)
    return float(fine.norm(np.array(differences)).max())


def squared_distances(
    discretisation: Discretisation, strain: Callable[[Points], Tensors], v: Array, rough: Sequence[Hyperplane]
) -> Array:
    """Return the squared energy norm of the difference of two strains ε and ε(v) on every cell, (cells,).

    On a cell T it is ∫_T A(ε − ε(v))·(ε − ε(v)) with the viscosity A.

    Args:
        discretisation: the mesh and the space of v.
        strain: the function from points to the strain ε, (2, ...) → (3, ...).
        v: a displacement of degree 2, (dofs,).
        rough: the lines (direction, offset) at which ε is not smooth; quadrature points are graded towards these lines.
    """
    data = discretisation.data
    squares = np.zeros(discretisation.mesh.t.shape[1])
    lines = [Line(*line) for line in rough]
    for rule in cell_rules(discretisation.mesh, INITIAL_DEGREE, lines, data.points):
        difference = strain(rule.points) - discretisation.displacements.strain_at(v, rule.cells, rule.points)
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
    low = -math.inf
    high = math.inf
    if coarse[0] > 0:
        low = math.log(coarse[0] / fine[1]) / ratio
    if fine[0] > 0:
        high = math.log(coarse[1] / fine[0]) / ratio
    return low, high


ENERGY_ROUNDING = 1e-11
"""Relative rounding error of the squared norm of a displacement, by which the interval of the energy is widened."""


class StaticDiscretisation(Discretisation):
    """The finite element spaces on one mesh for a static problem with the elasticity G.

    The norm of displacements is the energy norm of G, and stresses are measured in the norm of G⁻¹.
    """

    @cached_property
    def compliance(self) -> Array:
        return np.asarray(np.linalg.inv(self.data.law.A.matrix))

    def strain(self, v: Array) -> Tensors:
        """Return the strain of a displacement v at the Q quadrature points of every cell, (dofs,) → (3, cells, Q).

        The prescribed displacements, which are not among the unknowns, are included.
        """
        return self.displacements.strain_at(v, np.arange(self.stresses.cells), self.stresses.points)

    def products(self, *displacements: Array) -> Array:
        """Return the products (Gε(v_i), ε(v_j))_Q of any two of n displacements, with the elasticity G, (n, n).

        The prescribed displacements, which are not among the unknowns, are included.

        Args:
            displacements: the unknowns of the displacements v_i, (dofs,) each.
        """
        stresses = [self.elastic(v) for v in displacements]
        strains = [self.strain(v) for v in displacements]
        return np.einsum("iIcq,jIcq,cq->ij", stresses, strains, self.stresses.weights)

    def residual(self, v: Array) -> Array:
        """Return the load vector minus the elastic forces (Gε(v), ε(φ_i))_Q of a displacement v, (dofs,) → (dofs,).

        The φ_i are the basis functions, and G is the elasticity.
        """
        V = self.displacements
        strain = V.strain_at(v, np.arange(V.cells), V.points)
        stress = self.data.law.G.at(V.points)(strain)
        return np.asarray(self.load(0.0) - V.functional(stress))

    def squares(self, stress: Array) -> Array:
        """Return the squared norm ‖τ‖²_{G⁻¹} = ∫_T G⁻¹τ·τ of a stress τ on every cell T, (3, cells, Q) → (cells,)."""
        strain = np.tensordot(self.compliance, stress, axes=1) * self.inverse_viscosity
        return np.asarray(np.einsum("Icq,Icq,cq->c", stress, strain, self.stresses.weights))


def compute_static(coarse: Discretisation) -> Computed:
    """Return the P1 solution u_h of the static problem, stored as a displacement that is constant in time.

    Args:
        coarse: the static problem on the mesh of u_h.
    """
    fine = StaticDiscretisation(coarse.data, coarse.mesh)
    body = fine.data.body
    space = Space(fine.mesh, body)
    if not space.dofs:
        raise BoundError("no vertex of the mesh can move: take a finer level")
    lifting = on_refinement(space.mesh, 1, fine.mesh) @ space.prescribed
    load = prolongation(space, fine).T @ fine.residual(lifting[fine.displacements.free])
    solve = contact_solver(space)(form(space, fine.data.law.A), space.N)
    u, _ = solve(load)
    nodes = space.coefficients(u).ravel()
    return Computed(space.mesh, body, 1, np.array([0.0, body.T]), np.array([nodes, nodes]), 1)


def enclose_static(coarse: Discretisation, computed: Computed, refinements: int | None) -> tuple[Enclosure, Shares]:
    """Return lower and upper bounds of the error of a static displacement u_h, and the contributions of the cells.

    Args:
        coarse: the problem and the mesh of u_h.
        computed: the displacement u_h.
        refinements: how often the mesh is refined to compute the more accurate displacement ũ of degree 2. If None, ũ =
            u_h is used.

    Returns:
        The bounds, as an enclosure at one time, and how much each cell contributes to the bound of the error ‖u − ũ‖ of
        ũ.
    """
    fine = StaticDiscretisation(coarse.data, coarse.mesh.refined(refinements or 0))
    T = fine.data.body.T
    u_h = computed.on(fine)(0.0)
    v = u_h
    if refinements is not None:
        V = fine.displacements
        load = fine.residual(np.zeros(V.dofs))
        v, _ = Signorini(fine.M, V.N, V.free_points)(load)
    missed = fine.sampling.missed(fine.oscillation, 0.0, T)
    y, shares = _static_bound(fine, v, missed)
    evidence = fine.sampling.evidence(missed.everywhere, y, 0.0, T)
    d = float(fine.norm(v - u_h))
    require_visible(d + y, bool(fine.load(0.0).any() or computed.nodes.any()))
    y = max(y, SMALLEST_BOUND) if y > 0 else y
    products = fine.products(v, u_h)
    size = math.sqrt(products[0, 0])
    norm = max(0.0, size - y), size + y
    if not (fine.data.body.of(Kind.CONTACT) or fine.data.body.is_moved):
        rest = (2 * missed.everywhere + ENERGY_ROUNDING * size) * size
        energy = 2 * float(fine.load(0.0) @ v) - size**2
        norm = math.sqrt(max(0.0, energy - rest)), math.sqrt(energy + y**2 + rest)
    distances = fine.squares(fine.elastic(v) - fine.elastic(u_h))
    # A refinement lists the parts of all cells in the order of the cells, again and again.
    on_cells = distances.reshape(-1, coarse.mesh.t.shape[1]).sum(axis=0)
    enclosure = Enclosure(
        h=computed.h,
        times=np.zeros(1),
        distance=np.array([d]),
        bound=np.array([y]),
        error=np.array([math.nan]),
        intervals=(),
        start=d + y,
        initial=np.zeros(fine.stresses.cells),
        between=np.array([d + y]),
        evidence=evidence,
        norm=norm,
        products=products,
        on_cells=on_cells,
    )
    return enclosure, shares


def _static_bound(fine: StaticDiscretisation, v: Array, missed: Missed) -> tuple[float, Shares]:
    """Return the bound y of the error ‖u − ũ‖ of a static displacement ũ, and the contributions of the cells to y.

    Args:
        fine: the problem on the mesh of ũ.
        v: the coefficients of ũ.
        missed: bounds of the loads minus their samples.
    """
    snapshot = fine.snapshot(0.0)
    stress = fine.nearest_stress(snapshot.loads, fine.elastic(v), v)
    residual = np.sqrt(fine.squares(stress.values))
    squares = (residual + fine.oscillation(snapshot.left_out) + missed.cells) ** 2
    R = math.sqrt(squares.sum()) + missed.everywhere
    # By complementarity these products are not negative, but rounding can make them so.
    products = np.maximum(-fine.equilibrium.pressure(stress) * fine.normal_moments(v), 0.0)
    work = products.sum(axis=1)
    y = R / 2 + math.sqrt(R**2 / 4 + work.sum())
    cells = proportional(squares) + missed.in_cells + fine.divided_at_contact(y - R, work)
    return y, Shares(cells, 0.0).scaled_to(y)

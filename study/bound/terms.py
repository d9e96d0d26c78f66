"""The terms of a bound of the error ‖u(t) − ũ(t)‖_V of an admissible displacement ũ, without the exact solution u.

Let ũ(t) ∈ K and e = u − ũ. Let the stress σ̃(t) balance the projected loads f̃(t), with σ̃_τ = 0 and σ̃_ν ≤ 0 on Γ3.
The residual of the law is ρ = σ̃ − Aε(ũ̇) − Gε(ũ). Testing (3.13) for u with ũ gives (Aε(u̇) + Gε(u),
ε(e))_Q ≤ (f, e)_V. Green's formula for σ̃, with u_ν ≤ 0 on Γ3, gives

    (σ̃, ε(e))_Q = (f̃, e)_V + ∫_{Γ3} σ̃_ν e_ν ≥ (f̃, e)_V − c,     c = ∫_{Γ3} σ̃_ν ũ_ν ≥ 0.

Subtract. Let r = ‖ρ‖_{A⁻¹}, let η be the dual norm of f − f̃, and m the least modulus of ``study.bound.problem``. Then

    ½ d/dt ‖e‖_V² + m ‖e‖_V² ≤ (r + η) ‖e‖_V + c.

In time, ũ is a quadratic spline (``study.bound.trajectory``). The interval between two knots is called a piece. The
inequality bounds ‖e‖_V at the end of a piece by its bound at the start (``study.bound.terms``; proof in
``paper/enclosure.tex``). The class ``Terms`` contains all terms of one piece:

=============  ===========================================================  =========================================
attribute      term                                                         computed in
=============  ===========================================================  =========================================
residual       products of the coefficients in time of ρ, for r             ``Majorant._block``
curvature      Gε(ũ) minus its parabola in time, 0 for linear G             ``Majorant._elastic``
contact        products of the coefficients of σ̃_ν and ũ_ν, for c           ``Majorant._block``
oscillation    η_T: f − P f on cells, plus remainders of f on cells         ``study.stresses.oscillation``
bending        P f minus its parabola in time, in the dual norm             ``Majorant._block``
missed         remainders of f in the dual norm                             ``study.bound.remainders``
=============  ===========================================================  =========================================

**Between the knots** every quantity is a parabola in t in Bernstein form. σ̃ is a parabola with σ̃_ν ≤ 0 in all three
coefficients. It balances the parabola through P f at both ends and in the middle of the piece. For linear G, ρ is a
parabola, too, and only the last step of ∫ r ≤ (k ∫ ‖ρ‖²)^{1/2} is not exact. For other G, Lipschitz with L, Gε(ũ)
differs from its linear interpolation by at most 2θ(1−θ) k L |ε̇| at the relative time θ of the piece. The difference is
0 if the whole piece stays in the convex set of (3.3).

**Data.** The projected loads are P f. The rest f − P f is bounded on each cell and added to ρ in the same cell. P f
minus its parabola is sampled once in each piece and balanced by another stress. Integrals of the data are quadratures.
Ranges of the formulas bound the data between the samples; without formulas the bound is only estimated.

**Shares.** The increase of the bound on each piece is divided into contributions of the cells and of time, called
shares, to decide what to refine:

* the share of a cell T has three summands: a part proportional to k (‖ρ‖_T + η_T)²/(Σ …)^{1/2}, without the part of ρ
  that changes within the piece; the contact term on the sides of T on Γ3; and the remainder of the data in T;
* the share of time is the part of ρ that changes, the bending, and the remainder of the data between times.

ρ is measured in the norm in which stresses are balanced (``Moduli.weights``). The shares add up to the bound. Their
division is a heuristic that does not affect the bound.

How much the bound y of the error ‖e‖_V, e = u − ũ, can grow over one time step [a, b] of length k.

The elasticity G is described by moduli g_i relative to the viscosity A, one for each direction i of strain space
(``study.bound.problem``). ‖·‖ is the norm of A⁻¹, and |τ|²_i is the part of |τ|²_{A⁻¹} in the i-th direction. Choose θ
with 0 ≤ θ ≤ min g_i. Split the residual of the law into ρ = ρ_A + ρ_G, with the fractions 1 − w_i and w_i in each
direction, 0 ≤ w_i ≤ 1. Then

    (ρ, ε(e))_Q ≤ ‖ρ_A‖ ‖e‖_V + q + Σ_i (g_i − θ) ‖ε(e)‖²_i,     q = ¼ Σ_i w_i² ‖ρ‖²_i / (g_i − θ),

and the last sum plus θ ‖e‖_V² is at most (Gε(u) − Gε(ũ), ε(e))_Q. So the elasticity damps the error with the rate θ. In
directions in which G is stiff, such as volume changes of a nearly incompressible material, the rest of the elasticity
compensates a part of the residual:

    y(b) ≤ (e^{−2θk} y(a)² + 2 ∫ e^{−2θ(b−t)} (c + q))^{1/2} + ∫ e^{−θ(b−t)} (‖ρ_A‖ + η).

Here c is the contact term and η the dual norm of the loads that are not balanced (``study.bound.terms``). The smallest
value over several θ and w is used. Each integral is at most the integral of its kernel times the largest value of the
other factor, which is sharp for steps much longer than 1/θ. By the Cauchy–Schwarz inequality it is also at most a
multiple of the mean value. If the least g_i is m < 0, then θ = 0 and the right side has the factor e^{|m|k}.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement, islice

import numpy as np

from manufactured.law import Linear, Yield
from manufactured.tensors import Array, Tensors, mapped
from study.bound.discretisation import Discretisation
from study.bound.problem import BoundError
from study.bound.remainders import Missed, proportional
from study.bound.trajectory import Parabola
from study.stresses.loads import Loads, Snapshot, together
from study.stresses.stress_space import interval_mass

ROUNDS = 4
"""Number of iterations that improve the fractions w_i of the residual that the elasticity compensates."""
FIRST_PRODUCT = 2.0**-20
"""Value of k β with which an iteration for the fractions w_i = g_i/(g_i + β) starts, with a time step of length k.

w_i is the fraction of the residual that the elasticity with the modulus g_i compensates. β is a number ≥ 0 that is
optimised; all w_i are nearly 1 at first.
"""
LAGRANGE = np.array([[16.0, 15.0, 4.0], [15.0, 64.0, 15.0], [4.0, 15.0, 16.0]]) / 120
"""Integrals ∫_0^1 |L_i L_j| of the Lagrange polynomials L_i for the nodes 0, 1/2 and 1."""
LEBESGUE = 1.25
"""The largest value of Σ_i |L_i| on [0, 1] for the Lagrange polynomials L_i for the nodes 0, 1/2 and 1."""


@dataclass(frozen=True, eq=False)
class Sizes:
    """The quantities on which the growth of the error bound of a displacement ũ depends in time.

    They are means over a time step, or bounds that hold at all of its times (``Step``).

    Attributes:
        residual: the squared residual |ρ|²_i = ∫_T (v_i·ρ)²/α of the material law on every cell T, for each of the
            orthonormal directions v_i of strains in ``Moduli``, (directions, cells). ρ is an equilibrated stress σ̃
            minus the stress that the law gives for ũ, and α the scalar factor of the viscosity A(x) = α(x) A_0.
        oscillation: the square of the data oscillation η_T of the loads on every cell T, (cells,).
        contact: the contact term c = ∫_{Γ3} σ̃_ν ũ_ν, the work of the normal stress of σ̃.
        rest: a bound of the sum of the three terms of ``Terms`` that are not divided among the cells:
            ``curvature``, ``bending`` and ``missed.everywhere``.
    """

    residual: Array
    oscillation: Array
    contact: float
    rest: float

    def joined(self, share: Array) -> float:
        """Return (Σ_T (‖ρ_A‖_T + η_T)²)^½ over all cells T, with the oscillation η_T and a part ρ_A of the residual ρ.

        ρ_A is the part of ρ that the elasticity does not compensate, measured in the norm of the viscosity A.

        Args:
            share: for every direction v_i the number s_i with v_i·ρ_A = s_i v_i·ρ, 0 ≤ s_i ≤ 1, (directions,).
        """
        residual = np.sqrt(np.tensordot(share**2, self.residual, axes=1))
        return float(np.linalg.norm(residual + np.sqrt(self.oscillation)))

    def squares(self, inverse: Array) -> float:
        """Return 2 (c + q), the rate at which y² grows, for the bound y of the error, due to c and q alone.

        c is the contact term, and q = ¼ Σ_i w_i² |ρ|²_i/(g_i − θ) comes from the residual: in the direction v_i the
        elasticity with the modulus g_i compensates the fraction w_i of the residual. θ is the rate at which the
        elasticity damps the error.

        Args:
            inverse: the numbers w_i²/(g_i − θ), without the factor ¼, (directions,).
        """
        return 2 * self.contact + float(inverse @ self.residual.sum(axis=1)) / 2


@dataclass(frozen=True, eq=False)
class Step:
    """The quantities that make the error bound of a displacement grow over one time step.

    Attributes:
        k: the length of the step.
        mean: means over the step; for the residual and the oscillation these are mean squares.
        largest: bounds that hold at all times of the step.
    """

    k: float
    mean: Sizes
    largest: Sizes


def grow(y: float, moduli: Array, step: Step) -> tuple[float, float]:
    """Return two bounds of the error ‖u − ũ‖_V of a displacement ũ: at the end of a time step, and at all of its times.

    Args:
        y: a bound of the error at the start of the step.
        moduli: the moduli g_i of the elasticity relative to the viscosity, (directions,).
        step: the residual of the material law, the oscillation of the loads and the contact term on the step.
    """
    m = float(moduli.min())
    growth = float(np.exp(max(-m, 0.0) * step.k))
    bounds = [pair for theta in {0.0, max(m, 0.0)} for pair in _bounds(y, moduli, theta, step)]
    at_b, inside = (growth * min(ends) for ends in zip(*bounds, strict=True))
    return at_b, inside


def _bounds(y: float, moduli: Array, theta: float, step: Step) -> Iterator[tuple[float, float]]:
    """Yield pairs of bounds as in ``grow`` for one rate of decay θ and several weights w_i.

    The weights are w_i = g/(g + β) with g = g_i − θ. Every β ≥ 0 gives a valid bound. Each iteration computes β from
    the condition that the bound is stationary, then the weights from β. One iteration starts from w = 0. Another starts
    close to w = 1, because w = 1 is best for y = c = 0, but the first iteration then stays at 0.
    """
    k = step.k
    mean = step.mean
    largest = step.largest
    g = np.maximum(moduli - theta, 0.0)
    single = kernel(theta, k)
    double = kernel(2 * theta, k)
    decayed = np.exp(-theta * k) * y
    rest = min(k * mean.rest, single * largest.rest)
    for w in (np.zeros(len(g)), g / (g + FIRST_PRODUCT / k)):
        for _ in range(ROUNDS):
            inverse = np.divide(w**2, g, out=np.zeros_like(w), where=g > 0)
            square = min(k * mean.squares(inverse), double * largest.squares(inverse))
            joined = mean.joined(1 - w)
            linear = min(np.sqrt(double * k) * joined, single * largest.joined(1 - w)) + rest
            root = float(np.hypot(decayed, np.sqrt(square)))
            yield root + linear, float(np.hypot(y, np.sqrt(square))) + linear
            taking = 2 * root * g
            w = np.divide(taking, taking + joined, out=np.zeros_like(g), where=taking > 0)


def kernel(rate: float, k: float) -> float:
    """Return ∫_0^k e^{−rate·s} ds, the error that a constant right-hand side 1 causes over a step of length k."""
    return float(-np.expm1(-rate * k) / rate) if rate > 0 else k


def mean_square(norms: Array) -> Array:
    """Return a bound of the mean of ‖f‖² over a time step, for a parabola f in time, (3, ...) → (...).

    The bound follows from ‖f‖ ≤ Σ |L_i| ‖f_i‖ with the three values f_i and the Lagrange polynomials L_i.

    Args:
        norms: the norm ‖f‖ at the start, in the middle and at the end of the step.
    """
    return np.einsum("ij,i...,j...->...", LAGRANGE, norms, norms)


def largest_square(norms: Array) -> Array:
    """Return a bound of ‖f‖² at all times of a step, for a parabola f in time, (3, ...) → (...).

    Args:
        norms: the norm ‖f‖ at the start, in the middle and at the end of the step.
    """
    return np.asarray((LEBESGUE * norms.max(axis=0)) ** 2)


QUADRATIC = interval_mass(2, 2)
"""Integrals ∫_0^1 B_i B_j of the Bernstein polynomials B_0, B_1, B_2 of degree 2."""
CURVED, BENT = 1.5, 1.027
"""Factors by which values that are computed on a time interval are multiplied to bound the maximum over the interval.

For relative times 0 ≤ θ ≤ 1, ``CURVED`` is the maximum of θ(1 − θ) divided by its mean. ``BENT`` is the maximum of |θ(θ
− ½)(θ − 1)| divided by its value at θ = ¼.
"""
LEAST_INTERVALS, MOST_INTERVALS, VALUES_IN_CACHE = 4, 16, 1 << 20
"""Limits of the blocks of time intervals that are computed together, so that the data fit into the cache.

A block has ``LEAST_INTERVALS`` to ``MOST_INTERVALS`` intervals, and between these limits about ``VALUES_IN_CACHE``
stress values.
"""
VELOCITY_ROUNDING = 1e-6
"""A jump of the velocity of ũ at a knot counts as round-off up to this fraction of the velocity."""


@dataclass(frozen=True, eq=False)
class Shares:
    """The contributions, called shares, of the cells and of the time steps to an error bound; none is negative.

    Attributes:
        cells: the share of each cell, (cells,).
        time: the share of the time discretisation.
    """

    cells: Array
    time: float

    @property
    def total(self) -> float:
        return float(self.cells.sum()) + self.time

    def __add__(self, other: Shares) -> Shares:
        return Shares(self.cells + other.cells, self.time + other.time)

    def __rmul__(self, factor: float) -> Shares:
        return Shares(factor * self.cells, factor * self.time)

    def scaled_to(self, total: float) -> Shares:
        """Multiply all shares by one factor so that their sum is ``total``.

        If all shares are 0, the share of time becomes ``total``.
        """
        return total / self.total * self if self.total > 0 else Shares(0 * self.cells, total)


@dataclass(frozen=True, eq=False)
class Terms:
    """The terms of the error bound of a displacement ũ on one time interval between two knots of ũ.

    σ̃ is a stress that balances the projected loads P f, and ρ = σ̃ − Aε(ũ̇) − Gε(ũ) the residual of the material law.
    In time both are represented by parabolas on the interval, which have three Bernstein coefficients.

    Attributes:
        piece: the displacement ũ on this interval, a parabola in time.
        residual: for any two of the three coefficients ρ_a, ρ_b of ρ and each of the orthonormal directions v_i of
            strains in ``Moduli``, the integral ∫_T (v_i·ρ_a)(v_i·ρ_b)/α over each cell T, (3, 3, directions, cells).
            α is the scalar factor of A(x) = α(x) A_0. The sum over the directions is ∫_T A⁻¹ρ_a·ρ_b.
        curvature: a bound of the mean over time of the distance ‖Gε(ũ) − parabola‖_{A⁻¹} between the elastic stress and
            its approximation by a parabola in time; 0 for linear G.
        contact: for each of the three coefficients of σ̃_ν and each of those of ũ_ν, the integral of their product over
            every edge of Γ3, (3, 3, edges of Γ3).
        oscillation: the bound η_T of the work of the loads f − P f on every cell T, at both ends and in the middle of
            the interval, (3, cells).
        bending: a bound of the dual norm of P f minus its parabola in time, at the time a + k/4 of the interval
            [a, a + k]. The parabola is exact at both ends and in the middle. The cubic that is exact at a + k/4, too,
            differs from it on the whole interval by at most ``BENT`` times this value.
        missed: bounds of the loads f minus their samples: an increase of the oscillation of every cell, and a bound in
            the dual norm, which also bounds f minus the cubic in time.
    """

    piece: Parabola
    residual: Array
    curvature: float
    contact: Array
    oscillation: Array
    bending: float
    missed: Missed

    @property
    def contact_on_edges(self) -> Array:
        """The mean over time of the contact term ∫_e σ̃_ν ũ_ν on every edge e of Γ3, (edges of Γ3,).

        It is the work of the normal stress of the equilibrated stress σ̃ on the displacement ũ.
        """
        return np.tensordot(QUADRATIC, self.contact, axes=2)

    def step(self) -> Step:
        """Return means of the terms of the error bound over the time interval, and bounds that hold at all of its
        times.
        """
        rest = self.missed.everywhere
        mean = Sizes(
            np.tensordot(QUADRATIC, self.residual, axes=2),
            mean_square(self.oscillation),
            float(self.contact_on_edges.sum()),
            self.curvature + self.bending + rest,
        )
        largest = Sizes(
            np.einsum("iidc->idc", self.residual).max(axis=0),
            largest_square(self.oscillation),
            float(self.contact.sum(axis=2).max()),
            # The interpolation error of a cubic is a multiple of θ(θ − ½)(θ − 1), which is at most BENT times its value
            # at θ = ¼. Its mean is smaller than this value, so the mean needs no factor.
            CURVED * self.curvature + BENT * self.bending + rest,
        )
        return Step(self.piece.b - self.piece.a, mean, largest)


@dataclass(frozen=True)
class Interval:
    """The bound y of the error ‖u − ũ‖_V of a displacement ũ on one time interval [a, b] between two knots of ũ.

    The integrals over [a, b], or bounds of them, show what the bound is due to; they are only reported. ρ is the
    residual of the material law, an equilibrated stress minus the stress that the law gives for ũ; f are the loads and
    P f their projection.

    Attributes:
        a, b: the ends of the interval.
        at_a, at_b: the values of the bound y at a and at b.
        inside: a bound of the error at all times of the interval.
        residual: the integral of the norm of ρ.
        contact: the integral of the contact term, the work of the equilibrated normal stress on ũ_ν.
        oscillation: the integral of the bound of the work of f − P f.
        bending: the integral of the dual norm of P f minus its parabola in time.
        missed: the integral of the bound of f minus its samples.
        shares: the contributions of cells and time to the increase of y. The increase is y(b) − e^{−m(b−a)} y(a), where
            m is the least modulus of the elasticity, the rate at which earlier errors decay.
    """

    a: float
    b: float
    at_a: float
    at_b: float
    inside: float
    residual: float
    contact: float
    oscillation: float
    bending: float
    missed: float
    shares: Shares


class Majorant:
    """Computes the bound y of the error ‖u − ũ‖_V of a displacement ũ, forward in time, on one mesh.

    Several time intervals are computed together, as many as fit into the processor's cache. Calling the object with the
    pieces of ũ and a bound of the initial error yields pairs of a piece and the bound on its time interval.

    Args:
        discretisation: the problem on the mesh of ũ.
    """

    def __init__(self, discretisation: Discretisation) -> None:
        self.discretisation = discretisation
        space = discretisation.stresses
        self._directions = discretisation.moduli.directions.T
        self._roots = np.sqrt(space.weights * discretisation.inverse_viscosity)
        self._together = max(LEAST_INTERVALS, min(MOST_INTERVALS, VALUES_IN_CACHE // (3 * space.weights.size)))

    def __call__(self, pieces: Iterable[Parabola], start: float) -> Iterator[tuple[Parabola, Interval]]:
        """Yield ũ on every time interval between knots, together with the bound of its error there.

        Args:
            pieces: the displacement ũ on each time interval, in the order of time.
            start: a bound of the initial error ‖u_0 − ũ(0)‖_V.

        Raises:
            BoundError: the velocity ũ̇ jumps at a knot.
        """
        y = start
        for terms in self.terms(pieces):
            interval = self._interval(terms, y)
            yield terms.piece, interval
            y = interval.at_b

    def terms(self, pieces: Iterable[Parabola]) -> Iterator[Terms]:
        """Yield the terms of the error bound of a displacement ũ on every time interval between knots of ũ.

        Args:
            pieces: ũ on these intervals, in their order in time.

        Raises:
            BoundError: the velocity of ũ jumps at a knot.
        """
        remaining = iter(pieces)
        before = None
        while block := list(islice(remaining, self._together)):
            for piece in block:
                rate = piece.rate(end=False)
                if before is not None and abs(rate - before).max() > VELOCITY_ROUNDING * abs(rate).max():
                    raise BoundError(
                        f"ũ̇ jumps at t = {piece.a:.6g}: the nodes of a trajectory have to be equally spaced in time"
                    )
                before = piece.rate(end=True)
            yield from self._block(block)

    def _block(self, pieces: list[Parabola]) -> Iterator[Terms]:
        """Yield the terms of the error bound on consecutive time intervals."""
        d = self.discretisation
        first = pieces[0]
        # The displacement, its velocity and the loads at the knots, which are the ends of the intervals.
        u = np.array([first.start, *(piece.end for piece in pieces)])
        rates = np.array([first.rate(end=False), *(piece.rate(end=True) for piece in pieces)])
        knots = [d.snapshot(time) for time in (first.a, *(piece.b for piece in pieces))]
        middles = [d.snapshot((piece.a + piece.b) / 2) for piece in pieces]
        quarters = [d.snapshot(piece.a + (piece.b - piece.a) / 4) for piece in pieces]
        start, middle, end, quarter = map(_loads, (knots[:-1], middles, knots[1:], quarters))
        # The middle Bernstein coefficient of the parabola through the loads P f at both ends and in the middle.
        control_loads = 2.0 * middle + (-0.5) * (start + end)
        viscous = d.viscous(rates)
        elastic = d.elastic(u)
        residual, pressure = self._residual(_loads(knots), viscous + elastic, u)
        # The middle Bernstein coefficients of all other quantities.
        control = np.array([piece.control for piece in pieces])
        control_elastic, curvature = self._elastic(pieces, rates, control, elastic)
        control_viscous = (viscous[:, :-1] + viscous[:, 1:]) / 2
        target = control_viscous + control_elastic
        control_residual, control_pressure = self._residual(control_loads, target, control)
        products = self.products([residual[:, :-1], control_residual, residual[:, 1:]])
        # At a quarter of an interval, the loads P f differ from the parabola. The norm of the smallest stress that
        # balances the difference, with τν = 0 on Γ3, bounds the dual norm of the difference.
        parabola = (9 / 16) * start + (6 / 16) * control_loads + (1 / 16) * end
        balancing = self._in_directions(d.equilibrium.balance(quarter + (-1.0) * parabola).values)
        bending = np.sqrt(self.products([balancing])[0, 0].sum(axis=(0, -1)))
        pressures = np.array([pressure[:-1], control_pressure, pressure[1:]])
        moments = d.normal_moments(np.array([u[:-1], control, u[1:]]))
        # By complementarity these products are not negative, but rounding can make them so.
        contact = np.maximum(np.einsum("ipen,jpen->pije", pressures, moments), 0.0)
        for n, piece in enumerate(pieces):
            missed = d.sampling.missed(d.oscillation, piece.a, piece.b)
            snapshots = knots[n], middles[n], knots[n + 1]
            oscillation = np.array([d.oscillation(snapshot.left_out) for snapshot in snapshots])
            yield Terms(
                piece=piece,
                residual=products[..., n, :],
                curvature=float(curvature[n]),
                contact=contact[n],
                oscillation=oscillation + missed.cells,
                bending=float(bending[n]),
                missed=missed,
            )

    def _residual(self, loads: Loads, target: Tensors, u: Array) -> tuple[Array, Array]:
        """Compute the equilibrated stress σ̃ nearest to a given stress at several times.

        Args:
            loads: the loads that σ̃ balances.
            target: the given stress Aε(ũ̇) + Gε(ũ), (3, times, cells, Q).
            u: the displacements ũ, (times, dofs).

        Returns:
            The residual ρ = σ̃ − target, as ``_in_directions`` returns it, (directions, times, cells, Q); and the
            Bernstein coefficients of σ̃_ν on Γ3, (times, edges of Γ3, n).
        """
        d = self.discretisation
        nearest = d.nearest_stress(loads, target, u)
        return self._in_directions(nearest.values), -d.equilibrium.pressure(nearest)

    def _in_directions(self, stress: Tensors) -> Array:
        """Return the components v_i·τ of a stress τ times roots of the quadrature weights.

        The shape is (3, ..., Q) → (directions, ..., Q).

        With these factors (w/α)^½, a sum of products over the points is an integral ∫_T (v_i·σ)(v_i·τ)/α.
        """
        components = mapped(self._directions, stress)
        components *= self._roots
        return components

    def products(self, stresses: Sequence[Array]) -> Array:
        """Return the inner products on every cell of any two of n stresses, for each direction of ``Moduli``.

        The shape is (n, n, directions, ..., cells).

        Args:
            stresses: for each stress its components in the directions at the Q quadrature points, times the roots of
                the weights, (directions, ..., cells, Q).
        """
        n = len(stresses)
        products = np.empty((n, n, *stresses[0].shape[:-1]))
        for a, b in combinations_with_replacement(range(n), 2):
            products[a, b] = products[b, a] = np.einsum("...q,...q->...", stresses[a], stresses[b])
        return products

    def _elastic(
        self, pieces: list[Parabola], rates: Array, control: Array, at_knots: Tensors
    ) -> tuple[Tensors, Array]:
        """Approximate the elastic stress Gε(ũ) on each time interval by a parabola in time.

        Args:
            pieces: the displacement ũ on each time interval.
            rates: the velocity of ũ at the ends of the intervals, (times + 1, dofs).
            control: its middle Bernstein coefficients, (times, dofs).
            at_knots: the stress Gε(ũ) at the ends of the intervals, (3, times + 1, cells, Q).

        Returns:
            The middle Bernstein coefficients of the parabolas, and bounds of the mean distances
            ‖Gε(ũ) − parabola‖_{A⁻¹}, which are 0 for linear G.
        """
        d = self.discretisation
        G = d.data.law.G
        elastic = d.elastic(control)
        if isinstance(G, Linear):
            return elastic, np.zeros(len(pieces))
        left = at_knots[:, :-1]
        right = at_knots[:, 1:]
        k = np.array([piece.b - piece.a for piece in pieces])[:, None, None]
        speeds = np.linalg.norm(d.strain(rates), axis=0)
        change = G.lipschitz * k * np.maximum(speeds[:-1], speeds[1:]) / 3
        if isinstance(G, Yield):
            change[~np.any([left, elastic, right], axis=(0, 1))] = 0.0
        squares = np.einsum("cq,pcq->p", d.stresses.weights, change**2)
        return (left + right) / 2, np.sqrt(squares / d.data.law.A.ellipticity)

    def _interval(self, terms: Terms, y: float) -> Interval:
        """Return the error bound on one time interval, from its terms and the bound y at its start."""
        d = self.discretisation
        moduli = d.moduli
        step = terms.step()
        k = step.k
        mean = step.mean
        missed = terms.missed
        at_b, inside = grow(y, moduli.values, step)
        # The contributions of the cells and of time to the increase of y. Only their proportions matter, because they
        # are scaled below so that their sum is the increase.
        weights = moduli.weights(d.data.body.T)
        squares = weights @ mean.residual
        changing = part_that_changes(weights @ terms.residual, squares)
        added = k * proportional((np.sqrt(squares) + np.sqrt(mean.oscillation)) ** 2)
        by_contact = np.hypot(y, np.sqrt(2 * k * mean.contact)) - y
        of_contact = d.divided_at_contact(by_contact, terms.contact_on_edges)
        in_cells = k * missed.in_cells
        cells = added * (1 - changing) + in_cells + of_contact
        time = float(added @ changing + k * mean.rest - in_cells.sum())
        shares = Shares(cells, time)
        return Interval(
            a=terms.piece.a,
            b=terms.piece.b,
            at_a=y,
            at_b=at_b,
            inside=inside,
            residual=k * (float(np.sqrt(mean.residual.sum())) + terms.curvature),
            contact=k * mean.contact,
            oscillation=k * float(np.linalg.norm(np.sqrt(mean.oscillation))),
            bending=k * terms.bending,
            missed=k * missed.everywhere,
            shares=shares.scaled_to(at_b - moduli.decay(k) * y),
        )


def _loads(snapshots: Sequence[Snapshot]) -> Loads:
    """Return the projected loads at several times, given at single times."""
    return together([snapshot.loads for snapshot in snapshots])


def part_that_changes(products: Array, squares: Array) -> Array:
    """Return 1 − ‖mean(f)‖²/mean(‖f‖²) for n parabolas f in time, with means over the time interval, (n,).

    This is the fraction of the mean square that is due to the change of f in time; 0 if f is constant.

    Args:
        products: the inner products of any two Bernstein coefficients of each of n parabolas, (3, 3, n).
        squares: the mean over time of the squared norm of each parabola, (n,).
    """
    # The mean of a parabola is the mean of its three coefficients, because each Bernstein polynomial has the mean 1/3.
    means = products.sum(axis=(0, 1)) / 9
    return np.clip(1 - np.divide(means, squares, out=np.ones_like(squares), where=squares > 0), 0.0, 1.0)

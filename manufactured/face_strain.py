"""The normal strain q = ε_nn and the shear strain r = 2ε_sn on a contact face, for a given pressure p(s, t) = −σ_ν.

**Linear law** (``Memory``). If A and G do not couple the components nn and sn, only ε_nn is not zero on the face. Then
σ_ν = a q̇ + g q with a = A_nnnn, g = G_nnnn, and

    a q̇ + g q = −p,   q(s, 0) = q_0(s)
    q(s, t) = e^{−λt} q_0(s) − ∫_0^t e^{−λ(t−r)} p(s, r)/a dr,   λ = g/a.

In a heterogeneous body a and g are formulas of s with a constant ratio λ. After contact p = 0, and q decays like
e^{−λt}. The pressure is prescribed, not the strain, because a prescribed strain would give a tension, σ_ν > 0, where a
front recedes.

**Slip.** If the face also slips along itself by z(s, t), then ε_ss = ∂_s z, and the law needs the additional stress l =
A_nnss ∂_s ż + G_nnss ∂_s z: q is the solution of a q̇ + g q = −p − l. In 3D, ε_ss is the symmetric part of the 2 × 2
matrix ∇_s z, and A_nnss and G_nnss act on it.

**Coupled linear law** (``Coupled``). If A or G couples nn with sn, a shear r is needed for σ_τ = 0. With y = (q, r) and
the matrices 𝒜 and 𝒢 of moduli, 𝒜 ẏ + 𝒢 y = −(p, 0) − l, where the vector l of slip stresses has as many components as
y. In the basis of eigenvectors these are d scalar equations.

**Law (3.3)** (``Prescribed``). A formula of the normal strain q is given for each of several time intervals, and the
pressure follows from the law at the strain q n⊗n + ε_ss. The shear stress σ_τ is 0 for every slip, because ε_sn = 0, A
is isotropic, and the elastic stress of (3.3) with K = {|Pτ| ≤ r} is a multiple of Pε. The formulas of q and z must be
chosen such that p ≥ 0 on the contact zone and p = 0 elsewhere. Where |Pε| ≤ r, the elastic stress is 0 and
p = −a q̇ − A_nnss ∂_s ż. A slip with ∂_s z = 0, which moves the face as a whole, changes neither ε nor p.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from typing import Protocol

import numpy as np
import sympy as sp

from manufactured.arguments import Size, checked
from manufactured.compiled import Jet, coefficients_in_t, function
from manufactured.face_formula import SMOOTH
from manufactured.symbols import SMALLEST, FormulaError, Function, Symbols, Values, pos, s, t
from manufactured.tensors import Array, Time, with_time_axis

# Integrals over time of smooth functions times e^{−λ(t−r)}.
#
# For polynomials there is a closed form with the φ-functions of exponential integrators. Other functions are integrated
# by Gauss's rule.


Integrals = Callable[[Array, Array], Values]
"""The type of integrals over time ∫_a^b e^{−λ(b−r)} ∂_s^i P(s, r) dr at N points s of a contact face.

P is the contact pressure divided by the viscosity, on times at which the pressure is smooth, and λ is the relaxation
rate. The starting times a are fixed. A call with times b, (n,), and the indices of n of the points, (n,), returns a
dict from the multi-index i of the derivative along the face to the values of the integrals up to the times b, (n,).
"""
Prepare = Callable[[Array, Array, Array, int], Integrals]
"""The type of a function that prepares integrals over time. Its arguments are

* the coordinates s of the points, (d − 1, N);
* the starting times a, (N,);
* the latest times b for which integrals will be needed, (N,);
* the highest order |i| of derivatives along the face.
"""


def polynomial_integrals(smooth: sp.Expr, variables: Symbols, decay: float) -> Prepare:
    """Return the function that prepares integrals over time for a polynomial P of degree m in the time r.

    With τ = b − a, Taylor's formula at a gives

        ∫_a^b e^{−λ(b−r)} P(r) dr = Σ_{j≤m} ∂_r^j P(a) τ^{j+1} φ_{j+1}(−λτ),    φ_k(z) = Σ_n z^n/(n + k)!.

    Only τ depends on b, so the derivatives ∂_r^j P(a) at a point s are computed once.

    Args:
        smooth: the formula of P.
        variables: the symbols of the coordinates s along the face.
        decay: the rate λ.

    Source of the functions φ_k: M. Hochbruck, A. Ostermann, Exponential integrators, Acta Numer. 19 (2010) 209–286.
    """
    powers = [Jet(coefficient, variables) for coefficient in reversed(coefficients_in_t(smooth))]
    count = len(powers)
    factorials = np.array([[math.factorial(j)] for j in range(count)], dtype=float)

    def prepare(points: Array, lower: Array, upper: Array, order: int) -> Integrals:
        values = [jet(points, lower, order) for jet in powers]
        derivatives = {}
        for index in values[0]:
            taylor = 1.0 * np.array([value[index] for value in values])  # values of integers have an integer type
            # Repeated synthetic division by r − a turns coefficients of powers of r into those of powers of r − a.
            for first in range(count):
                for j in reversed(range(first, count - 1)):
                    taylor[j] += lower * taylor[j + 1]
            derivatives[index] = factorials * taylor

        def upto(upper: Array, chosen: Array) -> Values:
            found = {index: np.empty(upper.shape, np.result_type(upper, value)) for index, value in derivatives.items()}
            for first in range(0, len(upper), INTEGRALS_AT_ONCE):
                here = slice(first, first + INTEGRALS_AT_ONCE)
                duration = upper[here] - lower[chosen[here]]
                weights = phi(-decay * duration, count)
                weights *= duration ** np.arange(1, count + 1)[:, None]
                for index, value in derivatives.items():
                    found[index][here] = np.einsum("jn,jn->n", np.take(value, chosen[here], axis=1), weights)
            return found

        return upto

    return prepare


INTEGRALS_AT_ONCE = 1 << 12
"""Number of integrals over time that are evaluated together, so that their data stay in the processor's cache."""
SMALL_ARGUMENT = 12.0
"""Up to this |z|, ``phi`` computes the functions φ_k(z) from the highest one, φ_K, by downward recurrence.

The recurrence amplifies rounding by |z|^K/K!.
"""
SERIES_TERMS = 48
"""Number of terms of the power series of the highest function φ_K in ``phi``.

The next term |z|^n/(n + K)! is below the rounding of the sum.
"""


def phi(z: Array, count: int) -> Array:
    """Return the functions φ_k(z) = Σ_n z^n/(n + k)!, k = 1, …, count, at points z, (N,) → (count, N).

    These are the functions of exponential integrators. The recurrence φ_k = z φ_{k+1} + 1/k! is used. Where |z| is
    small it runs downwards from the power series of φ_count, elsewhere upwards from φ_1 = (e^z − 1)/z.
    """
    found = np.empty((count, *z.shape), dtype=np.result_type(z, float))
    large = abs(z) > SMALL_ARGUMENT
    near = np.where(large, 0.0, z)
    size, terms, first = float(abs(near).max(initial=0.0)), 1, 1e18 * math.factorial(count)
    while terms < SERIES_TERMS and size**terms * first >= math.factorial(terms + count):
        terms += 1
    # Horner's rule overwrites one array, because most of the time for a strain with memory is spent here.
    series = found[-1]
    series[:] = 0.0
    for n in reversed(range(terms)):
        series *= near
        series += 1 / math.factorial(n + count)
    for k in range(count - 1, 0, -1):
        found[k - 1] = near * found[k] + 1 / math.factorial(k)
    if large.any():
        far = np.where(large, z, -1.0)
        value = np.expm1(far) / far
        for k in range(1, count + 1):
            found[k - 1] = np.where(large, value, found[k - 1])
            value = (value - 1 / math.factorial(k)) / far
    return found


def composite_gauss(ends: Array, points: int) -> tuple[Array, Array]:
    """Return nodes and weights of Gauss's rule on every panel of an interval, (panels · points,) each.

    Args:
        ends: the increasing ends of the panels, (panels + 1,).
        points: the number of Gauss points on each panel.
    """
    x, w = np.polynomial.legendre.leggauss(points)
    half = np.diff(ends)[:, None] / 2
    return (ends[:-1, None] + half * (1 + x)).ravel(), (half * w).ravel()


POINTS_OF_RULE = 40
"""Number of Gauss points in time on an interval of contact, or on each of the equal pieces into which it is divided."""
GAUSS_PIECES = (1, 4)
"""Numbers of equal pieces into which an interval of contact is divided for Gauss's rule; they are tried in turn.

A long contact may contain many periods of a motion.
"""
ACCURACY = 1e-13
"""Largest accepted error of Gauss's rule for integrals over time, relative to the largest integral.

The error is estimated by the difference between the rule on an interval and the rule on its halves.
"""


def smooth_integrals(branch: sp.Expr, variables: Symbols, decay: float) -> Prepare:
    """Return the function that prepares integrals over time of a smooth function P by Gauss's rule.

    It has the same arguments as ``polynomial_integrals``. The returned function raises FormulaError if P changes too
    fast in time.
    """
    jet = Jet(branch, variables)

    def prepare(points: Array, lower: Array, upper: Array, order: int) -> Integrals:
        every = np.arange(lower.size)
        middle = (lower + upper) / 2
        fading = np.exp(-decay * (upper - middle))
        for pieces in GAUSS_PIECES:
            rule = composite_gauss(np.linspace(0, 1, pieces + 1), POINTS_OF_RULE)
            integrals = partial(integrate_by_gauss, jet, decay, rule, points, order)
            # The error is estimated from the rule on both halves, for the derivative with the largest relative error.
            first, second = integrals(lower, middle, every), integrals(middle, upper, every)
            defects = []
            for index, value in integrals(lower, upper, every).items():
                off = abs(value - fading * first[index] - second[index]).max(initial=0.0)
                # SMALLEST prevents a division by zero if all integrals are zero.
                defects.append((float(off), max(float(abs(value).max(initial=0.0)), SMALLEST)))
            off, size = max(defects, key=lambda pair: math.inf if math.isnan(pair[0]) else pair[0] / pair[1])
            if off <= ACCURACY * size:
                return partial(integrals, lower)
        raise FormulaError(
            f"{branch}: this part of p/a changes so fast in t that the strain it causes has an error of {off:.1g} for "
            f"a size of {size:.3g}; take a slower motion or a shorter time"
        )

    return prepare


def integrate_by_gauss(
    jet: Jet,
    decay: float,
    rule: tuple[Array, Array],
    points: Array,
    order: int,
    lower: Array,
    upper: Array,
    chosen: Array,
) -> Values:
    """Return integrals over time by a quadrature rule, (n,) for each derivative along the face.

    Args:
        jet: evaluates the integrand P.
        decay: the rate λ.
        rule: nodes and weights of the rule on (0, 1).
        points: the coordinates s of N points, (d − 1, N).
        order: the highest order of derivatives along the face.
        lower: the starting times at all points, (N,).
        upper: the times up to which is integrated, (n,).
        chosen: the numbers of n of the points, (n,).
    """
    nodes, weights = rule
    begin = lower[chosen][:, None]
    length = upper[:, None] - begin
    left = length * (1 - nodes)
    factors = length * weights * np.exp(-decay * left)
    places = np.repeat(points[:, chosen, None], len(nodes), axis=2)
    values = jet(places, begin + length * nodes, order)
    return {index: np.einsum("nq,nq->n", value, factors) for index, value in values.items()}


# The times at which contact fronts pass given points of a face, so that contact begins or ends there.


class Front(Protocol):
    """The interface of contact fronts, each given by a function ψ(s, t) that is positive where there is contact."""

    def passes(self, points: Array, T: float) -> Array:
        """Return the times in (0, T) at which the contact front passes N points, that is, ψ changes its sign there.

        Args:
            points: the coordinates s of the points along the face, (d − 1, N).
            T: the final time.

        Returns:
            The times, (n, N), where n is the largest number of times at a point. Missing times are T.
        """
        ...

    def beyond(self, points: Array, time: Array) -> Array:
        """Return whether there is contact, ψ > 0, at N points, (d − 1, N), and times (…, N); the result is (…, N)."""
        ...


def between(passes: Array, T: float) -> tuple[Array, Array]:
    """Return the starts and ends of the intervals into which n given times divide [0, T], at N points.

    Args:
        passes: the times at each point, (n, N), such as the times at which a front passes the point.
        T: the final time.

    Returns:
        The starts and the ends, (n + 1, N) each.
    """
    ends = np.zeros((1, passes.shape[1]))
    nodes = np.sort(np.vstack([ends, passes, ends + T]), axis=0)
    return nodes[:-1], nodes[1:]


WITHIN = 0.38
"""Whether there is contact in a time interval is tested at this relative position in the interval."""


def within(begin: Array, end: Array) -> Array:
    """Return a time inside each interval [begin, end], at the fraction ``WITHIN`` of its length; all shapes are equal.

    The midpoint is not used, because the level function ψ of a symmetric motion of the contact zone may be zero there.
    """
    return begin + WITHIN * (end - begin)


def front(formula: sp.Expr, variables: Symbols) -> Front:
    """Return the contact front for a formula ψ(s, t) that is positive where there is contact.

    The result is a ``PolynomialFront`` if ψ is a polynomial of t, otherwise a ``SmoothFront``.

    Args:
        formula: the formula of ψ.
        variables: the symbols of the coordinates s along the face.
    """
    if formula.is_polynomial(t):
        return PolynomialFront(function(variables, coefficients_in_t(formula)))
    return SmoothFront(Jet(formula, variables))


@dataclass(frozen=True)
class PolynomialFront:
    """A contact front given by a level function ψ(s, t) that is a polynomial of the time t; contact is where ψ > 0.

    Attributes:
        coefficients: the function from s to the coefficients of the polynomial, highest power first.
    """

    coefficients: Function

    def passes(self, points: Array, T: float) -> Array:
        return real_roots(self._at(points), T)

    def beyond(self, points: Array, time: Array) -> Array:
        return np.polyval(self._at(points), time) > 0

    def _at(self, points: Array) -> Array:
        _, *found = np.broadcast_arrays(points[0], *self.coefficients(*points))
        return np.array(found, dtype=float)


SEARCH_INTERVALS, SURE = (257, 600), 1e-6
"""The search for the turning points in time of the level function ψ, which is made twice as a check.

``SEARCH_INTERVALS`` are the numbers of intervals of [0, T] in both searches. ``SURE`` is the largest accepted
difference of the two results for the total time of contact, relative to T. Where ψ only touches zero, rounding changes
this time by 1e-8.
"""
BISECTIONS = 64
"""Number of bisections in the search for the time at which a front passes a point.

After this number an interval is as short as rounding permits.
"""
POINTS_AT_ONCE = 1024
"""Number of points of a face that are treated together."""


@dataclass(frozen=True)
class SmoothFront:
    """A contact front given by a level function ψ(s, t) that is smooth in the time t; contact is where ψ > 0.

    Between two turning points of ψ, at which ∂_t ψ changes its sign, ψ has at most one root. It is found by bisection.

    Attributes:
        level: evaluates ψ.
    """

    level: Jet

    def passes(self, points: Array, T: float) -> Array:
        """Return the times at which the contact front passes given points, with the shapes of ``Front.passes``.

        Raises:
            FormulaError: ψ turns so often that turning points may be missed.
        """
        found = [self._passes(points[:, i : i + POINTS_AT_ONCE], T) for i in range(0, points.shape[1], POINTS_AT_ONCE)]
        rows = max((len(times) for times in found), default=0)
        filled = [np.pad(times, ((0, rows - len(times)), (0, 0)), constant_values=T) for times in found]
        return np.concatenate([*filled, np.empty((rows, 0))], axis=1)

    def _passes(self, points: Array, T: float) -> Array:
        coarse, fine = (self._between(count, points, T) for count in SEARCH_INTERVALS)
        if (abs(self._beyond_for(coarse, points, T) - self._beyond_for(fine, points, T)) > SURE * T).any():
            raise FormulaError(
                f"{self.level.expression}: the front turns so often that {SEARCH_INTERVALS[1]} times in [0, {T:g}] do "
                "not show when it passes a point; take a slower motion or a shorter time"
            )
        return fine

    def _between(self, count: int, points: Array, T: float) -> Array:
        """Return the times at which ψ changes its sign, searched in ``count`` intervals and between turning points."""
        grid = np.repeat(np.linspace(0.0, T, count + 1)[:, None], points.shape[1], axis=1)
        turns = self._changes(self.level.rate(), points, grid, T)
        return self._changes(self.level, points, np.sort(np.concatenate([grid, turns]), axis=0), T)

    def _beyond_for(self, passes: Array, points: Array, T: float) -> Array:
        """Return the total time of contact, ψ > 0, at each point, (N,)."""
        begin, end = between(passes, T)
        return np.sum((end - begin) * self.beyond(points, within(begin, end)), axis=0)

    def beyond(self, points: Array, time: Array) -> Array:
        return _positive(self.level, points, time)

    def _changes(self, of: Jet, points: Array, times: Array, T: float) -> Array:
        """Return the times at which a function changes its sign between given times.

        Args:
            of: evaluates the function.
            points: the N points, (d − 1, N).
            times: the times between which a change of sign is searched, (n, N).
            T: the final time, which stands for missing times in the result.
        """
        signs = _positive(of, points, times)
        interval, point = np.nonzero(signs[1:] != signs[:-1])
        low, high, at = times[interval, point], times[interval + 1, point], points[:, point]
        before = signs[interval, point]
        for _ in range(BISECTIONS):
            middle = (low + high) / 2
            same = _positive(of, at, middle) == before
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        found = np.full((len(times) - 1, points.shape[1]), T)
        found[interval, point] = high
        most = np.bincount(point).max(initial=0)
        return np.sort(found, axis=0)[:most]


def _positive(of: Jet, points: Array, time: Array) -> Array:
    return of(points, time)[(0,) * len(points)] > 0


def real_roots(coefficients: Array, T: float) -> Array:
    """Return the roots in (0, T) of N polynomials, (degree, N); missing roots are T.

    A polynomial is monotone between the roots of its derivative, and has a root between two of them if its sign
    changes.

    Args:
        coefficients: the coefficients, highest power first, (degree+1, N).
        T: the end of the interval.
    """
    if len(coefficients) == 1:
        return np.empty((0, coefficients.shape[1]))
    begin, end = between(real_roots(_derivative(coefficients), T), T)
    signs = np.polyval(coefficients, begin) > 0
    interval, point = np.nonzero((np.polyval(coefficients, end) > 0) != signs)
    roots = np.full((len(coefficients) - 1, coefficients.shape[1]), T)
    roots[interval, point] = _bracketed(
        coefficients[:, point], begin[interval, point], end[interval, point], signs[interval, point]
    )
    return roots


def _bracketed(coefficients: Array, low: Array, high: Array, before: Array) -> Array:
    """Return the root of each of n polynomials in an interval on which it is monotone, (n,).

    Newton's method is used, and bisection where Newton's method leaves the interval, until no root changes.

    Args:
        coefficients: the coefficients, highest power first, (degree+1, n).
        low, high: the ends of the intervals, (n,) each; they are overwritten.
        before: whether the polynomial is positive at ``low``, (n,).
    """
    slopes = _derivative(coefficients)
    roots, moving, still = (low + high) / 2, np.arange(low.size), 4 * np.spacing(high)
    for _ in range(BISECTIONS):
        root = roots[moving]
        value, slope = np.polyval(coefficients[:, moving], root), np.polyval(slopes[:, moving], root)
        same = (value > 0) == before[moving]
        low[moving[same]], high[moving[~same]] = root[same], root[~same]
        with np.errstate(divide="ignore", invalid="ignore"):
            following = root - value / slope
        inside = (following >= low[moving]) & (following <= high[moving])
        roots[moving] = np.where(inside, following, (low[moving] + high[moving]) / 2)
        moving = moving[abs(roots[moving] - root) > still[moving]]
        if not moving.size:
            break
    return roots


def _derivative(coefficients: Array) -> Array:
    """Return the coefficients of the derivatives of polynomials: (degree+1, N) → (degree, N)."""
    return coefficients[:-1] * np.arange(len(coefficients) - 1, 0, -1)[:, None]


# Divides the pressure at a point of a face into intervals of contact, in each of which it is smooth in time.


def smooth_branch(term: sp.Expr, variables: Symbols) -> tuple[tuple[sp.Expr, ...], sp.Expr]:
    """Split a term of the contact pressure: return its moving fronts, and its formula where there is contact.

    The term is θ(s, t)·∏ pos(ψ_i, m_i). Its moving fronts are the formulas ψ_i that contain t; each is positive where
    there is contact.

    Args:
        term: the formula of the term.
        variables: the symbols of the coordinates s along the face.

    Raises:
        FormulaError: an exponent m_i is not an integer ≥ 2 (≥ 0 if ψ_i depends on t only), or the formula between the
            fronts contains functions of t that are not known to be smooth.
    """
    fronts = [p for p in term.atoms(pos) if p.args[0].has(t)]
    for power in fronts:
        # With the exponent 1, the second derivative of the strain along the face would contain a Dirac measure at the
        # front. If ψ depends on time only, there is no such measure.
        lowest = 2 if power.args[0].free_symbols & set(variables) else 0
        if not (power.args[1].is_integer and power.args[1] >= lowest):
            raise FormulaError(
                f"{power}: a moving front of the pressure needs pos(ψ, m) with an integer m ≥ 2; with a smaller m the "
                "strain that the pressure causes has no second derivative along the face"
            )
    smooth = term.subs({p: p.args[0] ** p.args[1] for p in fronts})
    strange = {str(type(f).__name__) for f in smooth.atoms(sp.Function) if f.has(t) and not isinstance(f, SMOOTH)}
    if strange:
        raise FormulaError(
            f"the pressure term {term} has {', '.join(sorted(strange))} of t, so that it is not known to be smooth "
            f"between its fronts; of functions use {', '.join(f.__name__ for f in SMOOTH)}"
        )
    return tuple(sorted({power.args[0] for power in fronts}, key=sp.default_sort_key)), smooth


@dataclass(frozen=True, eq=False)
class PressureTerm:
    """The sum of those terms of the load over the viscosity, (p + l)/a, that have the same moving contact fronts.

    p is the contact pressure, l the normal stress that a slip causes, and a the normal modulus of the viscosity. Each
    front is given by a function ψ(s, t). At each point of the face, the sum is smooth in time while all these ψ are
    positive, and 0 at other times.

    Attributes:
        moving: the moving contact fronts.
        integral: prepares integrals over time of the formula that holds where all ψ are positive.
    """

    moving: tuple[Front, ...]
    integral: Prepare

    def intervals(self, points: Array, T: float) -> tuple[Array, Array]:
        """Return the times at which contact begins and ends at N points, in J time intervals, (J, N) each.

        If both times of an interval are equal, there is no contact in this interval.

        Args:
            points: the coordinates s of the points along the face, (d − 1, N).
            T: the final time.
        """
        passes = [np.empty((0, points.shape[1]))]
        for moving in self.moving:
            passes.append(moving.passes(points, T))
        begin, end = between(np.vstack(passes), T)
        times = within(begin, end)
        inside = np.ones(times.shape, dtype=bool)
        for moving in self.moving:
            inside &= moving.beyond(points, times)
        return np.where(inside, begin, T), np.where(inside, end, T)


# The interface of the strain on a contact face, and prescribed strains, from which the law gives the pressure.

Components = tuple[Values, ...]
"""The strain on a contact face with its derivatives along the face.

It is (q,) with the normal strain q, or (q, r_1, …, r_{d−1}) if there is also shear.
"""


class StrainAtPoints(Protocol):
    """The interface of the strain at fixed points of a contact face, as a function of time.

    A call returns the tuple (q,) with the normal strain q, or (q, r_1, …, r_{d−1}) if there is also shear. Each entry
    is a dict from multi-indices of derivatives along the face to values at the points. The arguments are the time,
    whether time derivatives are wanted, and the highest order of derivatives along the face. For n times, (n,), the
    values have n as an additional last axis.
    """

    def __call__(self, time: Time, rate: bool, order: int) -> Components: ...


class FaceStrain(Protocol):
    """The interface of the normal strain q and shear strain r on a contact face as functions of s and t.

    ``at`` prepares the evaluation at fixed points with the coordinates s along the face, (d−1, ...). ``formula`` is a
    formula from whose truncated powers the smoothness of the strain is read off: q, or the pressure that determines q.
    """

    @property
    def formula(self) -> sp.Expr: ...

    def at(self, points: Array) -> StrainAtPoints: ...


def relaxation_rate(elasticity: sp.Expr, viscosity: sp.Expr) -> float:
    """Return the relaxation rate g/a of the normal strain on a contact face, which must be constant along the face.

    Args:
        elasticity: the formula of the normal modulus g of the elasticity along the face.
        viscosity: the formula of the normal modulus a of the viscosity along the face.

    Raises:
        FormulaError: g/a varies along the face.
    """
    ratio: sp.Expr = elasticity / viscosity
    # ``cancel`` is tried first: it is enough for most factors, and ``simplify`` takes longer because SymPy loads its
    # physical units.
    for shortened in (sp.cancel, sp.simplify):
        ratio = shortened(ratio) if ratio.free_symbols else ratio
    if ratio.free_symbols:
        raise FormulaError(
            f"the relaxation rate g/a = {ratio} varies along the face; let the factors of A and G agree on the "
            "contact face up to a constant, and differ inside"
        )
    return float(ratio)


@dataclass(frozen=True, eq=False)
@checked(FormulaError)
class Prescribed:
    """A prescribed normal strain q on a contact face; the pressure follows from q and q̇ by the law.

    Attributes:
        phases: pairs of the end of a time interval and the formula of q(s, t) in it, in the order of time. The last
            interval ends at T. Formulas of neighbouring intervals must agree where they meet; the self-proof checks
            this.
        variables: the symbols of the coordinates s along the face.
    """

    phases: tuple[tuple[Size, sp.Expr], ...]
    variables: Symbols = (s,)

    def __post_init__(self) -> None:
        ends = [end for end, _ in self.phases]
        if not ends or (np.diff(ends) <= 0).any():
            raise FormulaError(f"phases need one interval or more, and ends that increase, got the ends {ends}")

    @property
    def formula(self) -> sp.Expr:
        """The sum of the formulas of all time intervals, from whose truncated powers the smoothness is read off.

        It contains the truncated powers of every interval; its values are not the strain.
        """
        return sum((formula for _, formula in self.phases), sp.Integer(0))

    @cached_property
    def _jets(self) -> list[tuple[Jet, Jet]]:
        jets = [Jet(formula, self.variables) for _, formula in self.phases]
        return [(jet, jet.rate()) for jet in jets]

    def at(self, points: Array) -> StrainAtPoints:
        ends = [end for end, _ in self.phases]

        def strain(time: Time, rate: bool, order: int) -> Components:
            times, places = np.asarray(time), with_time_axis(points, time)
            phase = np.minimum(np.searchsorted(ends, times.real), len(ends) - 1)
            found: Values = {}
            for number in np.unique(phase):
                # Every formula is evaluated only at times of its own interval, because it may have no value elsewhere.
                here = phase == number
                values = self._jets[number][rate](places, np.where(here, times, times[here][0]), order)
                found = {index: np.where(here, value, found.get(index, value)) for index, value in values.items()}
            return (found,)

        return strain


# The strain on a contact face for a linear law, which depends on the history of the pressure.

NO_STRESS = sp.Integer(0)
RECENT = 3
"""Number of times for which the method ``Memory.at`` keeps computed values of the strain."""


@dataclass(frozen=True, eq=False)
@checked(FormulaError)
class Memory:
    """The normal strain q on a contact face for a linear law, computed from the history of the contact pressure p.

    q is the solution of a q̇ + g q = −(p + l), exact up to rounding. Here a and g are the normal moduli of viscosity
    and elasticity, and l is the normal stress that a slip of the face causes, 0 without slip.

    **Form of the load.** p + l must be a sum of terms θ(s, t)·∏ pos(ψ_i(s, t), m_i). Those ψ_i that contain t are
    called moving; their zeros are contact fronts that move. θ and the moving ψ_i must be smooth in t. The exponents m_i
    of moving ψ_i must be integers ≥ 2, or ≥ 0 if ψ_i does not depend on s.

    **Integration.** At each s, the roots in t of the moving ψ_i of a term divide [0, T] into intervals (``front``). The
    term, divided by a, is a smooth function P(s, ·) in those intervals in which all of them are positive, and 0 in the
    others. With λ = g/a, the integral of e^{−λ(t−r)} P over the time r is known in closed form if P is a polynomial of
    t; otherwise Gauss's rule is used. The derivative ∂_s^i q is the same expression with ∂_s^i P for all
    i up to the smallest exponent of a moving ψ that depends on s: ∂_s^{i−1} P then vanishes where an interval begins or
    ends at a time that depends on s.

    Attributes:
        pressure: the formula of p(s, t).
        viscosity, elasticity: the normal moduli a > 0 and g: numbers, or formulas of s with a constant ratio. g is
            negative if the material softens.
        T: the final time.
        initial: the formula of q(s, 0). By default q starts at rest, q = −(p + l)/g: without slip, the body starts in
            elastic equilibrium.
        variables: the coordinates along the face.
        slip_stress: the formula of l(s, t).

    Raises:
        FormulaError: g/a varies along the face. The method ``at`` raises it if p + l is not of this form.
    """

    pressure: sp.Expr
    viscosity: sp.Expr
    elasticity: sp.Expr
    T: Size
    initial: sp.Expr | None = None
    variables: Symbols = (s,)
    slip_stress: sp.Expr = NO_STRESS

    def __post_init__(self) -> None:
        self.decay  # refuse a wrong ratio when the face is made, not when it is used  # noqa: B018

    @property
    def formula(self) -> sp.Expr:
        """The formula from whose truncated powers the smoothness of the strain is read off: p + l + q(·, 0).

        p is the contact pressure, l the normal stress that the slip causes, and q(·, 0) the initial strain if given.
        """
        return self.load + (0 if self.initial is None else self.initial)

    @property
    def load(self) -> sp.Expr:
        """The formula of p + l, which drives the strain: contact pressure p plus normal stress l caused by the slip."""
        return self.pressure + self.slip_stress

    @cached_property
    def decay(self) -> float:
        """The relaxation rate λ = g/a, the normal modulus of the elasticity over that of the viscosity."""
        return relaxation_rate(self.elasticity, self.viscosity)

    @cached_property
    def start(self) -> Jet:
        """The initial strain q(s, 0) as a formula with its derivatives."""
        elastic = -self.load.subs(t, 0) / self.elasticity
        return Jet(elastic if self.initial is None else self.initial, self.variables)

    @cached_property
    def source_jet(self) -> Jet:
        """The load over the viscosity, (p + l)/a, as a formula with its derivatives.

        p is the contact pressure, l the normal stress that the slip causes, and a the normal modulus of the viscosity.
        """
        return Jet(self.load / self.viscosity, self.variables)

    @cached_property
    def terms(self) -> tuple[PressureTerm, ...]:
        """The terms of (p + l)/a, the load over the viscosity; terms with the same moving contact fronts are added up.

        p is the contact pressure, l the normal stress that the slip causes, and a the normal modulus of the viscosity.
        """
        branches: dict[tuple[sp.Expr, ...], sp.Expr] = {}
        for term in sp.Add.make_args(sp.expand(self.load)):
            fronts, branch = smooth_branch(term, self.variables)
            branches[fronts] = branches.get(fronts, sp.Integer(0)) + branch / self.viscosity
        terms = []
        for fronts, branch in branches.items():
            if branch != 0:
                integrals = polynomial_integrals if branch.is_polynomial(t) else smooth_integrals
                moving = tuple(front(formula, self.variables) for formula in fronts)
                terms.append(PressureTerm(moving, integrals(branch, self.variables, self.decay)))
        return tuple(terms)

    def at(self, points: Array) -> StrainAtPoints:
        flat = points.reshape(points.shape[0], -1)
        contacts = [contact_integrals(term, flat, self) for term in self.terms]
        start = lru_cache(partial(self.start, flat, 0.0))

        # Strains are cached, because a stress needs strain and strain rate at one time, and several computations need
        # the same times.
        @lru_cache(RECENT)
        def at_times(when: tuple[float, ...] | complex, order: int) -> Values:
            time = np.array(when) if isinstance(when, tuple) else when
            fading = np.exp(-self.decay * time)
            kind = np.result_type(flat, time)
            totals = {
                index: np.multiply.outer(value, fading).astype(kind, copy=False)
                for index, value in start(order).items()
            }
            for subtract in contacts:
                subtract(totals, time, order)
            shape = (*points.shape[1:], *np.shape(time))
            return {index: total.reshape(shape) for index, total in totals.items()}

        def strain(time: Time, rate: bool, order: int) -> Components:
            values = at_times(tuple(time) if isinstance(time, np.ndarray) else time, order)
            if not rate:
                return (values,)
            source = self.source_jet(with_time_axis(points, time), time, order)
            return ({index: -source[index] - self.decay * value for index, value in values.items()},)

        return strain


def contact_integrals(term: PressureTerm, points: Array, memory: Memory) -> Callable[[Values, Time, int], None]:
    """Return a function that subtracts the integrals ∫ e^{−λ(t−r)} ∂_s^i P dr of a term of the pressure from strains.

    The integrals are over all intervals of contact before t. A call has the strains, a dict from multi-indices i to
    values, which are changed; one time or several times; and the highest order of derivatives. The intervals of contact
    at each point, and the integrals over past intervals, are computed once.

    Args:
        term: the term of the pressure.
        points: the coordinates s of the points, (d − 1, N).
        memory: has the rate λ and the final time.
    """
    entry, exit_ = term.intervals(points.real, memory.T)
    used = entry < exit_
    # For each of the M intervals the number of its point, (M,). A point may have several intervals.
    touched = np.nonzero(used)[1]
    entry, exit_ = entry[used], exit_[used]

    @lru_cache
    def integrals(order: int) -> tuple[Integrals, Values]:
        """Return the integrals from the entry into contact as functions of time, and their values at the exit."""
        upto = term.integral(points[:, touched], entry, exit_, order)
        return upto, upto(exit_, np.arange(exit_.size))

    def subtract(totals: Values, time: Time, order: int) -> None:
        upto, whole = integrals(order)
        times = np.atleast_1d(time)
        now = times.real
        over, when = np.nonzero(exit_[:, None] <= now)
        if over.size:
            since = np.exp(-memory.decay * (times[when] - exit_[over]))
            places = touched[over] * len(times) + when
            for index, total in totals.items():
                np.subtract.at(total.reshape(-1), places, since * whole[index][over])
        touching, when = np.nonzero((entry[:, None] < now) & (exit_[:, None] > now))
        if touching.size:
            found = upto(times[when], touching)
            # No index occurs twice, because at any time a point belongs to at most one interval of contact. So ``-=``
            # is safe.
            places = touched[touching] * len(times) + when
            for index, total in totals.items():
                total.reshape(-1)[places] -= found[index]

    return subtract


@dataclass(frozen=True, eq=False)
@checked(FormulaError)
class Coupled:
    """The strain on a contact face for a linear law that couples the normal strain q with the shear strain r.

    y = (q, r) satisfies α (𝒜 ẏ + 𝒢 y) = −(p, 0) − l with the contact pressure p, the stress l that a slip of the face
    causes, matrices 𝒜, 𝒢 of moduli, and a common scalar factor α(s). The solution is y = Σ_i x_i η_i with the
    eigenvectors x_i, for which 𝒢 x_i = λ_i 𝒜 x_i and Xᵀ𝒜X = I, where X has the columns x_1, …, x_d. Each η_i is the
    solution of α (η̇_i + λ_i η_i) = −x_i·((p, 0) + l), a scalar equation that ``Memory`` solves.

    Attributes:
        pressure: the formula of p(s, t).
        modes: the functions η_i(s, t).
        vectors: the matrix X of the eigenvectors x_i, (d, d).
    """

    pressure: sp.Expr
    modes: tuple[Memory, ...]
    vectors: Array

    @classmethod
    @checked(FormulaError)
    def of(
        cls,
        pressure: sp.Expr,
        slip_stress: tuple[sp.Expr, ...],
        viscous: Array,
        elastic: Array,
        scale: sp.Expr,
        T: float,
        initial: sp.Expr | None,
        variables: Symbols,
    ) -> Coupled:
        """Return the normal strain q and the shear strain r on a contact face, from the contact pressure.

        Args:
            pressure: the formula of the contact pressure p(s, t).
            slip_stress: the formulas of the d components of l(s, t), the stress that a slip of the face causes.
            viscous, elastic: the matrices 𝒜 and 𝒢 of moduli without the factor α, (d, d) each. y = (q, r) solves
                α (𝒜 ẏ + 𝒢 y) = −(p, 0) − l.
            scale: the formula of the common factor α(s).
            T: the final time.
            initial: the formula of q(s, 0), with r(s, 0) = 0; None for a start at rest, q̇ = ṙ = 0.
            variables: the symbols of the coordinates s along the face.
        """
        inverse = np.linalg.inv(np.linalg.cholesky(viscous))
        rates, basis = np.linalg.eigh(inverse @ elastic @ inverse.T)
        vectors = inverse.T @ basis
        modes = tuple(
            Memory(
                sp.Float(x[0]) * pressure,
                scale,
                float(rate) * scale,
                T,
                None if initial is None else float(viscous[0] @ x) * initial,
                variables,
                x @ np.array(slip_stress, dtype=object),
            )
            for rate, x in zip(rates, vectors.T, strict=True)
        )
        return cls(pressure, modes, vectors)

    @property
    def formula(self) -> sp.Expr:
        """The formula from whose truncated powers the smoothness of the strain is read off.

        It is the sum of the pressure p and of the formulas of all η_i; its values have no meaning.
        """
        return self.pressure + sum(mode.formula for mode in self.modes)

    def at(self, points: Array) -> StrainAtPoints:
        modes = [mode.at(points) for mode in self.modes]

        def strain(time: Time, rate: bool, order: int) -> Components:
            found = [mode(time, rate, order) for mode in modes]
            return tuple(
                {index: sum(x * v[index] for x, (v,) in zip(row, found, strict=True)) for index in found[0][0]}
                for row in self.vectors
            )

        return strain

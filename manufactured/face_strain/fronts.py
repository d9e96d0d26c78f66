"""The times at which contact fronts pass given points of a face, so that contact begins or ends there."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import sympy as sp

from manufactured.compiled import coefficients_in_t, function
from manufactured.symbols import FormulaError, Function, Symbols, t
from manufactured.tensors import Array


class Front(Protocol):
    """The interface of contact fronts, each given by a function ψ(s, t) that is positive where there is contact."""

    def passes(self, points: Array, T: float) -> Array:
        """Return the times in (0, T) at which the front passes N points, that is, ψ changes its sign there.

        The points have the shape (d − 1, N), the result (most times at a point, N). Missing times are T.
        """
        ...

    def beyond(self, points: Array, time: Array) -> Array:
        """Return whether there is contact, ψ > 0, at N points, (d − 1, N), and times (…, N); the result is (…, N)."""
        ...


def between(passes: Array, T: float) -> tuple[Array, Array]:
    """Return the starts and ends of the intervals into which given times divide [0, T], (n, N) → (n + 1, N) each."""
    ends = np.zeros((1, passes.shape[1]))
    nodes = np.sort(np.vstack([ends, passes, ends + T]), axis=0)
    return nodes[:-1], nodes[1:]


WITHIN = 0.38
"""Whether there is contact in a time interval is tested at this relative position in the interval."""


def within(begin: Array, end: Array) -> Array:
    """Return a time inside each interval.

    The midpoint is not used, because ψ of a symmetric motion may be zero there.
    """
    return begin + WITHIN * (end - begin)


def front(formula: sp.Expr, variables: Symbols) -> Front:
    """Return the contact front for a formula ψ, a ``PolynomialFront`` if ψ is a polynomial of t."""
    if formula.is_polynomial(t):
        return PolynomialFront(function(variables, coefficients_in_t(formula)))
    symbols = (*variables, t)
    return SmoothFront(formula, function(symbols, [formula]), function(symbols, [sp.diff(formula, t)]))


@dataclass(frozen=True)
class PolynomialFront:
    """A contact front for which ψ is a polynomial of time.

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


INSTANTS, SURE = (257, 600), 1e-6
"""The search for the turning points of ψ in time, which is made twice as a check.

``INSTANTS`` are the numbers of intervals of [0, T] in both searches. ``SURE`` is the largest accepted difference of the
two results for the total time of contact, relative to T. Where ψ only touches zero, rounding changes this time by 1e-8.
"""
HALVINGS = 64
"""Number of bisections, after which an interval is as short as rounding permits."""
BLOCK = 1024
"""Number of points of a face that are treated together."""


@dataclass(frozen=True)
class SmoothFront:
    """A contact front for which ψ is any smooth function of time.

    Between two turning points of ψ, at which ∂_t ψ changes its sign, ψ has at most one root. It is found by bisection.

    Attributes:
        formula: the formula of ψ, for messages.
        level: the function from s and t to a list with the value of ψ.
        slope: the function from s and t to a list with the value of ∂_t ψ.
    """

    formula: sp.Expr
    level: Function
    slope: Function

    def passes(self, points: Array, T: float) -> Array:
        """Return the times at which the front passes given points; see ``Front.passes``.

        Raises:
            FormulaError: ψ turns so often that turning points may be missed.
        """
        found = [self._passes(points[:, i : i + BLOCK], T) for i in range(0, points.shape[1], BLOCK)]
        rows = max((len(times) for times in found), default=0)
        filled = [np.pad(times, ((0, rows - len(times)), (0, 0)), constant_values=T) for times in found]
        return np.concatenate([*filled, np.empty((rows, 0))], axis=1)

    def _passes(self, points: Array, T: float) -> Array:
        coarse, fine = (self._between(_grid(points, T, count), points, T) for count in INSTANTS)
        if (abs(self._beyond_for(coarse, points, T) - self._beyond_for(fine, points, T)) > SURE * T).any():
            raise FormulaError(
                f"{self.formula}: the front turns so often that {INSTANTS[1]} times in [0, {T:g}] do not show when it "
                "passes a point; take a slower motion or a shorter time"
            )
        return fine

    def _between(self, grid: Array, points: Array, T: float) -> Array:
        """Return the times at which ψ changes its sign, searched between grid times and turning points of ψ."""
        turns = self._changes(self.slope, points, grid, T)
        return self._changes(self.level, points, np.sort(np.concatenate([grid, turns]), axis=0), T)

    def _beyond_for(self, passes: Array, points: Array, T: float) -> Array:
        """Return the total time of contact, ψ > 0, at each point, (N,)."""
        begin, end = between(passes, T)
        return np.sum((end - begin) * self.beyond(points, within(begin, end)), axis=0)

    def beyond(self, points: Array, time: Array) -> Array:
        return _positive(self.level, points, time)

    def _changes(self, of: Function, points: Array, times: Array, T: float) -> Array:
        """Return the times at which a function changes its sign between given times.

        Args:
            of: the function.
            points: the N points, (d − 1, N).
            times: the times between which a change of sign is searched, (n, N).
            T: the final time, which stands for missing times in the result.
        """
        signs = _positive(of, points, times)
        interval, point = np.nonzero(signs[1:] != signs[:-1])
        low, high, at = times[interval, point], times[interval + 1, point], points[:, point]
        before = signs[interval, point]
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            same = _positive(of, at, middle) == before
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        found = np.full((len(times) - 1, points.shape[1]), T)
        found[interval, point] = high
        most = np.bincount(point).max(initial=0)
        return np.sort(found, axis=0)[:most]


def _grid(points: Array, T: float, count: int) -> Array:
    """Return the ends of ``count`` equal intervals of [0, T], repeated for all points, (count + 1, N)."""
    return np.repeat(np.linspace(0.0, T, count + 1)[:, None], points.shape[1], axis=1)


def _positive(of: Function, points: Array, time: Array) -> Array:
    return np.broadcast_to(of(*points, time)[0], time.shape) > 0


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
    for _ in range(HALVINGS):
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

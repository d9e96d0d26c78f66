"""Ranges of the Taylor coefficients of a formula over boxes: interval arithmetic on truncated power series.

For boxes X_1, …, X_N and an order m, the ranges of a formula f are numbers with

    {∂^α f(x)/α! : x ∈ X_n} ⊂ [low_αn, high_αn],   |α| ≤ m.

They are computed from the ranges of the parts of f. Sums and products are sums and products of power series; g(u) is
the series Σ_j g^(j)(u)/j! δ^j, where δ is the series of u without its constant term (R. E. Moore, Methods and
Applications of Interval Analysis, SIAM 1979, chapter 3). Ends are not rounded outward, so the ranges hold up to
round-off.

If the kink of pos(x, a) lies in a box, derivatives that do not exist at the kink have the range (−∞, ∞). The range of
the derivative of order a covers both sides of the kink, which suffices for Taylor's theorem with Lipschitz derivatives.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property, lru_cache, reduce
from typing import Any

import numpy as np
import sympy as sp
from numpy.polynomial import Polynomial

from manufactured.symbols import Index, indices, pos
from manufactured.tensors import Array

Pair = tuple[Array, Array]
"""The lower and upper ends of ranges, (boxes,) each."""
TINY, LARGEST = np.finfo(float).tiny, np.finfo(float).max
REAL = 1e-9
"""Imaginary part up to which a root counts as real."""


class RangeError(ValueError):
    """Raised for a formula with a function whose derivatives have no known ranges."""


# ---- arithmetic of ranges


def enclosed(low: Array, high: Array) -> Pair:
    """Return the ends of a range after overflow: an end that is infinite on the wrong side becomes the largest
    number."""
    return np.minimum(low, LARGEST), np.maximum(high, -LARGEST)


def times(a: Pair, b: Pair) -> Pair:
    """Return the range of a product. Zero times (−∞, ∞) is zero; a product that underflows gets a range around zero."""
    with np.errstate(invalid="ignore", over="ignore", under="ignore"):
        every = [x * y for x in a for y in b]
        low, high = reduce(np.minimum, every), reduce(np.maximum, every)
    if np.isnan(low).any():
        # Minima and maxima of NaN are NaN, so the products 0 · ∞ need to be searched only here.
        every = [np.where(np.isnan(product), 0.0, product) for product in every]
        low, high = reduce(np.minimum, every), reduce(np.maximum, every)
    zero = (low == 0) & (high == 0)
    if zero.any():
        zero &= ((a[0] != 0) | (a[1] != 0)) & ((b[0] != 0) | (b[1] != 0))
        low, high = np.where(zero, -TINY, low), np.where(zero, TINY, high)
    return enclosed(low, high)


def _scaled(c: float, ends: Pair) -> Pair:
    """Return the range of a constant multiple."""
    return times((np.array(c), np.array(c)), ends)


def _monotone(u: Pair, function: Callable[[Array], Array]) -> Pair:
    """Return the range of a monotone function of one variable, taken from its values at the ends."""
    ends = function(u[0]), function(u[1])
    return np.minimum(*ends), np.maximum(*ends)


def _or_line(where: Array, ends: Pair) -> Pair:
    """Return the ends, replaced by (−∞, ∞) for the boxes where the condition holds."""
    return np.where(where, -np.inf, ends[0]), np.where(where, np.inf, ends[1])


# ---- functions of one variable: ranges of g^(j)(u)/j! for u in an interval and j ≤ order


def _power(u: Pair, q: float) -> Pair:
    """Return the range of x^q."""
    low, high = u

    def monotone(u: Pair, q: float) -> Pair:
        """Return the range for ends of one sign. If u is not 0, the range excludes 0 even if the power underflows."""
        bottom, top = enclosed(*_monotone(u, lambda x: x**q))
        zero = (bottom == 0) & (top == 0) & ((u[0] != 0) | (u[1] != 0))
        return np.where(zero, -TINY * (u[0] < 0), bottom), np.where(zero, TINY, top)

    with np.errstate(all="ignore"):
        if q == 0:
            return np.ones_like(low), np.ones_like(low)
        if q == int(q):
            ends, inside = monotone(u, int(q)), (low <= 0) & (high >= 0)
            if q < 0:
                return _or_line(inside, ends)
            return (np.where(inside, 0.0, ends[0]), ends[1]) if q % 2 == 0 else ends
        ends = monotone((np.maximum(low, 0.0), np.maximum(high, 0.0)), q)
        return _or_line((low < 0) | ((low == 0) & (q < 0)), ends)


def _truncated(u: Pair, q: float) -> Pair:
    """Return the range of x_+^q away from x = 0; for q = 0 this is the range of the step function."""
    low, high = u
    if q == 0:
        return (low > 0).astype(float), (high > 0).astype(float)
    if q > 0:
        return _power((np.maximum(low, 0.0), np.maximum(high, 0.0)), q)
    ends = _power((np.where(low > 0, low, 1.0), np.where(low > 0, high, 1.0)), q)
    beyond = high < 0
    return _or_line((low <= 0) & ~beyond, (np.where(beyond, 0.0, ends[0]), np.where(beyond, 0.0, ends[1])))


def _of_power(u: Pair, q: float, order: int, truncated: bool = False) -> list[Pair]:
    """Return the Taylor coefficients of x^q, or of x_+^q, which has a kink at 0."""
    kink = (u[0] <= 0) & (u[1] >= 0)
    found, binomial = [], 1.0
    for j in range(order + 1):
        ends = _scaled(binomial, _truncated(u, q - j) if truncated else _power(u, q - j))
        # If q is an integer, the derivative of order q + 1 is 0 on both sides of the kink and a measure at the kink.
        found.append(_or_line(kink, ends) if truncated and q - j < 0 else ends)
        binomial *= (q - j) / (j + 1)
    return found


def _of_exp(u: Pair, order: int) -> list[Pair]:
    with np.errstate(over="ignore", under="ignore"):
        low, high = enclosed(*_monotone(u, np.exp))
    return [_scaled(1 / math.factorial(j), (low, np.maximum(high, TINY))) for j in range(order + 1)]


def _of_log(u: Pair, order: int) -> list[Pair]:
    with np.errstate(all="ignore"):
        ends = _monotone((np.maximum(u[0], 0.0), np.maximum(u[1], 0.0)), np.log)
        # Near 0 the logarithm is unbounded only from below; for negative numbers it is undefined.
        value = _or_line((u[0] < 0) | (u[1] <= 0), ends)
    return [value, *(_scaled((-1) ** (j - 1) / j, _power(u, -j)) for j in range(1, order + 1))]


def _cosine(u: Pair) -> Pair:
    """Return the range of cos, which includes ±1 if a maximum or minimum lies in the interval."""
    with np.errstate(invalid="ignore"):
        ends = _monotone(u, np.cos)
    tops = np.floor(u[1] / (2 * np.pi)) >= np.ceil(u[0] / (2 * np.pi))
    bottoms = np.floor((u[1] - np.pi) / (2 * np.pi)) >= np.ceil((u[0] - np.pi) / (2 * np.pi))
    return np.where(bottoms, -1.0, ends[0]), np.where(tops, 1.0, ends[1])


def _of_cosine(u: Pair, order: int, shift: float = 0.0) -> list[Pair]:
    """Return the Taylor coefficients of cos(x + shift); each derivative shifts by π/2."""
    shifts = [shift + j * np.pi / 2 for j in range(order + 1)]
    return [_scaled(1 / math.factorial(j), _cosine((u[0] + c, u[1] + c))) for j, c in enumerate(shifts)]


def _of_sinh(u: Pair, order: int, shift: int = 0) -> list[Pair]:
    """Return the Taylor coefficients of sinh, or of cosh for an odd shift; each is the derivative of the other."""
    with np.errstate(over="ignore"):
        sinh, (low, high) = enclosed(*_monotone(u, np.sinh)), enclosed(*_monotone(u, np.cosh))
    cosh = np.where((u[0] <= 0) & (u[1] >= 0), 1.0, low), high
    return [_scaled(1 / math.factorial(j), cosh if (shift + j) % 2 else sinh) for j in range(order + 1)]


def _of_polynomials(value: Pair, derivative: Polynomial, order: int) -> list[Pair]:
    """Return the Taylor coefficients of a function f with f' = derivative(f): all of them are polynomials of f.

    A polynomial takes its extrema at the ends of the range of f or where its derivative vanishes.
    """
    found, polynomial = [], Polynomial([0.0, 1.0])
    for j in range(order + 1):
        roots = polynomial.deriv().roots() if polynomial.degree() > 1 else np.empty(0)
        places = [*value, *(np.clip(root.real, *value) for root in roots if abs(root.imag) < REAL)]
        with np.errstate(over="ignore"):
            values = [polynomial(place) for place in places]
        found.append(enclosed(reduce(np.minimum, values), reduce(np.maximum, values)))
        polynomial = polynomial.deriv() * derivative / (j + 1)
    return found


def _of_tanh(u: Pair, order: int) -> list[Pair]:
    return _of_polynomials(_monotone(u, np.tanh), Polynomial([1.0, 0.0, -1.0]), order)


def _of_tan(u: Pair, order: int) -> list[Pair]:
    # Between two poles tan is increasing.
    poles = np.floor(u[0] / np.pi + 0.5) != np.floor(u[1] / np.pi + 0.5)
    ends = np.tan(np.where(poles, 0.0, u[0])), np.tan(np.where(poles, 0.0, u[1]))
    return [_or_line(poles, range_) for range_ in _of_polynomials(ends, Polynomial([1.0, 0.0, 1.0]), order)]


def _of_cot(u: Pair, order: int) -> list[Pair]:
    """Return the Taylor coefficients of cot x = −tan(x − π/2)."""
    return [(-high, -low) for low, high in _of_tan((u[0] - np.pi / 2, u[1] - np.pi / 2), order)]


KNOWN: dict[type, Callable[[Pair, int], list[Pair]]] = {
    sp.exp: _of_exp,
    sp.log: _of_log,
    sp.cos: _of_cosine,
    sp.sin: lambda u, order: _of_cosine(u, order, -np.pi / 2),
    sp.sinh: _of_sinh,
    sp.cosh: lambda u, order: _of_sinh(u, order, 1),
    sp.tanh: _of_tanh,
    sp.tan: _of_tan,
    sp.cot: _of_cot,
}
"""Functions of one variable and how to compute the ranges of their Taylor coefficients."""


# ---- functions with kinks or jumps, which are first rewritten with ``pos``


def _piecewise(*branches: tuple[sp.Expr, sp.Basic]) -> sp.Expr:
    """Return a Piecewise function as a sum of its values times the indicators of its branches."""
    total, rest = sp.Integer(0), sp.Integer(1)
    for value, condition in branches:
        holds = _indicator(condition)
        total, rest = total + value * rest * holds, rest * (1 - holds)
    return total


def _indicator(condition: sp.Basic) -> sp.Expr:
    """Return the indicator function of a condition, except at points where both sides of an inequality are equal."""
    if condition in (sp.true, sp.false):
        return sp.Integer(condition == sp.true)
    if isinstance(condition, sp.And):
        return sp.Mul(*map(_indicator, condition.args))
    if isinstance(condition, sp.Or):
        return 1 - sp.Mul(*(1 - _indicator(part) for part in condition.args))
    if isinstance(condition, sp.Not):
        return 1 - _indicator(condition.args[0])
    if isinstance(condition, sp.Gt | sp.Ge | sp.Lt | sp.Le):
        return pos(condition.gts - condition.lts, 0)
    if isinstance(condition, sp.ITE | sp.Xor):
        return _indicator(sp.to_nnf(condition))
    raise RangeError(f"{condition} in a Piecewise is no inequality; write its condition with <, ≤, > or ≥")


REWRITTEN: dict[type, Callable[..., sp.Expr]] = {
    sp.Max: lambda *args: reduce(lambda a, b: a + pos(b - a, 1), args),
    sp.Min: lambda *args: reduce(lambda a, b: a - pos(a - b, 1), args),
    sp.Abs: lambda x: pos(x, 1) + pos(-x, 1),
    sp.sign: lambda x: pos(x, 0) - pos(-x, 0),
    sp.Heaviside: lambda x, at_0=None: pos(x, 0),
    sp.Piecewise: _piecewise,
}
"""Functions that are rewritten with ``pos``; values at the jump itself may change."""
SERVED: tuple[Any, ...] = (sp.Add, sp.Mul, sp.Pow, pos, *KNOWN, *REWRITTEN)
"""Types of expressions that a formula may contain."""


def coefficients(formula: sp.Expr, u: Pair, order: int) -> list[Pair]:
    """Return the Taylor coefficients of the outermost function of a formula, for argument values in the range u.

    Raises:
        RangeError: the function is not known.
    """
    if formula.is_Pow or isinstance(formula, pos):
        return _of_power(u, float(formula.args[1]), order, truncated=not formula.is_Pow)
    if type(formula) in KNOWN:
        return KNOWN[type(formula)](u, order)
    raise unknown(formula)


def require_known(formula: sp.Expr) -> None:
    """Refuse a formula if a part of it has no known ranges.

    Raises:
        RangeError: names the part.
    """
    if formula.is_number or formula.is_Symbol:
        return
    if not isinstance(formula, SERVED):
        raise unknown(formula)
    if type(formula) in REWRITTEN:
        require_known(REWRITTEN[type(formula)](*formula.args))
        return
    if isinstance(formula, pos) and not formula.args[1].is_number:
        raise RangeError(f"{formula} has an exponent that is no number; give it a number")
    for part in formula.args:
        require_known(part)


def unknown(formula: sp.Expr) -> RangeError:
    """Return the error to raise for a formula without known ranges."""
    names = ", ".join(sorted(kind.__name__ for kind in (*KNOWN, *REWRITTEN, pos)))
    return RangeError(f"{formula} has no known range of its derivatives; known are powers and {names}")


# ---- formulas of several variables


@dataclass(frozen=True, eq=False)
class Series:
    """Ranges of the Taylor coefficients of one formula, (terms, boxes) each; ``indices`` lists the terms."""

    low: Array
    high: Array

    @cached_property
    def nonzero(self) -> Array:
        """Which coefficients are not identically 0, (terms,)."""
        return np.asarray(self.low.any(axis=1) | self.high.any(axis=1))

    @property
    def half_range(self) -> Array:
        """Half the range of the formula itself, (boxes,)."""
        return (self.high[0] - self.low[0]) / 2

    @property
    def largest(self) -> Array:
        """The largest absolute values of all coefficients, (terms, boxes)."""
        return np.maximum(abs(self.low), abs(self.high))

    def __add__(self, other: Series) -> Series:
        with np.errstate(over="ignore"):
            return Series(*enclosed(self.low + other.low, self.high + other.high))


@lru_cache
def _products(variables: int, order: int) -> tuple[Array, Array, Array]:
    """Return all i, j and k with multi-indices α_i + α_j = α_k, sorted by k, (pairs,) each."""
    keys = indices(variables, order)
    place = {key: number for number, key in enumerate(keys)}

    def total(a: Index, b: Index) -> Index:
        return tuple(map(sum, zip(a, b, strict=True)))

    found = [(place[total(a, b)], i, j) for i, a in enumerate(keys) for j, b in enumerate(keys) if total(a, b) in place]
    k, i, j = np.array(sorted(found)).T
    return i, j, k


@dataclass(frozen=True, eq=False)
class Boxes:
    """Boxes in space and time, and the variables in which formulas are expanded.

    Attributes:
        sides: the ends of the sides of the boxes for each symbol, (boxes,) each.
        variables: the symbols of the expansion.
        order: the order of the expansion.
    """

    sides: Mapping[sp.Symbol, Pair]
    variables: tuple[sp.Symbol, ...]
    order: int
    _known: dict[sp.Expr, Series] = field(default_factory=dict, init=False)
    """Cache of the series of formulas and of their parts, which formulas share."""

    @property
    def count(self) -> int:
        """The number of boxes."""
        return len(next(iter(self.sides.values()))[0])

    @property
    def keys(self) -> tuple[Index, ...]:
        """The multi-indices of the terms."""
        return indices(len(self.variables), self.order)

    def __call__(self, formula: sp.Expr) -> Series:
        """Return the ranges of all Taylor coefficients of a formula.

        Raises:
            RangeError: the formula has a function that is not known.
        """
        if formula not in self._known:
            self._known[formula] = self._expand(formula)
        return self._known[formula]

    def _expand(self, formula: sp.Expr) -> Series:
        """Return the series of a formula from the series of its parts, or from the box of a symbol."""
        if formula.is_Symbol:
            found = self._constant(self.sides[formula])
            if formula in self.variables and self.order > 0:
                unit = self.keys.index(tuple(int(formula == variable) for variable in self.variables))
                found.low[unit] = found.high[unit] = 1.0
            return found
        if formula.is_number:
            value = np.full(self.count, float(formula))
            return self._constant((value, value))
        if type(formula) in REWRITTEN:
            return self(REWRITTEN[type(formula)](*formula.args))
        if formula.is_Pow and not formula.exp.is_number:
            return self(sp.exp(formula.exp * sp.log(formula.base)))
        if formula.is_Add or formula.is_Mul:
            combine = Series.__add__ if formula.is_Add else self._product
            return reduce(combine, map(self, formula.args))
        # The sum Σ_j g_j δ^j by Horner's rule, δ being the inner series without its constant term.
        inner = self(formula.args[0])
        outer = coefficients(formula, (inner.low[0], inner.high[0]), self.order)
        low, high = inner.low.copy(), inner.high.copy()
        low[0] = high[0] = 0.0
        delta, found = Series(low, high), self._constant(outer[-1])
        for ends in outer[-2::-1]:
            found = self._product(found, delta) + self._constant(ends)
        return found

    def _constant(self, value: Pair) -> Series:
        """Return the series of a constant with a given range."""
        low, high = np.zeros((2, len(self.keys), self.count))
        low[0], high[0] = value
        return Series(low, high)

    def _product(self, a: Series, b: Series) -> Series:
        """Return the product of two truncated power series; coefficients that vanish are skipped."""
        low, high = np.zeros((2, *a.low.shape))
        i, j, k = _products(len(self.variables), self.order)
        nonzero = a.nonzero[i] & b.nonzero[j]
        i, j, k = i[nonzero], j[nonzero], k[nonzero]
        if k.size:
            ends = times((a.low[i], a.high[i]), (b.low[j], b.high[j]))
            first = np.flatnonzero(np.diff(k, prepend=-1))
            with np.errstate(over="ignore"):
                sums = (np.add.reduceat(end, first, axis=0) for end in ends)
                low[k[first]], high[k[first]] = enclosed(*sums)
        return Series(low, high)

"""Ranges of the Taylor coefficients of functions of one variable: g^(j)(u)/j! for all u between two ends.

Where a derivative does not exist, because pos(x, a) has its kink between the ends, the range is the whole line; the
range of the order a itself is that of the derivative on both sides of the kink, which is what Taylor's theorem needs of
a function with Lipschitz derivatives.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import reduce
from typing import Any

import numpy as np
import sympy as sp
from numpy.polynomial import Polynomial

from manufactured.symbols import pos
from manufactured.tensors import Array

Pair = tuple[Array, Array]
"""The ends of ranges, (boxes,) each."""


class RangeError(ValueError):
    """A formula with a function whose derivatives have no ranges here."""


TINY, LARGEST = np.finfo(float).tiny, np.finfo(float).max


def enclosed(low: Array, high: Array) -> Pair:
    """The ends of a range, where a number that overflowed lies between the largest one and infinity."""
    return np.minimum(low, LARGEST), np.maximum(high, -LARGEST)


def times(a: Pair, b: Pair) -> Pair:
    """The range of a product. Zero times the whole line is zero; a product that underflows lies around zero."""
    with np.errstate(invalid="ignore", over="ignore", under="ignore"):
        every = [x * y for x in a for y in b]
        low, high = reduce(np.minimum, every), reduce(np.maximum, every)
    if np.isnan(low).any():
        # Minima and maxima of anything and nan are nan: only then is it looked which product was 0 · ∞.
        every = [np.where(np.isnan(product), 0.0, product) for product in every]
        low, high = reduce(np.minimum, every), reduce(np.maximum, every)
    zero = (low == 0) & (high == 0)
    if zero.any():
        zero &= ((a[0] != 0) | (a[1] != 0)) & ((b[0] != 0) | (b[1] != 0))
        low, high = np.where(zero, -TINY, low), np.where(zero, TINY, high)
    return enclosed(low, high)


def _monotone(u: Pair, power: Callable[[Array], Array]) -> Pair:
    ends = power(u[0]), power(u[1])
    return np.minimum(*ends), np.maximum(*ends)


def _raised(u: Pair, power: Callable[[Array], Array]) -> Pair:
    """The range of a power between two ends of the same sign, away from 0 where u is, also if the power underflows."""
    low, high = enclosed(*_monotone(u, power))
    zero = (low == 0) & (high == 0) & ((u[0] != 0) | (u[1] != 0))
    return np.where(zero, -TINY * (u[0] < 0), low), np.where(zero, TINY, high)


def _line(where: Array, ends: Pair) -> Pair:
    """The whole line at some boxes."""
    return np.where(where, -np.inf, ends[0]), np.where(where, np.inf, ends[1])


def _power(u: Pair, q: float) -> Pair:
    """The range of x^q."""
    low, high = u
    with np.errstate(all="ignore"):
        if q == 0:
            return np.ones_like(low), np.ones_like(low)
        if q == int(q):
            ends = _raised(u, lambda x: x ** int(q))
            inside = (low <= 0) & (high >= 0)
            if q > 0:
                return (np.where(inside, 0.0, ends[0]), ends[1]) if q % 2 == 0 else ends
            return _line(inside, ends)
        ends = _raised((np.maximum(low, 0.0), np.maximum(high, 0.0)), lambda x: x**q)
        return _line((low < 0) | ((low == 0) & (q < 0)), ends)


def _truncated(u: Pair, q: float) -> Pair:
    """The range of x_+^q away from x = 0; that of the step for q = 0."""
    low, high = u
    if q == 0:
        return (low > 0).astype(float), (high > 0).astype(float)
    if q > 0:
        return _power((np.maximum(low, 0.0), np.maximum(high, 0.0)), q)
    positive = np.where(low > 0, low, 1.0), np.where(low > 0, high, 1.0)
    ends = _power(positive, q)
    beyond = high < 0
    return _line((low <= 0) & ~beyond, (np.where(beyond, 0.0, ends[0]), np.where(beyond, 0.0, ends[1])))


def _scaled(c: float, ends: Pair) -> Pair:
    return times((np.array(c), np.array(c)), ends)


def _of_power(u: Pair, q: float, order: int) -> list[Pair]:
    return [_scaled(_binomial(q, j), _power(u, q - j)) for j in range(order + 1)]


def _of_truncated(u: Pair, q: float, order: int) -> list[Pair]:
    # Beyond the order of a whole power the derivative is 0 on both sides, and a measure at the kink.
    kink = (u[0] <= 0) & (u[1] >= 0)
    found = []
    for j in range(order + 1):
        ends = _scaled(_binomial(q, j), _truncated(u, q - j))
        found.append(_line(kink, ends) if q - j < 0 else ends)
    return found


def _binomial(q: float, j: int) -> float:
    return math.prod((q - i) / (i + 1) for i in range(j))


def _of_exp(u: Pair, order: int) -> list[Pair]:
    with np.errstate(over="ignore", under="ignore"):
        low, high = enclosed(*_monotone(u, np.exp))
    ends = low, np.maximum(high, TINY)
    return [_scaled(1 / math.factorial(j), ends) for j in range(order + 1)]


def _of_log(u: Pair, order: int) -> list[Pair]:
    with np.errstate(all="ignore"):
        low, high = _monotone((np.maximum(u[0], 0.0), np.maximum(u[1], 0.0)), np.log)
        # At 0 the logarithm is unbounded from below alone; of negative numbers there is none.
        value = _line((u[0] < 0) | (u[1] <= 0), (low, high))
    return [value, *(_scaled((-1) ** (j - 1) / j, _power(u, -j)) for j in range(1, order + 1))]


def _cosine(u: Pair) -> Pair:
    """The range of cos: 1 and −1 where a multiple of π lies inside."""
    with np.errstate(invalid="ignore"):
        ends = _monotone(u, np.cos)
    tops = np.floor(u[1] / (2 * np.pi)) >= np.ceil(u[0] / (2 * np.pi))
    bottoms = np.floor((u[1] - np.pi) / (2 * np.pi)) >= np.ceil((u[0] - np.pi) / (2 * np.pi))
    return np.where(bottoms, -1.0, ends[0]), np.where(tops, 1.0, ends[1])


def _of_cosine(u: Pair, order: int, shift: float = 0.0) -> list[Pair]:
    """cos(x + shift); the derivative shifts by π/2."""
    found = []
    for j in range(order + 1):
        moved = shift + j * np.pi / 2
        found.append(_scaled(1 / math.factorial(j), _cosine((u[0] + moved, u[1] + moved))))
    return found


def _of_sinh(u: Pair, order: int, shift: int = 0) -> list[Pair]:
    """sinh, or cosh for an odd shift; each is the derivative of the other."""
    with np.errstate(over="ignore"):
        sinh, (low, high) = enclosed(*_monotone(u, np.sinh)), enclosed(*_monotone(u, np.cosh))
    cosh = np.where((u[0] <= 0) & (u[1] >= 0), 1.0, low), high
    return [_scaled(1 / math.factorial(j), cosh if (shift + j) % 2 else sinh) for j in range(order + 1)]


def _of_polynomials(value: Pair, slope: Polynomial, order: int) -> list[Pair]:
    """Taylor coefficients of a function f with f' = slope(f): all of them are polynomials of f.

    A polynomial takes its extrema at the ends of the range of f or where its derivative vanishes.
    """
    found, polynomial = [], Polynomial([0.0, 1.0])
    for j in range(order + 1):
        roots = polynomial.deriv().roots() if polynomial.degree() > 1 else np.empty(0)
        places = [*value, *(np.clip(root.real, *value) for root in roots if abs(root.imag) < REAL)]
        with np.errstate(over="ignore"):
            values = [polynomial(place) for place in places]
        found.append(enclosed(reduce(np.minimum, values), reduce(np.maximum, values)))
        polynomial = polynomial.deriv() * slope / (j + 1)
    return found


def _of_tanh(u: Pair, order: int) -> list[Pair]:
    return _of_polynomials(_monotone(u, np.tanh), Polynomial([1.0, 0.0, -1.0]), order)


def _of_tan(u: Pair, order: int) -> list[Pair]:
    # Between two poles tan increases.
    poles = np.floor(u[0] / np.pi + 0.5) != np.floor(u[1] / np.pi + 0.5)
    safe = np.where(poles, 0.0, u[0]), np.where(poles, 0.0, u[1])
    found = _of_polynomials((np.tan(safe[0]), np.tan(safe[1])), Polynomial([1.0, 0.0, 1.0]), order)
    return [_line(poles, ends) for ends in found]


def _of_cot(u: Pair, order: int) -> list[Pair]:
    """cot x = −tan(x − π/2)."""
    return [(-high, -low) for low, high in _of_tan((u[0] - np.pi / 2, u[1] - np.pi / 2), order)]


REAL = 1e-9
"""Imaginary part below which a root counts as real."""
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
"""Taylor coefficients of functions of one variable."""


def _maximum(*args: sp.Expr) -> sp.Expr:
    return reduce(lambda a, b: a + pos(b - a, 1), args)


def _minimum(*args: sp.Expr) -> sp.Expr:
    return reduce(lambda a, b: a - pos(a - b, 1), args)


def _piecewise(*branches: tuple[sp.Expr, sp.Basic]) -> sp.Expr:
    """Σ value · (1 where its condition holds and none before it does)."""
    found, rest = sp.Integer(0), sp.Integer(1)
    for value, condition in branches:
        holds = _indicator(condition)
        found, rest = found + value * rest * holds, rest * (1 - holds)
    return found


def _indicator(condition: sp.Basic) -> sp.Expr:
    """1 where a condition holds and 0 elsewhere, up to the points at which two sides are equal."""
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
    sp.Max: _maximum,
    sp.Min: _minimum,
    sp.Abs: lambda x: pos(x, 1) + pos(-x, 1),
    sp.sign: lambda x: pos(x, 0) - pos(-x, 0),
    sp.Heaviside: lambda x, at_0=None: pos(x, 0),
    sp.Piecewise: _piecewise,
}
"""Functions with kinks or jumps that are written with ``pos`` first, which may change values where a jump is."""
SERVED: tuple[Any, ...] = (sp.Add, sp.Mul, sp.Pow, pos, *KNOWN, *REWRITTEN)
"""What formulas are made of."""


def with_pos(formula: sp.Expr) -> sp.Expr:
    """A formula whose outermost function is one of ``REWRITTEN``, written with ``pos``.

    Raises:
        RangeError: the condition of a Piecewise is no inequality.
    """
    return REWRITTEN[type(formula)](*formula.args)


def coefficients(formula: sp.Expr, u: Pair, order: int) -> list[Pair]:
    """The Taylor coefficients of the outermost function of a formula at the values u of its argument.

    Raises:
        RangeError: it is not known here.
    """
    if formula.is_Pow:
        return _of_power(u, float(formula.exp), order)
    if isinstance(formula, pos):
        return _of_truncated(u, float(formula.args[1]), order)
    if type(formula) in KNOWN:
        return KNOWN[type(formula)](u, order)
    raise unknown(formula)


def require_known(formula: sp.Expr) -> None:
    """Refuse a formula some part of which has no ranges here.

    Raises:
        RangeError: names the part.
    """
    if formula.is_number or formula.is_Symbol:
        return
    if not isinstance(formula, SERVED):
        raise unknown(formula)
    if type(formula) in REWRITTEN:
        require_known(with_pos(formula))
        return
    if isinstance(formula, pos) and not formula.args[1].is_number:
        raise RangeError(f"{formula} has an exponent that is no number; give it a number")
    for part in formula.args:
        require_known(part)


def unknown(formula: sp.Expr) -> RangeError:
    """What is said of a formula without ranges."""
    names = ", ".join(sorted(kind.__name__ for kind in (*KNOWN, *REWRITTEN, pos)))
    return RangeError(f"{formula} has no known range of its derivatives; known are powers and {names}")

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

from manufactured.symbols import pos, written_with_pos
from manufactured.tensors import Array

Pair = tuple[Array, Array]
"""The ends of ranges, (boxes,) each."""


class RangeError(ValueError):
    """A formula with a function whose derivatives have no ranges here."""


def times(a: Pair, b: Pair) -> Pair:
    """The range of a product; nothing times the whole line is nothing."""
    with np.errstate(invalid="ignore"):
        every = [x * y for x in a for y in b]
        low, high = reduce(np.minimum, every), reduce(np.maximum, every)
    if np.isnan(low).any():
        # Minima and maxima of anything and nan are nan: only then is it looked which product was 0 · ∞.
        every = [np.where(np.isnan(product), 0.0, product) for product in every]
        low, high = reduce(np.minimum, every), reduce(np.maximum, every)
    return low, high


def _monotone(u: Pair, power: Callable[[Array], Array]) -> Pair:
    ends = power(u[0]), power(u[1])
    return np.minimum(*ends), np.maximum(*ends)


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
            ends = _monotone(u, lambda x: x ** int(q))
            inside = (low <= 0) & (high >= 0)
            if q > 0:
                return (np.where(inside, 0.0, ends[0]), ends[1]) if q % 2 == 0 else ends
            return _line(inside, ends)
        ends = _monotone((np.maximum(low, 0.0), np.maximum(high, 0.0)), lambda x: x**q)
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
    ends = _monotone(u, np.exp)
    return [_scaled(1 / math.factorial(j), ends) for j in range(order + 1)]


def _of_log(u: Pair, order: int) -> list[Pair]:
    with np.errstate(all="ignore"):
        value = _line(u[0] <= 0, _monotone(u, np.log))
    return [value, *(_scaled((-1) ** (j - 1) / j, _power(u, -j)) for j in range(1, order + 1))]


def _cosine(u: Pair) -> Pair:
    """The range of cos: 1 and −1 where a multiple of π lies inside."""
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


KNOWN: dict[type, Callable[[Pair, int], list[Pair]]] = {
    sp.exp: _of_exp,
    sp.log: _of_log,
    sp.cos: _of_cosine,
    sp.sin: lambda u, order: _of_cosine(u, order, -np.pi / 2),
}
"""Taylor coefficients of functions of one variable."""
REWRITTEN = {sp.sinh: sp.exp, sp.cosh: sp.exp, sp.tanh: sp.exp, sp.tan: sp.cos, sp.cot: sp.cos}
"""Functions that are written by others first."""
SERVED: tuple[Any, ...] = (sp.Add, sp.Mul, sp.Pow, pos, *KNOWN, *REWRITTEN)
"""What formulas are made of."""


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
    for part in formula.args:
        require_known(part)


def unknown(formula: sp.Expr) -> RangeError:
    """What is said of a formula without ranges."""
    names = ", ".join(sorted(kind.__name__ for kind in (*KNOWN, *REWRITTEN, pos)))
    return RangeError(
        f"{formula} has no known range of its derivatives; known are powers and {names}{written_with_pos(formula)}"
    )

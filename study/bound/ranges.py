"""Ranges of Taylor coefficients of a formula over boxes: interval arithmetic on truncated power series.

For boxes X_1, …, X_N, variables z and an order m, a formula f has the ranges

    {∂^α f(x)/α! : x ∈ X_n} ⊂ [low_αn, high_αn],   |α| ≤ m,

made from those of its parts: sums and products of power series, and for g(u) the series Σ_j g^(j)(u)/j! δ^j with δ the
series of u less its value (R. E. Moore, Methods and Applications of Interval Analysis, SIAM 1979, chapter 3). Ends are
not rounded outward: ranges are those of exact arithmetic up to rounding.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache, reduce

import numpy as np
import sympy as sp

from manufactured.symbols import Index, indices
from manufactured.tensors import Array
from study.bound.univariate import REWRITTEN, Pair, coefficients, enclosed, times, with_pos


@dataclass(frozen=True, eq=False)
class Series:
    """Ranges of the Taylor coefficients of one formula, (terms, boxes) each; terms as in ``indices``."""

    low: Array
    high: Array

    @cached_property
    def something(self) -> Array:
        """Which coefficients are not 0 on all boxes, (terms,)."""
        return np.asarray(self.low.any(axis=1) | self.high.any(axis=1))

    def __add__(self, other: Series) -> Series:
        with np.errstate(over="ignore"):
            return Series(*enclosed(self.low + other.low, self.high + other.high))


@lru_cache
def _products(variables: int, order: int) -> tuple[Array, Array, Array]:
    """All i, j and k with α_i + α_j = α_k, sorted by k, (pairs,) each."""
    keys = indices(variables, order)
    place = {key: number for number, key in enumerate(keys)}

    def total(a: Index, b: Index) -> Index:
        return tuple(map(sum, zip(a, b, strict=True)))

    found = [(place[total(a, b)], i, j) for i, a in enumerate(keys) for j, b in enumerate(keys) if total(a, b) in place]
    k, i, j = np.array(sorted(found)).T
    return i, j, k


@dataclass(frozen=True, eq=False)
class Boxes:
    """Boxes and the variables in which formulas are expanded.

    Attributes:
        sides: symbol ↦ the ends of its sides, (boxes,) each.
        variables: the symbols of the expansion.
        order: its order.
    """

    sides: Mapping[sp.Symbol, Pair]
    variables: tuple[sp.Symbol, ...]
    order: int

    @property
    def count(self) -> int:
        return len(next(iter(self.sides.values()))[0])

    @property
    def keys(self) -> tuple[Index, ...]:
        """The multi-indices of the terms."""
        return indices(len(self.variables), self.order)

    def __call__(self, formula: sp.Expr) -> Series:
        """Ranges of all Taylor coefficients of a formula.

        Raises:
            RangeError: the formula has a function that is not known here.
        """
        return self._series(formula, {})

    def _series(self, formula: sp.Expr, known: dict[sp.Expr, Series]) -> Series:
        if formula not in known:
            known[formula] = self._made(formula, known)
        return known[formula]

    def _made(self, formula: sp.Expr, known: dict[sp.Expr, Series]) -> Series:
        if formula.is_Symbol:
            return self._variable(formula)
        if formula.is_number:
            value = np.full(self.count, float(formula))
            return self._constant((value, value))
        parts = formula.args
        if formula.is_Add:
            return reduce(lambda a, b: a + b, (self._series(part, known) for part in parts))
        if formula.is_Mul:
            return reduce(self._product, (self._series(part, known) for part in parts))
        if type(formula) in REWRITTEN:
            return self._series(with_pos(formula), known)
        if formula.is_Pow and not formula.exp.is_number:
            return self._series(sp.exp(formula.exp * sp.log(formula.base)), known)
        inner = self._series(parts[0], known)
        return self._composed(inner, coefficients(formula, (inner.low[0], inner.high[0]), self.order))

    def _constant(self, value: Pair) -> Series:
        low, high = np.zeros((2, len(self.keys), self.count))
        low[0], high[0] = value
        return Series(low, high)

    def _variable(self, symbol: sp.Symbol) -> Series:
        found = self._constant(self.sides[symbol])
        if symbol in self.variables and self.order > 0:
            unit = tuple(int(symbol == variable) for variable in self.variables)
            found.low[self.keys.index(unit)] = found.high[self.keys.index(unit)] = 1.0
        return found

    def _product(self, a: Series, b: Series) -> Series:
        low, high = np.zeros((2, *a.low.shape))
        i, j, k = _products(len(self.variables), self.order)
        something = a.something[i] & b.something[j]
        i, j, k = i[something], j[something], k[something]
        if k.size:
            ends = times((a.low[i], a.high[i]), (b.low[j], b.high[j]))
            first = np.flatnonzero(np.diff(k, prepend=-1))
            with np.errstate(over="ignore"):
                sums = (np.add.reduceat(end, first, axis=0) for end in ends)
                low[k[first]], high[k[first]] = enclosed(*sums)
        return Series(low, high)

    def _composed(self, inner: Series, outer: list[Pair]) -> Series:
        """Σ_j g_j δ^j by Horner's rule."""
        low, high = inner.low.copy(), inner.high.copy()
        low[0] = high[0] = 0.0
        delta, found = Series(low, high), self._constant(outer[-1])
        for ends in outer[-2::-1]:
            found = self._product(found, delta) + self._constant(ends)
        return found

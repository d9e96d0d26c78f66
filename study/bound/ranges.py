"""Ranges of the Taylor coefficients of a formula over boxes, by interval arithmetic on truncated power series.

For a formula f, boxes X_1, …, X_N and an order m, the ranges are intervals with

    {∂^α f(x)/α! : x ∈ X_n} ⊂ [low_αn, high_αn],   |α| ≤ m.

They are computed from the ranges of the parts of f. Sums and products are sums and products of power series. A function
g of a part u has the series Σ_j g^(j)(u)/j! δ^j, where δ is the series of u without its constant term (R. E. Moore,
Methods and Applications of Interval Analysis, SIAM 1979, chapter 3). Ranges of values are rounded outward after each
operation, so that no condition is decided by rounding. Ranges of derivatives are not, so they hold up to round-off.

Formulas may contain the truncated power pos(x, a) = x_+^a, which has a kink or a jump at x = 0. If 0 lies in the range
of x, derivatives that do not exist there have the range (−∞, ∞). The range of the derivative of order a covers both
sides of the kink, which suffices for Taylor's theorem with Lipschitz derivatives.

A Piecewise function has on each box the union of the ranges of those branches that may be reached there. A condition
holds on a whole box, nowhere on it, or is undecided; the box belongs to its ends, so a range contains the values at
points where conditions change. If more than one branch may be reached, derivatives have the range (−∞, ∞), because the
function may jump. Max, Min and Abs are treated in the same way, but have a range of first derivatives.

Refusal of initial displacements u_0 that do not lie in K: they jump, are not 0 on Γ1 or penetrate the foundation.

Boxes that cover the body are halved again and again. A box is dropped if u_0 is known to be Lipschitz continuous on it,
also with kinks. In all other boxes the range of u_0 tends to a point if u_0 is continuous. If u_0 jumps, the range
remains as large as the jump, however narrow the band between two jumps is. In the same way, intervals that cover a side
of the body are halved, to find where u_0 violates a boundary condition.

The range is computed by interval arithmetic if u_0 is given by formulas whose ranges are known. Otherwise it is the
range of samples, which may miss narrow bands.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache, reduce
from itertools import product

import numpy as np
import sympy as sp
from sympy.core.relational import Relational

from manufactured.body import Body, Kind, Part
from manufactured.data import PIECEWISE, Data, Expressions, LoadError
from manufactured.exact import ExactSolution
from manufactured.factor import x1, x2
from manufactured.symbols import LARGEST, SMALLEST, Index, indices, pos, t
from manufactured.tensors import Array, Points
from study.bound.problem import place
from study.fem.mesh import distance

Pair = tuple[Array, Array]
"""The type of intervals, one for each box, given by their lower and their upper ends, (boxes,) each."""
Intervals = Array
"""The type of intervals, given by their lower ends and then their upper ends, (2, ...)."""
REALS = np.array([[-np.inf], [np.inf]])
"""The interval (−∞, ∞), (2, 1)."""
Flags = np.ndarray[tuple[int], np.dtype[np.bool_]]
"""The type of a truth value for each box, (boxes,)."""


ARC, ACROSS = sp.symbols("arc across", real=True)
"""The symbols for the arc length along a part of the boundary, and for the distance from it in outward direction."""


class RangeError(ValueError):
    """Raised for a formula with a function for whose derivatives no ranges of values over intervals are known."""


# ---- arithmetic of intervals


def enclosed(low: Array, high: Array) -> Intervals:
    """Return intervals from their lower and upper ends so that they are valid after overflow, (2, ...).

    A lower end of +∞ becomes the largest number, and an upper end of −∞ becomes the smallest number.

    Args:
        low, high: the lower and the upper ends, (...) each.
    """
    return np.array([np.minimum(low, LARGEST), np.maximum(high, -LARGEST)])


def outward(ends: Intervals) -> Intervals:
    """Round the ends of intervals outward, (2, ...) → (2, ...); an end that is 0 has no rounding error."""
    return np.where(ends == 0, ends, np.nextafter(ends, REALS))


def _is_power_of_two(ends: Intervals) -> Array:
    """Return whether both ends of intervals are ±2^k or 0, so that products with them have no rounding error."""
    mantissas, _ = np.frexp(ends)
    return np.asarray(np.isin(abs(mantissas), (0.0, 0.5)).all(axis=0))


def times(a: Intervals, b: Intervals) -> Intervals:
    """Return the products of intervals: intervals that contain all products of their numbers, (2, ...).

    Zero times (−∞, ∞) is zero. If the product of nonzero intervals underflows, the result is a small interval around
    zero.

    Args:
        a, b: the intervals, by their lower and then their upper ends, (2, ...) each.
    """
    with np.errstate(invalid="ignore", over="ignore", under="ignore"):
        products = np.array([x * y for x in a for y in b])
        if np.isnan(products).any():  # a product 0 · ∞
            products[np.isnan(products)] = 0.0
        ends = enclosed(products.min(axis=0), products.max(axis=0))
    zero = ~ends.any(axis=0)
    if zero.any():
        zero &= a.any(axis=0) & b.any(axis=0)
        ends[0] -= SMALLEST * zero
        ends[1] += SMALLEST * zero
    return ends


def _scaled(c: float, ends: Intervals) -> Intervals:
    """Return a constant times an interval."""
    return times(np.array([c, c]), ends)


def _monotone(u: Intervals, function: Callable[[Array], Array]) -> Intervals:
    """Return the range of a monotone function on intervals, from its values at their ends."""
    with np.errstate(all="ignore"):
        ends = function(u)
        return enclosed(ends.min(axis=0), ends.max(axis=0))


# ---- functions g of one variable: range of the Taylor coefficient g^(j)(u)/j! of order j for u in given intervals


def _power(u: Intervals, q: float) -> Intervals:
    """Return the range of the power x^q for x in given intervals."""
    low, high = u
    if q == 0:
        return np.ones_like(u)
    if q != int(q):
        undefined = (low < 0) | ((low == 0) & (q < 0))
        return np.where(undefined, REALS, _monotone_power(np.maximum(u, 0.0), q))
    ends = _monotone_power(u, q)
    has_zero = (low <= 0) & (high >= 0)
    if q < 0:
        return np.where(has_zero, REALS, ends)
    if q % 2 == 0:
        ends[0, has_zero] = 0.0
    return ends


def _monotone_power(u: Intervals, q: float) -> Intervals:
    """Return the range of x^q on intervals on which x does not change its sign.

    If the power of a nonzero number underflows to 0, the range is widened to a small interval.
    """
    ends = _monotone(u, lambda x: x**q)
    zero = u.any(axis=0) & ~ends.any(axis=0)
    ends[0] -= SMALLEST * (zero & (u[0] < 0))
    ends[1] += SMALLEST * zero
    return ends


def _truncated(u: Intervals, q: float) -> Intervals:
    """Return the range of the truncated power x_+^q for x ≠ 0 in given intervals; for q = 0 it is a step function."""
    low, high = u
    if q == 0:
        return (u > 0).astype(float)
    if q > 0:
        return _power(np.maximum(u, 0.0), q)
    ends = _power(np.where(low > 0, u, 1.0), q)
    return np.where(high < 0, 0.0, np.where(low <= 0, REALS, ends))


def _of_exp(u: Intervals, j: int) -> Intervals:
    ends = _monotone(u, np.exp)
    ends[1] = np.maximum(ends[1], SMALLEST)
    return _scaled(1 / math.factorial(j), ends)


def _of_log(u: Intervals, j: int) -> Intervals:
    if j > 0:
        return _scaled((-1) ** (j - 1) / j, _power(u, -j))
    # Towards 0 the logarithm is unbounded only from below; for negative numbers it is not defined.
    return np.where((u[0] < 0) | (u[1] <= 0), REALS, _monotone(np.maximum(u, 0.0), np.log))


WAVES = (np.cos, lambda x: -np.sin(x), lambda x: -np.cos(x), np.sin)
"""The functions cos(x + nπ/2) for n = 0, …, 3, which are the cosine and its derivatives.

They are 0 at x = 0 if the sine is; cos(x − π/2) in double precision is not.
"""


def _of_cosine(u: Intervals, j: int, turns: int = 0) -> Intervals:
    """Return the range of the Taylor coefficient of cos(x + turns π/2); each derivative adds another π/2."""
    low, high = (u + (turns + j) * np.pi / 2) / (2 * np.pi)
    ends = _monotone(u, WAVES[(turns + j) % 4])
    # The range contains ±1 if a maximum or minimum of cos lies in the interval.
    tops = np.floor(high) >= np.ceil(low)
    bottoms = np.floor(high - 0.5) >= np.ceil(low - 0.5)
    ends[0, bottoms] = -1.0
    ends[1, tops] = 1.0
    return _scaled(1 / math.factorial(j), ends)


RANGE_OF_FUNCTION: dict[type, Callable[[Intervals, int], Intervals]] = {
    sp.exp: _of_exp,
    sp.log: _of_log,
    sp.cos: _of_cosine,
    sp.sin: lambda u, j: _of_cosine(u, j, 3),
}
"""For each function of one variable, how to compute the range of its Taylor coefficient of a given order."""
BY_OTHERS: dict[type, Callable[..., sp.Expr]] = PIECEWISE | {
    sp.sinh: lambda x: (sp.exp(x) - sp.exp(-x)) / 2,
    sp.cosh: lambda x: (sp.exp(x) + sp.exp(-x)) / 2,
    sp.tanh: lambda x: 1 - 2 / (sp.exp(2 * x) + 1),
    sp.tan: lambda x: sp.sin(x) / sp.cos(x),
    sp.cot: lambda x: sp.cos(x) / sp.sin(x),
}
"""Functions that are written by means of other functions, whose ranges are known.

The ranges that are found in this way are valid, and a little wider than necessary.
"""


ORDERED: dict[type, Callable[[Array, Array], tuple[Flags, Flags]]] = {
    sp.Gt: lambda low, high: (high <= 0, low > 0),
    sp.Ge: lambda low, high: (high < 0, low >= 0),
    sp.Eq: lambda low, high: ((low > 0) | (high < 0), (low == 0) & (high == 0)),
}
"""For a relation x > 0, x ≥ 0 or x = 0 and the range of x: whether it never holds, and whether it always holds.

The values are functions from the lower and the upper ends of the ranges of x over boxes to two flags for each box. The
other relations are reversed or negated ones.
"""


def coefficients(formula: sp.Expr, u: Intervals, order: int) -> list[Intervals]:
    """Return the ranges of the Taylor coefficients of the outermost function of a formula, one for each order.

    Args:
        formula: the formula, such as exp(…).
        u: the range of the argument of the outermost function; the coefficients belong to expansions at all points of
            it.
        order: the highest order of the coefficients.

    Raises:
        RangeError: the function is not known, or the exponent of a truncated power is not a number.
    """
    if type(formula) in RANGE_OF_FUNCTION:
        return [RANGE_OF_FUNCTION[type(formula)](u, j) for j in range(order + 1)]
    if not formula.is_Pow and not isinstance(formula, pos):
        names = ", ".join(sorted(kind.__name__ for kind in (*RANGE_OF_FUNCTION, *BY_OTHERS, sp.Piecewise, pos)))
        raise RangeError(f"{formula} has no known range of its derivatives; known are powers and {names}")
    if not formula.args[1].is_number:
        raise RangeError(f"{formula} has an exponent that is no number; give it a number")
    q = float(formula.args[1])
    power = _power if formula.is_Pow else _truncated
    # At the kink, derivatives of order above q do not exist. For an integer q this includes the order q + 1, which is 0
    # on both sides and a Dirac measure at the kink.
    kink = isinstance(formula, pos) & (u[0] <= 0) & (u[1] >= 0)
    ranges = []
    binomial = 1.0
    for j in range(order + 1):
        ranges.append(np.where(kink & (j > q), REALS, _scaled(binomial, power(u, q - j))))
        binomial *= (q - j) / (j + 1)
    return ranges


def require_known(formula: sp.Expr) -> None:
    """Raise RangeError if a part of a formula is a function whose derivatives have no known ranges."""
    # The range is computed at one point and discarded; every function of the formula is then evaluated once.
    sides = dict.fromkeys((t, *formula.free_symbols), np.zeros((2, 1)))
    Boxes(sides, (), 0)(formula)


def along_side(part: Part, formulas: Sequence[sp.Expr], distance: sp.Expr | float = 0) -> list[sp.Expr]:
    """Return formulas of x1 and x2 as formulas of the arc length along a side of a body.

    The arc length is the symbol ``ARC``. It is 0 at the first corner of the side.

    Args:
        part: the side.
        formulas: the formulas.
        distance: the distance of the points from the side in outward direction, a number or a symbol such as
            ``ACROSS``.
    """
    place = part.start + part.tangent * ARC + part.normal * distance
    return [formula.subs({x1: place[0], x2: place[1]}, simultaneous=True) for formula in formulas]


# ---- formulas of several variables


@dataclass(frozen=True, eq=False)
class Series:
    """Ranges of the Taylor coefficients ∂^α f/α! of one formula f over several boxes.

    Attributes:
        ends: the lower and then the upper ends of the ranges, (2, terms, boxes). ``indices`` gives the multi-index α of
            each term.
    """

    ends: Intervals

    @cached_property
    def nonzero(self) -> Array:
        """For each Taylor coefficient, whether it is not identically 0, (terms,)."""
        return np.asarray(self.ends.any(axis=(0, 2)))

    @property
    def values(self) -> Intervals:
        """The range of the formula itself, (2, boxes)."""
        return self.ends[:, 0]

    @property
    def largest(self) -> Array:
        """The largest absolute value of each Taylor coefficient over each box, (terms, boxes)."""
        return np.asarray(abs(self.ends).max(axis=0))

    def __add__(self, other: Series) -> Series:
        with np.errstate(over="ignore"):
            total = Series(enclosed(*(self.ends + other.ends)))
        return total.rounded() if self.nonzero[0] and other.nonzero[0] else total

    def rounded(self, exact: Array | bool = False) -> Series:
        """Round the ranges of the values of the formula outward; ranges of derivatives remain as they are.

        Args:
            exact: for each box, whether the values are exact, so that they are not rounded, (boxes,).
        """
        self.ends[:, 0] = np.where(exact, self.values, outward(self.values))
        return self


@lru_cache
def _products(variables: int, order: int) -> tuple[Array, Array, Array]:
    """Return which terms of two power series contribute to which term of their product.

    Returns:
        The numbers i, j and k of all multi-indices with α_i + α_j = α_k, sorted by k, (pairs,) each.
    """
    keys = indices(variables, order)
    triples = []
    for (i, a), (j, b) in product(enumerate(keys), repeat=2):
        total = tuple(map(sum, zip(a, b, strict=True)))
        if total in keys:
            triples.append((keys.index(total), i, j))
    k, i, j = np.array(sorted(triples)).T
    return i, j, k


@dataclass(frozen=True, eq=False)
class Boxes:
    """Boxes in space and time, over which formulas are expanded into Taylor series.

    Calling the boxes with a formula returns the ranges of its Taylor coefficients (``Series``).

    Attributes:
        sides: for each symbol of the formulas, the lower and the upper ends of the sides of the boxes, (boxes,) each.
        variables: the symbols (coordinates, time) in which formulas are expanded.
        order: the highest order of the Taylor coefficients.
    """

    sides: Mapping[sp.Symbol, Pair | Intervals]
    variables: tuple[sp.Symbol, ...]
    order: int
    _known: dict[sp.Expr, Series] = field(default_factory=dict, init=False)
    """Taylor series that have been computed, by formula. They are stored because formulas have parts in common."""

    @property
    def count(self) -> int:
        return len(next(iter(self.sides.values()))[0])

    @property
    def keys(self) -> tuple[Index, ...]:
        """The multi-indices of the Taylor coefficients of a formula, in the order of ``Series``."""
        return indices(len(self.variables), self.order)

    def __call__(self, formula: sp.Expr) -> Series:
        """Return the ranges of all Taylor coefficients of a formula over the boxes.

        Raises:
            RangeError: the formula contains a function that is not known.
        """
        if formula not in self._known:
            self._known[formula] = self._expand(formula)
        return self._known[formula]

    def _expand(self, formula: sp.Expr) -> Series:
        """Compute the series of a formula from the series of its parts, or of a symbol from the sides of the boxes."""
        if formula.is_Symbol:
            return self._symbol(formula)
        if formula.is_number:
            return self._number(formula)
        if formula.is_Add:
            return reduce(Series.__add__, map(self, formula.args))
        if formula.is_Mul:
            return reduce(self._product, map(self, formula.args))
        if isinstance(formula, sp.Min):
            return self(-sp.Max(*(-part for part in formula.args)))
        if isinstance(formula, sp.Max):
            first, *others = formula.args
            return self._maximum(first, sp.Max(*others))
        if isinstance(formula, sp.Abs):
            (part,) = formula.args
            size = self._maximum(part, -part)
            size.ends[0, 0] = np.maximum(size.ends[0, 0], 0.0)  # rounding would make it negative
            return size
        if type(formula) in BY_OTHERS:
            return self(BY_OTHERS[type(formula)](*formula.args))
        if isinstance(formula, sp.Piecewise):
            return self._piecewise(formula)
        if formula.is_Pow and not formula.exp.is_number:
            return self(sp.exp(formula.exp * sp.log(formula.base)))
        return self._composition(formula)

    def _symbol(self, symbol: sp.Symbol) -> Series:
        if symbol not in self.sides:
            raise RangeError(f"{symbol} is bound in a sum or another unevaluated formula: call .doit() on it")
        series = self._constant(self.sides[symbol])
        if symbol in self.variables and self.order > 0:
            # The first derivatives follow the value, the last variable first.
            series.ends[:, len(self.variables) - self.variables.index(symbol)] = 1.0
        return series

    def _number(self, number: sp.Expr) -> Series:
        if not (number.is_real and number.is_finite):
            raise RangeError(f"{number} is no real number; it comes from a power whose base is not positive")
        value = float(number)
        exact = isinstance(number, sp.Float | sp.Rational) and sp.Rational(number) == sp.Rational(value)
        return self._constant(value).rounded(exact)

    def _composition(self, formula: sp.Expr) -> Series:
        """Return the series Σ_j g_j δ^j of g(u), by Horner's rule; δ is the series of u without its constant term."""
        inner = self(formula.args[0])
        *outer, last = coefficients(formula, inner.values, self.order)
        delta = Series(inner.ends.copy())
        delta.ends[:, 0] = 0.0
        series = self._constant(last)
        for ends in reversed(outer):
            series = self._product(series, delta) + self._constant(ends)
        return series.rounded(isinstance(formula, pos))

    def _maximum(self, first: sp.Expr, second: sp.Expr) -> Series:
        """Return the series of Max(first, second); derivatives of order 1 exist on both sides of its kink."""
        a = self(first)
        b = self(second)
        never, always = ORDERED[sp.Ge](*self(first - second).values)
        larger = self._union([(a, never, always), (b, always, ~always)], first - second, 1)
        larger.ends[:, 0] = np.where(never | always, larger.values, np.maximum(a.values, b.values))
        return larger

    def _piecewise(self, formula: sp.Piecewise) -> Series:
        """Return the series of a Piecewise function, whose derivatives do not exist where its branches may change."""
        _, conditions = zip(*formula.args, strict=True)
        branches = [(self(value), *self._truth(condition)) for value, condition in formula.args]
        if sp.Or(*conditions) == sp.true:
            # One of the conditions holds everywhere, so the last branch is reached wherever no earlier one holds.
            value, never, _ = branches.pop()
            branches.append((value, never, ~never))
        return self._union(branches, sp.Tuple(*conditions), 0)

    def _union(self, branches: Sequence[tuple[Series, Flags, Flags]], change: sp.Basic, highest: int) -> Series:
        """Return the series of a function that is equal to the first branch whose condition holds.

        Args:
            branches: the series of each branch; whether its condition holds nowhere on a box; and whether it holds on
                the whole box.
            change: what decides the branch. If it depends on none of the variables, no derivative sees a change.
            highest: the highest order of the derivatives that exist on both sides of places where branches change.
        """
        low, high = np.full((2, len(self.keys), self.count), -REALS[..., None])
        reached = np.zeros(self.count, dtype=int)
        open_boxes = np.ones(self.count, dtype=bool)
        for series, never, always in branches:
            possible = open_boxes & ~never
            np.minimum(low, series.ends[0], out=low, where=possible)
            np.maximum(high, series.ends[1], out=high, where=possible)
            reached += possible
            open_boxes &= ~always
        # Where no condition may hold, the function has no value.
        unknown: Array = open_boxes
        if change.has(*self.variables):
            orders = np.array([sum(key) for key in self.keys])[:, None]
            unknown = open_boxes | ((orders > highest) & (reached > 1))
        return Series(np.where(unknown, REALS[..., None], [low, high]))

    def _truth(self, condition: sp.Basic) -> tuple[Flags, Flags]:
        """Return for each box whether a condition holds nowhere on it, and whether it holds on the whole box.

        Equality on whole boxes, as in Max(x1 − 1, 0) ≤ 0 for x1 < 1, is decided by the ends of the ranges.

        Raises:
            RangeError: the condition is not made of inequalities and equations.
        """
        if condition in (sp.true, sp.false):
            holds = np.full(self.count, condition == sp.true)
            return ~holds, holds
        if isinstance(condition, sp.Not | sp.Ne):
            # Not of Not is not evaluated, because SymPy cannot negate some nested conditions.
            never, always = self._truth(sp.Not(condition) if isinstance(condition, sp.Ne) else condition.args[0])
            return always, never
        if isinstance(condition, sp.Lt | sp.Le):
            return self._truth(condition.reversed)
        if isinstance(condition, sp.And | sp.Or):
            never_each, always_each = zip(*map(self._truth, condition.args), strict=True)
            if isinstance(condition, sp.And):
                return np.logical_or.reduce(never_each), np.logical_and.reduce(always_each)
            return np.logical_and.reduce(never_each), np.logical_or.reduce(always_each)
        if isinstance(condition, sp.Xor | sp.ITE | sp.Implies | sp.Equivalent):
            return self._truth(sp.to_nnf(condition, simplify=False))
        if not isinstance(condition, Relational) or not isinstance(condition.lhs, sp.Expr):
            raise RangeError(f"{condition} in a Piecewise is no inequality; write it with <, ≤, >, ≥, Eq or Ne")
        difference = self(condition.lhs - condition.rhs)
        return ORDERED[condition.func](*difference.values)

    def _constant(self, value: Pair | Intervals | float) -> Series:
        """Return the series of a constant with a given value or range of values."""
        ends = np.zeros((2, len(self.keys), self.count))
        ends[:, 0] = value
        return Series(ends)

    def _product(self, a: Series, b: Series) -> Series:
        """Return the product of two truncated power series; coefficients that are identically 0 are skipped."""
        ends = np.zeros_like(a.ends)
        i, j, k = _products(len(self.variables), self.order)
        i, j, k = np.array([i, j, k])[:, a.nonzero[i] & b.nonzero[j]]
        if k.size:
            products = times(a.ends[:, i], b.ends[:, j])
            first = np.flatnonzero(np.diff(k, prepend=-1))
            with np.errstate(over="ignore"):
                ends[:, k[first]] = enclosed(*np.add.reduceat(products, first, axis=1))
        return Series(ends).rounded(_is_power_of_two(a.values) | _is_power_of_two(b.values))


ALL_HALVINGS = 44
"""Number of halvings of boxes in each direction, in the search for jumps of the initial displacement.

The last boxes are a few units in the last place of double precision wide.
"""
FIRST_HALVINGS = 5
"""Number of halvings of boxes in each direction before any box is dropped, in the search for jumps."""
MOST_BOXES = 2000
"""If more boxes than this number are left, only one half of each halved box is kept, the half with the larger range."""
INSIDE_MARGIN = 1e-9
"""A point is inside the body if its distance to the boundary is larger than this number times the size of the body."""
LEAST_JUMP = 1e-6
"""A function counts as having a jump if its range in the last boxes exceeds this fraction of its size.

The last boxes are a few units in the last place wide. The square root of the distance to a line, which is not in V, has
the range 2.4e-7 there.
"""

Spread = Callable[[Array], Array]
"""The type of a function that measures how much the initial displacement u_0 varies on boxes, (2, d, n) → (n,).

The boxes are given by their lower and then their upper corners. The result is the width of the range of u_0 on each
box; it is 0 on boxes on which u_0 is Lipschitz continuous. On sides of the body it is the violation of a boundary
condition.
"""


def require_continuous_start(data: Data) -> None:
    """Refuse an initial displacement u_0 that jumps, is unbounded, or violates a boundary condition.

    If u_0 is given by formulas, all three are checked: u_0 must be continuous and bounded in the body, zero on clamped
    sides, and must not penetrate the foundation on contact sides. If u_0 is a Python function, only jumps at sample
    points are noticed. Exact solutions are skipped: ``manufactured.self_proof.prove`` checks the displacement of an
    exact solution.

    Args:
        data: the problem, which has the body and u_0.

    Raises:
        LoadError: u_0 is refused. The message names the place and the size of the jump or of the violation.
    """
    if isinstance(data.formulas_of, ExactSolution):
        return
    body = data.body
    formulas = data.formulas_of.start if isinstance(data.formulas_of, Expressions) else ()
    try:
        for formula in formulas:
            require_known(formula)
    except RangeError:
        formulas = ()
    spread = _spread_of_formulas(formulas) if formulas else _spread_of_samples(data)
    around = np.array([body.vertices.min(axis=1), body.vertices.max(axis=1)])[..., None]
    margin = INSIDE_MARGIN * body.extent

    def inside(boxes: Array) -> Array:
        return np.where(_meets(body, boxes, margin), spread(boxes), 0.0)

    with np.errstate(all="ignore"):
        sample = data.start(body.sample(np.random.default_rng(0), MOST_BOXES))
        tolerance = LEAST_JUMP * abs(sample).max()
        _require_small(*_largest(around, inside), tolerance, "jumps by about")
        if not any(formulas):
            return
        for part in (*body.of(Kind.CLAMPED), *body.of(Kind.CONTACT)):
            size, at = _violation(part, np.array(formulas))
            _require_small(size, part.point(at), tolerance, f"violates the condition of a {part.kind.name} part by")


def _violation(part: Part, start: Array) -> tuple[float, Points]:
    """Return how far u_0 is from 0 on a clamped side, or above 0 in normal direction on a contact side, and where."""
    nonpositive = [*start, *-start] if part.kind is Kind.CLAMPED else [part.normal @ start]
    formulas = along_side(part, nonpositive)

    def largest(boxes: Array) -> Array:
        expand = Boxes({ARC: boxes[:, 0]}, (), 0)
        return np.max([expand(formula).values[1] for formula in formulas], axis=0)

    return _largest(np.array([[[0.0]], [[part.measure]]]), largest)


def _require_small(size: float, at: Points, tolerance: float, what: str) -> None:
    if size > tolerance:
        raise LoadError(
            f"u_0 {what} {size:.3g} at x = {place(at)}: give a continuous u_0 that is 0 on CLAMPED parts and does not "
            "penetrate the foundation; kinks such as Max(x1 - 1/2, 0) are permitted"
        )


def _largest(boxes: Array, spread: Spread) -> tuple[float, Points]:
    """Halve boxes with a positive spread again and again; return the largest spread at last, and its place."""
    dim = boxes.shape[1]
    for number in range(ALL_HALVINGS * dim):
        boxes = _halves(boxes, number % dim)
        if number < FIRST_HALVINGS * dim:
            continue
        widths = spread(boxes)
        kept = widths > 0
        if not kept.any():
            return 0.0, boxes[0, :, 0]
        if kept.sum() > MOST_BOXES:
            halves = widths.reshape(-1, 2)
            kept &= (halves.argmax(axis=1)[:, None] == (0, 1)).ravel()
        boxes = boxes[..., kept]
        widths = widths[kept]
    worst = widths.argmax()
    return float(widths[worst]), boxes[..., worst].mean(axis=0)


def _halves(boxes: Array, axis: int) -> Array:
    """Return both halves of boxes that are cut in one direction, one after the other, (2, d, n) → (2, d, 2n)."""
    middle = boxes[:, axis].mean(axis=0)
    boxes = np.repeat(boxes, 2, axis=2)
    boxes[1, axis, ::2] = boxes[0, axis, 1::2] = middle
    return boxes


def _places(boxes: Array) -> Points:
    """Return the corners and the middle of boxes, (2, d, n) → (d, 2^d + 1, n)."""
    low, high = boxes
    shares = np.array([*product((0.0, 1.0), repeat=len(low)), [0.5] * len(low)]).T
    return low[:, None] + shares[..., None] * (high - low)[:, None]


def _meets(body: Body, boxes: Array, margin: float) -> Array:
    """Return whether boxes may meet the body, (n,); a box as small as the margin has to lie farther inside."""
    middle = boxes.mean(axis=0)
    radii = np.linalg.norm(boxes[1] - boxes[0], axis=0) / 2
    to_sides = np.min([distance(middle, part.corners) for part in body.parts], axis=0)
    return np.where(to_sides > np.maximum(radii, margin), body.contains(middle), radii > margin)


def _spread_of_formulas(formulas: Sequence[sp.Expr]) -> Spread:
    def spread(boxes: Array) -> Array:
        expand = Boxes({x1: boxes[:, 0], x2: boxes[:, 1]}, (x1, x2), 1)
        widths = []
        for series in map(expand, formulas):
            is_lipschitz = np.isfinite(series.largest).all(axis=0)
            widths.append(np.where(is_lipschitz, 0.0, np.ptp(series.values, axis=0)))
        return np.max(widths, axis=0)

    return spread


def _spread_of_samples(data: Data) -> Spread:
    def spread(boxes: Array) -> Array:
        places = _places(boxes)
        inside = data.body.contains(places)
        values = np.full(places.shape, np.nan)
        values[:, inside] = data.start(places[:, inside])
        spans = np.fmax.reduce(values, axis=1) - np.fmin.reduce(values, axis=1)
        return np.nan_to_num(spans).max(axis=0)

    return spread

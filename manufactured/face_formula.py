"""Reads the exponents at contact fronts off the formulas of gap, pressure and strain on a face.

The truncated powers of a formula have these exponents. Parts of a formula that may not be smooth are refused.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp

from manufactured.body import Part
from manufactured.compiled import function
from manufactured.symbols import Function, Symbols, pos, s, s1, s2, t

SMOOTH = (sp.exp, sp.sin, sp.cos, sp.sinh, sp.cosh, sp.tanh, sp.atan, sp.asinh, sp.erf)
"""Functions that are smooth wherever their argument is smooth."""
FACE = frozenset({s, s1, s2})
"""The symbols of the coordinates along contact faces."""
ZERO_UP_TO = 1e-9
"""Relative tolerance: a value counts as zero if it is smaller than this fraction of the largest value on the face."""
GRID_POINTS, ZOOMS = 33, 8
"""The search for the extremum of a formula on a face: points of a grid along every axis, and number of grids.

Each grid covers the neighbourhood of the best point of the grid before it.
"""


class RoughError(ValueError):
    """Raised if the exponents of a formula at contact fronts cannot be read off, or no ``Regularity`` states them."""


@dataclass(frozen=True)
class FaceFormula:
    """A formula of the contact data on a face, such as the gap, and the time interval in which it is used.

    Attributes:
        formula: a formula of the coordinates along the face and of t.
        part: the contact face.
        variables: the symbols of the coordinates along the face.
        begin, end: the first and the last time at which the formula is used.
    """

    formula: sp.Expr
    part: Part
    variables: Symbols
    begin: float
    end: float

    @cached_property
    def plain(self) -> sp.Expr:
        """The formula without those truncated powers x_+^a that are smooth on the face, which are replaced by x^a or 0.

        A truncated power ``pos(x, a)`` is replaced by 0 if x ≤ 0 on the whole face at all times. It is replaced by x^a
        if x > 0, or if x ≥ 0 and a is a natural number. What remains are

        * powers whose x changes its sign on the face, at a contact front;
        * powers whose x ≥ 0 vanishes somewhere, such as at an end of the face, and whose a is no natural number;
        * powers that depend on t only.
        """

        def resolved(power: pos) -> sp.Expr:
            x, a = power.args
            low, high = self.range(x)
            tiny = ZERO_UP_TO * max(abs(low), abs(high))
            if high <= tiny:
                return sp.Integer(0)
            return x**a if low > tiny or (low >= -tiny and is_natural(a)) else power

        return self.formula.replace(lambda e: isinstance(e, pos) and bool(e.free_symbols & FACE), resolved)

    def refuse_unread(self) -> None:
        """Refuse a formula with a part that is neither a truncated power nor known to be smooth on the face.

        Logarithms, and powers with exponents that are not natural numbers, are smooth where their base is positive.
        Quotients are smooth where the denominator is not zero. The base is sampled on grids, so a zero between two grid
        points may be missed.

        Raises:
            RoughError: there is such a part; the message names it.
        """
        # Both formulas are searched: in ``plain`` a truncated power may have become an ordinary power, and parts of its
        # argument may have disappeared.
        parts = self.formula.atoms(sp.Function, sp.Pow) | self.plain.atoms(sp.Function, sp.Pow)
        for part in sorted(parts, key=str):
            base = must_be_positive(part) if part.free_symbols & FACE else None
            if base is None:
                continue
            low, high = self.range(base)
            if not ZERO_UP_TO * high < low < math.inf:
                raise RoughError(
                    f"{part} in {self.formula} is not known to be smooth on the whole face during "
                    f"[{self.begin:g}, {self.end:g}]; write a rough power x^a as pos(x, a) and state its exponent in "
                    f"the label, keep the base of other powers and logarithms above 0, and of functions use "
                    f"{', '.join(f.__name__ for f in SMOOTH)}"
                )

    def exponents(self) -> tuple[float, float]:
        """Return the lowest exponents a of truncated powers x_+^a at fixed and at moving contact fronts.

        Without fixed fronts the first exponent is infinity, without moving fronts the second.

        Raises:
            RoughError: a part of the formula is neither a truncated power nor known to be smooth on the face.
        """
        self.refuse_unread()
        found = {False: math.inf, True: math.inf}
        for front in {power.args[0] for power in self.plain.atoms(pos) if power.args[0].free_symbols & FACE}:
            # Whether a front moves is decided for each factor: t (s − c) depends on t, but vanishes at s = c for all t.
            factors = sp.Mul.make_args(sp.factor(front))
            moves = any(factor.has(t) and bool(factor.free_symbols & FACE) for factor in factors)
            found[moves] = min(found[moves], order_at(self.plain, front)[0])
        return found[False], found[True]

    def range(self, formula: sp.Expr) -> tuple[float, float]:
        """Return the least and the largest value of a formula, such as a part of ``self.formula``, on the face.

        Times are between ``begin`` and ``end``. The values may be infinite. They are searched on nested grids, so a
        narrow extremum may be missed.
        """
        values = function([*self.variables, t], [formula])
        return self._least(values, 1.0), -self._least(values, -1.0)

    def _least(self, values: Function, sign: float) -> float:
        """Return the least value of ``sign`` times a function on the face and in [begin, end].

        The least value is searched on ever smaller grids around the best point.
        """
        outline = self.part.outline
        start, stop = np.array([*outline.min(1), self.begin]), np.array([*outline.max(1), self.end])
        low, high, least = start, stop, math.inf
        for _ in range(ZOOMS):
            axes = np.linspace(low, high, GRID_POINTS).T
            grid = np.array(np.meshgrid(*axes, indexing="ij")).reshape(len(axes), -1)
            with np.errstate(all="ignore"):
                found = sign * np.broadcast_to(values(*grid)[0], grid.shape[1:])
            found = np.where(np.isnan(found), -math.inf, found)
            found = np.where(self.part.covers(grid[:-1], 1e-12 * self.part.measure), found, math.inf)
            best = int(found.argmin())
            least = min(least, float(found[best]))
            cell = (high - low) / (GRID_POINTS - 1)
            low, high = np.maximum(start, grid[:, best] - cell), np.minimum(stop, grid[:, best] + cell)
        return least


def read_off(gaps: Iterable[FaceFormula], pressures: Iterable[FaceFormula]) -> tuple[float, float, bool]:
    """Return the lowest exponents α of the gap and m of the pressure at contact fronts, and whether a front moves.

    If there is no front, the exponents are infinity. m is the exponent of the strain if no pressure is prescribed.

    Args:
        gaps: the formulas of the gap, and of an initial gap.
        pressures: the formulas of the pressure or of the strain on the face.

    Raises:
        RoughError: exponents cannot be read off a formula, or the gap has a fixed front with a lower exponent than its
            moving fronts. One ``Regularity`` cannot state both, because a moving front lowers the exponent of u̇ by
            one.
    """
    (alpha, moving_alpha), (m, moving_m) = (
        np.min([(math.inf, math.inf), *(piece.exponents() for piece in side)], axis=0) for side in (gaps, pressures)
    )
    moving = min(moving_alpha, moving_m) < math.inf
    if moving and alpha < moving_alpha:
        raise RoughError(
            f"the gap has a front that stays with α = {alpha:g} beside moving ones with α = {moving_alpha:g}, m = "
            f"{moving_m:g}; one label cannot state both: raise the exponent of the front that stays, or make two cases"
        )
    return min(alpha, moving_alpha), min(m, moving_m), moving


def order_at(formula: sp.Expr, x: sp.Expr) -> tuple[float, float]:
    """Return two exponents (a, k) that describe how a formula behaves near x = 0.

    The formula has the size x^k as x → 0 with x > 0. It is smooth there except for a truncated power x_+^a and higher
    ones; without truncated powers of x, a is infinity. For x ``pos(x, 2)`` the result is (3, 3), for 1 + ``pos(x, 2)``
    it is (2, 0). Sums, products and powers of ``pos(x, ·)`` and of x are understood.

    Args:
        formula: the formula.
        x: an expression of the coordinates and the time, which vanishes at a contact front.
    """
    if formula in (x, -x):
        return math.inf, 1.0
    if isinstance(formula, pos) and formula.args[0] == x:
        return float(formula.args[1]), float(formula.args[1])
    if isinstance(formula, sp.Pow):
        (rough, zero), exponent = order_at(formula.base, x), formula.exp
        if isinstance(formula.base, pos) and rough == zero and exponent.is_number:
            return rough * float(exponent), zero * float(exponent)
        if is_natural(exponent):
            return rough + (float(exponent) - 1) * zero, zero * float(exponent)
    below = [order_at(part, x) for part in formula.args]
    if isinstance(formula, sp.Mul):
        total = sum(zero for _, zero in below)
        return min(rough + total - zero for rough, zero in below), total
    least = min((rough for rough, _ in below), default=math.inf)
    return least, min(zero for _, zero in below) if isinstance(formula, sp.Add) else 0.0


def must_be_positive(part: sp.Expr) -> sp.Expr | None:
    """Return the expression that must be positive so that a part of a formula is smooth; None if it is always smooth.

    Args:
        part: a function or power that the formula contains. For a function that is not known to be smooth anywhere,
            the result is 0, which is never positive.
    """
    if isinstance(part, SMOOTH) or (isinstance(part, pos) and part.args[1].is_number):
        return None
    if isinstance(part, sp.log):
        return part.args[0]
    if not isinstance(part, sp.Pow):
        return sp.Integer(0)
    base = part.base
    exponent = part.exp
    if is_natural(exponent) or (isinstance(base, pos) and exponent.is_positive):
        return None
    return base**2 if is_natural(-exponent) else base


def is_natural(exponent: sp.Expr) -> bool:
    """Return whether an exponent is a natural number 0, 1, 2, …."""
    return bool(exponent.is_number and exponent.is_real and exponent >= 0 and float(exponent).is_integer())

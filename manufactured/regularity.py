"""What the exponents of a contact zone say about the regularity of the solution, and so the order.

Near a front c(t) let w ~ (s − c)_+^α and p ~ (c − s)_+^m. The lifting has u_s ~ w', u_n ~ w + y q:

* moving front, with ẇ ~ (s − c)_+^{α−1} and q̇ ~ p:
  u ∈ W^{1,2}(0,T;H²) iff ẇ''' ~ (·)^{α−4} and q̇'' ~ p'' ~ (·)^{m−2} are square integrable, that is
  α > 7/2 and m > 3/2; then (5.36) holds;
  u ∈ W^{1,∞}(0,T;V) iff α > 5/2 and m > 1/2;
  (3.4) read literally, f_0 ∈ W^{1,1}(0,T;H), needs α > 9/2 and m > 5/2. The source uses (3.4) only
  through (3.8), f ∈ W^{1,1}(0,T;V), which needs one derivative less in space and holds whenever
  σ and σ_ν are absolutely continuous in time;
* fixed front: u ∈ H^{1+s}(Ω) for s < min(α − 3/2, m − 1/2), from w' and q in H^{1+s}; (5.36) and
  (3.4) for α > 5/2 and m > 3/2.

A field of the form r^λ at a point (corner, junction of two conditions, natural front, extension of a
trace s_+^λ) lies in H^{1+s}(Ω) for s < λ; if the point is on Γ3 its trace lies in H^τ(Γ3) for τ < λ + 1/2
and σ_ν ~ r^{λ−1} in L²(Γ3) iff λ > 1/2. A strain that jumps across a line which the mesh does not
follow gives s < 1/2.

The predicted order of ‖u − u^h‖_{L∞(0,T;V)} for P1 on meshes that do not know the rough place is that
of interpolation, (5.23) between H¹ and H²: min(1, s) for u(t) ∈ H^{1+s}. What the proof of Prop. 5.4
gives is ``proved_order``: min(1, s', τ/2) from ‖u̇ − Π^h u̇‖_V and ‖u_ν − Π^h u_ν‖^{1/2}_{L²(Γ3)} in
(5.42), for u̇ ∈ H^{1+s'} and u_ν ∈ H^τ(Γ3), or min(1, s', s/2) from (5.28) where σ_ν ∉ L²(Γ3).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp

from manufactured.body import Part
from manufactured.symbols import function, pos, s, s1, s2, t
from manufactured.tensors import Array


@dataclass(frozen=True)
class Regularity:
    """The exponents of a case.

    Attributes:
        gap: α; math.inf without a front.
        pressure: m; math.inf without a front.
        moving: whether the front moves.
        corner: λ of the least regular r^λ inside or on Γ1 and Γ2; math.inf without one.
        on_contact: λ of the least regular r^λ on Γ3; math.inf without one.
        kink: whether the strain jumps across a line that meshes do not follow.

    Raises:
        ValueError: α ≤ 3/2, m ≤ 1/2 or λ ≤ 0, so that u(t) lies in no H^{1+s}, s > 0.
    """

    gap: float = math.inf
    pressure: float = math.inf
    moving: bool = False
    corner: float = math.inf
    on_contact: float = math.inf
    kink: bool = False

    def __post_init__(self) -> None:
        if not (self.gap > 1.5 and self.pressure > 0.5):
            raise ValueError(f"α = {self.gap}, m = {self.pressure}: H^(1+s) with s > 0 needs α > 3/2 and m > 1/2")
        if not min(self.corner, self.on_contact) > 0:
            raise ValueError(f"λ = {min(self.corner, self.on_contact)}: H^(1+s) with s > 0 needs λ > 0")

    @property
    def smoothness(self) -> float:
        """sup of the s with u(t) ∈ H^{1+s}(Ω)."""
        return min(self.gap - 1.5, self.pressure - 0.5, self.corner, self.on_contact, 0.5 if self.kink else math.inf)

    @property
    def rate_smoothness(self) -> float:
        """sup of the s with u̇(t) ∈ H^{1+s}(Ω): a front that moves costs w one power."""
        return min(self.smoothness, self.gap - 2.5) if self.moving else self.smoothness

    @property
    def force_in_L2(self) -> bool:
        """Whether f_0(t) ∈ L²(Ω)²: the lifting lies in H² with its rate.

        Fields r^λ at corners and natural fronts have Div σ = 0 where they are singular, and cost nothing.
        """
        front = min(self.gap - 1.5 - self.moving, self.pressure - 0.5)
        return front > 1

    @property
    def trace(self) -> float:
        """sup of the τ with u_ν(t) ∈ H^τ(Γ3,i)."""
        return min(self.gap, self.on_contact) + 0.5

    @property
    def order(self) -> float:
        """The predicted order of ‖u − u^h‖_{L∞(0,T;V)} on uniform meshes, min(1, s)."""
        return min(1.0, self.smoothness)

    @property
    def proved_order(self) -> float:
        """What the proof of Prop. 5.4 gives: min(1, s', τ/2), or min(1, s', s/2) for σ_ν ∉ L²(Γ3)."""
        contact = self.trace / 2 if self.on_contact > 0.5 else self.smoothness / 2
        return min(1.0, self.rate_smoothness, contact)

    @property
    def satisfies_5_36(self) -> bool:
        """u ∈ W^{1,2}(0,T;H²) and u_ν|Γ3,i ∈ L¹(0,T;H²)."""
        return self.rate_smoothness > 1 and self.trace > 2

    @property
    def proposition(self) -> str:
        """The numbered statement whose hypotheses hold."""
        return "Prop. 5.4" if self.satisfies_5_36 else "Prop. 5.3"

    def __str__(self) -> str:
        found = []
        if not (math.isinf(self.gap) and math.isinf(self.pressure)):
            front = "moving" if self.moving else "fixed"
            found.append(f"{front} front, α = {self.gap:g}, m = {self.pressure:g}")
        if not math.isinf(self.corner):
            found.append(f"r^{self.corner:.4g} at a corner")
        if not math.isinf(self.on_contact):
            found.append(f"r^{self.on_contact:.4g} on Γ3")
        if self.kink:
            found.append("strain with a jump inside cells")
        return ", ".join(found) or "smooth"


FACE = frozenset({s, s1, s2})
"""The coordinates along contact faces."""

SMOOTH = (sp.exp, sp.sin, sp.cos, sp.sinh, sp.cosh, sp.tanh, sp.atan, sp.asinh, sp.erf)
"""Functions that are smooth wherever their argument is."""

TINY = 1e-9
"""A value counts as zero if it is smaller than this part of the largest on the face."""
POINTS, ZOOMS = 33, 8
"""Points along every axis of the grid on which an extremum is looked for, and grids, each of one cell of the last."""


class RoughError(ValueError):
    """The exponents of a formula cannot be read off, or no label can state them."""


@dataclass(frozen=True)
class Piece:
    """A formula of the contact data on a face during [begin, end].

    Attributes:
        formula: of the variables and t.
        part: the face.
        variables: the coordinates along the face.
        begin, end: the times between which the formula is used.
    """

    formula: sp.Expr
    part: Part
    variables: tuple[sp.Symbol, ...]
    begin: float
    end: float

    @cached_property
    def plain(self) -> sp.Expr:
        """The formula without the truncated powers that are smooth here, as x keeps its sign or x^a is a polynomial.

        What remains as ``pos(x, a)`` has its front on the face, or is a power that is not natural at an end of it.
        """

        def resolved(power: pos) -> sp.Expr:
            x, a = power.args
            low, high = self.range(x)
            tiny = TINY * max(abs(low), abs(high))
            if high <= tiny:
                return sp.Integer(0)
            return x**a if low > tiny or (low >= -tiny and _natural(a)) else power

        return self.formula.replace(lambda e: isinstance(e, pos) and bool(e.free_symbols & FACE), resolved)

    def refuse_unread(self) -> None:
        """Every part of the formula that is not smooth on the face must be a truncated power.

        Powers that are not natural and logarithms are smooth where their base stays positive, poles where it is not
        zero; the base is sampled, so that a zero between the points of a grid may be missed.

        Raises:
            RoughError: another part is not smooth, or not known to be.
        """
        # A power that is resolved may hide what its argument is made of, or become a plain power itself.
        parts = self.formula.atoms(sp.Function, sp.Pow) | self.plain.atoms(sp.Function, sp.Pow)
        for part in sorted(parts, key=str):
            base = _must_be_positive(part) if part.free_symbols & FACE else None
            if base is None:
                continue
            low, high = self.range(base)
            if not TINY * high < low < math.inf:
                raise RoughError(
                    f"{part} in {self.formula} is not known to be smooth on the whole face during "
                    f"[{self.begin:g}, {self.end:g}]; write a rough power x^a as pos(x, a) and state its exponent in "
                    f"the label, keep the base of other powers and logarithms above 0, and of functions use "
                    f"{', '.join(f.__name__ for f in SMOOTH)}"
                )

    def fronts(self) -> tuple[float, float]:
        """The lowest exponents of the fronts that stay and of those that move; infinite without any."""
        found = {False: math.inf, True: math.inf}
        for front in {power.args[0] for power in self.plain.atoms(pos) if power.args[0].free_symbols & FACE}:
            # t (s − c) vanishes where s − c does: that front stays.
            factors = sp.Mul.make_args(sp.factor(front))
            moves = any(factor.has(t) and bool(factor.free_symbols & FACE) for factor in factors)
            found[moves] = min(found[moves], _order(self.plain, front)[0])
        return found[False], found[True]

    def range(self, formula: sp.Expr) -> tuple[float, float]:
        """(least, largest) value of a formula on the closed face × [begin, end], infinite where it has none."""
        values = function([*self.variables, t], [formula])
        return self._least(values, 1.0), -self._least(values, -1.0)

    def _least(self, values: Callable[..., list[Array]], sign: float) -> float:
        """The least value of a function times ±1: on a grid, then on ever smaller ones around the best point."""
        outline = self.part.outline
        start, stop = np.array([*outline.min(1), self.begin]), np.array([*outline.max(1), self.end])
        low, high, least = start, stop, math.inf
        for _ in range(ZOOMS):
            axes = [np.linspace(a, b, POINTS) for a, b in zip(low, high, strict=True)]
            grid = np.array(np.meshgrid(*axes, indexing="ij")).reshape(len(axes), -1)
            with np.errstate(all="ignore"):
                found = sign * np.broadcast_to(values(*grid)[0], grid.shape[1:])
            found = np.where(np.isnan(found), -math.inf, found)
            found = np.where(self.part.covers(grid[:-1], 1e-12 * self.part.measure), found, math.inf)
            best = int(found.argmin())
            least = min(least, float(found[best]))
            cell = (high - low) / (POINTS - 1)
            low, high = np.maximum(start, grid[:, best] - cell), np.minimum(stop, grid[:, best] + cell)
        return least


def read_off(gaps: Iterable[Piece], pressures: Iterable[Piece]) -> tuple[float, float, bool]:
    """(α, m, moving) of the formulas of a solution: the lowest exponents over its fronts, infinite without any.

    Raises:
        RoughError: a formula has parts that cannot be read, or its gap has a front that stays and is rougher
            than those that move, which one label cannot state: a moving front costs u̇ one power more.
    """
    sides = []
    for side in (gaps, pressures):
        pieces = list(side)
        for piece in pieces:
            piece.refuse_unread()
        found = [piece.fronts() for piece in pieces]
        sides.append([min((exponents[k] for exponents in found), default=math.inf) for k in (False, True)])
    (alpha, moving_alpha), (m, moving_m) = sides
    moving = min(moving_alpha, moving_m) < math.inf
    if moving and alpha < moving_alpha:
        raise RoughError(
            f"the gap has a front that stays with α = {alpha:g} beside moving ones with α = {moving_alpha:g}, m = "
            f"{moving_m:g}; one label cannot state both: raise the exponent of the front that stays, or make two cases"
        )
    return min(alpha, moving_alpha), min(m, moving_m), moving


def _natural(exponent: sp.Expr) -> bool:
    return bool(exponent.is_number and exponent.is_real and exponent >= 0 and float(exponent).is_integer())


def _must_be_positive(part: sp.Expr) -> sp.Expr | None:
    """What must stay positive for a power or a function to be smooth; None if nothing need."""
    if isinstance(part, SMOOTH) or (isinstance(part, pos) and part.args[1].is_number):
        return None
    if isinstance(part, sp.log):
        return part.args[0]
    if not isinstance(part, sp.Pow):
        return sp.Integer(0)
    base, exponent = part.base, part.exp
    if _natural(exponent) or (isinstance(base, pos) and exponent.is_positive):
        return None
    return base**2 if _natural(-exponent) else base


def _order(formula: sp.Expr, x: sp.Expr) -> tuple[float, float]:
    """(a, k): where x = 0 the formula is smooth but for x_+^a and beyond, and vanishes at least like x^k.

    Sums, products and powers of ``pos(x, ·)``, and of x itself as it is written there, are followed.
    """
    if formula in (x, -x):
        return math.inf, 1.0
    if isinstance(formula, pos) and formula.args[0] == x:
        return float(formula.args[1]), float(formula.args[1])
    if isinstance(formula, sp.Pow):
        (rough, zero), exponent = _order(formula.base, x), formula.exp
        if isinstance(formula.base, pos) and rough == zero and exponent.is_number:
            return rough * float(exponent), zero * float(exponent)
        if _natural(exponent):
            return rough + (float(exponent) - 1) * zero, zero * float(exponent)
    below = [_order(part, x) for part in formula.args]
    if isinstance(formula, sp.Mul):
        total = sum(zero for _, zero in below)
        return min(rough + total - zero for rough, zero in below), total
    least = min((rough for rough, _ in below), default=math.inf)
    return least, min(zero for _, zero in below) if isinstance(formula, sp.Add) else 0.0

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

The predicted order of ‖u − u^h‖_{L∞(0,T;V)} for P1 on meshes that do not know the front is
min(1, α − 3/2, m − 1/2), the order of interpolation (5.23) of a function in H^{1+s}.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import sympy as sp

from manufactured.symbols import pos, t


@dataclass(frozen=True)
class Regularity:
    """The exponents of a case.

    Attributes:
        gap: α; math.inf without a front.
        pressure: m; math.inf without a front.
        moving: whether the front moves.

    Raises:
        ValueError: α ≤ 3/2 or m ≤ 1/2, so that u(t) lies in no H^{1+s}, s > 0.
    """

    gap: float = math.inf
    pressure: float = math.inf
    moving: bool = False

    def __post_init__(self) -> None:
        if not (self.gap > 1.5 and self.pressure > 0.5):
            raise ValueError(f"α = {self.gap}, m = {self.pressure}: H^(1+s) with s > 0 needs α > 3/2 and m > 1/2")

    @property
    def smoothness(self) -> float:
        """sup of the s with u(t) ∈ H^{1+s}(Ω) near the front."""
        return min(self.gap - 1.5, self.pressure - 0.5)

    @property
    def order(self) -> float:
        """The predicted order of ‖u − u^h‖_{L∞(0,T;V)} on uniform meshes, min(1, s)."""
        return min(1.0, self.smoothness)

    @property
    def satisfies_5_36(self) -> bool:
        """u ∈ W^{1,2}(0,T;H²) and u_ν|Γ3,i ∈ L¹(0,T;H²)."""
        return self.gap > (3.5 if self.moving else 2.5) and self.pressure > 1.5

    @property
    def proposition(self) -> str:
        """The numbered statement whose hypotheses hold."""
        return "Prop. 5.4" if self.satisfies_5_36 else "Prop. 5.3"

    @property
    def satisfies_4_1(self) -> bool:
        """u ∈ W^{1,∞}(0,T;V)."""
        return not self.moving or (self.gap > 2.5 and self.pressure > 0.5)

    @property
    def satisfies_3_4(self) -> bool:
        """f_0 ∈ W^{1,1}(0,T;L²), read literally."""
        return self.gap > (4.5 if self.moving else 2.5) and self.pressure > (2.5 if self.moving else 1.5)

    def __str__(self) -> str:
        if math.isinf(self.gap) and math.isinf(self.pressure):
            return "smooth"
        front = "moving" if self.moving else "fixed"
        return f"{front} front, α = {self.gap:g}, m = {self.pressure:g}"


def fronts(formula: sp.Expr, variables: tuple[sp.Symbol, ...]) -> tuple[float, bool]:
    """(lowest exponent, whether any moves) of the truncated powers along the face in a formula.

    (inf, False) without any; a power of a truncated power counts with the product of the exponents.
    """
    exponents, moving = [math.inf], False
    powers = {base: float(e) for base, e in (p.as_base_exp() for p in formula.atoms(sp.Pow)) if isinstance(base, pos)}
    for front in formula.atoms(pos):
        if front.args[0].free_symbols & set(variables):
            exponents.append(float(front.args[1]) * powers.get(front, 1.0))
            moving |= front.args[0].has(t)
    return min(exponents), moving


def read_off(
    gaps: list[sp.Expr], pressures: list[sp.Expr], variables: tuple[sp.Symbol, ...]
) -> tuple[float, float, bool]:
    """(α, m, moving) of the formulas of a solution: the lowest exponents over its faces."""
    found = [[fronts(sp.sympify(f), variables) for f in formulas] for formulas in (gaps, pressures)]
    (alpha, m), moving = ([min(e for e, _ in side) for side in found]), any(move for side in found for _, move in side)
    return alpha, m, moving

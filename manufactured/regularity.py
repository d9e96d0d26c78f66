"""The regularity of a solution, and from it the predicted order, for given exponents of gap and pressure at the fronts.

**Contact fronts.** Near a front c(t) let w ~ (s − c)_+^α and p ~ (c − s)_+^m. The lifting has u_s ~ w', u_n ~ w + y q.

* At a moving front ẇ ~ (s − c)_+^{α−1} and q̇ ~ p. Then
  u ∈ W^{1,2}(0,T;H²), and so (5.36), holds if ẇ''' ~ (·)^{α−4} and q̇'' ~ p'' ~ (·)^{m−2} are square integrable, that is
  for α > 7/2 and m > 3/2;
  u ∈ W^{1,∞}(0,T;V) holds for α > 5/2 and m > 1/2;
  (3.4) as it is printed, f_0 ∈ W^{1,1}(0,T;H), needs α > 9/2 and m > 5/2. The paper uses (3.4) only through (3.8),
  f ∈ W^{1,1}(0,T;V). This needs one derivative less in space: it holds if σ and σ_ν are absolutely continuous in time.
* At a fixed front u ∈ H^{1+s}(Ω) for s < min(α − 3/2, m − 1/2), because w' and q are in H^{1+s}. (5.36) and (3.4) hold
  for α > 5/2 and m > 3/2.

**Singular points.** A field ~ r^λ at a point (corner, junction of two boundary conditions, natural front, extension of
a trace s_+^λ) lies in H^{1+s}(Ω) for s < λ. If the point is on Γ3, the trace of the field lies in H^τ(Γ3) for
τ < λ + 1/2, and σ_ν ~ r^{λ−1} lies in L²(Γ3) if λ > 1/2. If the point moves along Γ3, u̇ ~ r^{λ−1} lies in H^{1+s} for
s < λ − 1, and σ_ν ~ r^{λ−2} lies in L²(Γ3) if λ > 3/2.

**Interfaces.** If the strain jumps across a line that the mesh does not follow, s < 1/2.

**Orders.** On meshes that are not refined towards singular points, the predicted order of ‖u − u^h‖_{L∞(0,T;V)} for P1
is the order of interpolation, (5.23) between H¹ and H²: min(1, s) for u(t) ∈ H^{1+s}. The order that the proof of
Prop. 5.4 gives, ``proved_order``, may be lower. For u̇ ∈ H^{1+s'} and u_ν ∈ H^τ(Γ3) it is min(1, s', τ/2), from ‖u̇ −
Π^h u̇‖_V and ‖u_ν − Π^h u_ν‖^{1/2}_{L²(Γ3)} in (5.42). If σ_ν ∉ L²(Γ3), it is min(1, s', s/2), from (5.28).
"""

import math
from dataclasses import dataclass

from manufactured.arguments import Extended, checked

NATURAL_FRONT = (
    "A pressure that ends like a square root, as Hertz's does (m = 1/2, gap with α = 3/2), comes from a singular "
    "field, not from a lifting of gap and pressure: take the case natural-front of the catalogue, or build a case like "
    "natural_front in manufactured/cases/rough.py, with a SingularFace, a SingularField from kolosov(κ, 1j, -0.5j, "
    "1.5) and the label Regularity(on_contact=1.5)"
)


@dataclass(frozen=True)
@checked(ValueError)
class Regularity:
    """The exponents of gap, pressure and singular fields that determine how smooth a solution is.

    >>> Regularity(gap=4, pressure=2, moving=True).proposition
    'Prop. 5.4'
    >>> Regularity(gap=2.25, pressure=1.5).order
    0.75

    Attributes:
        gap: the exponent α of the gap, which behaves like r^α at the distance r from the contact fronts; math.inf
            without a front.
        pressure: the exponent m of the pressure, which behaves like r^m at the contact fronts; math.inf without a
            front.
        moving: whether the front moves.
        corner: the smallest λ of singular fields r^λ at points that are not on Γ3; math.inf if there are none.
        on_contact: the smallest λ of singular fields r^λ at points on Γ3; math.inf if there are none.
        kink: whether the strain jumps across a line that meshes do not follow.

    Raises:
        ValueError: α ≤ 3/2, m ≤ 1/2 or λ ≤ 0, so that u(t) lies in no H^{1+s} with s > 0.
    """

    gap: Extended = math.inf
    pressure: Extended = math.inf
    moving: bool = False
    corner: Extended = math.inf
    on_contact: Extended = math.inf
    kink: bool = False

    def __post_init__(self) -> None:
        if not (self.gap > 1.5 and self.pressure > 0.5):
            raise ValueError(
                f"α = {self.gap}, m = {self.pressure}: H^(1+s) with s > 0 needs α > 3/2 and m > 1/2. {NATURAL_FRONT}"
            )
        if not min(self.corner, self.on_contact) > 0:
            raise ValueError(f"λ = {min(self.corner, self.on_contact)}: H^(1+s) with s > 0 needs λ > 0")

    @property
    def smoothness(self) -> float:
        """The regularity of the displacement: the supremum of all s with u(t) ∈ H^{1+s}(Ω)."""
        return min(self.gap - 1.5, self.pressure - 0.5, self.corner, self.on_contact, 0.5 if self.kink else math.inf)

    @property
    def rate_smoothness(self) -> float:
        """The regularity of the velocity: the supremum of all s with u̇(t) ∈ H^{1+s}(Ω).

        A moving front lowers the exponents of the gap and of singular fields r^λ by one.
        """
        return min(self.smoothness, self.gap - 2.5, self.on_contact - 1) if self.moving else self.smoothness

    @property
    def force_in_L2(self) -> bool:
        """Whether the body force is square integrable, f_0(t) ∈ L²(Ω)^d.

        This holds if the displacement of the contact faces and its time derivative lie in H². Singular fields r^λ at
        corners and at natural fronts, where the gap behaves like r^{3/2}, have Div σ = 0 near the singular point, so
        f_0 is not singular there.
        """
        front = min(self.gap - 1.5 - self.moving, self.pressure - 0.5)
        return front > 1

    @property
    def trace(self) -> float:
        """The regularity of the normal trace u_ν on each contact face: the supremum of all τ with u_ν(t) ∈ H^τ."""
        return min(self.gap, self.on_contact) + 0.5

    @property
    def order(self) -> float:
        """The predicted order of ‖u − u^h‖_{L∞(0,T;V)} on uniform meshes: min(1, s) for u(t) ∈ H^{1+s}."""
        return min(1.0, self.smoothness)

    @property
    def proved_order(self) -> float:
        """The order of convergence that the proof of Prop. 5.4 gives.

        It is min(1, s', τ/2) for u̇ ∈ H^{1+s'} and u_ν ∈ H^τ(Γ3); if σ_ν ∉ L²(Γ3), it is min(1, s', s/2) for
        u ∈ H^{1+s}.
        """
        contact = self.trace / 2 if self.on_contact - self.moving > 0.5 else self.smoothness / 2
        return min(1.0, self.rate_smoothness, contact)

    @property
    def satisfies_5_36(self) -> bool:
        """Whether the assumption (5.36) of Prop. 5.4 holds: u ∈ W^{1,2}(0,T;H²) and u_ν|Γ3,i ∈ L¹(0,T;H²)."""
        return self.rate_smoothness > 1 and self.trace > 2

    @property
    def proposition(self) -> str:
        """The statement of the paper that applies: Prop. 5.4 if its assumption (5.36) holds, otherwise Prop. 5.3."""
        return "Prop. 5.4" if self.satisfies_5_36 else "Prop. 5.3"

    def __str__(self) -> str:
        found = []
        if not (math.isinf(self.gap) and math.isinf(self.pressure)):
            front = "moving" if self.moving else "fixed"
            found.append(f"{front} front, α = {self.gap:g}, m = {self.pressure:g}")
        if not math.isinf(self.corner):
            found.append(f"r^{self.corner:.4g} at a corner")
        if not math.isinf(self.on_contact):
            found.append(f"r^{self.on_contact:.4g} on Γ3{', moving' if self.moving else ''}")
        if self.kink:
            found.append("strain with a jump inside cells")
        return ", ".join(found) or "smooth"

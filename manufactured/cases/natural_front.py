"""The natural front of frictionless contact, at rest: the solution just violates (5.36).

The gap w, the contact pressure p and the contact zone {ψ ≥ 0} with the front c are

    w = θ (κ + 1) (x − c)_+^{3/2},   p = 3 (2μ_A θ̇ + 2μ_G θ) (c − x)_+^{1/2},   ψ = c − x,   c = 2/5,   θ(t) = 1/4 + 2t

on the bottom of the unit square. The elasticity is G = 2A, so κ = (λ_L + 3μ)/(λ_L + μ) is the same for A and G. At the
point between contact and separation without friction, a plane elastic body has Williams' field with the exponent 3/2,
which is half of the symmetric mode of a crack. Its potentials are Φ = i z^{3/2}, Ψ = −(i/2) z^{3/2} with
z = (x − c) + iy (``singular.kolosov``), and Div σ = 0. The displacement is this field times θ(t) and the cut-off
(1 − y)²(1 + 2y).

Predicted order 1: u(t) ∈ H^{1+s} for s < 3/2, so interpolation has order 1. The trace is u_ν(t) ∈ H^τ(Γ3) for τ < 2
only, which just violates (5.36), so Prop. 5.4 gives no order.

Source: M. L. Williams, J. Appl. Mech. 19 (1952) 526–528.
"""

from sympy import Expr, Rational

from manufactured.body import Kind, unit_square
from manufactured.case import Case
from manufactured.cases.laws import kolosov_constant, proportional, shearing
from manufactured.exact import ExactSolution
from manufactured.profile import cutoff
from manufactured.regularity import Regularity
from manufactured.singular import SingularFace, SingularField, TravellingField, kolosov
from manufactured.symbols import pos, s, t


def with_natural_front(theta: Expr, place: Expr, moving: bool = False) -> ExactSolution:
    """Return the solution with a natural front on the unit square.

    Args:
        theta: the formula of the factor θ(t).
        place: the position c of the front, a number or a formula of t.
        moving: whether the front moves.
    """
    body, law = unit_square(), proportional(2.0)
    (part,) = body.of(Kind.CONTACT)
    kappa = kolosov_constant(law.A)
    x, y = kolosov(kappa, 1j, -0.5j, 1.5)
    steady = SingularField((0 if moving else place, 0), part.frame, x, y, theta, depth=cutoff().b)
    field = TravellingField(steady, place) if moving else steady
    gap = (kappa + 1) * theta * pos(s - place, Rational(3, 2))
    pressure = 3 * shearing(law, theta * pos(place - s, Rational(1, 2)))
    face = SingularFace(part, gap, pressure, place - s, field, rough=() if moving else (place,))
    return ExactSolution(body, law, (face,))


def case() -> Case:
    return Case(
        name="natural-front",
        summary="the natural front of frictionless contact, w ~ r^{3/2}, fixed",
        solution=with_natural_front(Rational(1, 4) + 2 * t, Rational(2, 5)),
        regularity=Regularity(on_contact=1.5),
        order=1,
        reason="u(t) ∈ H^{5/2−ε} ⊂ H², so interpolation has order 1; the trace r^{3/2} just misses (5.36)",
        pace=1,
    )

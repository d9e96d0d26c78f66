"""The natural front of frictionless contact as it advances over a viscoelastic body.

    w = θ (κ + 1) (x − c)_+^{3/2},   p = 3 (2μ_A ∂_t + 2μ_G)(θ (c − x)_+^{1/2}),   ψ = c − x,   c(t) = 1/4 + 2t/5,

with θ(t) = 1/4 + t on the unit square, G = 2A: the field of ``cases.natural_front``, of which ∂_x has Div σ = 0 and the
same conditions on both sides of the front, moved with it. So u̇ ~ r^{1/2} and

    p = 3μ_A θ ċ (c − x)_+^{−1/2} + 6 (μ_A θ̇ + μ_G θ) (c − x)_+^{1/2},

which is not bounded, and no pressure if ċ < 0. Forces f_0 come from the cut-off alone and are ~ r^{1/2} at the front,
with rates ~ r^{−1/2}, and tractions f_2 are smooth: (3.4) holds as it is printed.

Predicted order 1: u(t) ∈ H^{1+s} for s < 3/2, so that the interpolation error of u has order 1. But u̇(t) ∈ H^{1+s}
for s < 1/2 only and p ∉ L²(Γ3), which misses both halves of (5.36). The proof of Prop. 5.4 gives 1/2, as does the
theorem on rollers up to a logarithm. ‖u̇ − Π^h u̇‖_V ~ h^{1/2} comes from the cells at the front, which it passes in a
time ~ h, so that each keeps ~ h^{3/2}; of h^{−1} independent ones that makes h, no more than the interpolation error.
"""

from __future__ import annotations

from sympy import Expr, Rational

from manufactured.body import Kind, unit_square
from manufactured.case import Case
from manufactured.cases.laws import kolosov_constant, proportional, shearing
from manufactured.exact import ExactSolution
from manufactured.profile import cutoff
from manufactured.regularity import Regularity
from manufactured.singular import SingularFace, SingularField, TravellingField, kolosov
from manufactured.symbols import pos, s, t

NAME = "natural-motion"
PLACE = Rational(1, 4) + Rational(2, 5) * t
"""The front c(t)."""


def natural_motion(place: Expr = PLACE) -> Case:
    """Return the case with the given front c(t). A receding front would pull, so its self-proof fails."""
    body, law = unit_square(), proportional(2.0)
    (part,) = body.of(Kind.CONTACT)
    theta, kappa = Rational(1, 4) + t, kolosov_constant(law.A)
    x, y = kolosov(kappa, 1j, -0.5j, 1.5)
    steady = SingularField(tuple(part.start), part.frame, x, y, theta, depth=cutoff().b)
    gap = (kappa + 1) * theta * pos(s - place, Rational(3, 2))
    pressure = 3 * shearing(law, theta * pos(place - s, Rational(1, 2)))
    face = SingularFace(part, gap, pressure, place - s, TravellingField(steady, place))
    return Case(
        name=NAME,
        summary="the natural front advances: w ~ r^{3/2}, p ~ r^{−1/2}",
        solution=ExactSolution(body, law, (face,)),
        regularity=Regularity(on_contact=1.5, moving=True),
        order=1,
        reason="u(t) ∈ H^{5/2−ε} ⊂ H², so interpolation has order 1; u̇(t) ∈ H^{3/2−ε}, and 1/2 is proved",
        pace=4,
    )

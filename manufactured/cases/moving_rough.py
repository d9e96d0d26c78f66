"""A moving front that violates (5.36): u(t) ∈ H², but u̇(t) only in H^{7/4−ε}.

The gap w, the contact pressure p, the contact zone {ψ ≥ 0} with the front c, and the normal strain q at t = 0 are

    w = 20 (1/5 + t) (x − c)_+^{13/4},   p = 150 (c − x)_+²,   ψ = c − x,   c(t) = 3/8 + t/4,   q(0) = −p(0)/g

on the bottom of the unit square, with g = G_nnnn. Viscosity A and elasticity G are not proportional.

Predicted order 1: the exponents of gap and pressure at the front are α = 13/4 and m = 2. So u(t) ∈ H^{1+s} for
s < min(α − 3/2, m − 1/2) = 3/2, and the interpolation error of u has order 1. α < 7/2 violates (5.36), so Prop. 5.4
gives no order.

ẇ ~ (x − c)_+^{9/4}, so ‖u̇ − Π^h u̇‖_V ~ h^{3/4}, and the proof of Prop. 5.4 gives the order α − 5/2 = 3/4. The
predicted order is higher because the front passes each cell in a time of order h. In this time a velocity error of
order h^{3/4} changes the displacement by h^{7/4} only.
"""

from sympy import Rational

from manufactured.body import unit_square
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.cases.shared import with_one_face
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def case() -> Case:
    c = Rational(3, 8) + t / 4
    solution = with_one_face(
        unit_square(),
        not_proportional(),
        gap=20 * (Rational(1, 5) + t) * pos(s - c, Rational(13, 4)),
        pressure=150 * pos(c - s, 2),
        level=c - s,
    )
    return Case(
        name="moving-rough",
        summary="advancing front with u(t) in H², u̇(t) not",
        solution=solution,
        regularity=Regularity(gap=3.25, pressure=2, moving=True),
        order=1,
        reason="u(t) ∈ H² for α = 13/4, m = 2: interpolation of order 1; the proof of 5.4 gives α − 5/2 = 3/4",
        pace=4,
    )

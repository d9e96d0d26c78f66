"""A body above a round foundation: the initial gap is a parabola, and a patch of contact lies around its apex.

The initial gap g, the gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} are

    g = 6 (x − 2/5)²,   w = 8 (1 + t) (−ψ)_+^4/(1/5 − ψ)³,   p = 500 ψ_+²,   z = t(1 + t) sin(2x + 1)/2,
    ψ = 1/16 + t(1 − t)/4 − (x − b(t))²,   b(t) = 9/20 + t/10

on the bottom of the unit square. Viscosity and elasticity are equal, A = G: τ ↦ 2τ + (tr τ)/2 I. The paper does not
treat this case: the initial gap g is not zero, and w = g − u_ν is the remaining gap.

Predicted order 1: u_ν = g − w on Γ3, where the polynomial g only adds a smooth field. Both fronts move. The exponents
of gap and pressure at the fronts, α = 4 > 7/2 and m = 2 > 3/2, give (5.36), with which the proof of Prop. 5.4 holds for
u minus a lifting of g.

The half-width of the patch is 1/4 at t = 0 and t = 1, and 0.35 at t = 1/2. In the patch the body takes the shape of the
foundation.
"""

from sympy import Rational

from manufactured.body import unit_square
from manufactured.case import Case
from manufactured.cases.laws import proportional
from manufactured.cases.shared import SLIP, with_one_face
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def case() -> Case:
    level = Rational(1, 16) + t * (1 - t) / 4 - (s - Rational(9, 20) - t / 10) ** 2
    solution = with_one_face(
        unit_square(),
        proportional(),
        gap=8 * (1 + t) * pos(-level, 4) / (Rational(1, 5) - level) ** 3,
        pressure=500 * pos(level, 2),
        level=level,
        initial_gap=6 * (s - Rational(2, 5)) ** 2,
        slip=(SLIP / 2,),
    )
    return Case(
        name="parabolic-gap",
        summary="initial gap above a round foundation, a patch about its apex slips, widens, narrows and drifts",
        solution=solution,
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="a parabola as initial gap adds a smooth field; α = 4 > 7/2 and m = 2 > 3/2 give (5.36): order 1",
        families=("shaken",),
    )

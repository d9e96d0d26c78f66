"""A body above a sloping foundation, which its left end reaches first.

The initial gap g, the gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} with the front c are

    g = 2/5 + x/5,   w = 2 (x − c)_+^4/(1/4 + (x − c)²),   p = 40 (c − x)_+²,   z = t(1 + t) sin(2x + 1)/2,
    ψ = c − x,   c(t) = −1/6 + 5t/6

on the bottom of the unit square. Viscosity A and elasticity G are not proportional. The paper does not treat this case:
the initial gap g is not zero, and w = g − u_ν is the remaining gap.

Predicted order 1: u_n = w − g on Γ3, and a linear g adds a smooth field. The front moves. The exponents of gap and
pressure at the front, α = 4 > 7/2 and m = 2 > 3/2, give (5.36), with which the proof of Prop. 5.4 holds for u minus a
lifting of g.

There is no contact before t = 1/5, when the front enters at the left end. At t = 1 the front is at x = 2/3, which is a
vertex of no structured mesh with 2^k cells along a side.
"""

from sympy import Rational

from manufactured.body import unit_square
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.cases.shared import SLIP, with_one_face
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def case() -> Case:
    c = Rational(-1, 6) + 5 * t / 6
    solution = with_one_face(
        unit_square(),
        not_proportional(),
        gap=2 * pos(s - c, 4) / (Rational(1, 4) + (s - c) ** 2),
        pressure=40 * pos(c - s, 2),
        level=c - s,
        initial_gap=(2 + s) / 5,
        slip=(SLIP / 2,),
    )
    return Case(
        name="closing-gap",
        summary="initial gap above a sloping foundation closes from the left, the face slips",
        solution=solution,
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="a linear initial gap adds a smooth field; α = 4 > 7/2 and m = 2 > 3/2 give (5.36): order 1",
        families=("criss-cross",),
    )

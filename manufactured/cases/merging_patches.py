"""Two patches of contact appear, merge into one and separate again.

The gap w, the contact pressure p, the normal strain q at t = 0 and the contact zone {ψ ≥ 0} are

    w = 8 (1/4 + 3t(1 − t)) (−ψ)_+^4/(1/5 − ψ)³,   p = 3000 ψ_+²,   q(0) = 0,
    ψ = −1/50 + (2/5) t(1 − t) − h(x),   h = 16 ((x − 1/4)(x − 7/10))²

on the bottom of the unit square. Viscosity A and elasticity G are not proportional.

Predicted order 1: all four fronts move. The exponents of gap and pressure at the fronts, α = 4 > 7/2 and m = 2 > 3/2,
give (5.36), so that Prop. 5.4 applies.

The patches appear at x = 1/4 and x = 7/10, merge, separate and vanish. The number of fronts is 0, 4, 2, 4, 0 in turn.
The denominator of w makes the gap flatter away from the fronts.
"""

from sympy import Rational

from manufactured.body import unit_square
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.cases.shared import with_one_face
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def case() -> Case:
    landscape = 16 * ((s - Rational(1, 4)) * (s - Rational(7, 10))) ** 2
    level = -Rational(1, 50) + Rational(2, 5) * t * (1 - t) - landscape
    solution = with_one_face(
        unit_square(),
        not_proportional(),
        gap=8 * (Rational(1, 4) + 3 * t * (1 - t)) * pos(-level, 4) / (Rational(1, 5) - level) ** 3,
        pressure=3000 * pos(level, 2),
        level=level,
    )
    return Case(
        name="merging-patches",
        summary="two patches are born, merge, part again and vanish",
        solution=solution,
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 at all four fronts give (5.36): order 1 by Prop. 5.4",
        pace=4,
        families=("shaken",),
    )

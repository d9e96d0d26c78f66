"""The unit cube above a foundation shaped like an upturned bowl, on which a disc of contact grows and moves.

The initial gap g, the gap w, the contact pressure p, the slip z, and the contact zone {ψ ≥ 0}, a disc with the centre
c, are

    g = 1/10 + (3/5)(x − 2/5)² + (2/5)(y − 3/5)²,   w = 2 (1/5 + t) (−ψ)_+^4/(1/2 − ψ)²,   p = 500 ψ_+²,
    z = (t(1 + t) sin(x + 2y)/6, −t cos(2x − y)/5),
    ψ = 1/10 + t/10 − |s − c(t)|²,   c(t) = (2/5 + t/10, 1/2 + t/20)

with the coordinates s = (x, y) along the bottom. Viscosity A and elasticity G are not proportional. The paper does not
treat this case: the initial gap g is not zero, and w = g − u_ν is the remaining gap.

Predicted order 1: u_n = w − g on Γ3 with a polynomial g, which adds a smooth field. The front moves. The exponents of
gap and pressure across the circle, α = 4 > 7/2 and m = 2 > 3/2, give (5.36). With (5.36) the proof of Prop. 5.4 holds
for u minus a lifting of g, also in 3D.
"""

from sympy import Rational, cos, sin

from manufactured.body import box
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.cases.shared import with_one_face
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s1, s2, t


def case() -> Case:
    half = Rational(1, 2)
    level = (1 + t) / 10 - (s1 - Rational(2, 5) - t / 10) ** 2 - (s2 - half - t / 20) ** 2
    solution = with_one_face(
        box(),
        not_proportional(3),
        gap=2 * (Rational(1, 5) + t) * pos(-level, 4) / (half - level) ** 2,
        pressure=500 * pos(level, 2),
        level=level,
        initial_gap=Rational(1, 10) + 3 * (s1 - Rational(2, 5)) ** 2 / 5 + 2 * (s2 - Rational(3, 5)) ** 2 / 5,
        slip=(t * (1 + t) * sin(s1 + 2 * s2) / 6, -t * cos(2 * s1 - s2) / 5),
    )
    return Case(
        name="cube-bowl",
        summary="cube above a bowl turned upside down, a disc of contact slips and grows",
        solution=solution,
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="a paraboloid as initial gap adds a smooth field; α = 4 > 7/2 and m = 2 > 3/2 give (5.36): order 1",
        pace=4,
    )

"""The unit cube with a disc of contact on its bottom that moves, grows and shrinks.

The gap w, the contact pressure p, the slip z, and the contact zone {ψ ≥ 0}, a disc with the centre c, are

    w = 2 (1/5 + t) (−ψ)_+^5/(1/2 − ψ)³,   p = 2000 ψ_+³,   z = (t(1 + t) sin(x + 2y)/4, −t cos(2x − y)/3),
    ψ = 1/10 + (3/5) t(1 − t) − |s − c(t)|²,   c(t) = (2/5 + t/5, 1/2)

with the coordinates s = (x, y) along the bottom. Viscosity A and elasticity G are not proportional.

Predicted order 1: the front moves. The exponents of gap and pressure across the circle, α = 5 > 7/2 and m = 3 > 3/2,
give (5.36), so that Prop. 5.4 applies; its proof also holds in 3D. The exponents also satisfy α > 9/2 and m > 5/2, so
(3.4) holds as it is printed.
"""

from sympy import Rational, cos, sin

from manufactured.body import box
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.cases.shared import with_one_face
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s1, s2, t


def case() -> Case:
    level = (
        Rational(1, 10) + Rational(3, 5) * t * (1 - t) - (s1 - Rational(2, 5) - t / 5) ** 2 - (s2 - Rational(1, 2)) ** 2
    )
    solution = with_one_face(
        box(),
        not_proportional(3),
        gap=2 * (Rational(1, 5) + t) * pos(-level, 5) / (Rational(1, 2) - level) ** 3,
        pressure=2000 * pos(level, 3),
        level=level,
        slip=(t * (1 + t) * sin(s1 + 2 * s2) / 4, -t * cos(2 * s1 - s2) / 3),
    )
    return Case(
        name="cube-disc",
        summary="cube, a disc of contact slips, moves, grows and shrinks",
        solution=solution,
        regularity=Regularity(gap=5, pressure=3, moving=True),
        order=1,
        reason="α = 5 > 7/2 and m = 3 > 3/2 across the circle give (5.36): order 1 by Prop. 5.4, in 3D, too",
        pace=4,
    )

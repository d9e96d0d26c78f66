"""The unit cube with a disc of contact on its bottom that moves, grows and shrinks.

The gap w, the contact pressure p, the normal strain q at t = 0, and the contact zone {ψ ≥ 0}, a disc with the centre c,
are

    w = 2 (1/5 + t) (−ψ)_+^4/(1/2 − ψ)²,   p = 500 ψ_+²,   q(0) = −p(0)/g,
    ψ = 1/10 + (3/5) t(1 − t) − |s − c(t)|²,   c(t) = (2/5 + t/5, 1/2)

with the coordinates s = (x, y) along the bottom and g = G_nnnn. Viscosity A and elasticity G are not proportional.

Predicted order 1: the front moves. The exponents of gap and pressure across the circle, α = 4 > 7/2 and m = 2 > 3/2,
give (5.36), so that Prop. 5.4 applies; its proof also holds in 3D.
"""

from sympy import Rational

from manufactured.body import Kind, box
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s1, s2, t


def case() -> Case:
    body = box()
    law = not_proportional(3)
    (part,) = body.of(Kind.CONTACT)
    level = (
        Rational(1, 10) + Rational(3, 5) * t * (1 - t) - (s1 - Rational(2, 5) - t / 5) ** 2 - (s2 - Rational(1, 2)) ** 2
    )
    gap = 2 * (Rational(1, 5) + t) * pos(-level, 4) / (Rational(1, 2) - level) ** 2
    face = ContactFace.linear(part, law, body.T, gap, 500 * pos(level, 2), level)
    return Case(
        name="cube-disc",
        summary="cube, a disc of contact moves, grows and shrinks",
        solution=ExactSolution(body, law, (face,)),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 across the circle give (5.36): order 1 by Prop. 5.4, in 3D, too",
        pace=4,
    )

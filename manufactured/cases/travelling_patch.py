"""A contact patch that appears, travels and vanishes.

The gap w, the contact pressure p, the normal strain q at t = 0, and the contact zone {ψ ≥ 0} with the centre b are

    w = 60 (1/4 + 3t(1 − t)) (−ψ)_+^4,   p = 3000 ψ_+²,   q(0) = 0,
    ψ = (3/4)(t − 1/8)(7/8 − t) − (x − b(t))²,   b(t) = 3/10 + 2t/5

on the bottom of the unit square. Viscosity A and elasticity G are not proportional.

Predicted order 1: the fronts move. The exponents of gap and pressure at the fronts, α = 4 > 7/2 and m = 2 > 3/2, give
(5.36), so that Prop. 5.4 applies.

The patch appears at t = 1/8, travels from left to right and vanishes at t = 7/8; its largest half-width is 0.32. When
it appears and vanishes, the speed of its fronts is infinite. The gap is largest between these times, so that the error
is largest while the contact zone moves.
"""

from sympy import Rational

from manufactured.body import Kind, unit_square
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def case() -> Case:
    body = unit_square()
    law = not_proportional()
    (part,) = body.of(Kind.CONTACT)
    b = Rational(3, 10) + 2 * t / 5
    level = Rational(3, 4) * (t - Rational(1, 8)) * (Rational(7, 8) - t) - (s - b) ** 2
    gap = 60 * (Rational(1, 4) + 3 * t * (1 - t)) * pos(-level, 4)
    pressure = 3000 * pos(level, 2)
    return Case(
        name="travelling-patch",
        summary="patch is born at t = 1/8, travels, vanishes at t = 7/8",
        solution=ExactSolution(body, law, (ContactFace.linear(part, law, body.T, gap, pressure, level),)),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 give (5.36): order 1 by Prop. 5.4",
        pace=10,
        families=("criss-cross",),
    )

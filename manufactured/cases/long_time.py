"""A contact front that moves periodically, four periods until T = 20, which is twenty relaxation times of the material.

The gap w, the contact pressure p, the contact zone {ψ ≥ 0} with the front c, and the normal strain q at t = 0 are

    w = 20 (x − c)_+^4,   p = 20 (c − x)_+²,   ψ = c − x,   c(t) = 1/2 + cos(2πt/5)/4,   q(0) = −2p(0)/5

on the bottom of the unit square. Viscosity and elasticity are equal, A = G: τ ↦ 2τ + (tr τ)/2 I, so that strains of
earlier contact decay like e^{−t}.

Predicted order 1: the front moves. The exponents of gap and pressure at the front, α = 4 > 7/2 and m = 2 > 3/2, give
(5.36), so that Prop. 5.4 applies for every T. The constant of its proof may grow like e^{T L_G/m_A} = e^{40}. But G is
monotone, and the error is predicted to be equally large in every period: most of it is interpolation error, which is
periodic once the effect of the initial strain has decayed.

In a first version G was A/5 and steps were 1.5 times as long. In that version 2.1 % of the error was due to the time
discretisation on the coarsest criss-cross mesh.
"""

from sympy import Rational, cos, pi

from manufactured.body import Kind, unit_square
from manufactured.case import Case
from manufactured.cases.laws import proportional
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def case() -> Case:
    body, law = unit_square(T=20.0), proportional()
    c = Rational(1, 2) + cos(2 * pi * t / 5) / 4
    (part,) = body.of(Kind.CONTACT)
    face = ContactFace.linear(part, law, body.T, 20 * pos(s - c, 4), 20 * pos(c - s, 2), c - s)
    return Case(
        name="long-time",
        summary="four periods of contact until T = 20",
        solution=ExactSolution(body, law, (face,)),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 give (5.36), for every T: order 1 by Prop. 5.4",
        pace=1.5,
    )

"""An oblique front that moves over the bottom of a cube; the solution is not smooth enough for (5.36).

The gap w, the contact pressure p, the contact zone {ψ ≥ 0} with the front x + y/2 = c, and the normal strain q at t = 0
are

    w = 20 (1/5 + t) (−ψ)_+^{13/4},   p = 150 ψ_+²,   ψ = c(t) − (x + y/2),   c(t) = 1/2 + t/4,   q(0) = −p(0)/g

on the bottom of the unit cube, with the coordinates (x, y) and g = G_nnnn. Viscosity A and elasticity G are not
proportional. The front is parallel to no edge of the meshes. This is the case ``moving-rough`` in 3D.

Predicted order 1: the exponents of gap and pressure at the front are α = 13/4 and m = 2. So u(t) ∈ H^{1+s} for
s < min(α − 3/2, m − 1/2) = 3/2, and the interpolation error of u has order 1. α < 7/2 violates (5.36), so Prop. 5.4
gives no order. The observed orders are predicted to rise towards 1 from below: on the coarsest meshes the cells are as
large as the layer in which w and p change.
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
    body, law = box(), not_proportional(3)
    (part,) = body.of(Kind.CONTACT)
    level = Rational(1, 2) + t / 4 - (s1 + s2 / 2)
    gap = 20 * (Rational(1, 5) + t) * pos(-level, Rational(13, 4))
    face = ContactFace.linear(part, law, body.T, gap, 150 * pos(level, 2), level)
    return Case(
        name="cube-rough",
        summary="cube, an oblique front with u(t) in H², u̇(t) not",
        solution=ExactSolution(body, law, (face,)),
        regularity=Regularity(gap=3.25, pressure=2, moving=True),
        order=1,
        reason="u(t) ∈ H² for α = 13/4, m = 2 across the front: interpolation of order 1; α < 7/2 misses (5.36)",
        pace=2,
    )

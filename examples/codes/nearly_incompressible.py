"""A front that advances and recedes over a nearly incompressible body, ν = 0.495 in plane strain.

    w = 20 (x − c)_+^4,   p = 400 (c − x)_+²,   ψ = c − x,   c(t) = 1/4 + 2t(1 − t),   q(0) = −p(0)/102

on the unit square; A: τ ↦ 2τ + (tr τ) I, G: τ ↦ 2τ + 100 (tr τ) I.

Predicted order 1: as in *advance-recede*, from which it differs by constants, Prop. 5.4 applies, but with a constant
that λ enters: linear elements lock, and what is seen on coarse meshes may be less.
"""

from sympy import Rational

from manufactured.body import Kind, unit_square
from manufactured.case import Case
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.law import KelvinVoigt, isotropic
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def case() -> Case:
    body, law = unit_square(), KelvinVoigt(isotropic(1, 1), isotropic(1, 100), "linear, G nearly incompressible")
    c = Rational(1, 4) + 2 * t * (1 - t)
    (part,) = body.of(Kind.CONTACT)
    face = ContactFace.linear(part, law, body.T, 20 * pos(s - c, 4), 400 * pos(c - s, 2), c - s)
    return Case(
        name="nearly-incompressible",
        summary="front advances and recedes, ν = 0.495",
        solution=ExactSolution(body, law, (face,)),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 give (5.36): order 1 by Prop. 5.4, with a constant that λ enters",
    )

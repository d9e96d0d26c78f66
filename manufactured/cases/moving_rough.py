"""A moving front too rough for (5.36): u(t) ∈ H², but u̇(t) only in H^{3/2−ε}.

    w = 20 (x − c)_+³,   p = 60 (c − x)_+²,   c(t) = 1/4 + t/2,   q(0) = −p(0)/g

on the unit square, A and G not proportional. ẇ ~ (x − c)_+², so ‖u̇ − Π^h u̇‖_V ~ h^{1/2} and the proof of
Prop. 5.4 gives the order 1/2. The interpolation error of u itself has order 1, and the front passes
each cell in a time of order h, in which a rate that is wrong by h^{1/2} leaves no more than h^{3/2} behind:
order 1 is predicted.
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
    c = Rational(1, 4) + t / 2
    (part,) = body.of(Kind.CONTACT)
    face = ContactFace.linear(part, law, body.T, 20 * pos(s - c, 3), 60 * pos(c - s, 2), c - s)
    return Case(
        name="moving-rough",
        summary="advancing front with u(t) in H², u̇(t) not",
        solution=ExactSolution(body, law, (face,)),
        regularity=Regularity(gap=3, pressure=2, moving=True),
        order=1,
        reason="u(t) ∈ H² for α = 3 > 5/2, m = 2 > 3/2: order 1 of interpolation; the proof of 5.4 gives α − 5/2 = 1/2",
    )

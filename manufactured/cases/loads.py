"""A load that is little more than W^{1,1} in time.

    ε_nn = q = −(1 + 4x(1 − x)) (t + (t − t_0)_+^{5/4}/4),   t_0 = 9/20,   w = 0

on the unit square under full contact; p = −(a q̇ + g q) ≥ 0. With u̇ ~ (t − t_0)^{1/4} the load has
ḟ ~ (t − t_0)^{−3/4}: f ∈ W^{1,1}(0,T;V), (3.8), in no W^{1,r} with r ≥ 4/3. Since u̇ is bounded and smooth in
space, (5.36) holds all the same.
"""

from sympy import Integer, Rational

from manufactured.body import Kind, unit_square
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.memory import Prescribed
from manufactured.profile import PARABOLA, cutoff
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def case() -> Case:
    body = unit_square()
    law = not_proportional()
    (part,) = body.of(Kind.CONTACT)
    strain = -(1 + 4 * s * (1 - s)) * (t + pos(t - Rational(9, 20), Rational(5, 4)) / 4)
    face = ContactFace(part, Integer(0), Prescribed(((body.T, strain),)), Integer(1), cutoff(phi=PARABOLA))
    return Case(
        name="load-w11",
        summary="full contact under a load in W^{1,r}(0,T) for r < 4/3 only",
        solution=ExactSolution(body, law, (face,)),
        regularity=Regularity(),
        order=1,
        reason="u̇ bounded with values in H²: (5.36) needs no more of the load, order 1 by Prop. 5.4",
        pace=16,
    )

"""Full contact under a load that is hardly smoother in time than W^{1,1}, as the paper requires.

The gap w, the contact pressure p, the slip z, the contact zone {ψ ≥ 0} and the normal strain q are

    w = 0,   p = (1 + 4x(1 − x)) (a θ̇ + g θ) − ∂_s ż/2 − 3 ∂_s z,   z = 2t(3/2 − t) cos(x),   ψ = 1,
    ε_nn = q = −(1 + 4x(1 − x)) θ,   θ(t) = t + (t − t_0)_+^{5/4}/4,   t_0 = 9/20,   φ(y) = 1 − y²

on the bottom of the unit square, where the cut-off φ lets the displacement end at the top. Viscosity A and elasticity G
are not proportional; their normal moduli are a = 5/2 and g = 7, and A_nnss = 1/2 and G_nnss = 3. The final time is
T = 3/2, so that a time step 1/n is not T/n. The slip turns round at t = 3/4.

Predicted order 1: there is no front. θ̇ is bounded and all functions are smooth in space, so u̇ is bounded with values
in H². This gives (5.36), so that Prop. 5.4 applies.

One could expect that only Prop. 5.3, which gives no order, applies to such a load. The loads contain θ̇ with the term
(t − t_0)_+^{1/4}, so ḟ ~ (t − t_0)^{−3/4}, and the loads are in W^{1,r}(0,T) for r < 4/3 only. But both propositions
require of the loads no more than W^{1,1}, (3.4) and (3.8). The further assumptions of Prop. 5.4 are on the solution:
(4.12), which holds because p is bounded, and (5.36).
"""

from sympy import Rational, cos

from manufactured.body import Kind, unit_square
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.face_strain import Prescribed
from manufactured.profile import PARABOLA, cutoff
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def case() -> Case:
    body = unit_square(T=1.5)
    law = not_proportional()
    (part,) = body.of(Kind.CONTACT)
    strain = -(1 + 4 * s * (1 - s)) * (t + pos(t - Rational(9, 20), Rational(5, 4)) / 4)
    slip = 2 * t * (Rational(3, 2) - t) * cos(s)
    face = ContactFace(part, 0, Prescribed(((body.T, strain),)), 1, cutoff(phi=PARABOLA), slip=(slip,))
    return Case(
        name="load-w11",
        summary="full contact under a load in W^{1,r}(0,T) for r < 4/3 only",
        solution=ExactSolution(body, law, (face,)),
        regularity=Regularity(),
        order=1,
        reason="u̇ bounded with values in H²: (5.36) needs no more of the load, order 1 by Prop. 5.4",
        pace=16,
        families=("one-diagonal",),
    )

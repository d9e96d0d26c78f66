"""No contact at any time; a strain from earlier contact relaxes.

The gap w, the contact pressure p, the contact zone {ψ ≥ 0}, which is empty, and the normal strain q at t = 0 are

    w = (1/10 + t²)(1 + 4x(1 − x)),   p = 0,   ψ = −1,   q(0) = −x(1 − x)

on the bottom of the unit square. Viscosity A and elasticity G are not proportional.

Predicted order 1: there is no front, and w and q are smooth in space and time, which gives (5.36), so that Prop. 5.4
applies.

Signorini's condition is never active, so the scheme must solve the linear problem. The initial strain q(0) relaxes like
e^{−gt/a} with a = A_nnnn and g = G_nnnn.
"""

from sympy import Rational

from manufactured.body import unit_square
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.cases.shared import with_one_face
from manufactured.regularity import Regularity
from manufactured.symbols import s, t


def case() -> Case:
    solution = with_one_face(
        unit_square(),
        not_proportional(),
        gap=(Rational(1, 10) + t**2) * (1 + 4 * s * (1 - s)),
        pressure=0,
        level=-1,
        initial=-s * (1 - s),
    )
    return Case(
        name="no-contact",
        summary="no contact at any time, a strain from earlier contact relaxes",
        solution=solution,
        regularity=Regularity(),
        order=1,
        reason="no front, u smooth in space and time: (5.36) and order 1 by Prop. 5.4",
        pace=4,
        families=("criss-cross",),
    )

"""The whole of the contact boundary stays in contact while the pressure grows from zero.

The gap w, the contact pressure p, the slip z, the contact zone {ψ ≥ 0} and the normal strain q at t = 0 are

    w = 0,   p = 20 t (1 + 4 x(1 − x)),   z = t(1 + t) sin(2x + 1)/2,   ψ = 1,   q(0) = 0,   φ(y) = 1 − y²

on the bottom of the unit square, where the cut-off φ lets the displacement end at the top. Viscosity A and elasticity G
are not proportional.

Predicted order 1: there is no front, and w and q are smooth in space and time, which gives (5.36), so that Prop. 5.4
applies.

The body starts at rest, u_0 = 0, so the error is zero at t = 0 and grows with the pressure. With this cut-off φ, the
traction on the clamped boundary is not zero.
"""

from manufactured.body import unit_square
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.cases.shared import SLIP, with_one_face
from manufactured.profile import PARABOLA, cutoff
from manufactured.regularity import Regularity
from manufactured.symbols import s, t


def case() -> Case:
    solution = with_one_face(
        unit_square(),
        not_proportional(),
        gap=0,
        pressure=20 * t * (1 + 4 * s * (1 - s)),
        level=1,
        initial=0,
        profile=cutoff(phi=PARABOLA),
        slip=(SLIP / 2,),
    )
    return Case(
        name="full-contact",
        summary="all of Γ3 in contact at all times, pressure growing from zero",
        solution=solution,
        regularity=Regularity(),
        order=1,
        reason="no front, u smooth in space and time: (5.36) and order 1 by Prop. 5.4",
        pace=4,
        families=("one-diagonal",),
    )

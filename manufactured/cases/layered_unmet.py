"""Full contact of a body of two layers; the interface cuts through cells of the meshes.

The gap w, the contact pressure p, the contact zone {ψ ≥ 0} and the normal strain q at t = 0 are

    w = 0,   p = 20 t (1 + x(1 − x)),   ψ = 1,   q(0) = 0

on the bottom of the unit square. Viscosity A and elasticity G are not proportional, and for y > 1/3 both are 10 times
as large. At y = 1/3 the displacement has a kink that keeps σν continuous (``profile.layered``).

Predicted order 1/2: the strain jumps inside cells, so u(t) ∈ H^{1+s} for s < 1/2 only, and interpolation has the
order 1/2. Prop. 5.3 gives no order.

Apart from the kink the solution is smooth, so the kink causes most of the error.
"""

from manufactured.body import unit_square
from manufactured.case import Case
from manufactured.cases.laws import two_layers
from manufactured.cases.shared import with_one_face
from manufactured.profile import layered
from manufactured.regularity import Regularity
from manufactured.symbols import s, t


def case() -> Case:
    solution = with_one_face(
        unit_square(),
        two_layers(1 / 3, 10.0),
        gap=0,
        pressure=20 * t * (1 + s * (1 - s)),
        level=1,
        profile=layered(1 / 3, 10.0),
    )
    return Case(
        name="layered-unmet",
        summary="two layers, the interface y = 1/3 is met by no mesh",
        solution=solution,
        regularity=Regularity(kink=True),
        order=0.5,
        reason="the strain jumps inside cells: u(t) ∈ H^{1+s} for s < 1/2, interpolation of order 1/2, no rate claimed",
        pace=1,
    )

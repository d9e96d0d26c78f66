"""An advancing contact front on a body of two layers; the interface consists of edges of every mesh.

The gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} with the front c are

    w = 8 (1/5 + t) (x − c)_+^4,   p = 400 (c − x)_+³,   z = t(1 + t) sin(2x + 1),   ψ = c − x,   c(t) = 1/4 + t/2

on the bottom of the unit square. Viscosity A and elasticity G are not proportional, and for y > 1/2 both are 4 times as
large. At y = 1/2 the displacement has a kink that keeps σν continuous (``profile.layered``). In the upper layer u_s
contains ∇_s q, the derivative of the normal strain q.

Predicted order 1: the front moves, and the gap has the exponent α = 4 > 7/2 there. The term ∇_s q lowers the exponent
m = 3 of the pressure by one, to 2 > 3/2. This gives (5.36) in each layer, but not across the interface. That is enough:
the proof of Prop. 5.4 uses H² in (5.23) cell by cell, and no cell lies in both layers.
"""

from manufactured.body import Kind, polygon
from manufactured.case import Case
from manufactured.cases.laws import two_layers
from manufactured.cases.shared import FRONT, advancing_front
from manufactured.profile import layered
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s


def case() -> Case:
    sides = [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED]
    body = polygon([(0, 0), (1, 0), (1, 1), (0, 1)], sides, interfaces=[((0, 0.5), (1, 0.5))])
    return Case(
        name="layered",
        summary="two layers, the interface y = 1/2 is met by the meshes",
        solution=advancing_front(body, two_layers(0.5, 4.0), layered(0.5, 4.0), 400 * pos(FRONT - s, 3)),
        regularity=Regularity(gap=4, pressure=3, moving=True),
        order=1,
        reason="α = 4, m = 3, less one for ∇_s q: (5.36) in each layer, not across; (5.23) is cell by cell: order 1",
        pace=4,
        families=("criss-cross",),
    )

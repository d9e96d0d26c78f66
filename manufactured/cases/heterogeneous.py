"""An advancing contact front on a heterogeneous body: A and G vary smoothly with different factors.

The gap w, the contact pressure p, the slip z, the contact zone {ψ ≥ 0} with the front c, the viscosity A and the
elasticity G are

    w = 8 (1/5 + t) (x − c)_+^4,   p = 150 (c − x)_+²,   z = t(1 + t) sin(2x + 1),   ψ = c − x,   c(t) = 1/4 + t/2,
    A(x, y) = (1 + x/2)(1 + y) A,   G(x, y) = (1 + x/2)(1 + 3y²) G

on the unit square, with contact on its bottom. The tensors A and G are not proportional. At y = 0 both factors are
equal, so the relaxation rate G_nnnn/A_nnnn is constant on Γ3, which the exact solution needs. Inside the body the
factors differ.

Predicted order 1: the front moves. The coefficients are smooth, so the exponents of gap and pressure at the front,
α = 4 > 7/2 and m = 2 > 3/2, give (5.36), and Prop. 5.4 applies.
"""

from manufactured.body import unit_square
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.cases.shared import FRONT, advancing_front
from manufactured.factor import Factor, x1, x2
from manufactured.profile import cutoff
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s


def case() -> Case:
    along = 1 + x1 / 2
    viscous, elastic = Factor(along * (1 + x2), 1.0, 3.0), Factor(along * (1 + 3 * x2**2), 1.0, 6.0)
    law = not_proportional(2, viscous, elastic)
    return Case(
        name="heterogeneous",
        summary="advancing front, A and G vary smoothly in different ways",
        solution=advancing_front(unit_square(), law, cutoff(), 150 * pos(FRONT - s, 2)),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="smooth coefficients do not change the regularity: α = 4, m = 2, (5.36) and order 1 by Prop. 5.4",
        pace=4,
        families=("one-diagonal",),
    )

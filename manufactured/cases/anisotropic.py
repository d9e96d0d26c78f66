"""An advancing contact front on an anisotropic body, whose normal and shear strains are coupled on Γ3.

The gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} with the front c are

    w = 8 (1/5 + t) (x − c)_+^4,   p = 150 (c − x)_+²,   z = t(1 + t) sin(2x + 1),   ψ = c − x,   c(t) = 1/4 + t/2

on the bottom of the unit square. Viscosity A and elasticity G are orthotropic with different axes
(``laws.anisotropic``), so they couple the normal strain q = ε_nn and ε_ss with ε_sn. A shear strain r(x, t) on Γ3 keeps
σ_τ = 0.

Predicted order 1: the front moves. q and r have the exponent m = 2 > 3/2 of p at the front, and w has the exponent
α = 4 > 7/2. This gives (5.36), so that Prop. 5.4 applies.
"""

from manufactured.body import unit_square
from manufactured.case import Case
from manufactured.cases import laws
from manufactured.cases.shared import FRONT, advancing_front
from manufactured.profile import cutoff
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s


def case() -> Case:
    return Case(
        name="anisotropic",
        summary="advancing front, A and G anisotropic with different axes",
        solution=advancing_front(unit_square(), laws.anisotropic(), cutoff(), 150 * pos(FRONT - s, 2)),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="r and q inherit m = 2 from p, α = 4: (5.36) and order 1 by Prop. 5.4",
        pace=4,
        families=("unstructured",),
    )

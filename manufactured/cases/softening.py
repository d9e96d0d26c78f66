"""A front that advances and recedes on a material that softens in volume: G is symmetric but not positive.

The gap w, the contact pressure p, the slip z, the contact zone {ψ ≥ 0} with the front c, and the normal strain q at
t = 0 are

    w = 20 (1 + t) (x − c)_+^5,   p = 20 (c − x)_+³,   z = 4t sin(3x + 1/2),   ψ = c − x,
    c(t) = 7/24 + 15t(1 − t)/8,   q(0) = 0

on the bottom of the unit square. The viscosity is A τ = 2τ + (tr τ)/2 I with m_A = 2. The elasticity G τ = τ − (3/2)(tr
τ) I has the eigenvalues 1 in shear and −2 in volume. The normal moduli are a = 5/2 and g = −1/2.

Predicted order 1: the front moves. The exponents of gap and pressure at the front, α = 5 > 7/2 and m = 3 > 3/2, give
(5.36), so that Prop. 5.4 applies, for which it is enough that G is Lipschitz. The exponents also satisfy α > 9/2 and
m > 5/2, so (3.4) holds as it is printed.

G is not monotone, and L_G/m_A = 1. The strain that the pressure has caused does not decay but grows like e^{t/5}.
Errors may grow like e^{2t/3}. The problem of a time step of length k is known to have a unique solution for k < 1.

In a first version the eigenvalue in volume was −5 and the gap did not grow. In that version ‖Π^h u − u^h‖ may grow like
e^{5t/3}. On the mesh with n = 8 cells along a side it was 0.65 ‖u − Π^h u‖, and the check that (‖u − u^h‖² + ‖Π^h u −
u^h‖²)^{1/2} is about ‖u − Π^h u‖ failed with the quotient 1.15.
"""

from sympy import Rational, sin

from manufactured.body import unit_square
from manufactured.case import Case
from manufactured.cases.laws import softening_in_volume
from manufactured.cases.shared import with_one_face
from manufactured.exact import ExactSolution
from manufactured.law import KelvinVoigt
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def softening(law: KelvinVoigt) -> ExactSolution:
    """Return the solution for a law whose normal modulus of viscosity is positive."""
    c = Rational(7, 24) + Rational(15, 8) * t * (1 - t)
    return with_one_face(
        unit_square(),
        law,
        gap=20 * (1 + t) * pos(s - c, 5),
        pressure=20 * pos(c - s, 3),
        level=c - s,
        initial=0,
        slip=(4 * t * sin(3 * s + Rational(1, 2)),),
    )


def case() -> Case:
    return Case(
        name="softening",
        summary="front advances and recedes, the face slips, G softens in volume, memory grows",
        solution=softening(softening_in_volume()),
        regularity=Regularity(gap=5, pressure=3, moving=True),
        order=1,
        reason="α = 5 > 7/2 and m = 3 > 3/2 give (5.36): order 1 by Prop. 5.4, G only Lipschitz",
        families=("one-diagonal",),
    )

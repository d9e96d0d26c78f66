"""A contact patch that appears, travels and vanishes, on a face that slips.

The gap w, the contact pressure p, the slip z, and the contact zone {ψ ≥ 0} with the centre b are

    w = 80 (1/4 + 3t(1 − t)) (−ψ)_+^5,   p = 20000 ψ_+³,   z = 3t² sin(2x + 1),
    ψ = (3/4)(t − 1/8)(7/8 − t) − (x − b(t))²,   b(t) = 3/10 + 2t/5

on the bottom of the unit square. Viscosity A and elasticity G are not proportional.

Predicted order 1: the fronts move. The exponents of gap and pressure at the fronts, α = 5 > 7/2 and m = 3 > 3/2, give
(5.36), so that Prop. 5.4 applies. The exponents also satisfy α > 9/2 and m > 5/2, so (3.4) holds as it is printed.

The patch appears at t = 1/8, travels from left to right and vanishes at t = 7/8; its largest half-width is 0.32. When
it appears and vanishes, the speed of its fronts is infinite. The gap is largest between these times, so that the error
is largest while the contact zone moves.
"""

from sympy import Rational, sin

from manufactured.body import unit_square
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.cases.shared import with_one_face
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def case() -> Case:
    b = Rational(3, 10) + 2 * t / 5
    level = Rational(3, 4) * (t - Rational(1, 8)) * (Rational(7, 8) - t) - (s - b) ** 2
    solution = with_one_face(
        unit_square(),
        not_proportional(),
        gap=80 * (Rational(1, 4) + 3 * t * (1 - t)) * pos(-level, 5),
        pressure=20000 * pos(level, 3),
        level=level,
        slip=(3 * t**2 * sin(2 * s + 1),),
    )
    return Case(
        name="travelling-patch",
        summary="patch is born at t = 1/8, travels on a face that slips, vanishes at t = 7/8",
        solution=solution,
        regularity=Regularity(gap=5, pressure=3, moving=True),
        order=1,
        reason="α = 5 > 7/2 and m = 3 > 3/2 give (5.36): order 1 by Prop. 5.4",
        pace=10,
        families=("criss-cross",),
    )

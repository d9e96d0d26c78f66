"""A contact front that advances and then recedes while the face slips; where it has been, the strain decays slowly.

The gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} with the front c are

    w = 20 (x − c)_+^4,   p = 20 (c − x)_+²,   z = 4t sin(3x + 1/2),   ψ = c − x,   c(t) = 1/4 + 2t(1 − t)

on the bottom of the unit square. Viscosity and elasticity are equal, A = G: τ ↦ 2τ + (tr τ)/2 I, so their normal moduli
are a = g = 5/2.

Predicted order 1: the front moves. The exponents of gap and pressure at the front, α = 4 > 7/2 and m = 2 > 3/2, give
(5.36), so that Prop. 5.4 applies.

The front moves from 1/4 to 3/4 and back. Where it has receded, the strain q that the pressure has caused decays like
e^{−t}.
"""

from sympy import Rational, sin

from manufactured.body import Body, unit_square
from manufactured.case import Case
from manufactured.cases.laws import proportional
from manufactured.cases.shared import with_one_face
from manufactured.exact import ExactSolution
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def on(body: Body) -> ExactSolution:
    """Return the solution on a unit square that may be rotated and translated."""
    c = Rational(1, 4) + 2 * t * (1 - t)
    return with_one_face(
        body,
        proportional(),
        gap=20 * pos(s - c, 4),
        pressure=20 * pos(c - s, 2),
        level=c - s,
        slip=(4 * t * sin(3 * s + Rational(1, 2)),),
    )


def case() -> Case:
    return Case(
        name="advance-recede",
        summary="front advances to 3/4 and recedes, the face slips, and the material remembers",
        solution=on(unit_square()),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 give (5.36): order 1 by Prop. 5.4",
        families=("one-diagonal",),
    )

"""A fixed contact zone with a growing pressure and a growing gap; its front is at a vertex of the meshes.

The gap w, the contact pressure p, the contact zone {ψ ≥ 0} with the front c, and the normal strain q at t = 0 are

    w = 10 t (x − c)_+³,   p = 400 t (c − x)_+²,   ψ = c − x,   c = 1/2,   q(0) = 0,   φ(y) = 1 − y²

on the bottom of the unit square, where the cut-off φ lets the displacement end at the top. Viscosity A and elasticity G
are not proportional.

Predicted order 1: the front is fixed. The exponents of gap and pressure at the front, α = 3 > 5/2 and m = 2 > 3/2, give
u ∈ W^{1,∞}(0,T;H²) and (5.36), so that Prop. 5.4 applies.

c = 1/2 is a vertex of every structured mesh with an even number of cells along a side. With this cut-off φ, the
traction on the clamped boundary is not zero.
"""

from sympy import Expr, Rational

from manufactured.body import Kind, unit_square
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.profile import PARABOLA, cutoff
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def at(c: Expr) -> ExactSolution:
    """Return the solution with the contact front at x = c."""
    body = unit_square()
    law = not_proportional()
    (part,) = body.of(Kind.CONTACT)
    gap, pressure = 10 * t * pos(s - c, 3), 400 * t * pos(c - s, 2)
    face = ContactFace.linear(part, law, body.T, gap, pressure, c - s, profile=cutoff(phi=PARABOLA), rough=(float(c),))
    return ExactSolution(body, law, (face,))


def case() -> Case:
    return Case(
        name="fixed-front-on-vertex",
        summary="zone [0, 1/2] that stays, front on a vertex",
        solution=at(Rational(1, 2)),
        regularity=Regularity(gap=3, pressure=2),
        order=1,
        reason="fixed front with α = 3 > 5/2 and m = 2 > 3/2: u(t) ∈ H², (5.36) and order 1 by Prop. 5.4",
        pace=2,
        families=("shaken",),
    )

"""A fixed front at which the strain is unbounded: gap and pressure behave like r^{7/4} and r^{3/4}.

The gap w, the contact pressure p, the contact zone {ψ ≥ 0} with the front c, and the normal strain q at t = 0 are

    w = 60 t (x − c)_+^{7/4} (1 − x)²,   p = 200 t (c − x)_+^{3/4} x²,   ψ = c − x,   c = 1/3,   q(0) = 0

on the bottom of the unit square. Viscosity A and elasticity G are not proportional.

Predicted order 1/4: the exponents of gap and pressure are α = 7/4 and m = 3/4. So u(t) ∈ H^{1+s} for
s < min(α − 3/2, m − 1/2) = 1/4, and interpolation has the order 1/4. Prop. 5.3 gives convergence but no order.

c is not a vertex of the structured meshes. The factors (1 − x)² and x² make the error far from the front, of order 1,
small compared with the error at the front.
"""

from sympy import Rational

from manufactured.body import unit_square
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.cases.shared import with_one_face
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def case() -> Case:
    c = Rational(1, 3)
    solution = with_one_face(
        unit_square(),
        not_proportional(),
        gap=60 * t * pos(s - c, Rational(7, 4)) * (1 - s) ** 2,
        pressure=200 * t * pos(c - s, Rational(3, 4)) * s**2,
        level=c - s,
        rough=(c,),
    )
    return Case(
        name="rough-1.75",
        summary="fixed front with w ~ r^1.75, p ~ r^0.75",
        solution=solution,
        regularity=Regularity(gap=1.75, pressure=0.75),
        order=0.25,
        reason="u(t) ∈ H^(1+s) for s < α − 3/2 = 0.25: interpolation of that order, no rate claimed",
        pace=1,
    )

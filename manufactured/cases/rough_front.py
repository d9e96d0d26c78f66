"""A fixed front with any exponent 3/2 < α < 5/2, which violates (5.36): ``rough_1_75``, ``rough_2``, ``rough_2_25``.

The gap w, the contact pressure p, the contact zone {ψ ≥ 0} with the front c, and the normal strain q at t = 0 are

    w = 60 t (x − c)_+^α (1 − x)²,   p = 200 t (c − x)_+^{α−1} x²,   ψ = c − x,   c = 1/3,   q(0) = 0

on the bottom of the unit square. Viscosity A and elasticity G are not proportional. u(t) ∈ H^{1+s} for s < min(α − 3/2,
(α − 1) − 1/2) = α − 3/2 only.

Prop. 5.3 gives convergence but no order. The order α − 3/2 is predicted from the interpolation error of functions in
H^{1+s}. c is not a vertex of the structured meshes. The factors (1 − x)² and x² make the error far from the front, of
order 1, small compared with the error at the front. For α < 2 the strain is unbounded at the front.
"""

from sympy import Expr, Rational

from manufactured.body import Kind, unit_square
from manufactured.case import Case
from manufactured.cases.constants import ONE
from manufactured.cases.laws import not_proportional
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.law import KelvinVoigt
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t

LAW = not_proportional()


def rough_front(
    alpha: Rational,
    law: KelvinVoigt = LAW,
    gap: Expr = ONE,
    pressure: Expr = ONE,
    place: Expr = ONE,
) -> Case:
    """Return the case for an exponent α of the gap, optionally with another linear law.

    ``gap``, ``pressure`` and ``place`` are factors that multiply constants of the formulas.
    """
    body = unit_square()
    (part,) = body.of(Kind.CONTACT)
    c = place * Rational(1, 3)
    w = 60 * gap * t * pos(s - c, alpha) * (1 - s) ** 2
    p = 200 * pressure * t * pos(c - s, alpha - 1) * s**2
    face = ContactFace.linear(part, law, body.T, w, p, c - s, rough=(float(c),))
    return Case(
        name=f"rough-{float(alpha):g}",
        summary=f"fixed front with w ~ r^{float(alpha):g}, p ~ r^{float(alpha - 1):g}",
        solution=ExactSolution(body, law, (face,)),
        regularity=Regularity(gap=float(alpha), pressure=float(alpha - 1)),
        order=float(alpha - Rational(3, 2)),
        reason=f"u(t) ∈ H^(1+s) for s < α − 3/2 = {float(alpha) - 1.5:g}: interpolation of that order, no rate claimed",
        pace=1,
    )

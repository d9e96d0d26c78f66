"""Fronts whose trace on Γ3 is not in H²(Γ3) although u(t) ∈ H²(Ω): on and beyond the border of (5.36).

Natural front. Between contact and separation without friction a plane elastic body has the field of
Williams with exponent 3/2 (half of the symmetric mode of a crack): with Φ = i z^{3/2}, Ψ = −(i/2) z^{3/2},
z = (x − c) + iy, κ = (λ_L + 3μ)/(λ_L + μ) the same for A and G,

    w = θ (κ + 1) (x − c)_+^{3/2},     p = 3 (2μ_A θ̇ + 2μ_G θ) (c − x)_+^{1/2},     Div σ = 0,

so real fronts sit on the border: u(t) ∈ H^{5/2−ε}(Ω), u_ν(t) ∈ H^{2−ε}(Γ3).

Rough trace. For any exponent α > 1 and any isotropic A, G, with complex numbers a and b that

    u_s = −α y Re(a z^{α−1}),     u_n = Re(a z^α) + y Re(b z^{α−1})

needs for u_n = W (x − c)_+^α and ε_nn = −Q (c − x)_+^{α−1} on y = 0; here α = 5/4: u(t) ∈ H^{9/4−ε}(Ω),
u_ν(t) ∈ H^{7/4−ε}(Γ3). Both are multiplied by θ(t) = 1/4 + 2t and the cut-off (1 − y)²(1 + 2y). The arguments of
both are the law and factors of their other constants.

Source: M. L. Williams, J. Appl. Mech. 19 (1952) 526–528.
"""

import numpy as np
from sympy import Expr, Float, Integer, Rational

from manufactured.body import Kind, unit_square
from manufactured.case import Case
from manufactured.cases.laws import kolosov_constant, lame, not_proportional, proportional
from manufactured.exact import ExactSolution
from manufactured.law import KelvinVoigt, Linear
from manufactured.profile import cutoff
from manufactured.regularity import Regularity
from manufactured.singular import Monomial, SingularFace, SingularField, kolosov
from manufactured.symbols import pos, s, t

FRONT = Rational(2, 5)
THETA = Rational(1, 4) + 2 * t
PROPORTIONAL, NOT_PROPORTIONAL = proportional(2.0), not_proportional()
ONE: Expr = Integer(1)


def natural(law: KelvinVoigt = PROPORTIONAL, mode: Expr = ONE, speed: Expr = ONE, place: Expr = ONE) -> Case:
    body = unit_square()
    (part,) = body.of(Kind.CONTACT)
    front, theta = place * FRONT, mode * THETA.subs(t, speed * t)
    assert isinstance(law.G, Linear)
    kappa = kolosov_constant(law.A)
    mu_A, mu_G = (Rational(lame(tensor)[0]) for tensor in (law.A, law.G))
    x, y = kolosov(kappa, 1j, -0.5j, 1.5)
    field = SingularField((float(front), 0.0), part.frame, x, y, theta, depth=cutoff().b)
    pressure = 3 * (2 * mu_A * theta.diff(t) + 2 * mu_G * theta) * pos(front - s, Rational(1, 2))
    gap = (kappa + 1) * theta * pos(s - front, Rational(3, 2))
    face = SingularFace(part, gap, pressure, front - s, field, rough=(float(front),))
    return Case(
        name="natural-front",
        summary="the natural front of frictionless contact, w ~ r^{3/2}, fixed",
        solution=ExactSolution(body, law, (face,)),
        regularity=Regularity(on_contact=1.5),
        order=1,
        reason="u(t) ∈ H^{5/2−ε} ⊂ H², so interpolation has order 1; the trace r^{3/2} just misses (5.36)",
        pace=1,
    )


def rough_trace(
    law: KelvinVoigt = NOT_PROPORTIONAL,
    gap: Expr = ONE,
    pressure: Expr = ONE,
    speed: Expr = ONE,
    place: Expr = ONE,
) -> Case:
    body = unit_square()
    (part,) = body.of(Kind.CONTACT)
    front, theta = place * FRONT, THETA.subs(t, speed * t)
    alpha, W, Q = 1.25, 4.0 * float(gap), 3.0 * float(pressure)
    a = W * (1 + 1j / np.tan(np.pi * alpha))
    b = 1j * Q / np.sin(np.pi * (alpha - 1)) - 1j * alpha * a
    x = (Monomial(1, -alpha * a, alpha - 1),)
    y = (Monomial(0, a, alpha), Monomial(1, b, alpha - 1))
    field = SingularField((float(front), 0.0), part.frame, x, y, theta, depth=cutoff().b)
    modulus, stiffness = (tensor.normal_modulus(part.normal) for tensor in (law.A, law.G))  # type: ignore[attr-defined]
    p = Q * (modulus * theta.diff(t) + stiffness * theta) * pos(front - s, Float(alpha) - 1)
    w = W * theta * pos(s - front, Float(alpha))
    face = SingularFace(part, w, p, front - s, field, rough=(float(front),))
    return Case(
        name="rough-trace",
        summary="u(t) in H², its trace on Γ3 only in H^{7/4}: w ~ r^{5/4}",
        solution=ExactSolution(body, law, (face,)),
        regularity=Regularity(on_contact=alpha),
        order=1,
        reason="u(t) ∈ H^{9/4−ε} ⊂ H², so interpolation has order 1; the proof of 5.4 gives 7/8 for this trace",
        pace=1,
    )

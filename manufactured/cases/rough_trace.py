"""A fixed front with u(t) ∈ H²(Ω), but with a trace on Γ3 that is not in H²(Γ3) and so violates (5.36).

The gap w, the contact pressure p and the contact zone {ψ ≥ 0} with the front c are

    w = W θ (x − c)_+^α,   p = Q (A_nnnn θ̇ + G_nnnn θ) (c − x)_+^{α−1},   ψ = c − x,   c = 2/5,   θ(t) = 1/4 + 2t

on the bottom of the unit square with α = 5/4, W = 4, Q = 3. Viscosity A and elasticity G are not proportional,
A_nnnn = 5/2, G_nnnn = 7. The displacement is

    u_s = −α y Re(a z^{α−1}),   u_n = Re(a z^α) + y Re(b z^{α−1}),   z = (x − c) + iy,

times θ(t) and the cut-off (1 − y)²(1 + 2y). The complex numbers a = W (1 + i cot πα) and b = iQ/sin π(α − 1) − iαa are
such that u_n = W (x − c)_+^α and ε_nn = −Q (c − x)_+^{α−1} on y = 0. This works for any α > 1 and any isotropic A, G.

Predicted order 1: u(t) ∈ H^{1+s} for s < α = 5/4, so interpolation has order 1. The trace is u_ν(t) ∈ H^τ(Γ3) for
τ < α + 1/2 = 7/4 only, which violates (5.36), so Prop. 5.4 gives no order. Its proof gives τ/2, that is 7/8.
"""

import numpy as np
from sympy import Rational

from manufactured.body import Kind, unit_square
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.exact import ExactSolution
from manufactured.profile import cutoff
from manufactured.regularity import Regularity
from manufactured.singular import Monomial, SingularFace, SingularField
from manufactured.symbols import pos, s, t


def case() -> Case:
    law = not_proportional()
    body = unit_square()
    (part,) = body.of(Kind.CONTACT)
    front = Rational(2, 5)
    theta = Rational(1, 4) + 2 * t
    alpha, W, Q = 1.25, 4.0, 3.0
    a = W * (1 + 1j / np.tan(np.pi * alpha))
    b = 1j * Q / np.sin(np.pi * (alpha - 1)) - 1j * alpha * a
    x = (Monomial(1, -alpha * a, alpha - 1),)
    y = (Monomial(0, a, alpha), Monomial(1, b, alpha - 1))
    field = SingularField((float(front), 0.0), part.frame, x, y, theta, depth=cutoff().b)
    modulus, stiffness = (tensor.normal_modulus(part.normal) for tensor in (law.A, law.G))  # type: ignore[attr-defined]
    p = Q * (modulus * theta.diff(t) + stiffness * theta) * pos(front - s, alpha - 1)
    w = W * theta * pos(s - front, alpha)
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

"""Clamped and contact boundary meet on a straight side, with contact everywhere: a singularity u ~ r^{1/2}.

The gap w, the contact pressure p, the contact zone {ψ ≥ 0} and the function of time θ are

    w = 0,   p = (κ − 1)/2 (2μ_A θ̇ + 2μ_G θ) x^{−1/2},   ψ = 1,   θ(t) = t

on the bottom of [−1, 1] × [0, 1]. The bottom is clamped for x < 0 and in contact for x > 0. The elasticity is G = 2A,
so κ = (λ_L + 3μ)/(λ_L + μ) is the same for A and G. The displacement is θ(t) times Williams' singular field for these
two boundary conditions. The field has the exponent λ = 1/2 and the potentials Φ = z^{1/2}, Ψ = −(κ + 1/2) z^{1/2}
(``singular.kolosov``). It satisfies σ_τ = 0 on Γ3 and Div σ = 0. p is not in L²(Γ3).

Predicted order 1/2: u(t) ∈ H^{1+s} for s < λ = 1/2 at the junction, so interpolation has the order 1/2 on uniform
meshes, and 1 on graded ones. Prop. 5.3 gives no order.

Source: M. L. Williams, J. Appl. Mech. 19 (1952) 526–528.
"""

import numpy as np
from sympy import Rational

from manufactured.body import Kind, polygon
from manufactured.case import Case
from manufactured.cases.laws import kolosov_constant, proportional, shearing
from manufactured.exact import ExactSolution
from manufactured.regularity import Regularity
from manufactured.singular import SingularFace, SingularField, kolosov
from manufactured.symbols import pos, s, t


def case() -> Case:
    law = proportional(2.0)
    kinds = [Kind.CLAMPED, Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.LOADED]
    body = polygon([(-1, 0), (0, 0), (1, 0), (1, 1), (-1, 1)], kinds, refine=((0.0, 0.0),))
    kappa = kolosov_constant(law.A)
    (part,) = body.of(Kind.CONTACT)
    x, y = kolosov(kappa, 1.0, -(kappa + 0.5), 0.5)
    field = SingularField((0.0, 0.0), np.eye(2), x, y, t)
    pressure = Rational(kappa - 1) / 2 * shearing(law, t) * pos(s, -Rational(1, 2))
    face = SingularFace(part, 0, pressure, 1, field, rough=(0.0,))
    return Case(
        name="junction",
        summary="Γ1 meets Γ3 in contact on a straight line: u ~ r^{1/2}, p ~ r^{−1/2}",
        solution=ExactSolution(body, law, (face,), (), ((0.0, 0.0),)),
        regularity=Regularity(on_contact=0.5),
        order=0.5,
        reason="u(t) ∈ H^{1+s} for s < 1/2 at the junction: order 1/2 on uniform meshes, 1 on graded ones",
        pace=1,
        families=("one-diagonal", "graded"),
    )

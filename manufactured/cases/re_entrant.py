"""An L-shaped body with a singularity at its re-entrant corner and an advancing contact front on its bottom.

The gap w, the contact pressure p, the contact zone {ψ ≥ 0} with the front c, and the normal strain q at t = 0 are

    w = (x − c)_+^4,   p = 5 (c − x)_+²,   ψ = c − x,   c(t) = 3/5 + t/2,   q(0) = −p(0)/g

on the bottom of the body with the corners (0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2), where g = G_nnnn. The
elasticity is G = 2A, and the displacement of the contact face has the depth 9/10. The interior angle at the corner
(1, 1) is ω = 3π/2. There Williams' symmetric singular field U for sides free of traction is added, with a cut-off,

    4t (1 − (r/R)²)_+³ U,   R = 9/10,   Φ = z^λ,   Ψ = b z^λ,   b = −(cos λω + λ cos ω).

U has the potentials Φ and Ψ (``singular.kolosov``), and λ ≈ 0.5445 is the smallest positive root of sin λω + λ sin
ω = 0. Both sides of the corner are free of traction at all times because A and G are proportional.

Predicted order 0.5445 (λ): u(t) ∈ H^{1+s} for s < λ at the corner, so interpolation has the order λ on uniform meshes,
and 1 on graded ones. Prop. 5.3 gives no order.

Source: M. L. Williams, J. Appl. Mech. 19 (1952) 526–528.
"""

from dataclasses import replace

import numpy as np
from sympy import Rational, Symbol, nsolve, pi, sin

from manufactured.case import Case
from manufactured.cases.laws import kolosov_constant, proportional
from manufactured.cases.shared import l_shape, with_one_face
from manufactured.profile import QUARTIC, Piecewise, cutoff
from manufactured.regularity import Regularity
from manufactured.singular import SingularField, kolosov
from manufactured.symbols import pos, s, t

RADIUS = 0.9


def exponent() -> float:
    """Return the exponent λ of the singularity: the smallest positive root of sin λω + λ sin ω = 0 for ω = 3π/2."""
    root = Symbol("root")
    return float(nsolve(sin(3 * pi / 2 * root) - root, root, 0.54))


def case() -> Case:
    law = proportional(2.0)
    c = Rational(3, 5) + t / 2
    on_bottom = with_one_face(
        l_shape(refine=((1.0, 1.0),)),
        law,
        gap=pos(s - c, 4),
        pressure=5 * pos(c - s, 2),
        level=c - s,
        profile=cutoff(0.9, QUARTIC),
    )
    lam, omega = exponent(), 1.5 * np.pi
    x, y = kolosov(kolosov_constant(law.A), 1.0, -(np.cos(lam * omega) + lam * np.cos(omega)), lam)
    # The first axis of the singular field is its axis of symmetry, which must point into the body.
    frame = np.array([[-1.0, 1.0], [-1.0, -1.0]]) / np.sqrt(2)
    fade = Piecewise((RADIUS,), ((1.0, 0.0, -3 / RADIUS**2, 0.0, 3 / RADIUS**4, 0.0, -1 / RADIUS**6),))
    corner = SingularField((1.0, 1.0), frame, x, y, 4 * t, radial=fade)
    return Case(
        name="re-entrant",
        summary="re-entrant corner of an L-shaped body, advancing front on its bottom",
        solution=replace(on_bottom, others=(corner,), singular=((1.0, 1.0),)),
        regularity=Regularity(gap=4, pressure=2, moving=True, corner=lam),
        order=min(1.0, lam),
        reason="u(t) ∈ H^{1+s} for s < λ ≈ 0.5445 at the corner: that order on uniform meshes, 1 on graded ones",
        pace=1.5,
        families=("unstructured", "graded"),
    )

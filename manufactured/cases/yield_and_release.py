"""Under the nonlinear law (3.3), a whole face is pressed from rest until t_1 and is then released.

The gap w, the slip z, the contact pressure p and the contact zone {ψ ≥ 0} are

    w = 8 (t − t_1)_+² (1 + 4x(1 − x)),   z = 3t/2 + (t_1 − t)_+² (x + x²)/2,   ψ = t_1 − t,   t_1 = 3/5,
    p = a Q̇ − λ ∂_s ż + b (1 − ρ/|ε|)_+ Q,   |ε|² = (∂_s z)² + Q²

on the bottom of the unit square. The convex set K of (3.3) is a ball in the Frobenius norm. The normal strain is q = −Q
with Q of ``yielding``. Until t_1, Q changes from Q_0 = 0 to Q_1 = (3/2 + 2x(1 − x)) ρ > ρ. The strain leaves K when Q
exceeds ρ, at different times at different points of the face. The constants are a = 5/2, λ = A_nnss = 1/2, b = β = 6, ρ
= 1/2. After t_1 the face slips as a whole, with ∂_s z = 0, so that p = 0.

Predicted order 1: there is no front. w and q = −Q are smooth in space, and u̇ is Lipschitz in time, which gives (5.36),
so that Prop. 5.4 applies, for which it is enough that G is Lipschitz.
"""

from sympy import Rational

from manufactured.body import Kind, unit_square
from manufactured.case import Case
from manufactured.cases.shared import RELEASE, edge, pressed_and_released
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.law import FrobeniusBall, KelvinVoigt, Yield, isotropic
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def case() -> Case:
    law = KelvinVoigt(isotropic(1, 0.5), Yield(6.0, FrobeniusBall(0.5)), "(3.3), Frobenius ball")
    body = unit_square()
    (part,) = body.of(Kind.CONTACT)
    rise = edge(law, part) * (Rational(3, 2) + 2 * s * (1 - s))
    strain = pressed_and_released(law, part, 0, rise)
    w = 8 * pos(t - RELEASE, 2) * (1 + 4 * s * (1 - s))
    slip = 3 * t / 2 + pos(RELEASE - t, 2) * (s + s**2) / 2
    return Case(
        name="yield-and-release",
        summary="law (3.3) yields under full contact of a face that slips, then the whole face is released",
        solution=ExactSolution(body, law, (ContactFace(part, w, strain, RELEASE - t, slip=(slip,)),)),
        regularity=Regularity(),
        order=1,
        reason="w and q smooth in space, u̇ Lipschitz in time: (5.36) and order 1 by Prop. 5.4, G only Lipschitz",
        pace=8,
        families=("criss-cross",),
    )

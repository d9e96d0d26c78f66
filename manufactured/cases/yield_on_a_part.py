"""Under the nonlinear law (3.3), the part x < c of a face is in contact until t_1 and is then released.

The gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} are

    w = 15 t² (x − c)_+³ + 4 (t − t_1)_+²,   p = a Q̇ + b (Q − ρ)_+,   z = 3t/2 + x²/4,   c = 3/5,   t_1 = 3/5,
    ψ = c − x for t < t_1,   ψ = −1 for t ≥ t_1

on the bottom of the unit square. The convex set of (3.3) is K = {|dev τ| ≤ r}. The normal strain is q = ∂_s z − Q with
Q of ``yielding``: dev ε depends on q − ∂_s z only, and ∂_s z does not change in time. Until t_1, Q changes from Q_0 = ρ
to Q_1 = ρ + 3 (c − x)_+². At Q_0 the strain is on the boundary of K, so where there is contact it leaves K immediately.
The constants are a = 5/2, b = β/2 = 4, ρ = √2/10.

Predicted order 1: the front is fixed. The exponents of gap and pressure at the front, α = 3 > 5/2 and m = 2 > 3/2, give
u(t) ∈ H² and (5.36), so that Prop. 5.4 applies.
"""

from sympy import Rational

from manufactured.body import Kind, unit_square
from manufactured.case import Case
from manufactured.cases.shared import RELEASE, edge, pressed_and_released
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.face_strain import Prescribed
from manufactured.law import DeviatoricBall, KelvinVoigt, Yield, isotropic
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def case() -> Case:
    law = KelvinVoigt(isotropic(1, 0.5), Yield(8.0, DeviatoricBall(0.1)), "(3.3), deviatoric ball")
    body = unit_square()
    (part,) = body.of(Kind.CONTACT)
    c = Rational(3, 5)
    rise = 3 * pos(c - s, 2)
    slip = 3 * t / 2 + s**2 / 4
    loaded = pressed_and_released(law, part, edge(law, part), rise)
    strain = Prescribed(tuple((end, slip.diff(s) + q) for end, q in loaded.phases))
    w = 15 * t**2 * pos(s - c, 3) + 4 * pos(t - RELEASE, 2)
    released = pos(t - RELEASE, 0)
    level = (c - s) * (1 - released) - released
    return Case(
        name="yield-on-a-part",
        summary="the face slips, law (3.3) yields under contact on [0, 3/5], then that part is released",
        solution=ExactSolution(body, law, (ContactFace(part, w, strain, level, rough=(float(c),), slip=(slip,)),)),
        regularity=Regularity(gap=3, pressure=2),
        order=1,
        reason="fixed front with α = 3 > 5/2 and m = 2 > 3/2: u(t) ∈ H², (5.36) and order 1 by Prop. 5.4",
        pace=6,
        families=("shaken",),
    )

"""An advancing contact front on a prestressed material that softens and then hardens: G is nonlinear, not monotone.

The gap w, the slip z, the normal strain q, the contact pressure p and the contact zone {ψ ≥ 0} with the front c are

    w = 5 (1 + 24t(1 − t)) (x − c)_+^4,   z = 3t (1 + x/2 − x²/4),   ψ = c − x,   c(t) = 5/24 + t/2,
    q = q_z − Q,   q_z = 3(1 − x)(1 − e^{2t/5})/4,   Q = 20 (c − x)_+³,
    p = a Q̇ − Q − 4 (1 − 2/|ε|)_+ q,   |ε|² = (∂_s z)² + q²

on the bottom of the unit square. The viscosity is A τ = 2τ + (tr τ)/2 I with a = A_nnnn = 5/2. The elasticity is
G ε = S − ε + 4 (ε − P_K ε) with K = {|τ| ≤ 2} and the stress at rest S = e_1 ⊗ e_1.

Predicted order 1: the front moves. At the front q has the exponent 3, so p ~ q̇ has m = 2 > 3/2, and the gap has
α = 4 > 7/2. This gives (5.36), so that Prop. 5.4 applies, for which it is enough that G is Lipschitz.

q_z is the strain that the slip alone needs, with a q̇_z − q_z + λ ∂_s ż = 0 for λ = A_nnss = 1/2. Where the front has
not been, |ε| ≤ 2 and p = 0.

Without S, the stored energy is smallest on a sphere around ε = 0, as in a body that snaps through. The slope of G is −1
inside K and 3 far from K. So L_G/m_A = 3/2, and differences of solutions may grow at the rate 1/2. The stress at rest S
acts along the face and causes no traction on it, so it enters f_2 only.

The gap is largest while the front moves. In a first version the gap was small, and the pressure caused most of the
error. In that version the check that (‖u − u^h‖² + ‖Π^h u − u^h‖²)^{1/2} is about ‖u − Π^h u‖ failed on criss-cross
meshes, with a quotient of up to 1.24.
"""

from sympy import Rational, exp

from manufactured.body import Kind, unit_square
from manufactured.case import Case
from manufactured.cases.laws import softening_then_hardening
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.face_strain import Prescribed
from manufactured.law import Combined
from manufactured.law.linear_operator import face_moduli
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def case() -> Case:
    law = softening_then_hardening()
    body = unit_square()
    (part,) = body.of(Kind.CONTACT)
    c = Rational(5, 24) + t / 2
    w = 5 * (1 + 24 * t * (1 - t)) * pos(s - c, 4)
    z = 3 * t * (1 + s / 2 - s**2 / 4)
    assert isinstance(law.G, Combined)
    (a, a_ss), (g, _) = (face_moduli(tensor, part.frame)[0, [0, 2]] for tensor in (law.A, law.G.linear))
    by_slip = z.diff(s, t) * (a_ss / g) * (exp(-g / a * t) - 1)
    strain = Prescribed(((body.T, by_slip - 20 * pos(c - s, 3)),))
    face = ContactFace(part, w, strain, c - s, slip=(z,))
    return Case(
        name="double-well",
        summary="front advances, the face slips, G softens, then hardens, and is prestressed",
        solution=ExactSolution(body, law, (face,)),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 give (5.36): order 1 by Prop. 5.4, G only Lipschitz",
        families=("criss-cross",),
    )

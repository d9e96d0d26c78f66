"""An advancing contact front, which the cases ``anisotropic``, ``heterogeneous`` and ``layered`` share.

The gap w, the slip z and the contact zone {ψ ≥ 0} with the front c are

    w = 8 (1/5 + t) (x − c)_+^4,   z = t(1 + t) sin(2x + 1),   ψ = c − x,   c(t) = 1/4 + t/2

on the bottom of the unit square. Each case prescribes another contact pressure.
"""

from sympy import Expr, Rational, sin

from manufactured.body import Body, Kind
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.law import KelvinVoigt
from manufactured.profile import Profile
from manufactured.symbols import pos, s, t

FRONT: Expr = Rational(1, 4) + t / 2
"""The position c(t) of the contact front."""


def advancing_front(body: Body, law: KelvinVoigt, profile: Profile, pressure: Expr) -> ExactSolution:
    """Return the exact solution with the advancing front of this module, for a given material law and pressure.

    Args:
        body: the unit square.
        law: the material law.
        profile: the functions that continue the displacement into the body.
        pressure: the formula of the contact pressure p(s, t), which must be 0 beyond the front.
    """
    (part,) = body.of(Kind.CONTACT)
    gap = 8 * (Rational(1, 5) + t) * pos(s - FRONT, 4)
    slip = t * (1 + t) * sin(2 * s + 1)
    face = ContactFace.linear(part, law, body.T, gap, pressure, FRONT - s, profile=profile, slip=(slip,))
    return ExactSolution(body, law, (face,))

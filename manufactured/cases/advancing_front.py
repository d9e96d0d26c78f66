"""An advancing contact front, which the cases ``anisotropic``, ``heterogeneous`` and ``layered`` share.

    w = 8 (1/5 + t) (x − c)_+^4,   ψ = c − x,   c(t) = 1/4 + t/2

on the unit square. Each case prescribes another pressure. The body starts in elastic equilibrium.
"""

from sympy import Expr, Rational

from manufactured.body import Body, Kind
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.law import KelvinVoigt
from manufactured.profile import Profile
from manufactured.symbols import pos, s, t

FRONT: Expr = Rational(1, 4) + t / 2
"""The front c(t)."""


def advancing_front(body: Body, law: KelvinVoigt, profile: Profile, pressure: Expr) -> ExactSolution:
    """Return the solution for a body, a law, a lifting profile and a pressure p(s, t), which is 0 beyond the front."""
    (part,) = body.of(Kind.CONTACT)
    gap = 8 * (Rational(1, 5) + t) * pos(s - FRONT, 4)
    face = ContactFace.linear(part, law, body.T, gap, pressure, FRONT - s, profile=profile)
    return ExactSolution(body, law, (face,))

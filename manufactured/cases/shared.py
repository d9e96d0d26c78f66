"""Bodies, solutions and strains that several cases share.

**Contact faces under a linear law** (``with_faces``, ``with_one_face``), which most cases have.

**An advancing contact front**, which the cases ``anisotropic``, ``heterogeneous`` and ``layered`` share.

The gap w, the slip z and the contact zone {ψ ≥ 0} with the front c are

    w = 8 (1/5 + t) (x − c)_+^4,   z = t(1 + t) sin(2x + 1),   ψ = c − x,   c(t) = 1/4 + t/2

on the bottom of the unit square. Each case prescribes another contact pressure.

**The law (3.3)**, for a face that is loaded until t_1 and then released. For the normal strain −Q with Q ≥ 0, the law
gives the pressure p = a Q̇ + b (Q − ρ)_+. Here ρ is the value of Q at which the strain reaches the boundary of K.
Q changes from Q_0(s) at t = 0 to Q_1(s) at t = t_1. With τ = t/t_1 its formula is

    Q = Q_0 + (Q_1 − Q_0) h(τ) + t_1 D k(τ),   h = τ²(3 − 2τ),   k = τ²(τ − 1),   D = −(b/a)(Q_1 − ρ)   for t ≤ t_1,
    Q = ρ + (Q_1 − ρ) e^{−b(t − t_1)/a}                                                                 for t ≥ t_1,

Then Q, Q̇ and p are continuous, p(t_1) = 0, and after t_1, where p = 0, Q relaxes towards ρ.
"""

from typing import Any

from sympy import Expr, Rational, exp, sin

from manufactured.body import Body, Kind, Part, polygon
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.face_strain import Prescribed
from manufactured.law import KelvinVoigt, Yield
from manufactured.profile import Profile
from manufactured.symbols import pos, s, t

SLIP: Expr = t * (1 + t) * sin(2 * s + 1)
"""A slip z(s, t) that other cases use with a factor."""
FRONT: Expr = Rational(1, 4) + t / 2
"""The position c(t) of the contact front."""


def with_faces(body: Body, law: KelvinVoigt, *faces: dict[str, Any]) -> ExactSolution:
    """Return the exact solution with a contact face on every piece of Γ3, for a linear law.

    Args:
        body: the body.
        law: the material law.
        faces: for each piece of Γ3 the data of its face, as arguments of ``ContactFace.linear`` with their names.
    """
    pieces = zip(body.of(Kind.CONTACT), faces, strict=True)
    return ExactSolution(body, law, tuple(ContactFace.linear(part, law, body.T, **data) for part, data in pieces))


def with_one_face(body: Body, law: KelvinVoigt, **data: Any) -> ExactSolution:
    """Return the exact solution on a body with a single piece of Γ3; see ``with_faces``."""
    return with_faces(body, law, data)


def l_shape(refine: tuple[tuple[float, float], ...]) -> Body:
    """Return an L-shaped body that is clamped on top, with contact on its bottom.

    Args:
        refine: the vertices towards which graded meshes are refined.
    """
    kinds = [Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.LOADED, Kind.CLAMPED, Kind.LOADED]
    return polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], kinds, refine=refine)


def advancing_front(body: Body, law: KelvinVoigt, profile: Profile, pressure: Expr) -> ExactSolution:
    """Return the exact solution with the advancing front of this module, for a given material law and pressure.

    Args:
        body: the unit square.
        law: the material law.
        profile: the functions that continue the displacement into the body.
        pressure: the formula of the contact pressure p(s, t), which must be 0 beyond the front.
    """
    gap = 8 * (Rational(1, 5) + t) * pos(s - FRONT, 4)
    return with_one_face(body, law, gap=gap, pressure=pressure, level=FRONT - s, profile=profile, slip=(SLIP,))


RELEASE = Rational(3, 5)
"""The time t_1 at which the face is released."""


def edge(law: KelvinVoigt, part: Part) -> float:
    """Return the value ρ of Q at which the strain −Q n⊗n reaches the boundary of K, on a face with the normal n."""
    assert isinstance(law.G, Yield)
    return law.G.normal_response(part.normal)[1]


def pressed_and_released(law: KelvinVoigt, part: Part, start: Expr, rise: Expr) -> Prescribed:
    """Return the prescribed normal strain −Q on a face that is loaded and then released at the time t_1.

    Args:
        law: the law (3.3).
        part: the face.
        start, rise: the formulas of Q_0 and of Q_1 − Q_0.
    """
    assert isinstance(law.G, Yield)
    response, rho = law.G.normal_response(part.normal)
    tau = t / RELEASE
    h, k = tau**2 * (3 - 2 * tau), tau**2 * (tau - 1)
    decay = response / law.A.normal_modulus(part.normal)
    excess = start + rise - rho
    loading = start + rise * h - RELEASE * decay * excess * k
    relaxing = rho + excess * exp(-decay * (t - RELEASE))
    return Prescribed(((float(RELEASE), -loading), (1.0, -relaxing)))

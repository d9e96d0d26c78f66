"""Corner singularities, where uniform meshes lose their order and graded ones regain it.

* re-entrant: an L-shaped body. At its corner of 3π/2 with sides free of traction the symmetric mode of
  Williams, Φ = z^λ, Ψ = b z^λ with real b = −(cos λω + λ cos ω), ω = 3π/2, and the smallest root λ ≈ 0.5445 of
  sin λω + λ sin ω = 0, times t (1 − (r/R)²)³, R = 9/10; superposed on an advancing front on the bottom.
* junction: where Γ1 meets Γ3 on a straight line, a clamped half and a half in contact give λ = 1/2:
  Φ = z^{1/2}, Ψ = −(κ + 1/2) z^{1/2}; p = (κ − 1)/2 (2μ_A θ̇ + 2μ_G θ) x^{−1/2} is not in L²(Γ3). Times θ = t.

A and G are proportional, so that both sides of the corner are free of traction, σ_τ = 0 and Div σ = 0. The arguments
of both are the law and factors of their other constants.

Source: M. L. Williams, J. Appl. Mech. 19 (1952) 526–528.
"""

import numpy as np
from sympy import Expr, Integer, Rational, Symbol, nsolve, pi, sin

from manufactured.body import Kind, polygon
from manufactured.case import Case
from manufactured.cases.laws import kolosov_constant, lame, proportional
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.law import KelvinVoigt, Linear
from manufactured.profile import QUARTIC, Piecewise, cutoff
from manufactured.regularity import Regularity
from manufactured.singular import SingularFace, SingularField, kolosov
from manufactured.symbols import pos, s, t

RADIUS = 0.9
LAW = proportional(2.0)
ONE: Expr = Integer(1)


def exponent() -> float:
    """The smallest positive root of sin λω + λ sin ω = 0 for ω = 3π/2."""
    root = Symbol("root")
    return float(nsolve(sin(3 * pi / 2 * root) - root, root, 0.54))


def reentrant(
    law: KelvinVoigt = LAW,
    gap: Expr = ONE,
    pressure: Expr = ONE,
    mode: Expr = ONE,
    speed: Expr = ONE,
    place: Expr = ONE,
) -> Case:
    kinds = [Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.LOADED, Kind.CLAMPED, Kind.LOADED]
    body = polygon([(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)], kinds, refine=((1.0, 1.0),))
    (part,) = body.of(Kind.CONTACT)
    c = place * (Rational(3, 5) + speed * t / 2)
    w, p = gap * pos(s - c, 4), 5 * pressure * pos(c - s, 2)
    face = ContactFace.linear(part, law, body.T, w, p, c - s, profile=cutoff(0.9, QUARTIC))
    lam, omega = exponent(), 1.5 * np.pi
    x, y = kolosov(kolosov_constant(law.A), 1.0, -(np.cos(lam * omega) + lam * np.cos(omega)), lam)
    # The axis of symmetry points into the body.
    frame = np.array([[-1.0, 1.0], [-1.0, -1.0]]) / np.sqrt(2)
    fade = Piecewise((RADIUS,), ((1.0, 0.0, -3 / RADIUS**2, 0.0, 3 / RADIUS**4, 0.0, -1 / RADIUS**6),))
    corner = SingularField((1.0, 1.0), frame, x, y, 4 * mode * speed * t, radial=fade)
    return Case(
        name="re-entrant",
        summary="re-entrant corner of an L-shaped body, advancing front on its bottom",
        solution=ExactSolution(body, law, (face,), (corner,), ((1.0, 1.0),)),
        regularity=Regularity(gap=4, pressure=2, moving=True, corner=lam),
        order=min(1.0, lam),
        reason="u(t) ∈ H^{1+s} for s < λ ≈ 0.5445 at the corner: that order on uniform meshes, 1 on graded ones",
        pace=1.5,
    )


def junction(law: KelvinVoigt = LAW, mode: Expr = ONE) -> Case:
    kinds = [Kind.CLAMPED, Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.LOADED]
    body = polygon([(-1, 0), (0, 0), (1, 0), (1, 1), (-1, 1)], kinds, refine=((0.0, 0.0),))
    assert isinstance(law.G, Linear)
    kappa = kolosov_constant(law.A)
    mu_A, mu_G = (Rational(lame(tensor)[0]) for tensor in (law.A, law.G))
    (part,) = body.of(Kind.CONTACT)
    x, y = kolosov(kappa, 1.0, -(kappa + 0.5), 0.5)
    theta = mode * t
    field = SingularField((0.0, 0.0), np.eye(2), x, y, theta)
    pressure = Rational(kappa - 1) / 2 * (2 * mu_A * theta.diff(t) + 2 * mu_G * theta) * pos(s, -Rational(1, 2))
    face = SingularFace(part, Integer(0), pressure, Integer(1), field, rough=(0.0,))
    return Case(
        name="junction",
        summary="Γ1 meets Γ3 in contact on a straight line: u ~ r^{1/2}, p ~ r^{−1/2}",
        solution=ExactSolution(body, law, (face,), (), ((0.0, 0.0),)),
        regularity=Regularity(on_contact=0.5),
        order=0.5,
        reason="u(t) ∈ H^{1+s} for s < 1/2 at the junction: order 1/2 on uniform meshes, 1 on graded ones",
        pace=1,
    )

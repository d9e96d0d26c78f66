"""Anisotropic and heterogeneous bodies: an advancing front over each.

    w = 8 (1/5 + t) (x − c)_+^4,   p = 150 (c − x)_+²,   c(t) = 1/4 + t/2

on the unit square, in elastic equilibrium at the start.

* anisotropic: A and G couple ε_nn with ε_sn on Γ3; a shear r(x, t) of the lifting keeps σ_τ = 0.
* graded: A(x) = (1 + x/2)(1 + y) A, G(x) = (1 + x/2)(1 + 3y²) G; along Γ3 both vary alike, so that the
  memory has one relaxation rate, inside they do not.
* layered: beyond y = 1/2 the body is 4 times as stiff and viscous. The displacement has a kink there
  that keeps σν continuous (``profile.layered``), and every mesh meets the interface. In the upper layer u_s has a
  part ∇_s q, which costs p one power more: p = 400 (c − x)_+³.
* layered-unmet: beyond y = 1/3, which no mesh meets, the body is 10 times as stiff and viscous; full
  contact under p = 20 t (1 + x(1 − x)), so that little but the kink makes the error.
"""

from sympy import Expr, Integer, Rational

from manufactured.body import Body, Kind, polygon, unit_square
from manufactured.case import Case
from manufactured.cases.laws import anisotropic, not_proportional
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.factor import Factor, layers, x1, x2
from manufactured.law import KelvinVoigt
from manufactured.profile import Profile, cutoff, layered
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t

FRONT: Expr = Rational(1, 4) + t / 2
PRESSURE: Expr = 150 * pos(FRONT - s, 2)


def _solution(body: Body, law: KelvinVoigt, profile: Profile, pressure: Expr) -> ExactSolution:
    (part,) = body.of(Kind.CONTACT)
    gap = 8 * (Rational(1, 5) + t) * pos(s - FRONT, 4)
    face = ContactFace.linear(part, law, body.T, gap, pressure, FRONT - s, profile=profile)
    return ExactSolution(body, law, (face,))


def coupled() -> Case:
    return Case(
        name="anisotropic",
        summary="advancing front, A and G anisotropic with different axes",
        solution=_solution(unit_square(), anisotropic(), cutoff(), PRESSURE),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="r and q inherit m = 2 from p, α = 4: (5.36) and order 1 by Prop. 5.4",
        pace=4,
    )


def graded() -> Case:
    along = 1 + x1 / 2
    viscous, elastic = Factor(along * (1 + x2), 1.0, 3.0), Factor(along * (1 + 3 * x2**2), 1.0, 6.0)
    return Case(
        name="heterogeneous",
        summary="advancing front, A and G vary smoothly in different ways",
        solution=_solution(unit_square(), not_proportional(2, viscous, elastic), cutoff(), PRESSURE),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="smooth coefficients do not change the regularity: α = 4, m = 2, (5.36) and order 1 by Prop. 5.4",
        pace=4,
    )


def _layers(interface: float, ratio: float) -> KelvinVoigt:
    factor = layers((0.0, 1.0), interface, ratio)
    return not_proportional(2, factor, factor)


def met() -> Case:
    sides = [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED]
    body = polygon([(0, 0), (1, 0), (1, 1), (0, 1)], sides, interfaces=[((0, 0.5), (1, 0.5))])
    return Case(
        name="layered",
        summary="two layers, the interface y = 1/2 is met by the meshes",
        solution=_solution(body, _layers(0.5, 4.0), layered(0.5, 4.0), 400 * pos(FRONT - s, 3)),
        regularity=Regularity(gap=4, pressure=3, moving=True),
        order=1,
        reason="α = 4, m = 3, less one for ∇_s q: (5.36) in each layer, not across; (5.23) is cell by cell: order 1",
        pace=4,
    )


def unmet() -> Case:
    body, law = unit_square(), _layers(1 / 3, 10.0)
    (part,) = body.of(Kind.CONTACT)
    pressure = 20 * t * (1 + s * (1 - s))
    face = ContactFace.linear(part, law, body.T, Integer(0), pressure, Integer(1), profile=layered(1 / 3, 10.0))
    return Case(
        name="layered-unmet",
        summary="two layers, the interface y = 1/3 is met by no mesh",
        solution=ExactSolution(body, law, (face,)),
        regularity=Regularity(kink=True),
        order=0.5,
        reason="the strain jumps inside cells: u(t) ∈ H^{1+s} for s < 1/2, interpolation of order 1/2, no rate claimed",
        pace=1,
    )

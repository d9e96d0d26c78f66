"""An irregular hexagon with contact on three sides of different directions.

The gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} with the front c are

    w = 4 (1/5 + t) (ξ − c)_+^4/(1/4 + (ξ − c)²),   p = P (c − ξ)_+²,   ψ = c − ξ,
    first:  ξ = s,               c(t) = 3/10 + t/4,        P = 50,        z = t(1 + t) sin(2ξ + 1)/2,
    second: ξ = |Γ3,2| − s,      c(t) = 3/4 − t/4,         P = 900 ξ²,    z = 25t ξ³ e^{−4ξ},
    third:  ξ = s,               c(t) = 1/2 + t(1 − t),    P = 900 ξ²,    z = 25t ξ³ e^{−4ξ}

with the coordinate s along each side. Viscosity A and elasticity G are not proportional. Two of the sides meet the
clamped boundary Γ1. On them ξ is the distance from the end at Γ1, P has the factor ξ², and z has the factor ξ³, so that
the displacement vanishes on Γ1. The displacement fields of the three sides reach to the depth 4/5, which is not as far
as another contact side.

Predicted order 1: the fronts move. On every side the exponents of gap and pressure at the front, α = 4 > 7/2 and
m = 2 > 3/2, give (5.36), so that Prop. 5.4 applies.

The denominator of w makes the gap flatter away from the fronts.
"""

from typing import Any

from sympy import Expr, Rational, exp

from manufactured.body import Kind, polygon
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.cases.shared import SLIP, with_faces
from manufactured.profile import QUARTIC, cutoff
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t

HEXAGON = ((-0.5, -0.9), (0.55, -0.85), (1.05, 0.05), (0.5, 0.85), (-0.55, 0.9), (-1.0, 0.0))


def case() -> Case:
    contact, loaded = Kind.CONTACT, Kind.LOADED
    body = polygon(HEXAGON, [contact, loaded, contact, Kind.CLAMPED, contact, loaded])
    _, second, _ = body.of(contact)
    solution = with_faces(
        body,
        not_proportional(),
        _with_front(s, Rational(3, 10) + t / 4, 50, SLIP / 2),
        _from_clamp(second.measure - s, Rational(3, 4) - t / 4),
        _from_clamp(s, Rational(1, 2) + t * (1 - t)),
    )
    return Case(
        name="hexagon",
        summary="irregular hexagon with contact on three sides of different directions",
        solution=solution,
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 on every side give (5.36): order 1 by Prop. 5.4",
        pace=4,
    )


def _from_clamp(place: Expr, c: Expr) -> dict[str, Any]:
    return _with_front(place, c, 900 * pos(place, 2), 25 * t * pos(place, 3) * exp(-4 * place))


def _with_front(place: Expr, c: Expr, scale: Expr, slip: Expr) -> dict[str, Any]:
    return {
        "gap": 4 * (Rational(1, 5) + t) * pos(place - c, 4) / (Rational(1, 4) + (place - c) ** 2),
        "pressure": scale * pos(c - place, 2),
        "level": c - place,
        "profile": cutoff(0.8, QUARTIC),
        "slip": (slip,),
    }

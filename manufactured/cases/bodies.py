"""Other bodies: turned, with three faces, with a corner between two faces under pressure.

* rotated: the data of ``advance_recede`` on the unit square turned by 2/5 and moved; every error must be
  that of the unturned one, to round-off.
* hexagon: an irregular hexagon with contact on three sides of different directions. On the first side with
  z = s, on the two beside Γ1 with the distance z from the end at Γ1,

      w = 4 (1/5 + t) (z − c)_+^4/(1/4 + (z − c)²),   p = P (c − z)_+²,

  P = 50 on the first, P = 900 z_+² on the others, so that nothing is lifted onto Γ1. The depth 4/5 does not
  reach from one contact side to another; the denominator flattens the gap away from the fronts.
* corner: Γ3 is the bottom and the left side of the unit square, Γ1 the right quarter of the top. With the
  distance ρ from the corner, on each side

      w = 4 (ρ − c)_+^4,   p = 40 (c² − ρ²)_+²;

  p is even in ρ, so the lifting of one side is symmetric about the other and leaves σ_τ = 0 there, and
  A, G do not couple normal strains. Both sides press at the corner itself, a vertex with two constraints.
"""

import numpy as np
from sympy import Expr, Integer, Rational

from manufactured.body import Body, Kind, Part, polygon, unit_square
from manufactured.case import Case
from manufactured.cases import advance_recede
from manufactured.cases.laws import not_proportional, without_contraction
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.law import KelvinVoigt
from manufactured.profile import QUARTIC, cutoff
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t

ANGLE = 0.4
SHIFT = (3.0, -1.0)
HEXAGON = ((-0.5, -0.9), (0.55, -0.85), (1.05, 0.05), (0.5, 0.85), (-0.55, 0.9), (-1.0, 0.0))


def rotated() -> Case:
    turn = np.array([[np.cos(ANGLE), -np.sin(ANGLE)], [np.sin(ANGLE), np.cos(ANGLE)]])
    corners = turn @ unit_square().vertices + np.array(SHIFT)[:, None]
    body = polygon([(x, y) for x, y in corners.T], [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED])
    plain = advance_recede.case()
    return Case(
        name="rotated",
        summary="advance-recede on a turned square",
        solution=advance_recede.on(body),
        regularity=plain.regularity,
        order=plain.order,
        reason="nothing depends on the axes: the errors of advance-recede",
        twin=plain.name,
    )


def hexagon() -> Case:
    contact, loaded = Kind.CONTACT, Kind.LOADED
    body = polygon(HEXAGON, [contact, loaded, contact, Kind.CLAMPED, contact, loaded])
    law = not_proportional()
    first, second, third = body.of(contact)
    faces = (
        _with_front(first, body, law, s, Rational(3, 10) + t / 4, Integer(50)),
        _with_front(second, body, law, second.measure - s, Rational(3, 4) - t / 4, 900 * pos(second.measure - s, 2)),
        _with_front(third, body, law, s, Rational(1, 2) + t * (1 - t), 900 * pos(s, 2)),
    )
    return Case(
        name="hexagon",
        summary="irregular hexagon with contact on three sides of different directions",
        solution=ExactSolution(body, law, faces),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 on every side give (5.36): order 1 by Prop. 5.4",
        pace=4,
    )


def _with_front(part: Part, body: Body, law: KelvinVoigt, place: Expr, c: Expr, scale: Expr) -> ContactFace:
    gap = 4 * (Rational(1, 5) + t) * pos(place - c, 4) / (Rational(1, 4) + (place - c) ** 2)
    return ContactFace.linear(
        part, law, body.T, gap, scale * pos(c - place, 2), c - place, profile=cutoff(0.8, QUARTIC)
    )


def corner() -> Case:
    kinds = [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED, Kind.CONTACT]
    body = polygon([(0, 0), (1, 0), (1, 1), (0.75, 1), (0, 1)], kinds)
    law = without_contraction()
    bottom, left = body.of(Kind.CONTACT)
    faces = (
        _at_corner(bottom, body, law, s, Rational(2, 5) + Rational(4, 5) * t * (1 - t), 1.0),
        # The left side runs down to the corner.
        _at_corner(left, body, law, 1 - s, Rational(3, 5) - t / 3, 0.75),
    )
    return Case(
        name="corner",
        summary="two sides at right angles in contact, pressure at the corner between them",
        solution=ExactSolution(body, law, faces),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 on both sides, u smooth at the corner: (5.36), order 1 by Prop. 5.4",
        pace=4,
    )


def _at_corner(part: Part, body: Body, law: KelvinVoigt, rho: Expr, c: Expr, depth: float) -> ContactFace:
    gap, pressure = 4 * pos(rho - c, 4), 40 * pos(c**2 - rho**2, 2)
    return ContactFace.linear(part, law, body.T, gap, pressure, c - rho, profile=cutoff(depth))

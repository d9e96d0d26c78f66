"""Other bodies: turned, with three faces, with a corner between two faces under pressure.

* rotated: the data of ``advance_recede`` on the unit square turned by 2/5 and moved; every error must be
  that of the unturned one, to round-off.
* hexagon: an irregular hexagon with contact on three sides of different directions. On a side of length L

      w = 1000 β_+^4 (−ψ)_+^4,   p = 900 β_+² ψ_+²,   β = 4 s(L − s)/L²,   ψ = (1/8 + t/8) − (s − c(t))²,

  lifted to the depth 3/5; β keeps what belongs to one side away from the others.
* corner: Γ3 is the bottom and the left side of the unit square, Γ1 the right half of the top. With the
  distance ρ from the corner, on each side

      w = W (ρ − c)_+^4,   p = P (c² − ρ²)_+²;

  p is even in ρ, so the lifting of one side is symmetric about the other and leaves σ_τ = 0 there, and
  A, G do not couple normal strains. Both sides press at the corner itself, a vertex with two constraints.
"""

import numpy as np
from sympy import Expr, Float, Rational

from manufactured.body import Body, Kind, Part, polygon, unit_square
from manufactured.case import Case
from manufactured.cases import advance_recede
from manufactured.cases.laws import not_proportional, without_contraction
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.law import KelvinVoigt
from manufactured.profile import cutoff
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t

ANGLE = 0.4
SHIFT = (3.0, -1.0)
HEXAGON = ((-0.55, -0.8), (0.5, -0.9), (1.1, 0.05), (0.55, 0.85), (-0.5, 0.9), (-1.0, 0.1))


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
    kinds = [Kind.CONTACT, Kind.LOADED, Kind.CONTACT, Kind.CLAMPED, Kind.CONTACT, Kind.LOADED]
    body = polygon(HEXAGON, kinds)
    law = not_proportional()
    shares = (Rational(2, 5) + t / 5, Rational(3, 5) - t / 10, Rational(1, 2))
    faces = tuple(_pressed(part, body, law, c) for part, c in zip(body.of(Kind.CONTACT), shares, strict=True))
    return Case(
        name="hexagon",
        summary="irregular hexagon with contact on three sides of different directions",
        solution=ExactSolution(body, law, faces),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 on every side give (5.36): order 1 by Prop. 5.4",
    )


def _pressed(part: Part, body: Body, law: KelvinVoigt, share: Expr) -> ContactFace:
    """A patch that grows about the given share of a side."""
    length = Float(part.measure)
    bump = 4 * s * (length - s) / length**2
    level = Rational(1, 40) + t / 12 - (s / length - share) ** 2
    gap, pressure = 1000 * pos(bump, 4) * pos(-level, 4), 2500 * pos(bump, 2) * pos(level, 2)
    return ContactFace.linear(part, law, body.T, gap, pressure, level, profile=cutoff(0.6))


def corner() -> Case:
    kinds = [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED, Kind.CONTACT]
    body = polygon([(0, 0), (1, 0), (1, 1), (0.5, 1), (0, 1)], kinds)
    law = without_contraction()
    bottom, left = body.of(Kind.CONTACT)
    faces = (
        _at_corner(bottom, body, law, s, Rational(2, 5) + Rational(4, 5) * t * (1 - t), 1.0),
        # The left side runs down to the corner.
        _at_corner(left, body, law, 1 - s, Rational(3, 5) - t / 3, 0.5),
    )
    return Case(
        name="corner",
        summary="two sides at right angles in contact, pressure at the corner between them",
        solution=ExactSolution(body, law, faces),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 on both sides, u smooth at the corner: (5.36), order 1 by Prop. 5.4",
    )


def _at_corner(part: Part, body: Body, law: KelvinVoigt, rho: Expr, c: Expr, depth: float) -> ContactFace:
    gap, pressure = 20 * pos(rho - c, 4), 60 * pos(c**2 - rho**2, 2)
    return ContactFace.linear(part, law, body.T, gap, pressure, c - rho, profile=cutoff(depth))

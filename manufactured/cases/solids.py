"""Three dimensions: the unit cube on its bottom, and on its bottom and one side.

* disc: ψ = 1/10 + (3/5) t(1 − t) − |s − c(t)|², c = (2/5 + t/5, 1/2): a disc that moves, grows and shrinks;
  w = 2 (1/5 + t) (−ψ)_+^4/(1/2 − ψ)², p = 500 ψ_+², A and G not proportional.
* two faces: bottom z = 0 and side x = 0 with the edge between them under pressure, as ``bodies.corner`` in the
  plane; on each with the distance ρ from the edge and the coordinate η along it

      ψ = c(t)² + (η − 1/2)²/4 − ρ²,   w = (1/5 + t) (−ψ)_+^4/(1 − ψ)²,   p = 1500 t ψ_+²;

  Γ1 is the third x > 2/3 of the top.
"""

import numpy as np
from sympy import Expr, Rational

from manufactured.body import Body, Kind, Part, box
from manufactured.case import Case
from manufactured.cases.laws import not_proportional, without_contraction
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.law import KelvinVoigt
from manufactured.profile import cutoff
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s1, s2, t


def disc() -> Case:
    body = box()
    law = not_proportional(3)
    (part,) = body.of(Kind.CONTACT)
    level = (
        Rational(1, 10) + Rational(3, 5) * t * (1 - t) - (s1 - Rational(2, 5) - t / 5) ** 2 - (s2 - Rational(1, 2)) ** 2
    )
    gap = 2 * (Rational(1, 5) + t) * pos(-level, 4) / (Rational(1, 2) - level) ** 2
    face = ContactFace.linear(part, law, body.T, gap, 500 * pos(level, 2), level)
    return Case(
        name="cube-disc",
        summary="cube, a disc of contact moves, grows and shrinks",
        solution=ExactSolution(body, law, (face,)),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 across the circle give (5.36): order 1 by Prop. 5.4, in 3D, too",
        pace=4,
    )


def two_faces() -> Case:
    body = _cube_clamped_on_a_third()
    law = without_contraction(3)
    bottom, side = body.of(Kind.CONTACT)
    faces = (
        _at_edge(bottom, body, law, Rational(1, 2) + Rational(2, 5) * t * (1 - t), 1.0),
        _at_edge(side, body, law, Rational(3, 5) - t / 4, 2 / 3),
    )
    return Case(
        name="cube-two-faces",
        summary="cube, bottom and one side in contact, pressure on the edge between them",
        solution=ExactSolution(body, law, faces),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 on both faces, u smooth at the edge: (5.36), order 1 by Prop. 5.4 in 3D",
        pace=3,
    )


def _cube_clamped_on_a_third() -> Body:
    def part(kind: Kind, *corners: tuple[float, float, float]) -> Part:
        return Part(kind, np.array(corners).T)

    h = 2 / 3
    return Body(
        (
            part(Kind.CONTACT, (0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0)),
            part(Kind.CONTACT, (0, 0, 0), (0, 0, 1), (0, 1, 1), (0, 1, 0)),
            part(Kind.LOADED, (1, 0, 0), (1, 1, 0), (1, 1, 1), (1, 0, 1)),
            part(Kind.LOADED, (0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)),
            part(Kind.LOADED, (0, 1, 0), (0, 1, 1), (1, 1, 1), (1, 1, 0)),
            part(Kind.LOADED, (0, 0, 1), (h, 0, 1), (h, 1, 1), (0, 1, 1)),
            part(Kind.CLAMPED, (h, 0, 1), (1, 0, 1), (1, 1, 1), (h, 1, 1)),
        )
    )


def _at_edge(part: Part, body: Body, law: KelvinVoigt, c: Expr, depth: float) -> ContactFace:
    # On both faces the first corner lies on the edge x = z = 0; ρ runs along the first or second axis of s.
    edge = np.array([0.0, 1.0, 0.0])
    rho, eta = (s1, s2) if abs(part.tangent @ edge) < 0.5 else (s2, s1)
    level = c**2 + (eta - Rational(1, 2)) ** 2 / 4 - rho**2
    gap = (Rational(1, 5) + t) * pos(-level, 4) / (1 - level) ** 2
    return ContactFace.linear(part, law, body.T, gap, 1500 * t * pos(level, 2), level, profile=cutoff(depth))

"""Cases in space that satisfy the assumptions of Proposition 5.4; no initial gap."""

from typing import Any

import numpy as np
from sympy import Expr, Rational, cos, sin

from manufactured.body import Body, Kind, Part, box
from manufactured.case import Case
from manufactured.cases.shared import not_proportional, with_faces, with_one_face, without_contraction
from manufactured.profile import cutoff
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s1, s2, t


def cube_disc() -> Case:
    """The unit cube with a disc of contact on its bottom that moves, grows and shrinks.

    The gap w, the contact pressure p, the slip z, and the contact zone {ψ ≥ 0}, a disc with the centre c, are

        w = 2 (1/5 + t) (−ψ)_+^5/(1/2 − ψ)³,   p = 2000 ψ_+³,   z = (t(1 + t) sin(x + 2y)/4, −t cos(2x − y)/3),
        ψ = 1/10 + (3/5) t(1 − t) − |s − c(t)|²,   c(t) = (2/5 + t/5, 1/2)

    with the coordinates s = (x, y) along the bottom. Viscosity A and elasticity G are not proportional.

    Predicted order 1: the front moves. The exponents of gap and pressure across the circle, α = 5 > 7/2 and m = 3 >
    3/2, give (5.36), so that Prop. 5.4 applies; its proof also holds in 3D. The exponents also satisfy α > 9/2 and m >
    5/2, so that even (3.4) holds, with f_0 ∈ W^{1,1}(0,T;H); the paper uses only its consequence (3.8), f ∈
    W^{1,1}(0,T;V).
    """
    level = (
        Rational(1, 10) + Rational(3, 5) * t * (1 - t) - (s1 - Rational(2, 5) - t / 5) ** 2 - (s2 - Rational(1, 2)) ** 2
    )
    solution = with_one_face(
        box(),
        not_proportional(3),
        gap=2 * (Rational(1, 5) + t) * pos(-level, 5) / (Rational(1, 2) - level) ** 3,
        pressure=2000 * pos(level, 3),
        level=level,
        slip=(t * (1 + t) * sin(s1 + 2 * s2) / 4, -t * cos(2 * s1 - s2) / 3),
    )
    return Case(
        name="cube-disc",
        summary="cube, a disc of contact slips, moves, grows and shrinks",
        solution=solution,
        regularity=Regularity(gap=5, pressure=3, moving=True),
        order=1,
        reason="α = 5 > 7/2 and m = 3 > 3/2 across the circle give (5.36): order 1 by Prop. 5.4, in 3D, too",
        pace=4,
    )


def cube_two_faces() -> Case:
    """The unit cube with contact on its bottom and on one side, and pressure on their common edge: ``corner`` in 3D.

    The gap w, the contact pressure p, the contact zone {ψ ≥ 0} and the normal strain q at t = 0 are

        w = (1/5 + t) (−ψ)_+^4/(1 − ψ)²,   p = 1500 t ψ_+²,   ψ = c(t)² + (η − 1/2)²/4 − ρ²,   q(0) = 0,
        bottom: c(t) = 1/2 + (2/5) t(1 − t),   side: c(t) = 3/5 − t/4

    on each face, where ρ is the distance from the edge and η the coordinate along it. Γ3 is the bottom z = 0 and the
    side x = 0. Γ1 is the part x > 2/3 of the top. The displacement is the sum of two fields, one for each face, which
    reach to the depths 1 and 2/3. The field of one face does not change the contact data of the other face, because p
    is even in ρ, and A and G do not couple normal strains (``shared.without_contraction``).

    Predicted order 1: both fronts move. On both faces the exponents of gap and pressure at the front are α = 4 > 7/2
    and m = 2 > 3/2, and u is smooth at the edge. This gives (5.36), so that Prop. 5.4 applies; its proof also holds in
    3D.
    """
    # The coordinates along the bottom are (x, y), along the side (y, z). The edge between them is the y-axis.
    solution = with_faces(
        _cube_clamped_on_a_third(),
        without_contraction(3),
        _at_edge(s1, s2, Rational(1, 2) + Rational(2, 5) * t * (1 - t), 1.0),
        _at_edge(s2, s1, Rational(3, 5) - t / 4, 2 / 3),
    )
    return Case(
        name="cube-two-faces",
        summary="cube, bottom and one side in contact, pressure on the edge between them",
        solution=solution,
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 on both faces, u smooth at the edge: (5.36), order 1 by Prop. 5.4 in 3D",
        pace=3,
    )


def _cube_clamped_on_a_third() -> Body:
    """Return the unit cube with its top divided at x = 2/3."""
    left, right, front, back, bottom, top = box(left=Kind.CONTACT).parts
    h = 2 / 3
    loaded = np.diag([h, 1, 1]) @ top.corners
    clamped = np.diag([1 - h, 1, 1]) @ top.corners + np.array([[h], [0], [0]])
    return Body((bottom, left, right, front, back, Part(Kind.LOADED, loaded), Part(Kind.CLAMPED, clamped)))


def _at_edge(rho: Expr, eta: Expr, c: Expr, depth: float) -> dict[str, Any]:
    level = c**2 + (eta - Rational(1, 2)) ** 2 / 4 - rho**2
    return {
        "gap": (Rational(1, 5) + t) * pos(-level, 4) / (1 - level) ** 2,
        "pressure": 1500 * t * pos(level, 2),
        "level": level,
        "profile": cutoff(depth),
    }

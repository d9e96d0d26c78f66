"""Two sides at right angles in contact, with pressure at the corner between them: a vertex with two constraints.

The gap w, the contact pressure p, the slip z away from the corner and the contact zone {ψ ≥ 0} with the front c are

    w = 5 (ρ − c)_+^5,   p = 100 (c² − ρ²)_+³,   z = Z t ρ² (1 − ρ),   ψ = c − ρ,
    bottom: c(t) = 2/5 + (4/5) t(1 − t), Z = 8,   left: c(t) = 3/5 − t/3, Z = 12

on each side, where ρ is the distance from the corner. Γ3 is the bottom and the left side of the unit square. Γ1 is the
right quarter of the top. The displacement is the sum of two fields, one for each side, which reach to the depths 1 and
3/4. The field of one side does not change the contact data of the other side, for three reasons. Since p is even in ρ,
the field is symmetric about the other side and causes no shear there. z and ∂_ρ z vanish at ρ = 0. And A and G do not
couple normal strains (``laws.without_contraction``).

Predicted order 1: both fronts move. On both sides the exponents of gap and pressure at the front are α = 5 > 7/2 and m
= 3 > 3/2, and u is smooth at the corner. This gives (5.36), so that Prop. 5.4 applies. The exponents also satisfy α >
9/2 and m > 5/2, so (3.4) holds as it is printed.
"""

from typing import Any

from sympy import Expr, Rational

from manufactured.body import Kind, polygon
from manufactured.case import Case
from manufactured.cases.laws import without_contraction
from manufactured.cases.shared import with_faces
from manufactured.profile import cutoff
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def case() -> Case:
    kinds = [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED, Kind.CONTACT]
    body = polygon([(0, 0), (1, 0), (1, 1), (0.75, 1), (0, 1)], kinds)
    solution = with_faces(
        body,
        without_contraction(),
        _at_corner(s, Rational(2, 5) + Rational(4, 5) * t * (1 - t), 1.0, 8),
        # s runs down the left side, so the distance from the corner is 1 − s.
        _at_corner(1 - s, Rational(3, 5) - t / 3, 0.75, -12),
    )
    return Case(
        name="corner",
        summary="two sides at right angles in contact, pressure at the corner between them",
        solution=solution,
        regularity=Regularity(gap=5, pressure=3, moving=True),
        order=1,
        reason="α = 5 > 7/2 and m = 3 > 3/2 on both sides, u smooth at the corner: (5.36), order 1 by Prop. 5.4",
        pace=4,
        families=("unstructured",),
    )


def _at_corner(rho: Expr, c: Expr, depth: float, size: int) -> dict[str, Any]:
    return {
        "gap": 5 * pos(rho - c, 5),
        "pressure": 100 * pos(c**2 - rho**2, 3),
        "level": c - rho,
        "profile": cutoff(depth),
        "slip": (size * t * rho**2 * (1 - rho),),
    }

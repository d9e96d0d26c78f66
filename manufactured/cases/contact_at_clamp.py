"""A block that is clamped on its left side, with a contact zone that begins at the clamp.

The gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} with the front c are

    w = 5 (x − c)_+^4,   p = 400 x (c − x)_+²,   z = 12t x² (1 − x),   ψ = c − x,   c(t) = 1/5 + t/2

on the bottom of the unit square. Viscosity A and elasticity G are not proportional. Γ1 is the left
side, Γ3 the bottom, Γ2 the rest. Γ1 and Γ3 meet at the origin, at a right angle, and the contact zone [0, c(t)] begins
there.

Predicted order 1: p has the factor x, z and ∂_s z vanish at x = 0, so w and q vanish there for all times. The
displacement therefore vanishes on Γ1, (2.3), and is smooth at the corner between Γ1 and Γ3. The front moves. The
exponents of gap and pressure at the front, α = 4 > 7/2 and m = 2 > 3/2, give (5.36), so that Prop. 5.4 applies.

Where a contact zone meets a clamped side, the solution is usually singular (``junction``). This load avoids the
singularity.
"""

from sympy import Rational

from manufactured.body import Kind, polygon
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.cases.shared import with_one_face
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def case() -> Case:
    kinds = [Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.CLAMPED]
    c = Rational(1, 5) + t / 2
    solution = with_one_face(
        polygon([(0, 0), (1, 0), (1, 1), (0, 1)], kinds),
        not_proportional(),
        gap=5 * pos(s - c, 4),
        pressure=400 * s * pos(c - s, 2),
        level=c - s,
        slip=(12 * t * s**2 * (1 - s),),
    )
    return Case(
        name="contact-at-clamp",
        summary="Γ1 meets Γ3 at a right angle, and contact from there on to a front that moves",
        solution=solution,
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="p and ∂_s z have the factor x, so u is smooth at the clamp; α = 4 > 7/2 and m = 2 > 3/2 give (5.36): "
        "order 1 by Prop. 5.4",
        families=("unstructured",),
    )

"""Cases with an initial gap between body and foundation, which the paper does not treat."""

from sympy import Rational, cos, sin

from manufactured.body import box, unit_square
from manufactured.case import Case
from manufactured.cases.shared import SLIP, not_proportional, proportional, with_one_face
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, s1, s2, t


def closing_gap() -> Case:
    """A body above a sloping foundation, which its left end reaches first.

    The initial gap g, the gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} with the front c are

        g = 2/5 + x/5,   w = 2 (x − c)_+^4/(1/4 + (x − c)²),   p = 40 (c − x)_+²,   z = t(1 + t) sin(2x + 1)/2,
        ψ = c − x,   c(t) = −1/6 + 5t/6

    on the bottom of the unit square. Viscosity A and elasticity G are not proportional. The paper does not treat this
    case: the initial gap g is not zero, and w = g − u_ν is the remaining gap.

    Predicted order 1: u_n = w − g on Γ3, and a linear g adds a smooth field. The front moves. The exponents of gap and
    pressure at the front, α = 4 > 7/2 and m = 2 > 3/2, give (5.36), with which the proof of Prop. 5.4 holds for u minus
    a lifting of g.

    There is no contact before t = 1/5, when the front enters at the left end. At t = 1 the front is at x = 2/3, which
    is a vertex of no structured mesh with 2^k cells along a side.
    """
    c = Rational(-1, 6) + 5 * t / 6
    solution = with_one_face(
        unit_square(),
        not_proportional(),
        gap=2 * pos(s - c, 4) / (Rational(1, 4) + (s - c) ** 2),
        pressure=40 * pos(c - s, 2),
        level=c - s,
        initial_gap=(2 + s) / 5,
        slip=(SLIP / 2,),
    )
    return Case(
        name="closing-gap",
        summary="initial gap above a sloping foundation closes from the left, the face slips",
        solution=solution,
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="a linear initial gap adds a smooth field; α = 4 > 7/2 and m = 2 > 3/2 give (5.36): order 1",
        families=("criss-cross",),
    )


def parabolic_gap() -> Case:
    """A body above a round foundation: the initial gap is a parabola, and a patch of contact lies around its apex.

    The initial gap g, the gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} are

        g = 6 (x − 2/5)²,   w = 8 (1 + t) (−ψ)_+^4/(1/5 − ψ)³,   p = 500 ψ_+²,   z = t(1 + t) sin(2x + 1)/2,
        ψ = 1/16 + t(1 − t)/4 − (x − b(t))²,   b(t) = 9/20 + t/10

    on the bottom of the unit square. Viscosity and elasticity are equal, A = G: τ ↦ 2τ + (tr τ)/2 I. The paper does not
    treat this case: the initial gap g is not zero, and w = g − u_ν is the remaining gap.

    Predicted order 1: u_ν = g − w on Γ3, where the polynomial g only adds a smooth field. Both fronts move. The
    exponents of gap and pressure at the fronts, α = 4 > 7/2 and m = 2 > 3/2, give (5.36), with which the proof of Prop.
    5.4 holds for u minus a lifting of g.

    The half-width of the patch is 1/4 at t = 0 and t = 1, and 0.35 at t = 1/2. In the patch the body takes the shape of
    the foundation.
    """
    level = Rational(1, 16) + t * (1 - t) / 4 - (s - Rational(9, 20) - t / 10) ** 2
    solution = with_one_face(
        unit_square(),
        proportional(),
        gap=8 * (1 + t) * pos(-level, 4) / (Rational(1, 5) - level) ** 3,
        pressure=500 * pos(level, 2),
        level=level,
        initial_gap=6 * (s - Rational(2, 5)) ** 2,
        slip=(SLIP / 2,),
    )
    return Case(
        name="parabolic-gap",
        summary="initial gap above a round foundation, a patch about its apex slips, widens, narrows and drifts",
        solution=solution,
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="a parabola as initial gap adds a smooth field; α = 4 > 7/2 and m = 2 > 3/2 give (5.36): order 1",
        families=("shaken",),
    )


def cube_bowl() -> Case:
    """The unit cube above a foundation shaped like an upturned bowl, on which a disc of contact grows and moves.

    The initial gap g, the gap w, the contact pressure p, the slip z, and the contact zone {ψ ≥ 0}, a disc with the
    centre c, are

        g = 1/10 + (3/5)(x − 2/5)² + (2/5)(y − 3/5)²,   w = 2 (1/5 + t) (−ψ)_+^4/(1/2 − ψ)²,   p = 500 ψ_+²,
        z = (t(1 + t) sin(x + 2y)/6, −t cos(2x − y)/5),
        ψ = 1/10 + t/10 − |s − c(t)|²,   c(t) = (2/5 + t/10, 1/2 + t/20)

    with the coordinates s = (x, y) along the bottom. Viscosity A and elasticity G are not proportional. The paper does
    not treat this case: the initial gap g is not zero, and w = g − u_ν is the remaining gap.

    Predicted order 1: u_n = w − g on Γ3 with a polynomial g, which adds a smooth field. The front moves. The exponents
    of gap and pressure across the circle, α = 4 > 7/2 and m = 2 > 3/2, give (5.36). With (5.36) the proof of Prop. 5.4
    holds for u minus a lifting of g, also in 3D.
    """
    half = Rational(1, 2)
    level = (1 + t) / 10 - (s1 - Rational(2, 5) - t / 10) ** 2 - (s2 - half - t / 20) ** 2
    solution = with_one_face(
        box(),
        not_proportional(3),
        gap=2 * (Rational(1, 5) + t) * pos(-level, 4) / (half - level) ** 2,
        pressure=500 * pos(level, 2),
        level=level,
        initial_gap=Rational(1, 10) + 3 * (s1 - Rational(2, 5)) ** 2 / 5 + 2 * (s2 - Rational(3, 5)) ** 2 / 5,
        slip=(t * (1 + t) * sin(s1 + 2 * s2) / 6, -t * cos(2 * s1 - s2) / 5),
    )
    return Case(
        name="cube-bowl",
        summary="cube above a bowl turned upside down, a disc of contact slips and grows",
        solution=solution,
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="a paraboloid as initial gap adds a smooth field; α = 4 > 7/2 and m = 2 > 3/2 give (5.36): order 1",
        pace=4,
    )

"""Law (3.3): the material yields under contact and is then released.

On a contact face with normal strain −Q, Q ≥ 0, the law gives p = a Q̇ + b (Q − ρ)_+. With τ = t/t_1,

    Q = Q_1 h(τ) + t_1 D k(τ),   h = τ²(3 − 2τ),   k = τ²(τ − 1),   D = −(b/a)(Q_1 − ρ)   for t ≤ t_1,
    Q = ρ + (Q_1 − ρ) e^{−b(t − t_1)/a}                                                     for t ≥ t_1,

so that Q, Q̇ and p are continuous, p(t_1) = 0, and Q relaxes to the edge of K once p = 0. The arguments of both cases
are the law and factors of their other constants.
"""

from sympy import Expr, Float, Integer, Rational, exp

from manufactured.body import Kind, unit_square
from manufactured.case import Case
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.law import DeviatoricBall, FrobeniusBall, KelvinVoigt, Yield, isotropic
from manufactured.memory import Prescribed
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t

RELEASE = Rational(3, 5)
FROBENIUS = KelvinVoigt(isotropic(1, 1), Yield(6.0, FrobeniusBall(0.5)), "(3.3), Frobenius ball")
DEVIATORIC = KelvinVoigt(isotropic(1, 0.5), Yield(8.0, DeviatoricBall(0.1)), "(3.3), deviatoric ball")
ONE: Expr = Integer(1)


def _strain(viscosity: float, response: float, edge: float, start: Expr, rise: Expr, release: Expr) -> Prescribed:
    """−Q for Q = start + (part that rises), with Q_1 − ρ = ``rise`` + start − ρ at the release."""
    tau = t / release
    h, k = tau**2 * (3 - 2 * tau), tau**2 * (tau - 1)
    decay = Float(response / viscosity)
    excess = start + rise - Float(edge)
    loading = start + rise * h - release * decay * excess * k
    relaxing = Float(edge) + excess * exp(-decay * (t - release))
    return Prescribed(((float(release), -loading), (1.0, -relaxing)))


def whole_face(law: KelvinVoigt = FROBENIUS, gap: Expr = ONE, pressure: Expr = ONE, speed: Expr = ONE) -> Case:
    """Frobenius ball; all of Γ3 is pressed from rest, yields point after point, and is let go.

    Q_1 = (3/2 + 2x(1 − x)) ρ > ρ, start 0; after the release w = 8 (t − t_1)_+² (1 + 4x(1 − x)).
    """
    body = unit_square()
    (part,) = body.of(Kind.CONTACT)
    assert isinstance(law.G, Yield)
    response, edge = law.G.normal_response(part.normal)
    release = RELEASE / speed
    rise = Float(edge) * pressure * (Rational(3, 2) + 2 * s * (1 - s))
    strain = _strain(law.A.normal_modulus(part.normal), response, edge, Float(0), rise, release)
    w = 8 * gap * pos(t - release, 2) * (1 + 4 * s * (1 - s))
    return Case(
        name="yield-and-release",
        summary="law (3.3) yields under full contact, then the whole face is released",
        solution=ExactSolution(body, law, (ContactFace(part, w, strain, release - t),)),
        regularity=Regularity(),
        order=1,
        reason="w and q smooth in space, u̇ Lipschitz in time: (5.36) and order 1 by Prop. 5.4, G only Lipschitz",
        pace=6,
    )


def part_of_face(
    law: KelvinVoigt = DEVIATORIC, gap: Expr = ONE, pressure: Expr = ONE, speed: Expr = ONE, place: Expr = ONE
) -> Case:
    """Deviatoric ball; only x < c = 3/5 is in contact, yields at once, and is let go.

    Start ρ, the edge of K; Q_1 = ρ + 3 (c − x)_+²; w = 15 t² (x − c)_+³ + 4 (t − t_1)_+².
    """
    body = unit_square()
    (part,) = body.of(Kind.CONTACT)
    assert isinstance(law.G, Yield)
    response, edge = law.G.normal_response(part.normal)
    release, c = RELEASE / speed, place * Rational(3, 5)
    rise = 3 * pressure * pos(c - s, 2)
    strain = _strain(law.A.normal_modulus(part.normal), response, edge, Float(edge), rise, release)
    w = 15 * gap * t**2 * pos(s - c, 3) + 4 * gap * pos(t - release, 2)
    released = pos(t - release, 0)
    level = (c - s) * (1 - released) - released
    return Case(
        name="yield-on-a-part",
        summary="law (3.3) yields under contact on [0, 3/5], then that part is released",
        solution=ExactSolution(body, law, (ContactFace(part, w, strain, level, rough=(float(c),)),)),
        regularity=Regularity(gap=3, pressure=2),
        order=1,
        reason="fixed front with α = 3 > 5/2 and m = 2 > 3/2: u(t) ∈ H², (5.36) and order 1 by Prop. 5.4",
        pace=3,
    )

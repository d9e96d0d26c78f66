"""A front that advances and recedes over a material that softens in volume: G is symmetric and not positive.

    w = 20 (1 + t) (x − c)_+^5,   p = 20 (c − x)_+³,   ψ = c − x,   c(t) = 7/24 + 15t(1 − t)/8,   q(0) = 0

on the unit square; A τ = 2τ + (tr τ)/2 I with m_A = 2, G τ = τ − (3/2)(tr τ) I with the eigenvalues 1 in shear and −2
in volume, a = 5/2, g = −1/2.

Predicted order 1: the front moves, and the exponents α = 5 > 7/2 and m = 3 > 3/2 give (5.36), so that Prop. 5.4
applies, for which it is enough that G is Lipschitz. They satisfy (3.4) literally, too: α > 9/2, m > 5/2.

G is not monotone: L_G/m_A = 1. The strain that the pressure has caused does not decay but grows like e^{t/5}; errors
may grow like e^{2t/3}. The problem of a time step is known to have one solution for k < 1.

An eigenvalue of −5 in volume was tried first, with a gap that does not grow. There ‖Π^h u − u^h‖ may grow like
e^{5t/3}; it was 0.65 ‖u − Π^h u‖ at n = 8, and the row on Pythagoras failed with 1.15.
"""

from sympy import Integer, Rational

from manufactured.body import Kind, unit_square
from manufactured.case import Case
from manufactured.cases.laws import softening_in_volume
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.law import KelvinVoigt
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t

LAW = softening_in_volume()


def softening(law: KelvinVoigt = LAW, T: float = 1.0) -> ExactSolution:
    """Return the solution for another law with a > 0, with t replaced by t/T."""
    body, time = unit_square(T), t / Rational(T).limit_denominator(1000)
    (part,) = body.of(Kind.CONTACT)
    c = Rational(7, 24) + Rational(15, 8) * time * (1 - time)
    gap, pressure = 20 * (1 + time) * pos(s - c, 5), 20 * pos(c - s, 3)
    face = ContactFace.linear(part, law, body.T, gap, pressure, c - s, initial=Integer(0))
    return ExactSolution(body, law, (face,))


def case() -> Case:
    return Case(
        name="softening",
        summary="front advances and recedes, G softens in volume, memory grows",
        solution=softening(),
        regularity=Regularity(gap=5, pressure=3, moving=True),
        order=1,
        reason="α = 5 > 7/2 and m = 3 > 3/2 give (5.36): order 1 by Prop. 5.4, G only Lipschitz",
        families=("one-diagonal",),
    )

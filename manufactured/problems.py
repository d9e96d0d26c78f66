"""Problems whose solution and contact zone are not known, given by their data.

* ramp: a wedge that is clamped in a wall on its left side and rests on the ground. A load travels down its top,

      f_2 = −8 a(t) (1 − ((x_1 − c(t))/w)²)_+³ ν,   a = t²(3 − 2t),   c = 4/5 + 7t/5,   w = 4/5,

  The angles are such that no corner is singular while the ends of Γ3 are in contact: 60° between Γ1 and Γ2, 90° at both
  ends of Γ3, 120° within Γ2. Only the contact front is singular, with r^{3/2}. So u(t) ∈ H^{1+s} for s < 3/2, and the
  order is 1.
* bracket: an L-shaped body that is clamped at the top of its vertical part and pressed down at the end of its foot.
  Because of the re-entrant corner, u(t) ∈ H^{1+s} for s < 0.5445 only. Meshes of the family ``graded`` are refined
  towards this corner and towards the ends of Γ1.
"""

from dataclasses import dataclass

from sympy import Expr, Rational, sqrt

from manufactured.arguments import checked
from manufactured.body import Kind, polygon
from manufactured.cases.shared import l_shape, not_proportional
from manufactured.data import Data, LoadError
from manufactured.factor import x1
from manufactured.symbols import pos, t


def _bump(x: Expr) -> Expr:
    """Return the formula (1 − x²)_+³ of a load that is concentrated on |x| < 1."""
    return pos(1 - x**2, 3)


def ramp() -> Data:
    """Return the data of the problem ramp: a wedge on whose inclined top a load travels.

    The wedge has the corners (0, 0), (3, 0), (3, 1/2), (0, 1/2 + √3). Γ1 is its left side, Γ3 its bottom. The load on
    its top is

        f_2 = −8 t² (3 − 2t) (1 − ((x_1 − c(t))/w)²)_+³ ν,   c = 4/5 + 7t/5,   w = 4/5,   0 ≤ t ≤ 1.

    The right side is free, f_0 = 0 and u_0 = 0. The law is linear, with A and G that are not proportional.
    """
    slope = 1 / sqrt(3)
    height = Rational(1, 2) + 3 * slope
    kinds = [Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.CLAMPED]
    body = polygon([(0, 0), (3, 0), (3, 0.5), (0, float(height))], kinds)
    strength = 8 * t**2 * (3 - 2 * t) * _bump((x1 - Rational(4, 5) - 7 * t / 5) / Rational(4, 5))
    # The load presses against the outward normal of the top, which is (sin 30°, cos 30°).
    load = (-strength / 2, -strength * sqrt(3) / 2)
    return Data.formulas(body, not_proportional(), f0=(0, 0), f2={2: load})


def bracket() -> Data:
    """Return the data of the problem bracket: an L-shaped body whose foot is pressed down.

    The body is [0, 2]² without (1, 2]². Γ1 is its top x_2 = 2, Γ3 its bottom. The load on the top of the foot, x_2 = 1
    and 1 ≤ x_1 ≤ 2, is f_2 = −4t (1 − (2x_1 − 3)²)_+³ ν with 0 ≤ t ≤ 1. Other sides are free, f_0 = 0 and u_0 = 0. The
    law is linear, with A and G that are not proportional.
    """
    body = l_shape(refine=((1.0, 1.0), (1.0, 2.0), (0.0, 2.0)))
    strength = 4 * t * _bump((x1 - Rational(3, 2)) * 2)
    return Data.formulas(body, not_proportional(), f0=(0, 0), f2={2: (0, -strength)})


@dataclass(frozen=True, eq=False)
@checked(LoadError)
class OpenProblem:
    """A problem whose solution is not known, with the predicted order of convergence.

    Attributes:
        name: the name for tables and commands.
        summary: a description in one line.
        data: the data of the problem.
        order: the predicted order of ‖u − u^h‖_{L∞(0,T;V)}, or None.
        reason: why this order is predicted.
    """

    name: str
    summary: str
    data: Data
    order: float | None
    reason: str


def problems() -> tuple[OpenProblem, ...]:
    """Return all problems whose solution is not known."""
    return (
        OpenProblem(
            "ramp",
            "a wedge clamped in a wall and resting on the ground, under a load that travels",
            ramp(),
            1.0,
            "no corner is singular, and the front r^{3/2} lies in H^{5/2−ε} ⊂ H²",
        ),
        OpenProblem(
            "bracket",
            "an L-shaped body pressed down on its foot",
            bracket(),
            None,
            "u ∈ H^{1+s} for s < 0.5445 at the re-entrant corner, towards which meshes are graded",
        ),
    )

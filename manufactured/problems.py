"""Problems with unknown solution and contact zone, given by their data.

* ramp: a wedge clamped in a wall on its left side, resting on the ground, with a load that travels down its top,

      f_2 = −8 a(t) (1 − ((x_1 − c(t))/w)²)_+³ ν,   a = t²(3 − 2t),   c = 4/5 + 7t/5,   w = 4/5,

  the angles are such that no corner is singular while its ends touch the ground: 60° between Γ1 and Γ2, 90° at both
  ends of Γ3, 120° within Γ2. Only the contact front is singular, r^{3/2}: u(t) ∈ H^{1+s} for s < 3/2, order 1.
* bracket: an L-shaped body clamped at the top of its upright and pressed down on its foot; re-entrant corner, so u(t) ∈
  H^{1+s} for s < 0.5445 only. Meshes of the family ``graded`` refine towards it and towards the ends of Γ1.
"""

from __future__ import annotations

from dataclasses import dataclass

from sympy import Expr, Rational, sqrt

from manufactured.body import Kind, polygon
from manufactured.cases.laws import not_proportional
from manufactured.data import Data
from manufactured.factor import x1
from manufactured.symbols import pos, t


def _bump(x: Expr) -> Expr:
    """(1 − x²)_+³."""
    return pos(1 - x**2, 3)


def ramp() -> Data:
    """Return the wedge under a travelling load."""
    slope = 1 / sqrt(3)
    height = Rational(1, 2) + 3 * slope
    kinds = [Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.CLAMPED]
    body = polygon([(0, 0), (3, 0), (3, 0.5), (0, float(height))], kinds)
    strength = 8 * t**2 * (3 - 2 * t) * _bump((x1 - Rational(4, 5) - 7 * t / 5) / Rational(4, 5))
    # The outward normal of the top is (sin 30°, cos 30°).
    load = (-strength / 2, -strength * sqrt(3) / 2)
    return Data.formulas(body, not_proportional(), f0=(0, 0), f2={2: load})


def bracket() -> Data:
    """Return the L-shaped body that is pressed down on its foot."""
    kinds = [Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.LOADED, Kind.CLAMPED, Kind.LOADED]
    corners = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)]
    body = polygon(corners, kinds, refine=((1.0, 1.0), (1.0, 2.0), (0.0, 2.0)))
    strength = 4 * t * _bump((x1 - Rational(3, 2)) * 2)
    return Data.formulas(body, not_proportional(), f0=(0, 0), f2={2: (0, -strength)})


@dataclass(frozen=True, eq=False)
class OpenProblem:
    """A problem with unknown solution: its data and the predicted order.

    Attributes:
        name, summary: for tables.
        data: the data.
        order: the order of ‖u − u^h‖_{L∞(0,T;V)} that is to be enclosed, None if none is predicted.
        reason: the reason for this order.
    """

    name: str
    summary: str
    data: Data
    order: float | None
    reason: str


def problems() -> tuple[OpenProblem, ...]:
    """Return all problems of this module."""
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

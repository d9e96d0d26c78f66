"""Solutions in H² with contact patches of many sizes: trains of patches, each train half as wide as the one before.

There are two cases, trains and breathing-trains. The gap w, the contact pressure p and the contact zone {ψ ≥ 0} are

    S = sin(π (s/ℓ + 29/100)),   E = 4 s(L − s)/L²,   L = 1/8,   ℓ = 2^{−j−3} on the piece j = 0, …, 6 of Γ3,
    trains:            w = ω ℓ^{3/2} t E³ S_+^4,          p = ϖ ℓ^{1/2} t E³ (−S)_+²,            ψ = −S,
    breathing-trains:  w = ω ℓ^{3/2} E³ (S − μ(t))_+^4,   p = ϖ ℓ^{1/2} E³ (μ(t) − S)_+²,        ψ = μ(t) − S,

on the unit square. Γ3 is the first 7/8 of its bottom, divided into parts of the length L, with s measured along each
part; μ = 4t(1 − t) − 1/2, ω = 2, ϖ = 200. The displacement of a part is zero beyond its ends and below the depth ℓ/4.

The powers of ℓ have the following reason. A detail of width ℓ and height ℓ^{3/2} that reaches to a depth proportional
to ℓ contributes about ℓ to |u|²_{H²} and to |σ_ν|_{1/2} |u_ν'|_{1/2} on Γ3. So every train, which has about 1/ℓ
details, contributes equally. To |u_ν|²_{H²(Γ3)} a detail contributes about 1. With more and more trains of the same
total length, u therefore stays bounded in H², but its trace on Γ3 does not. The phase 29/100 is such that no front lies
at a vertex of a mesh, and that every mesh cuts the train of its own size in the same way. The depth and ϖ/ω are such
that the work of contact is large compared with the error.

Predicted for the work of contact on meshes with n cells along a side, 32 ≤ n ≤ 128: its square root has the order 1 of
the bound h² Σ_E |σ_ν|_{1/2,E} |u_ν'|_{1/2,E}, because for every such h there are trains of the widths h/2, …, 4h. On
coarser meshes wider trains are missing, and the order is lower; on finer meshes narrower trains are missing, and it is
higher. For one fixed u the order finally rises above 1. No order is predicted for the error in V, which is not
asymptotic on these meshes.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from sympy import Expr, Rational, pi, sin, sqrt

from manufactured.body import Body, Kind, polygon
from manufactured.case import Case
from manufactured.cases.shared import not_proportional
from manufactured.contact import ContactFace
from manufactured.contact.contact_face import Lifting
from manufactured.exact import ExactSolution
from manufactured.profile import QUARTIC, cutoff
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t
from manufactured.tensors import Points

TRAINS = 7
"""The number of trains of contact patches, one on each part of Γ3."""
LENGTH = Rational(1, 8)
"""The length L of every part of Γ3."""
GAP, PRESSURE = 2, 200
"""The factors ω and ϖ in the formulas of gap and pressure."""


@lru_cache
def multiscale() -> tuple[Case, ...]:
    """Return the cases with trains of contact patches.

    They are not in the catalogue, because the meshes of its cases are too coarse for them.
    """
    return static(), breathing()


def static() -> Case:
    """Return the case with fixed contact patches under a growing pressure."""
    return _case(
        "trains",
        "patches of contact of seven widths",
        [_piece(j, t, -_wave(j)) for j in range(TRAINS)],
        Regularity(gap=4, pressure=2),
    )


def breathing() -> Case:
    """Return the case with contact patches that widen and narrow again."""
    mu = 4 * t * (1 - t) - Rational(1, 2)
    return _case(
        "breathing-trains",
        "patches of contact of seven widths that widen and narrow again",
        [_piece(j, 1, mu - _wave(j)) for j in range(TRAINS)],
        Regularity(gap=4, pressure=2, moving=True),
    )


@dataclass(frozen=True, eq=False)
class StripFace(ContactFace):
    """A contact face in 2D whose displacement is zero beyond the ends s = 0 and s = |Γ3,i| of its part.

    The displacement of each train reaches to a depth in proportion to its details, and must not reach into the strip
    above the next part. At the ends the contact data must vanish so smoothly that no strain jumps.
    """

    def at(self, x: Points) -> Lifting:
        along = np.real(self.part.coordinates(x)[0][0])
        outside = (along < 0) | (along > self.part.measure)
        # Points beyond the ends are moved away from the face, deeper than the displacement reaches.
        return Lifting(self, x - np.multiply.outer(self.part.normal, 2 * self.profile.depth * outside))


Piece = tuple[float, Expr, Expr, Expr]
"""The data of a train of patches: its depth, and the formulas of gap w, pressure p and level function ψ."""


def _wave(j: int) -> Expr:
    return sin(pi * (s / _width(j) + Rational(29, 100)))


def _width(j: int) -> Expr:
    return Rational(1, 2 ** (j + 3))


def _piece(j: int, growth: Expr, level: Expr) -> Piece:
    width, fade = _width(j), (4 * s * (LENGTH - s) / LENGTH**2) ** 3
    w = GAP * growth * width * sqrt(width) * fade * pos(-level, 4)
    p = PRESSURE * growth * sqrt(width) * fade * pos(level, 2)
    return float(width) / 4, w, p, level


def _case(name: str, summary: str, pieces: list[Piece], regularity: Regularity) -> Case:
    body, law = _body(), not_proportional()
    faces = []
    for part, (depth, gap, pressure, level) in zip(body.of(Kind.CONTACT), pieces, strict=True):
        profile = cutoff(depth, QUARTIC)
        faces.append(StripFace.linear(part, law, body.T, gap, pressure, level, profile=profile))
    return Case(
        name=name,
        summary=summary,
        solution=ExactSolution(body, law, tuple(faces)),
        regularity=regularity,
        order=1,
        reason="α = 4 and m = 2 give (5.36), but the trace is large in H²(Γ3): order 1 where trains are resolved",
        pace=2,
    )


def _body() -> Body:
    """Return the unit square whose bottom is divided into parts, one for each train."""
    bottom = [(float(k * LENGTH), 0.0) for k in range(TRAINS + 1)]
    kinds = [Kind.CONTACT] * TRAINS + [Kind.LOADED, Kind.LOADED, Kind.CLAMPED, Kind.LOADED]
    return polygon([*bottom, (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], kinds)

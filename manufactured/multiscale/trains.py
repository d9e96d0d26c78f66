"""Solutions in H² with contact at every scale: trains of patches of contact, each train half as wide as the one before.

    S = sin(π (s/ℓ + 29/100)),   E = 4 s(L − s)/L²,   L = 1/8,   ℓ = 2^{−j−3} on the piece j = 0, …, 6 of Γ3,
    trains:            w = ω ℓ^{3/2} t E³ S_+^4,          p = ϖ ℓ^{1/2} t E³ (−S)_+²,            ψ = −S,
    breathing-trains:  w = ω ℓ^{3/2} E³ (S − μ(t))_+^4,   p = ϖ ℓ^{1/2} E³ (μ(t) − S)_+²,        ψ = μ(t) − S,

on the unit square. Γ3 is the first 7/8 of its bottom, in pieces of the length L with s measured on each;
μ = 4t(1 − t) − 1/2, ω = 2, ϖ = 200. The lifting of a piece is cut off at its ends and at the depth ℓ/4.

Why these powers: a detail of the width ℓ that is ℓ^{3/2} high and fades at a depth ∝ ℓ adds ∝ ℓ to |u|²_{H²} and to
|σ_ν|_{1/2} |u_ν'|_{1/2} on Γ3, so that every train counts alike, while it adds ∝ 1 to |u_ν|²_{H²(Γ3)}: with ever more
trains of equal length, of a total that stays fixed, u stays bounded in H² and its trace does not. The phase cuts every
level alike, as ℓ halves with h, and no front lies at a vertex of a grid. The depth and ϖ/ω are such that the work of
contact is large compared with the error.

Predicted for the work of contact on meshes of n cells along a side, 32 ≤ n ≤ 128: its root is of the order 1 of the
bound h² Σ_E |σ_ν|_{1/2,E} |u_ν'|_{1/2,E}, as for every such h there are trains of the widths h/2, …, 4h. On coarser
meshes there are too few that are wider, on finer ones too few that are narrower: lower and higher orders there. For one
fixed u the order must rise above 1 in the end. The error in V is not asymptotic on these meshes and no order is
predicted for it.
"""

from __future__ import annotations

from functools import lru_cache

from sympy import Expr, Rational, pi, sin, sqrt

from manufactured.body import Body, Kind, Part, polygon
from manufactured.case import Case
from manufactured.cases.laws import not_proportional
from manufactured.exact import ExactSolution
from manufactured.law import KelvinVoigt
from manufactured.multiscale.strip import StripFace
from manufactured.profile import QUARTIC, cutoff
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t

TRAINS = 7
"""The number of trains, and of pieces of Γ3."""
LENGTH = Rational(1, 8)
GAP, PRESSURE = 2, 200
"""ω and ϖ."""


@lru_cache
def multiscale() -> tuple[Case, ...]:
    """Return the cases with trains. They are not in the catalogue, whose levels are too coarse for them."""
    return static(), breathing()


def static() -> Case:
    """Return the case with fixed patches under a growing pressure."""
    return _case(
        "trains",
        "patches of contact of seven widths",
        [_piece(j, t, S := _wave(j), -S, t) for j in range(TRAINS)],
        Regularity(gap=4, pressure=2),
    )


def breathing() -> Case:
    """Return the case with patches that widen and narrow again."""
    mu = 4 * t * (1 - t) - Rational(1, 2)
    return _case(
        "breathing-trains",
        "patches of contact of seven widths that widen and narrow again",
        [_piece(j, 1, S := _wave(j) - mu, -S, 1) for j in range(TRAINS)],
        Regularity(gap=4, pressure=2, moving=True),
    )


Piece = tuple[float, Expr, Expr, Expr]
"""Depth, w, p and ψ of a train."""


def _wave(j: int) -> Expr:
    return sin(pi * (s / _width(j) + Rational(29, 100)))


def _width(j: int) -> Expr:
    return Rational(1, 2 ** (j + 3))


def _piece(j: int, gap: Expr, above: Expr, below: Expr, pressure: Expr) -> Piece:
    width, fade = _width(j), (4 * s * (LENGTH - s) / LENGTH**2) ** 3
    w = GAP * gap * width * sqrt(width) * fade * pos(above, 4)
    p = PRESSURE * pressure * sqrt(width) * fade * pos(below, 2)
    return float(width) / 4, w, p, below


def _case(name: str, summary: str, pieces: list[Piece], regularity: Regularity) -> Case:
    body, law = _body(), not_proportional()
    faces = tuple(_face(part, body, law, piece) for part, piece in zip(body.of(Kind.CONTACT), pieces, strict=True))
    return Case(
        name=name,
        summary=summary,
        solution=ExactSolution(body, law, faces),
        regularity=regularity,
        order=1,
        reason="α = 4 and m = 2 give (5.36), but the trace is large in H²(Γ3): order 1 where trains are resolved",
        pace=2,
    )


def _face(part: Part, body: Body, law: KelvinVoigt, piece: Piece) -> StripFace:
    depth, gap, pressure, level = piece
    face = StripFace.linear(part, law, body.T, gap, pressure, level, profile=cutoff(depth, QUARTIC))
    assert isinstance(face, StripFace)
    return face


def _body() -> Body:
    """The unit square whose bottom is cut into pieces."""
    bottom = [(float(k * LENGTH), 0.0) for k in range(TRAINS + 1)]
    kinds = [Kind.CONTACT] * TRAINS + [Kind.LOADED, Kind.LOADED, Kind.CLAMPED, Kind.LOADED]
    return polygon([*bottom, (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)], kinds)

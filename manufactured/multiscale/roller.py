"""Rollers: a narrow patch of contact that moves along Γ3, or that opens and closes in a fixed place.

The patch has the width ℓ if it moves and 2ℓ if it stands. Its normal strain q, contact pressure p and gap w are

    roller:          ξ = s − 3/20 − t,   q = −Q e^ξ H(−ξ/ℓ),          p = 3Q e^ξ H'(−ξ/ℓ)/ℓ,    w = ω ℓ W(ρ),
                     ρ = dist(ξ, [−ℓ, 0])/ℓ,
    standing patch:  ξ = s − 1/2,        q = −Q B(ξ/ℓ) Σ_j e^{t_j−t} H((t − t_j)/ℓ),
                     p = 3Q B(ξ/ℓ) Σ_j e^{t_j−t} H'((t − t_j)/ℓ)/ℓ,
                     w = ω ℓ (W(ρ) + B(ξ/ℓ) Π_j C((t − t_j)/ℓ)),   ρ = dist(ξ, [−ℓ, ℓ])/ℓ,

    H(z) = z³(10 − 15z + 6z²) on [0, 1], constant beyond,   B(z) = (1 − z²)_+^4,   W(ρ) = ρ³/(1 + ρ²)^{9/8},
    C(z) = H(−z) + H(z − 1), zero for 0 ≤ z ≤ 1,   t_1 = 1/10, t_2 = 2/5,   Q = 1, ω = 1/10, 0 ≤ t ≤ 7/10,

on the unit square with A = G: τ ↦ 2τ + (tr τ) I, so that p = −3(q̇ + q). The displacement reaches to the depth
7/10 (ℓ² + ξ²)^{1/2}: a detail of width r, at the distance r from the patch, reaches to a depth proportional to r.

For a fixed ℓ, u lies in H². As ℓ → 0 its norm in H² grows, but only like |log ℓ|^{1/2}. The reason is that W ~ ρ^{3/4}
for large ρ, which keeps ∂_s w bounded in H^{1/2}(Γ3), while q has a step at the patch: the strain that the pressure
p ≥ 0 causes decays in a time ∼ 1, much later than the patch has passed. The velocity is not bounded in H² as ℓ → 0.
W ~ ρ³ at ρ = 0, because with ρ² the strain ∂_s u_s = −y ∂_s² w would jump on lines into the body, and u would not lie
in H².

Predicted order 1 for a fixed ℓ and h → 0, because u ∈ H². The case ℓ = 2h is in
``study.statements.work_of_contact``.
"""

from functools import lru_cache

from sympy import Expr, Rational, exp, prod, sqrt

from manufactured.arguments import checked
from manufactured.body import Kind, unit_square
from manufactured.case import Case
from manufactured.exact import ExactSolution
from manufactured.law import KelvinVoigt, isotropic
from manufactured.multiscale.fading import FadingFace
from manufactured.regularity import Regularity
from manufactured.symbols import FormulaError, pos, s, t

T = 0.7
START = Rational(3, 20)
"""The position of the front of a roller at t = 0."""
MIDDLE = Rational(1, 2)
"""The position of the centre of a standing patch."""
LANDINGS = Rational(1, 10), Rational(2, 5)
"""The times t_j at which a standing patch comes into contact."""
SLOPE = Rational(1, 10)
"""The factor ω in the formula of the gap."""
ROLLERS = "roller", "pushing-roller", "steep-roller", "standing"
"""The names of the roller cases; a case of level n has "-n" added."""
COARSEST_ROLLER = 5
"""The smallest level n of the cases. A standing patch of half-width 2/n must lie within the contact face."""
DEPTH = Rational(7, 10)
"""The depth of the displacement divided by (ℓ² + ξ²)^{1/2}, where ξ is the position relative to the patch."""


@checked(FormulaError)
@lru_cache
def rollers(level: int) -> tuple[Case, ...]:
    """Return the roller cases for a level n, in which the width or half-width ℓ of the patch is 2/n.

    These cases are not in the catalogue, because each of them is meant for the meshes of one level.
    """
    if level < COARSEST_ROLLER:
        raise FormulaError(f"rollers: level has to be {COARSEST_ROLLER} or more, got {level}")
    width, (plain, pushing, steep, still) = Rational(2, level), (f"{kind}-{level}" for kind in ROLLERS)
    return (
        roller(plain, width),
        roller(pushing, width, push=2),
        roller(steep, width, slope=2 * SLOPE),
        standing(still, width),
    )


def roller(name: str, width: Expr, push: int = 1, slope: Expr = SLOPE) -> Case:
    """Return the case of a moving patch, for ℓ = ``width``, Q = ``push`` and ω = ``slope`` in the formulas."""
    xi = s - START - t
    place = -xi / width
    return _case(
        name,
        "a narrow patch runs along the floor",
        xi,
        width,
        gap=slope * width * (away(-place) + away(place - 1)),
        strain=-push * exp(xi) * step(place),
        pressure=3 * push * exp(xi) * kick(place) / width,
        level=-xi * (xi + width),
        regularity=Regularity(gap=3, pressure=2, moving=True),
    )


def standing(name: str, width: Expr) -> Case:
    """Return the case of a standing patch with the half-width ℓ = ``width``, which comes into contact twice."""
    xi = s - MIDDLE
    place = xi / width
    bump = pos(1 - (xi / width) ** 2, 4)
    since = [(t - start) / width for start in LANDINGS]
    pulses = [(exp(start - t), z) for start, z in zip(LANDINGS, since, strict=True)]
    lifted = prod([step(-z) + step(z - 1) for z in since])
    gap = SLOPE * width * (away(place - 1) + away(-place - 1) + bump * lifted)
    return _case(
        name,
        "a narrow patch opens and closes in its place",
        xi,
        width,
        gap=gap,
        strain=-bump * sum(fading * step(z) for fading, z in pulses),
        pressure=3 * bump * sum(fading * kick(z) for fading, z in pulses) / width,
        level=-gap,
        regularity=Regularity(gap=3, pressure=4),
    )


def step(z: Expr) -> Expr:
    """Return the formula of the smooth step H(z) = z³(10 − 15z + 6z²) on [0, 1], which is constant beyond."""
    inside = pos(z, 1) - pos(z - 1, 1)
    return inside**3 * (10 - 15 * inside + 6 * inside**2)


def kick(z: Expr) -> Expr:
    """Return the formula of the derivative H'(z) = 30 z²(1 − z)² of the smooth step on [0, 1], which is zero beyond."""
    return 30 * pos(z, 2) * pos(1 - z, 2)


def away(rho: Expr) -> Expr:
    """Return the formula W(ρ_+) of the gap outside the patch, with W(ρ) = ρ³/(1 + ρ²)^{9/8}."""
    return pos(rho, 3) / (1 + rho**2) ** Rational(9, 8)


def _case(name: str, summary: str, xi: Expr, width: Expr, regularity: Regularity, **data: Expr) -> Case:
    body, law = unit_square(T), KelvinVoigt(isotropic(1, 1), isotropic(1, 1), "linear, A = G")
    depth = DEPTH * sqrt(width**2 + xi**2)
    face = FadingFace(body.of(Kind.CONTACT)[0], depth=depth, least_depth=float(DEPTH * width), **data)
    return Case(
        name=name,
        summary=summary,
        solution=ExactSolution(body, law, (face,)),
        regularity=regularity,
        order=1,
        reason="α = 3 and m ≥ 2 give u ∈ H²: order 1 where the patch is resolved",
    )

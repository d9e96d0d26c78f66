"""Cases that are not smooth enough for Proposition 5.4: rough fronts, natural fronts, corners, a kink in a cell."""

from dataclasses import replace

import numpy as np
from sympy import Expr, Rational, Symbol, nsolve, pi, sin

from manufactured.arguments import checked
from manufactured.body import Kind, polygon, unit_square
from manufactured.case import Case
from manufactured.cases.shared import l_shape, not_proportional, proportional, two_layers, with_one_face
from manufactured.catalogue import NATURAL_MOTION
from manufactured.exact import ExactSolution
from manufactured.law import KelvinVoigt, Linear
from manufactured.profile import QUARTIC, Piecewise, cutoff, layered
from manufactured.regularity import Regularity
from manufactured.singular import Monomial, SingularFace, SingularField, TravellingField, kolosov
from manufactured.symbols import FormulaError, pos, s, t


def lame(tensor: Linear) -> tuple[float, float]:
    """Return the Lamé constants (μ, λ) of an isotropic tensor."""
    return float(tensor.matrix[-1, -1]) / 2, float(tensor.matrix[0, 1])


def kolosov_constant(tensor: Linear) -> float:
    """Return Kolosov's constant κ = (λ + 3μ)/(λ + μ) of an isotropic tensor in the plane."""
    mu, lam = lame(tensor)
    return (lam + 3 * mu) / (lam + mu)


def shearing(law: KelvinVoigt, theta: Expr) -> Expr:
    """Return the factor 2μ_A θ̇ + 2μ_G θ, by which an elastic stress is multiplied to give the stress.

    Let U = κΦ − z conj(Φ') − conj(Ψ) be a plane displacement, given by the potentials Φ and Ψ (``singular.kolosov``).
    The stress σ = A ε(u̇) + G ε(u) of the displacement u = θ(t) U is this factor times the elastic stress with these
    potentials. The viscosity A, with the shear modulus μ_A, and the elasticity G, with μ_G, must be isotropic with the
    same Kolosov constant κ.
    """
    assert isinstance(law.G, Linear)
    mu_A, mu_G = (Rational(lame(tensor)[0]) for tensor in (law.A, law.G))
    return 2 * mu_A * theta.diff(t) + 2 * mu_G * theta


def with_natural_front(theta: Expr, place: Expr, moving: bool = False) -> ExactSolution:
    """Return the exact solution with a natural front on the bottom of the unit square, for the law with G = 2A.

    A natural front is a contact front as it forms if the loads are smooth: the gap behaves like r^{3/2} and the strain
    like r^{1/2} at the distance r from it.

    Args:
        theta: the formula of the factor θ(t) by which the singular field of ``natural_front`` is multiplied.
        place: the position c of the front along the bottom: a number, or a formula of t if the front moves.
        moving: whether ``place`` depends on t. The velocity then also contains the derivative of the field along Γ3
            (``TravellingField``), and quadrature is not graded towards the front.
    """
    body, law = unit_square(), proportional(2.0)
    (part,) = body.of(Kind.CONTACT)
    kappa = kolosov_constant(law.A)
    x, y = kolosov(kappa, 1j, -0.5j, 1.5)
    steady = SingularField((0 if moving else place, 0), part.frame, x, y, theta, depth=cutoff().b)
    field = TravellingField(steady, place) if moving else steady
    gap = (kappa + 1) * theta * pos(s - place, Rational(3, 2))
    pressure = 3 * shearing(law, theta * pos(place - s, Rational(1, 2)))
    face = SingularFace(part, gap, pressure, place - s, field, rough=() if moving else (place,))
    return ExactSolution(body, law, (face,))


def natural_front() -> Case:
    """The natural front of frictionless contact, at rest: the solution just violates (5.36).

    The gap w, the contact pressure p and the contact zone {ψ ≥ 0} with the front c are

        w = θ (κ + 1) (x − c)_+^{3/2},   p = 3 (2μ_A θ̇ + 2μ_G θ) (c − x)_+^{1/2},   ψ = c − x,   c = 2/5,
        θ(t) = 1/4 + 2t

    on the bottom of the unit square. The elasticity is G = 2A, so κ = (λ_L + 3μ)/(λ_L + μ) is the same for A and G. At
    the point between contact and separation without friction, a plane elastic body has Williams' field with the
    exponent 3/2, which is half of the symmetric mode of a crack. Its potentials are Φ = i z^{3/2}, Ψ = −(i/2) z^{3/2}
    with z = (x − c) + iy (``singular.kolosov``), and Div σ = 0. The displacement is this field times θ(t) and the
    cut-off (1 − y)²(1 + 2y).

    Predicted order 1: u(t) ∈ H^{1+s} for s < 3/2, so interpolation has order 1. The trace is u_ν(t) ∈ H^τ(Γ3) for τ < 2
    only, which just violates (5.36), so Prop. 5.4 gives no order.

    Source: M. L. Williams, J. Appl. Mech. 19 (1952) 526–528.
    """
    return Case(
        name="natural-front",
        summary="the natural front of frictionless contact, w ~ r^{3/2}, fixed",
        solution=with_natural_front(Rational(1, 4) + 2 * t, Rational(2, 5)),
        regularity=Regularity(on_contact=1.5),
        order=1,
        reason="u(t) ∈ H^{5/2−ε} ⊂ H², so interpolation has order 1; the trace r^{3/2} just misses (5.36)",
        pace=1,
    )


MOVING_FRONT = Rational(1, 4) + Rational(2, 5) * t
"""The position c(t) of the contact front on the bottom of the unit square, in ``natural_motion``."""


@checked(FormulaError)
def natural_motion(place: Expr = MOVING_FRONT) -> Case:
    """The natural front of frictionless contact, advancing on a viscoelastic body.

    The gap w, the contact pressure p and the contact zone {ψ ≥ 0} with the front c are

        w = θ (κ + 1) (x − c)_+^{3/2},   p = 3 (2μ_A ∂_t + 2μ_G)(θ (c − x)_+^{1/2}),   ψ = c − x,   c(t) = 1/4 + 2t/5,

    with θ(t) = 1/4 + t, on the bottom of the unit square. A natural front is one as it forms if the loads are smooth:
    the gap behaves like r^{3/2} at the distance r from it. The elasticity is G = 2A. μ_A and μ_G are the shear moduli
    of A and G, and κ is Kolosov's constant, the same for both. The displacement is the singular field of
    ``natural_front``, which moves with the front. Its derivative ∂_x also satisfies Div σ = 0 and the contact
    conditions on both sides of the front. So u̇ ~ r^{1/2} and

        p = 3μ_A θ ċ (c − x)_+^{−1/2} + 6 (μ_A θ̇ + μ_G θ) (c − x)_+^{1/2}.

    p is not bounded, and for ċ < 0 it would be negative. The body force f_0 is due to the cut-off only. Near the front
    f_0 ~ r^{1/2} and ḟ_0 ~ r^{−1/2}, and the tractions f_2 are smooth, so (3.4) holds, f_0 ∈ W^{1,1}(0,T;H).

    Predicted order 1: u(t) ∈ H^{1+s} for s < 3/2, so that the interpolation error of u has order 1. But u̇(t) ∈ H^{1+s}
    for s < 1/2 only, and p ∉ L²(Γ3). Both parts of (5.36) are violated, u ∈ W^{1,2}(0,T;H²) by u̇ and u_ν ∈
    L¹(0,T;H²(Γ3)) by the gap, and the proof of Prop. 5.4 gives the order 1/2 only. The predicted order is higher for
    the following reason. The velocity error ‖u̇ − Π^h u̇‖_V ~ h^{1/2} comes from the cells at the front. The front
    passes a cell in a time ~ h, so the error that remains in this cell is ~ h^{3/2}. If the errors of the h^{−1} cells
    that the front passes are independent, the norm of all of them is ~ h, like the interpolation error. After this
    prediction, the order 1 up to a logarithm was proved in paper/fronts.tex.

    Args:
        place: the formula of the position c(t) of the front, with 0 < c < 1. By default it is 1/4 + 2t/5. If the front
            recedes, p is negative near it, so that the contact conditions (2.5) are violated.
    """
    return Case(
        name=NATURAL_MOTION,
        summary="the natural front advances: w ~ r^{3/2}, p ~ r^{−1/2}",
        solution=with_natural_front(Rational(1, 4) + t, place, moving=True),
        regularity=Regularity(on_contact=1.5, moving=True),
        order=1,
        reason="u(t) ∈ H^{5/2−ε} ⊂ H², so interpolation has order 1; u̇(t) ∈ H^{3/2−ε}, and C h |log h| is proved",
        pace=4,
    )


def rough_trace() -> Case:
    """A fixed front with u(t) ∈ H²(Ω), but with a trace on Γ3 that is not in H²(Γ3) and so violates (5.36).

    The gap w, the contact pressure p and the contact zone {ψ ≥ 0} with the front c are

        w = W θ (x − c)_+^α,   p = Q (A_nnnn θ̇ + G_nnnn θ) (c − x)_+^{α−1},   ψ = c − x,   c = 2/5,   θ(t) = 1/4 + 2t

    on the bottom of the unit square with α = 5/4, W = 4, Q = 3. Viscosity A and elasticity G are not proportional,
    A_nnnn = 5/2, G_nnnn = 7. The displacement is

        u_s = −α y Re(a z^{α−1}),   u_n = Re(a z^α) + y Re(b z^{α−1}),   z = (x − c) + iy,

    times θ(t) and the cut-off (1 − y)²(1 + 2y). The complex numbers a = W (1 + i cot πα) and b = iQ/sin π(α − 1) − iαa
    are such that u_n = W (x − c)_+^α and ε_nn = −Q (c − x)_+^{α−1} on y = 0. This works for any α > 1 and any isotropic
    A, G.

    Predicted order 1: u(t) ∈ H^{1+s} for s < α = 5/4, so interpolation has order 1. The trace is u_ν(t) ∈ H^τ(Γ3) for τ
    < α + 1/2 = 7/4 only, which violates (5.36), so Prop. 5.4 gives no order. Its proof gives τ/2, that is 7/8.
    """
    law = not_proportional()
    body = unit_square()
    (part,) = body.of(Kind.CONTACT)
    front = Rational(2, 5)
    theta = Rational(1, 4) + 2 * t
    alpha, W, Q = 1.25, 4.0, 3.0
    a = W * (1 + 1j / np.tan(np.pi * alpha))
    b = 1j * Q / np.sin(np.pi * (alpha - 1)) - 1j * alpha * a
    x = (Monomial(1, -alpha * a, alpha - 1),)
    y = (Monomial(0, a, alpha), Monomial(1, b, alpha - 1))
    field = SingularField((float(front), 0.0), part.frame, x, y, theta, depth=cutoff().b)
    modulus, stiffness = (tensor.normal_modulus(part.normal) for tensor in (law.A, law.G))  # type: ignore[attr-defined]
    p = Q * (modulus * theta.diff(t) + stiffness * theta) * pos(front - s, alpha - 1)
    w = W * theta * pos(s - front, alpha)
    face = SingularFace(part, w, p, front - s, field, rough=(float(front),))
    return Case(
        name="rough-trace",
        summary="u(t) in H², its trace on Γ3 only in H^{7/4}: w ~ r^{5/4}",
        solution=ExactSolution(body, law, (face,)),
        regularity=Regularity(on_contact=alpha),
        order=1,
        reason="u(t) ∈ H^{9/4−ε} ⊂ H², so interpolation has order 1; the proof of 5.4 gives 7/8 for this trace",
        pace=1,
    )


def moving_rough() -> Case:
    """A moving front that violates (5.36): u(t) ∈ H², but u̇(t) only in H^{7/4−ε}.

    The gap w, the contact pressure p, the contact zone {ψ ≥ 0} with the front c, and the normal strain q at t = 0 are

        w = 20 (1/5 + t) (x − c)_+^{13/4},   p = 150 (c − x)_+²,   ψ = c − x,   c(t) = 3/8 + t/4,   q(0) = −p(0)/g

    on the bottom of the unit square, with g = G_nnnn. Viscosity A and elasticity G are not proportional.

    Predicted order 1: the exponents of gap and pressure at the front are α = 13/4 and m = 2. So u(t) ∈ H^{1+s} for s <
    min(α − 3/2, m − 1/2) = 3/2, and the interpolation error of u has order 1. α < 7/2 violates (5.36), so Prop. 5.4
    gives no order.

    ẇ ~ (x − c)_+^{9/4}, so ‖u̇ − Π^h u̇‖_V ~ h^{3/4}, and the proof of Prop. 5.4 gives the order α − 5/2 = 3/4. The
    predicted order is higher because the front passes each cell in a time of order h. In this time a velocity error of
    order h^{3/4} changes the displacement by h^{7/4} only.
    """
    c = Rational(3, 8) + t / 4
    solution = with_one_face(
        unit_square(),
        not_proportional(),
        gap=20 * (Rational(1, 5) + t) * pos(s - c, Rational(13, 4)),
        pressure=150 * pos(c - s, 2),
        level=c - s,
    )
    return Case(
        name="moving-rough",
        summary="advancing front with u(t) in H², u̇(t) not",
        solution=solution,
        regularity=Regularity(gap=3.25, pressure=2, moving=True),
        order=1,
        reason="u(t) ∈ H² for α = 13/4, m = 2: interpolation of order 1; the proof of 5.4 gives α − 5/2 = 3/4",
        pace=4,
    )


def layered_unmet() -> Case:
    """Full contact of a body of two layers; the interface cuts through cells of the meshes.

    The gap w, the contact pressure p, the contact zone {ψ ≥ 0} and the normal strain q at t = 0 are

        w = 0,   p = 20 t (1 + x(1 − x)),   ψ = 1,   q(0) = 0

    on the bottom of the unit square. Viscosity A and elasticity G are not proportional, and for y > 1/3 both are 10
    times as large. At y = 1/3 the displacement has a kink that keeps σν continuous (``profile.layered``).

    Predicted order 1/2: the strain jumps inside cells, so u(t) ∈ H^{1+s} for s < 1/2 only, and interpolation has the
    order 1/2. Prop. 5.3 gives no order.

    Apart from the kink the solution is smooth, so the kink causes most of the error.
    """
    solution = with_one_face(
        unit_square(),
        two_layers(1 / 3, 10.0),
        gap=0,
        pressure=20 * t * (1 + s * (1 - s)),
        level=1,
        profile=layered(1 / 3, 10.0),
    )
    return Case(
        name="layered-unmet",
        summary="two layers, the interface y = 1/3 is met by no mesh",
        solution=solution,
        regularity=Regularity(kink=True),
        order=0.5,
        reason="the strain jumps inside cells: u(t) ∈ H^{1+s} for s < 1/2, interpolation of order 1/2, no rate claimed",
        pace=1,
    )


def rough_1_75() -> Case:
    """A fixed front at which the strain is unbounded: gap and pressure behave like r^{7/4} and r^{3/4}.

    The gap w, the contact pressure p, the contact zone {ψ ≥ 0} with the front c, and the normal strain q at t = 0 are

        w = 60 t (x − c)_+^{7/4} (1 − x)²,   p = 200 t (c − x)_+^{3/4} x²,   ψ = c − x,   c = 1/3,   q(0) = 0

    on the bottom of the unit square. Viscosity A and elasticity G are not proportional.

    Predicted order 1/4: the exponents of gap and pressure are α = 7/4 and m = 3/4. So u(t) ∈ H^{1+s} for s < min(α −
    3/2, m − 1/2) = 1/4, and interpolation has the order 1/4. Prop. 5.3 gives convergence but no order.

    c is not a vertex of the structured meshes. The factors (1 − x)² and x² make the error far from the front, of order
    1, small compared with the error at the front.
    """
    c = Rational(1, 3)
    solution = with_one_face(
        unit_square(),
        not_proportional(),
        gap=60 * t * pos(s - c, Rational(7, 4)) * (1 - s) ** 2,
        pressure=200 * t * pos(c - s, Rational(3, 4)) * s**2,
        level=c - s,
        rough=(c,),
    )
    return Case(
        name="rough-1.75",
        summary="fixed front with w ~ r^1.75, p ~ r^0.75",
        solution=solution,
        regularity=Regularity(gap=1.75, pressure=0.75),
        order=0.25,
        reason="u(t) ∈ H^(1+s) for s < α − 3/2 = 0.25: interpolation of that order, no rate claimed",
        pace=1,
    )


def re_entrant() -> Case:
    """An L-shaped body with a singularity at its re-entrant corner and an advancing contact front on its bottom.

    The gap w, the contact pressure p, the contact zone {ψ ≥ 0} with the front c, and the normal strain q at t = 0 are

        w = (x − c)_+^4,   p = 5 (c − x)_+²,   ψ = c − x,   c(t) = 3/5 + t/2,   q(0) = −p(0)/g

    on the bottom of the body with the corners (0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2), where g = G_nnnn. The
    elasticity is G = 2A, and the displacement of the contact face has the depth 9/10. The interior angle at the corner
    (1, 1) is ω = 3π/2. There Williams' symmetric singular field U for sides free of traction is added, with a cut-off,

        4t (1 − (r/R)²)_+³ U,   R = 9/10,   Φ = z^λ,   Ψ = b z^λ,   b = −(cos λω + λ cos ω).

    U has the potentials Φ and Ψ (``singular.kolosov``), and λ ≈ 0.5445 is the smallest positive root of sin λω + λ sin
    ω = 0. Both sides of the corner are free of traction at all times because A and G are proportional.

    Predicted order 0.5445 (λ): u(t) ∈ H^{1+s} for s < λ at the corner, so interpolation has the order λ on uniform
    meshes, and 1 on graded ones. Prop. 5.3 gives no order.

    Source: M. L. Williams, J. Appl. Mech. 19 (1952) 526–528.
    """
    law = proportional(2.0)
    c = Rational(3, 5) + t / 2
    on_bottom = with_one_face(
        l_shape(refine=((1.0, 1.0),)),
        law,
        gap=pos(s - c, 4),
        pressure=5 * pos(c - s, 2),
        level=c - s,
        profile=cutoff(0.9, QUARTIC),
    )
    root = Symbol("root")
    lam = float(nsolve(sin(3 * pi / 2 * root) - root, root, 0.54))
    omega = 1.5 * np.pi
    x, y = kolosov(kolosov_constant(law.A), 1.0, -(np.cos(lam * omega) + lam * np.cos(omega)), lam)
    # The first axis of the singular field is its axis of symmetry, which must point into the body.
    frame = np.array([[-1.0, 1.0], [-1.0, -1.0]]) / np.sqrt(2)
    radius = 0.9
    fade = Piecewise((radius,), ((1.0, 0.0, -3 / radius**2, 0.0, 3 / radius**4, 0.0, -1 / radius**6),))
    corner = SingularField((1.0, 1.0), frame, x, y, 4 * t, radial=fade)
    return Case(
        name="re-entrant",
        summary="re-entrant corner of an L-shaped body, advancing front on its bottom",
        solution=replace(on_bottom, others=(corner,), singular=((1.0, 1.0),)),
        regularity=Regularity(gap=4, pressure=2, moving=True, corner=lam),
        order=min(1.0, lam),
        reason="u(t) ∈ H^{1+s} for s < λ ≈ 0.5445 at the corner: that order on uniform meshes, 1 on graded ones",
        pace=1.5,
        families=("unstructured", "graded"),
    )


def junction() -> Case:
    """Clamped and contact boundary meet on a straight side, with contact everywhere: a singularity u ~ r^{1/2}.

    The gap w, the contact pressure p, the contact zone {ψ ≥ 0} and the function of time θ are

        w = 0,   p = (κ − 1)/2 (2μ_A θ̇ + 2μ_G θ) x^{−1/2},   ψ = 1,   θ(t) = t

    on the bottom of [−1, 1] × [0, 1]. The bottom is clamped for x < 0 and in contact for x > 0. The elasticity is G =
    2A, so κ = (λ_L + 3μ)/(λ_L + μ) is the same for A and G. The displacement is θ(t) times Williams' singular field for
    these two boundary conditions. The field has the exponent λ = 1/2 and the potentials Φ = z^{1/2}, Ψ = −(κ + 1/2)
    z^{1/2} (``singular.kolosov``). It satisfies σ_τ = 0 on Γ3 and Div σ = 0. p is not in L²(Γ3).

    Predicted order 1/2: u(t) ∈ H^{1+s} for s < λ = 1/2 at the junction, so interpolation has the order 1/2 on uniform
    meshes, and 1 on graded ones. Prop. 5.3 gives no order.

    Source: M. L. Williams, J. Appl. Mech. 19 (1952) 526–528.
    """
    law = proportional(2.0)
    kinds = [Kind.CLAMPED, Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.LOADED]
    body = polygon([(-1, 0), (0, 0), (1, 0), (1, 1), (-1, 1)], kinds, refine=((0.0, 0.0),))
    kappa = kolosov_constant(law.A)
    (part,) = body.of(Kind.CONTACT)
    x, y = kolosov(kappa, 1.0, -(kappa + 0.5), 0.5)
    field = SingularField((0.0, 0.0), np.eye(2), x, y, t)
    pressure = Rational(kappa - 1) / 2 * shearing(law, t) * pos(s, -Rational(1, 2))
    face = SingularFace(part, 0, pressure, 1, field, rough=(0.0,))
    return Case(
        name="junction",
        summary="Γ1 meets Γ3 in contact on a straight line: u ~ r^{1/2}, p ~ r^{−1/2}",
        solution=ExactSolution(body, law, (face,), (), ((0.0, 0.0),)),
        regularity=Regularity(on_contact=0.5),
        order=0.5,
        reason="u(t) ∈ H^{1+s} for s < 1/2 at the junction: order 1/2 on uniform meshes, 1 on graded ones",
        pace=1,
        families=("one-diagonal", "graded"),
    )

"""Cases with nonlinear, anisotropic, heterogeneous or softening material laws; the front is smooth."""

from dataclasses import replace

import numpy as np
from sympy import Expr, Rational, exp

from manufactured import profile
from manufactured.body import Body, Kind, Part, unit_square
from manufactured.case import Case
from manufactured.cases.shared import BULGE, GROWING_SLIP, SLIP, not_proportional, turn, two_layers, with_one_face
from manufactured.catalogue import NO_POTENTIAL
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.face_strain import Prescribed
from manufactured.factor import Factor, x1, x2
from manufactured.law import (
    Combined,
    DeviatoricBall,
    FrobeniusBall,
    Indefinite,
    KelvinVoigt,
    Linear,
    NonSymmetric,
    Yield,
    face_moduli,
    isotropic,
    isotropic_matrix,
)
from manufactured.profile import Profile, cutoff
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t
from manufactured.tensors import Array, rotation

RELEASE = Rational(3, 5)
"""The time t_1 at which the face is released."""


def edge(law: KelvinVoigt, part: Part) -> float:
    """Return the value ρ of Q at which the strain −Q n⊗n leaves the convex set K of the law (3.3).

    Args:
        law: a law whose elasticity is a ``Yield``, the law (3.3).
        part: the contact face, which gives the normal n.
    """
    assert isinstance(law.G, Yield)
    return law.G.normal_response(part.normal)[1]


def pressed_and_released(law: KelvinVoigt, part: Part, start: Expr, rise: Expr) -> Prescribed:
    """Return the prescribed normal strain −Q(s, t) on a face that is loaded and then released at t_1 = ``RELEASE``.

    The law (3.3) gives the pressure p = a Q̇ + b (Q − ρ)_+ for the normal strain −Q with Q ≥ 0. Here ρ is the value of
    Q at which the strain reaches the boundary of K. Q changes from Q_0(s) at t = 0 to Q_1(s) at t = t_1. With τ = t/t_1
    its formula is

        Q = Q_0 + (Q_1 − Q_0) h(τ) + t_1 D k(τ)   for t ≤ t_1,   Q = ρ + (Q_1 − ρ) e^{−b(t − t_1)/a}   for t ≥ t_1,
        h = τ²(3 − 2τ),   k = τ²(τ − 1),   D = −(b/a)(Q_1 − ρ).

    Then Q, Q̇ and p are continuous, p(t_1) = 0, and after t_1, where p = 0, Q relaxes towards ρ.

    Args:
        law: a law whose elasticity is a ``Yield``, the law (3.3).
        part: the face.
        start, rise: the formulas of Q_0 and of Q_1 − Q_0, functions of the coordinate s along the face.
    """
    assert isinstance(law.G, Yield)
    response, rho = law.G.normal_response(part.normal)
    tau = t / RELEASE
    h, k = tau**2 * (3 - 2 * tau), tau**2 * (tau - 1)
    decay = response / law.A.normal_modulus(part.normal)
    excess = start + rise - rho
    loading = start + rise * h - RELEASE * decay * excess * k
    relaxing = rho + excess * exp(-decay * (t - RELEASE))
    return Prescribed(((float(RELEASE), -loading), (1.0, -relaxing)))


def yield_and_release() -> Case:
    """Under the nonlinear law (3.3), a whole face is pressed from rest until t_1 and is then released.

    The gap w, the slip z, the contact pressure p and the contact zone {ψ ≥ 0} are

        w = 8 (t − t_1)_+² (1 + 4x(1 − x)),   z = 3t/2 + (t_1 − t)_+² (x + x²)/2,   ψ = t_1 − t,   t_1 = 3/5,
        p = a Q̇ − λ ∂_s ż + b (1 − ρ/|ε|)_+ Q,   |ε|² = (∂_s z)² + Q²

    on the bottom of the unit square. The convex set K of (3.3) is a ball in the Frobenius norm. The normal strain is q
    = −Q with Q of ``pressed_and_released``. Until t_1, Q changes from Q_0 = 0 to Q_1 = (3/2 + 2x(1 − x)) ρ > ρ. The
    strain leaves K when Q exceeds ρ, at different times at different points of the face. The constants are a = 5/2, λ =
    A_nnss = 1/2, b = β = 6, ρ = 1/2. After t_1 the face slips as a whole, with ∂_s z = 0, so that p = 0.

    Predicted order 1: there is no front. w and q = −Q are smooth in space, and u̇ is Lipschitz in time, which gives
    (5.36), so that Prop. 5.4 applies, for which it is enough that G is Lipschitz.
    """
    law = KelvinVoigt(isotropic(1, 0.5), Yield(6.0, FrobeniusBall(0.5)), "(3.3), Frobenius ball")
    body = unit_square()
    (part,) = body.of(Kind.CONTACT)
    rise = edge(law, part) * (Rational(3, 2) + 2 * s * (1 - s))
    strain = pressed_and_released(law, part, 0, rise)
    w = 8 * pos(t - RELEASE, 2) * BULGE
    slip = 3 * t / 2 + pos(RELEASE - t, 2) * (s + s**2) / 2
    return Case(
        name="yield-and-release",
        summary="law (3.3) yields under full contact of a face that slips, then the whole face is released",
        solution=ExactSolution(body, law, (ContactFace(part, w, strain, RELEASE - t, slip=(slip,)),)),
        regularity=Regularity(),
        order=1,
        reason="w and q smooth in space, u̇ Lipschitz in time: (5.36) and order 1 by Prop. 5.4, G only Lipschitz",
        pace=8,
        families=("criss-cross",),
    )


def yield_on_a_part() -> Case:
    """Under the nonlinear law (3.3), the part x < c of a face is in contact until t_1 and is then released.

    The gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} are

        w = 15 t² (x − c)_+³ + 4 (t − t_1)_+²,   p = a Q̇ + b (Q − ρ)_+,   z = 3t/2 + x²/4,   c = 3/5,   t_1 = 3/5,
        ψ = c − x for t < t_1,   ψ = −1 for t ≥ t_1

    on the bottom of the unit square. The convex set of (3.3) is K = {|dev τ| ≤ r}. The normal strain is q = ∂_s z − Q
    with Q of ``pressed_and_released``: dev ε depends on q − ∂_s z only, and ∂_s z does not change in time. Until t_1, Q
    changes from Q_0 = ρ to Q_1 = ρ + 3 (c − x)_+². At Q_0 the strain is on the boundary of K, so where there is contact
    it leaves K immediately. The constants are a = 5/2, b = β/2 = 4, ρ = √2/10.

    Predicted order 1: the front is fixed. The exponents of gap and pressure at the front, α = 3 > 5/2 and m = 2 > 3/2,
    give u(t) ∈ H² and (5.36), so that Prop. 5.4 applies.
    """
    law = KelvinVoigt(isotropic(1, 0.5), Yield(8.0, DeviatoricBall(0.1)), "(3.3), deviatoric ball")
    body = unit_square()
    (part,) = body.of(Kind.CONTACT)
    c = Rational(3, 5)
    rise = 3 * pos(c - s, 2)
    slip = 3 * t / 2 + s**2 / 4
    loaded = pressed_and_released(law, part, edge(law, part), rise)
    strain = Prescribed(tuple((end, slip.diff(s) + q) for end, q in loaded.phases))
    w = 15 * t**2 * pos(s - c, 3) + 4 * pos(t - RELEASE, 2)
    released = pos(t - RELEASE, 0)
    level = (c - s) * (1 - released) - released
    return Case(
        name="yield-on-a-part",
        summary="the face slips, law (3.3) yields under contact on [0, 3/5], then that part is released",
        solution=ExactSolution(body, law, (ContactFace(part, w, strain, level, rough=(float(c),), slip=(slip,)),)),
        regularity=Regularity(gap=3, pressure=2),
        order=1,
        reason="fixed front with α = 3 > 5/2 and m = 2 > 3/2: u(t) ∈ H², (5.36) and order 1 by Prop. 5.4",
        pace=6,
        families=("shaken",),
    )


FRONT: Expr = Rational(1, 4) + t / 2
"""The position c(t) of the contact front on the bottom of the unit square."""


def advancing_front(body: Body, law: KelvinVoigt, profile: Profile, pressure: Expr) -> ExactSolution:
    """Return the exact solution with an advancing contact front, for a given material law and pressure.

    The gap w, the slip z and the contact zone {ψ ≥ 0} with the front c are

        w = 8 (1/5 + t) (x − c)_+^4,   z = t(1 + t) sin(2x + 1),   ψ = c − x,   c(t) = 1/4 + t/2

    on the bottom of the unit square.

    Args:
        body: the unit square.
        law: the material law.
        profile: the functions of the depth that continue the displacement from the contact face into the body.
        pressure: the formula of the contact pressure p(s, t) with s = x, which must be 0 for x > c.
    """
    gap = 8 * (Rational(1, 5) + t) * pos(s - FRONT, 4)
    return with_one_face(body, law, gap=gap, pressure=pressure, level=FRONT - s, profile=profile, slip=(SLIP,))


def anisotropic_law() -> KelvinVoigt:
    """Return a law with orthotropic viscosity A and elasticity G that couples normal and shear strains on a face.

    The strains are coupled because the axes of A and G differ from each other and from the directions of the faces of
    the unit square.
    """
    A = _turned([[4.0, 0.5, 0.0], [0.5, 2.0, 0.0], [0.0, 0.0, 1.5]], 0.5)
    G = _turned([[3.0, 1.0, 0.0], [1.0, 6.0, 0.0], [0.0, 0.0, 2.0]], -0.3)
    return KelvinVoigt(Linear(A), Linear(G), "linear, A and G anisotropic")


def _turned(matrix: list[list[float]], angle: float) -> Array:
    """Return a tensor in Mandel form after a rotation of its axes."""
    turned_axes = rotation(turn(angle))
    C = turned_axes @ np.array(matrix) @ turned_axes.T
    return (C + C.T) / 2


def anisotropic() -> Case:
    """An advancing contact front on an anisotropic body, whose normal and shear strains are coupled on Γ3.

    The gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} with the front c are

        w = 8 (1/5 + t) (x − c)_+^4,   p = 150 (c − x)_+²,   z = t(1 + t) sin(2x + 1),   ψ = c − x,   c(t) = 1/4 + t/2

    on the bottom of the unit square. Viscosity A and elasticity G are orthotropic with different axes
    (``anisotropic_law``), so they couple the normal strain q = ε_nn and ε_ss with ε_sn. A shear strain r(x, t) on Γ3
    keeps σ_τ = 0.

    Predicted order 1: the front moves. q and r have the exponent m = 2 > 3/2 of p at the front, and w has the exponent
    α = 4 > 7/2. This gives (5.36), so that Prop. 5.4 applies.
    """
    return Case(
        name="anisotropic",
        summary="advancing front, A and G anisotropic with different axes",
        solution=advancing_front(unit_square(), anisotropic_law(), cutoff(), 150 * pos(FRONT - s, 2)),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="r and q inherit m = 2 from p, α = 4: (5.36) and order 1 by Prop. 5.4",
        pace=4,
        families=("unstructured",),
    )


def heterogeneous() -> Case:
    """An advancing contact front on a heterogeneous body: A and G vary smoothly with different factors.

    The gap w, the contact pressure p, the slip z, the contact zone {ψ ≥ 0} with the front c, the viscosity A and the
    elasticity G are

        w = 8 (1/5 + t) (x − c)_+^4,   p = 150 (c − x)_+²,   z = t(1 + t) sin(2x + 1),   ψ = c − x,   c(t) = 1/4 + t/2,
        A(x, y) = (1 + x/2)(1 + y) A_0,   G(x, y) = (1 + x/2)(1 + 3y²) G_0

    on the unit square, with contact on its bottom. The constant tensors A_0 and G_0 are not proportional. At y = 0 both
    factors are equal, so the relaxation rate G_nnnn/A_nnnn is constant on Γ3, which the exact solution needs. Inside
    the body the factors differ.

    Predicted order 1: the front moves. The coefficients are smooth, so the exponents of gap and pressure at the front,
    α = 4 > 7/2 and m = 2 > 3/2, give (5.36), and Prop. 5.4 applies.
    """
    along = 1 + x1 / 2
    viscous, elastic = Factor(along * (1 + x2), 1.0, 3.0), Factor(along * (1 + 3 * x2**2), 1.0, 6.0)
    law = not_proportional(2, viscous, elastic)
    return Case(
        name="heterogeneous",
        summary="advancing front, A and G vary smoothly in different ways",
        solution=advancing_front(unit_square(), law, cutoff(), 150 * pos(FRONT - s, 2)),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="smooth coefficients do not change the regularity: α = 4, m = 2, (5.36) and order 1 by Prop. 5.4",
        pace=4,
        families=("one-diagonal",),
    )


def layered() -> Case:
    """An advancing contact front on a body of two layers; the interface consists of edges of every mesh.

    The gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} with the front c are

        w = 8 (1/5 + t) (x − c)_+^4,   p = 400 (c − x)_+³,   z = t(1 + t) sin(2x + 1),   ψ = c − x,   c(t) = 1/4 + t/2

    on the bottom of the unit square. Viscosity A and elasticity G are not proportional, and for y > 1/2 both are 4
    times as large. At y = 1/2 the displacement has a kink that keeps σν continuous (``profile.layered``). In the upper
    layer u_s contains ∇_s q, the derivative of the normal strain q.

    Predicted order 1: the front moves, and the gap has the exponent α = 4 > 7/2 there. The term ∇_s q lowers the
    exponent m = 3 of the pressure by one, to 2 > 3/2. This gives (5.36) in each layer, but not across the interface.
    That is enough: the proof of Prop. 5.4 uses H² in (5.23) cell by cell, and no cell lies in both layers.
    """
    interface = Part(Kind.INTERFACE, np.array([[0.0, 1.0], [0.5, 0.5]]))
    body = replace(unit_square(), interfaces=(interface,))
    return Case(
        name="layered",
        summary="two layers, the interface y = 1/2 is met by the meshes",
        solution=advancing_front(body, two_layers(0.5, 4.0), profile.layered(0.5, 4.0), 400 * pos(FRONT - s, 3)),
        regularity=Regularity(gap=4, pressure=3, moving=True),
        order=1,
        reason="α = 4, m = 3, less one for ∇_s q: (5.36) in each layer, not across; (5.23) is cell by cell: order 1",
        pace=4,
        families=("criss-cross",),
    )


def softening_in_volume() -> KelvinVoigt:
    """Return a law whose elasticity G is positive in shear and negative in volume, so that the material softens.

    A τ = 2τ + (tr τ)/2 I and G τ = τ − (3/2)(tr τ) I; the normal moduli are a = 5/2 and g = −1/2.
    """
    return KelvinVoigt(isotropic(1, 0.5), Indefinite(isotropic_matrix(0.5, -1.5)), "linear, G softens in volume")


def with_softening(law: KelvinVoigt) -> ExactSolution:
    """Return the exact solution with the gap, pressure and slip of the case ``softening`` for a linear law.

    Args:
        law: the law; the normal modulus of its viscosity must be positive.
    """
    c = Rational(7, 24) + Rational(15, 8) * t * (1 - t)
    return with_one_face(
        unit_square(),
        law,
        gap=20 * (1 + t) * pos(s - c, 5),
        pressure=20 * pos(c - s, 3),
        level=c - s,
        initial=0,
        slip=(GROWING_SLIP,),
    )


def softening() -> Case:
    """A front that advances and recedes on a material that softens in volume: G is symmetric but not positive.

    The gap w, the contact pressure p, the slip z, the contact zone {ψ ≥ 0} with the front c, and the normal strain q at
    t = 0 are

        w = 20 (1 + t) (x − c)_+^5,   p = 20 (c − x)_+³,   z = 4t sin(3x + 1/2),   ψ = c − x,
        c(t) = 7/24 + 15t(1 − t)/8,   q(0) = 0

    on the bottom of the unit square. The viscosity is A τ = 2τ + (tr τ)/2 I with m_A = 2. The elasticity G τ = τ −
    (3/2)(tr τ) I has the eigenvalues 1 in shear and −2 in volume. The normal moduli are a = 5/2 and g = −1/2.

    Predicted order 1: the front moves. The exponents of gap and pressure at the front, α = 5 > 7/2 and m = 3 > 3/2,
    give (5.36), so that Prop. 5.4 applies, for which it is enough that G is Lipschitz. The exponents also satisfy α >
    9/2 and m > 5/2, so that even (3.4) holds, with f_0 ∈ W^{1,1}(0,T;H); the paper uses only its consequence (3.8), f ∈
    W^{1,1}(0,T;V).

    G is not monotone, and L_G/m_A = 1. The normal strain that the pressure has caused on Γ3 does not decay but grows
    like e^{t/5}, because −g/a = 1/5. Errors contain other strains, too. They may grow faster, like e^{2t/3}, because in
    volume A has the eigenvalue 3 and G the eigenvalue −2. The problem of a time step of length k is known to have a
    unique solution for k < 1.
    """
    return Case(
        name="softening",
        summary="front advances and recedes, the face slips, G softens in volume, memory grows",
        solution=with_softening(softening_in_volume()),
        regularity=Regularity(gap=5, pressure=3, moving=True),
        order=1,
        reason="α = 5 > 7/2 and m = 3 > 3/2 give (5.36): order 1 by Prop. 5.4, G only Lipschitz",
        families=("one-diagonal",),
    )


def softening_then_hardening() -> KelvinVoigt:
    """Return a prestressed law whose elasticity G softens inside K = {|τ| ≤ 2} and hardens outside.

    A τ = 2τ + (tr τ)/2 I with the normal modulus a = 5/2, and G ε = S − ε + 4 (ε − P_K ε) with the stress at rest S =
    e_1 ⊗ e_1 and the projection P_K onto K.
    """
    softens = Indefinite(isotropic_matrix(-0.5, 0))
    G = Combined(np.array([1.0, 0.0, 0.0]), softens, Yield(4.0, FrobeniusBall(2.0)))
    return KelvinVoigt(isotropic(1, 0.5), G, "G softens, then hardens, with a stress at rest")


def double_well() -> Case:
    """An advancing contact front on a prestressed material that softens and then hardens: G is nonlinear, not monotone.

    The gap w, the slip z, the normal strain q, the contact pressure p and the contact zone {ψ ≥ 0} with the front c are

        w = 5 (1 + 24t(1 − t)) (x − c)_+^4,   z = 3t (1 + x/2 − x²/4),   ψ = c − x,   c(t) = 5/24 + t/2,
        q = q_z − Q,   q_z = 3(1 − x)(1 − e^{2t/5})/4,   Q = 20 (c − x)_+³,
        p = a Q̇ − Q − 4 (1 − 2/|ε|)_+ q,   |ε|² = (∂_s z)² + q²

    on the bottom of the unit square. The viscosity is A τ = 2τ + (tr τ)/2 I with a = A_nnnn = 5/2. The elasticity is G
    ε = S − ε + 4 (ε − P_K ε) with K = {|τ| ≤ 2} and the stress at rest S = e_1 ⊗ e_1. q_z is the normal strain that the
    slip needs without pressure: a q̇_z − q_z + λ ∂_s ż = 0 with λ = A_nnss = 1/2. Where the front has not been, q =
    q_z, |ε| ≤ 2 and p = 0.

    Predicted order 1: the front moves. At the front q has the exponent 3, so p ~ q̇ has m = 2 > 3/2, and the gap has α
    = 4 > 7/2. This gives (5.36), so that Prop. 5.4 applies, for which it is enough that G is Lipschitz.

    Without S, the stored energy is smallest on a sphere around ε = 0, as in a body that snaps through. The slope of G
    is −1 inside K and 3 far from K. So L_G/m_A = 3/2, and differences of solutions may grow at the rate 1/2. The stress
    at rest S acts along the face and causes no traction on it, so it enters f_2 only.

    The factor 1 + 24t(1 − t) makes the gap largest while the front moves. With a small gap the pressure would cause
    most of the error.
    """
    law = softening_then_hardening()
    body = unit_square()
    (part,) = body.of(Kind.CONTACT)
    c = Rational(5, 24) + t / 2
    w = 5 * (1 + 24 * t * (1 - t)) * pos(s - c, 4)
    z = 3 * t * (1 + s / 2 - s**2 / 4)
    assert isinstance(law.G, Combined)
    (a, a_ss), (g, _) = (face_moduli(tensor, part.frame)[0, [0, 2]] for tensor in (law.A, law.G.linear))
    by_slip = z.diff(s, t) * (a_ss / g) * (exp(-g / a * t) - 1)
    strain = Prescribed(((body.T, by_slip - 20 * pos(c - s, 3)),))
    face = ContactFace(part, w, strain, c - s, slip=(z,))
    return Case(
        name="double-well",
        summary="front advances, the face slips, G softens, then hardens, and is prestressed",
        solution=ExactSolution(body, law, (face,)),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 give (5.36): order 1 by Prop. 5.4, G only Lipschitz",
        families=("criss-cross",),
    )


SKEW = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0], [-1.0, 0.0, 0.0]])
"""A skew matrix in Mandel form: the rotation by a right angle of the first and third components, 11 and √2·12."""


def law_without_potential() -> KelvinVoigt:
    """Return a linear law whose elasticity G is not symmetric, so that it is not the derivative of an energy.

    A τ = 2τ + (tr τ)/2 I and G τ = τ − (3/2)(tr τ) I + W τ, where W is skew: (W τ)_11 = 3√2 τ_12, (W τ)_12 =
    −(3/√2) τ_11 and (W τ)_22 = 0.
    """
    G = NonSymmetric(isotropic_matrix(0.5, -1.5) + 3 * SKEW)
    return KelvinVoigt(isotropic(1, 0.5), G, "linear, G softens in volume and has no potential")


def no_potential() -> Case:
    """A front that advances and recedes on a material whose elasticity has no potential and is not monotone.

    The gap w, the contact pressure p, the slip z, the contact zone {ψ ≥ 0} with the front c, and the normal strain q at
    t = 0 are the same as in the case ``softening``,

        w = 20 (1 + t) (x − c)_+^5,   p = 20 (c − x)_+³,   z = 4t sin(3x + 1/2),   ψ = c − x,
        c(t) = 7/24 + 15t(1 − t)/8,   q(0) = 0

    on the bottom of the unit square. The viscosity is A τ = 2τ + (tr τ)/2 I, and the elasticity is G τ = τ − (3/2)(tr
    τ) I + W τ with the skew part

        (W τ)_11 = 3√2 τ_12,   (W τ)_12 = −(3/√2) τ_11,   (W τ)_22 = 0.

    W τ·τ = 0, so G has the same constant of monotonicity m = −2 as in ``softening``, and differences of solutions may
    grow at the rate γ = 2/m_A = 1; κ = L_G/m_A = 2.03. G is not the derivative of a stored energy, because its matrix
    is not symmetric. W maps ε_22 to 0, so the normal strain on Γ3 is the same as in ``softening``. It maps ε_11 = ∂_s z
    to a shear stress; a shear strain on Γ3 causes the opposite shear stress, so that σ_τ = 0.

    Predicted order 1: (5.36) holds as for ``softening``, and Prop. 5.4 requires only that G is Lipschitz.

    The case is not in the catalogue, because some computations for cases of the catalogue need a symmetric G: the
    solution of Problem 3.2 (for the stress instead of the displacement), the energy balance, and the error bound.
    """
    return Case(
        name=NO_POTENTIAL,
        summary="front advances and recedes, G softens and has no potential",
        solution=with_softening(law_without_potential()),
        regularity=Regularity(gap=5, pressure=3, moving=True),
        order=1,
        reason="α = 5 > 7/2 and m = 3 > 3/2 give (5.36): order 1 by Prop. 5.4, G only Lipschitz",
        families=("one-diagonal",),
    )

"""Cases in the plane that satisfy the assumptions of Proposition 5.4, with linear laws; no initial gap."""

from dataclasses import replace
from typing import Any

import numpy as np
from sympy import Expr, Rational, cos, exp, sin

from manufactured.body import Body, Kind, polygon, unit_square
from manufactured.case import Case
from manufactured.cases.shared import (
    BULGE,
    GROWING_SLIP,
    SLIP,
    not_proportional,
    proportional,
    turn,
    with_faces,
    with_one_face,
    without_contraction,
)
from manufactured.contact import ContactFace
from manufactured.exact import ExactSolution
from manufactured.face_strain import Prescribed
from manufactured.law import KelvinVoigt, isotropic
from manufactured.profile import PARABOLA, QUARTIC, cutoff, slab
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t


def full_contact() -> Case:
    """The whole of the contact boundary stays in contact while the pressure grows from zero.

    The gap w, the contact pressure p, the slip z, the contact zone {ψ ≥ 0} and the normal strain q at t = 0 are

        w = 0,   p = 20 t (1 + 4 x(1 − x)),   z = t(1 + t) sin(2x + 1)/2,   ψ = 1,   q(0) = 0,   φ(y) = 1 − y²

    on the bottom of the unit square, where the cut-off φ lets the displacement end at the top. Viscosity A and
    elasticity G are not proportional.

    Predicted order 1: there is no front, and w and q are smooth in space and time, which gives (5.36), so that Prop.
    5.4 applies.

    The body starts at rest, u_0 = 0, so the error is zero at t = 0 and grows with the pressure. With this cut-off φ,
    the traction on the clamped boundary is not zero.
    """
    solution = with_one_face(
        unit_square(),
        not_proportional(),
        gap=0,
        pressure=20 * t * BULGE,
        level=1,
        initial=0,
        profile=cutoff(phi=PARABOLA),
        slip=(SLIP / 2,),
    )
    return Case(
        name="full-contact",
        summary="all of Γ3 in contact at all times, pressure growing from zero",
        solution=solution,
        regularity=Regularity(),
        order=1,
        reason="no front, u smooth in space and time: (5.36) and order 1 by Prop. 5.4",
        pace=4,
        families=("one-diagonal",),
    )


def no_contact() -> Case:
    """No contact at any time; a strain from earlier contact relaxes.

    The gap w, the contact pressure p, the contact zone {ψ ≥ 0}, which is empty, and the normal strain q at t = 0 are

        w = (1/10 + t²)(1 + 4x(1 − x)),   p = 0,   ψ = −1,   q(0) = −x(1 − x)

    on the bottom of the unit square. Viscosity A and elasticity G are not proportional.

    Predicted order 1: there is no front, and w and q are smooth in space and time, which gives (5.36), so that Prop.
    5.4 applies.

    Signorini's condition is never active, so the scheme must solve the linear problem. The initial strain q(0) relaxes
    like e^{−gt/a} with a = A_nnnn and g = G_nnnn.
    """
    solution = with_one_face(
        unit_square(),
        not_proportional(),
        gap=(Rational(1, 10) + t**2) * BULGE,
        pressure=0,
        level=-1,
        initial=-s * (1 - s),
    )
    return Case(
        name="no-contact",
        summary="no contact at any time, a strain from earlier contact relaxes",
        solution=solution,
        regularity=Regularity(),
        order=1,
        reason="no front, u smooth in space and time: (5.36) and order 1 by Prop. 5.4",
        pace=4,
        families=("criss-cross",),
    )


def _advancing_and_receding(body: Body) -> ExactSolution:
    """Return the solution on a unit square that may be rotated and translated."""
    c = Rational(1, 4) + 2 * t * (1 - t)
    return with_one_face(
        body,
        proportional(),
        gap=20 * pos(s - c, 4),
        pressure=20 * pos(c - s, 2),
        level=c - s,
        slip=(GROWING_SLIP,),
    )


def advance_recede() -> Case:
    """A contact front that advances and then recedes while the face slips; where it has been, the strain decays slowly.

    The gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} with the front c are

        w = 20 (x − c)_+^4,   p = 20 (c − x)_+²,   z = 4t sin(3x + 1/2),   ψ = c − x,   c(t) = 1/4 + 2t(1 − t)

    on the bottom of the unit square. Viscosity and elasticity are equal, A = G: τ ↦ 2τ + (tr τ)/2 I, so their normal
    moduli are a = g = 5/2.

    Predicted order 1: the front moves. The exponents of gap and pressure at the front, α = 4 > 7/2 and m = 2 > 3/2,
    give (5.36), so that Prop. 5.4 applies.

    The front moves from 1/4 to 3/4 and back. Where it has receded, the strain q that the pressure has caused decays
    like e^{−t}.
    """
    return Case(
        name="advance-recede",
        summary="front advances to 3/4 and recedes, the face slips, and the material remembers",
        solution=_advancing_and_receding(unit_square()),
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 give (5.36): order 1 by Prop. 5.4",
        families=("one-diagonal",),
    )


def travelling_patch() -> Case:
    """A contact patch that appears, travels and vanishes, on a face that slips.

    The gap w, the contact pressure p, the slip z, and the contact zone {ψ ≥ 0} with the centre b are

        w = 80 (1/4 + 3t(1 − t)) (−ψ)_+^5,   p = 20000 ψ_+³,   z = 3t² sin(2x + 1),
        ψ = (3/4)(t − 1/8)(7/8 − t) − (x − b(t))²,   b(t) = 3/10 + 2t/5

    on the bottom of the unit square. Viscosity A and elasticity G are not proportional.

    Predicted order 1: the fronts move. The exponents of gap and pressure at the fronts, α = 5 > 7/2 and m = 3 > 3/2,
    give (5.36), so that Prop. 5.4 applies. The exponents also satisfy α > 9/2 and m > 5/2, so that even (3.4) holds,
    with f_0 ∈ W^{1,1}(0,T;H); the paper uses only its consequence (3.8), f ∈ W^{1,1}(0,T;V).

    The patch appears at t = 1/8, travels from left to right and vanishes at t = 7/8; its largest half-width is 0.32.
    When it appears and vanishes, the speed of its fronts is infinite. The gap is largest between these times, so that
    the error is largest while the contact zone moves.
    """
    b = Rational(3, 10) + 2 * t / 5
    level = Rational(3, 4) * (t - Rational(1, 8)) * (Rational(7, 8) - t) - (s - b) ** 2
    solution = with_one_face(
        unit_square(),
        not_proportional(),
        gap=80 * (Rational(1, 4) + 3 * t * (1 - t)) * pos(-level, 5),
        pressure=20000 * pos(level, 3),
        level=level,
        slip=(3 * t**2 * sin(2 * s + 1),),
    )
    return Case(
        name="travelling-patch",
        summary="patch is born at t = 1/8, travels on a face that slips, vanishes at t = 7/8",
        solution=solution,
        regularity=Regularity(gap=5, pressure=3, moving=True),
        order=1,
        reason="α = 5 > 7/2 and m = 3 > 3/2 give (5.36): order 1 by Prop. 5.4",
        pace=10,
        families=("criss-cross",),
    )


def merging_patches() -> Case:
    """Two patches of contact appear, merge into one and separate again.

    The gap w, the contact pressure p, the normal strain q at t = 0 and the contact zone {ψ ≥ 0} are

        w = 8 (1/4 + 3t(1 − t)) (−ψ)_+^4/(1/5 − ψ)³,   p = 3000 ψ_+²,   q(0) = 0,
        ψ = −1/50 + (2/5) t(1 − t) − h(x),   h = 16 ((x − 1/4)(x − 7/10))²

    on the bottom of the unit square. Viscosity A and elasticity G are not proportional.

    Predicted order 1: all four fronts move. The exponents of gap and pressure at the fronts, α = 4 > 7/2 and m = 2 >
    3/2, give (5.36), so that Prop. 5.4 applies.

    The patches appear at x = 1/4 and x = 7/10, merge, separate and vanish. The number of fronts is 0, 4, 2, 4, 0 in
    turn. The denominator of w makes the gap flatter away from the fronts.
    """
    landscape = 16 * ((s - Rational(1, 4)) * (s - Rational(7, 10))) ** 2
    level = -Rational(1, 50) + Rational(2, 5) * t * (1 - t) - landscape
    solution = with_one_face(
        unit_square(),
        not_proportional(),
        gap=8 * (Rational(1, 4) + 3 * t * (1 - t)) * pos(-level, 4) / (Rational(1, 5) - level) ** 3,
        pressure=3000 * pos(level, 2),
        level=level,
    )
    return Case(
        name="merging-patches",
        summary="two patches are born, merge, part again and vanish",
        solution=solution,
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 at all four fronts give (5.36): order 1 by Prop. 5.4",
        pace=4,
        families=("shaken",),
    )


def lift_and_land() -> Case:
    """The whole contact face lifts off and lands again while it slips; the normal velocity jumps at the landing.

    The gap w, the contact zone {ψ ≥ 0}, the contact pressure p and the slip z are

        w = 40 (t − t_1)_+² (t_2 − t)_+,   ψ = (t − t_1)(t − t_2),   t_1 = 3/10, t_2 = 7/10,
        p = 3000 t (1 + 4x(1 − x)) (t_1 − t)_+² + [a·40 (t_2 − t_1)² + 60 (t − t_2) (1 + 4x(1 − x))] H(t − t_2),
        z = t(1 + t) sin(2x + 1)/2

    on the bottom of the unit square, with the unit step H. The viscosity A has no lateral contraction (λ_A = 0), and a
    = A_nnnn = 2.

    Predicted order 1: there is no front. w and the normal strain q on Γ3, which p and z cause, are smooth in space, and
    u̇ is bounded with one jump in time, so that u ∈ W^{1,∞}(0,T;H²). This gives (5.36), so that Prop. 5.4 applies.

    At the landing u̇ jumps by −ẇ(t_2^−) (1 − y) n with the inward normal n. For this A, the viscous stress of the jump
    is balanced by the pressure −a ẇ(t_2^−) on Γ3 alone. So p jumps, but the loads f_0 and f_2 stay continuous: f ∈
    W^{1,1}(0,T;V), while u is only in W^{1,∞}(0,T;V). The jump has this form because the normal displacement is u_n =
    w (1 − y) + (w + q) y φ(y) (``profile.slab``), and ẇ + q̇ does not jump.
    """
    lift, land = Rational(3, 10), Rational(7, 10)
    impact = 2 * 40 * (land - lift) ** 2
    solution = with_one_face(
        unit_square(),
        KelvinVoigt(isotropic(1, 0), isotropic(1, 2), "linear, A without contraction"),
        gap=40 * pos(t - lift, 2) * pos(land - t, 1),
        pressure=3000 * t * BULGE * pos(lift - t, 2) + (impact + 60 * (t - land) * BULGE) * pos(t - land, 0),
        level=(t - lift) * (t - land),
        profile=slab(),
        slip=(SLIP / 2,),
    )
    return Case(
        name="lift-and-land",
        summary="the whole face slips, lifts off and lands with a jump of the velocity",
        solution=solution,
        regularity=Regularity(),
        order=1,
        reason="w and q smooth in space, u̇ bounded with one jump: u ∈ W^{1,∞}(0,T;H²), (5.36), order 1 by Prop. 5.4",
        pace=14,
        families=("unstructured",),
    )


def load_w11() -> Case:
    """Full contact under a load that is hardly smoother in time than W^{1,1}, as the paper requires.

    The gap w, the contact pressure p, the slip z, the contact zone {ψ ≥ 0} and the normal strain q are

        w = 0,   p = (1 + 4x(1 − x)) (a θ̇ + g θ) − ∂_s ż/2 − 3 ∂_s z,   z = 2t(3/2 − t) cos(x),   ψ = 1,
        ε_nn = q = −(1 + 4x(1 − x)) θ,   θ(t) = t + (t − t_0)_+^{5/4}/4,   t_0 = 9/20,   φ(y) = 1 − y²

    on the bottom of the unit square, where the cut-off φ lets the displacement end at the top. Viscosity A and
    elasticity G are not proportional; their normal moduli are a = 5/2 and g = 7, and A_nnss = 1/2 and G_nnss = 3. The
    final time is T = 3/2, so that a time step 1/n is not T/n. The slip turns round at t = 3/4.

    Predicted order 1: there is no front. θ̇ is bounded and all functions are smooth in space, so u̇ is bounded with
    values in H². This gives (5.36), so that Prop. 5.4 applies.

    One could expect that only Prop. 5.3, which gives no order, applies to such a load. The loads contain θ̇ with the
    term (t − t_0)_+^{1/4}, so ḟ ~ (t − t_0)^{−3/4}, and the loads are in W^{1,r}(0,T) for r < 4/3 only. But both
    propositions require of the loads no more than W^{1,1}, (3.4) and (3.8). The further assumptions of Prop. 5.4 are on
    the solution: (4.12), which holds because p is bounded, and (5.36).
    """
    body = unit_square(T=1.5)
    law = not_proportional()
    (part,) = body.of(Kind.CONTACT)
    strain = -BULGE * (t + pos(t - Rational(9, 20), Rational(5, 4)) / 4)
    slip = 2 * t * (Rational(3, 2) - t) * cos(s)
    face = ContactFace(part, 0, Prescribed(((body.T, strain),)), 1, cutoff(phi=PARABOLA), slip=(slip,))
    return Case(
        name="load-w11",
        summary="full contact under a load in W^{1,r}(0,T) for r < 4/3 only",
        solution=ExactSolution(body, law, (face,)),
        regularity=Regularity(),
        order=1,
        reason="u̇ bounded with values in H²: (5.36) needs no more of the load, order 1 by Prop. 5.4",
        pace=16,
        families=("one-diagonal",),
    )


def rotated() -> Case:
    """The data of ``advance_recede`` on a unit square that is rotated by the angle 2/5 and translated.

    The gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} with the front c are

        w = 20 (s − c)_+^4,   p = 20 (c − s)_+²,   z = 4t sin(3s + 1/2),   ψ = c − s,   c(t) = 1/4 + 2t(1 − t)

    with s along the rotated bottom. Viscosity and elasticity are equal, A = G: τ ↦ 2τ + (tr τ)/2 I.

    Predicted order 1: the problem does not depend on the axes. As for ``advance_recede``, the exponents of gap and
    pressure at the front, α = 4 > 7/2 and m = 2 > 3/2, give (5.36), so that Prop. 5.4 applies.

    On structured meshes every error must equal the error of ``advance_recede`` up to round-off.
    """
    square = unit_square()
    corners = turn(0.4) @ square.vertices + np.array([[3.0], [-1.0]])
    body = polygon([(x, y) for x, y in corners.T], [part.kind for part in square.parts])
    plain = advance_recede()
    return replace(
        plain,
        name="rotated",
        summary="advance-recede on a turned square",
        solution=_advancing_and_receding(body),
        reason="nothing depends on the axes: the errors of advance-recede",
        twin=plain.name,
    )


def corner() -> Case:
    """Two sides at right angles in contact, with pressure at the corner between them: a vertex with two constraints.

    The gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} with the front c are

        w = 5 (ρ − c)_+^5,   p = 100 (c² − ρ²)_+³,   z = Z t ρ² (1 − ρ),   ψ = c − ρ,
        bottom: c(t) = 2/5 + (4/5) t(1 − t), Z = 8,   left: c(t) = 3/5 − t/3, Z = 12

    on each side, where ρ is the distance from the corner, and z > 0 is a slip that points away from it. Γ3 is the
    bottom and the left side of the unit square. Γ1 is the right quarter of the top. The displacement is the sum of two
    fields, one for each side, which reach to the depths 1 and 3/4. The field of one side does not change the contact
    data of the other side, for three reasons. Since p is even in ρ, the field is symmetric about the other side and
    causes no shear there. z and ∂_ρ z vanish at ρ = 0. And A and G do not couple normal strains
    (``shared.without_contraction``).

    Predicted order 1: both fronts move. On both sides the exponents of gap and pressure at the front are α = 5 > 7/2
    and m = 3 > 3/2, and u is smooth at the corner. This gives (5.36), so that Prop. 5.4 applies. The exponents also
    satisfy α > 9/2 and m > 5/2, so that even (3.4) holds, with f_0 ∈ W^{1,1}(0,T;H); the paper uses only its
    consequence (3.8), f ∈ W^{1,1}(0,T;V).
    """
    kinds = [Kind.CONTACT, Kind.LOADED, Kind.CLAMPED, Kind.LOADED, Kind.CONTACT]
    body = polygon([(0, 0), (1, 0), (1, 1), (0.75, 1), (0, 1)], kinds)
    solution = with_faces(
        body,
        without_contraction(),
        _at_corner(s, Rational(2, 5) + Rational(4, 5) * t * (1 - t), 1.0, 8),
        # s runs down the left side, so the distance from the corner is 1 − s.
        _at_corner(1 - s, Rational(3, 5) - t / 3, 0.75, -12),
    )
    return Case(
        name="corner",
        summary="two sides at right angles in contact, pressure at the corner between them",
        solution=solution,
        regularity=Regularity(gap=5, pressure=3, moving=True),
        order=1,
        reason="α = 5 > 7/2 and m = 3 > 3/2 on both sides, u smooth at the corner: (5.36), order 1 by Prop. 5.4",
        pace=4,
        families=("unstructured",),
    )


def _at_corner(rho: Expr, c: Expr, depth: float, size: int) -> dict[str, Any]:
    return {
        "gap": 5 * pos(rho - c, 5),
        "pressure": 100 * pos(c**2 - rho**2, 3),
        "level": c - rho,
        "profile": cutoff(depth),
        "slip": (size * t * rho**2 * (1 - rho),),
    }


def contact_at_clamp() -> Case:
    """A block that is clamped on its left side, with a contact zone that begins at the clamp.

    The gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} with the front c are

        w = 5 (x − c)_+^4,   p = 400 x (c − x)_+²,   z = 12t x² (1 − x),   ψ = c − x,   c(t) = 1/5 + t/2

    on the bottom of the unit square. Viscosity A and elasticity G are not proportional. Γ1 is the left side, Γ3 the
    bottom, Γ2 the rest. Γ1 and Γ3 meet at the origin, at a right angle, and the contact zone [0, c(t)] begins there.

    Predicted order 1: p has the factor x, and z and ∂_s z vanish at x = 0. So the normal strain q, which p and z cause,
    vanishes there for all times; w does, too, because c > 0. The displacement therefore vanishes on Γ1, (2.3), and is
    smooth at the corner between Γ1 and Γ3. The front moves. The exponents of gap and pressure at the front, α = 4 > 7/2
    and m = 2 > 3/2, give (5.36), so that Prop. 5.4 applies.

    Where a contact zone meets a clamped side, the solution is usually singular (``rough.junction``). This load avoids
    the singularity.
    """
    kinds = [Kind.CONTACT, Kind.LOADED, Kind.LOADED, Kind.CLAMPED]
    c = Rational(1, 5) + t / 2
    solution = with_one_face(
        polygon([(0, 0), (1, 0), (1, 1), (0, 1)], kinds),
        not_proportional(),
        gap=5 * pos(s - c, 4),
        pressure=400 * s * pos(c - s, 2),
        level=c - s,
        slip=(12 * t * s**2 * (1 - s),),
    )
    return Case(
        name="contact-at-clamp",
        summary="Γ1 meets Γ3 at a right angle, and contact from there on to a front that moves",
        solution=solution,
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="p and ∂_s z have the factor x, so u is smooth at the clamp; α = 4 > 7/2 and m = 2 > 3/2 give (5.36): "
        "order 1 by Prop. 5.4",
        families=("unstructured",),
    )


def hexagon() -> Case:
    """An irregular hexagon with contact on three sides of different directions.

    The gap w, the contact pressure p, the slip z and the contact zone {ψ ≥ 0} with the front c are

        w = 4 (1/5 + t) (ξ − c)_+^4/(1/4 + (ξ − c)²),   p = P (c − ξ)_+²,   ψ = c − ξ,
        first:  ξ = s,               c(t) = 3/10 + t/4,        P = 50,        z = t(1 + t) sin(2ξ + 1)/2,
        second: ξ = |Γ3,2| − s,      c(t) = 3/4 − t/4,         P = 900 ξ²,    z = 25t ξ³ e^{−4ξ},
        third:  ξ = s,               c(t) = 1/2 + t(1 − t),    P = 900 ξ²,    z = 25t ξ³ e^{−4ξ}

    with the coordinate s along each side. Viscosity A and elasticity G are not proportional. Two of the sides meet the
    clamped boundary Γ1. On them ξ is the distance from the end at Γ1, P has the factor ξ², and z has the factor ξ³, so
    that the displacement vanishes on Γ1. The displacement fields of the three sides reach to the depth 4/5, which is
    not as far as another contact side.

    Predicted order 1: the fronts move. On every side the exponents of gap and pressure at the front, α = 4 > 7/2 and m
    = 2 > 3/2, give (5.36), so that Prop. 5.4 applies.

    The denominator of w makes the gap flatter away from the fronts.
    """
    contact, loaded = Kind.CONTACT, Kind.LOADED
    vertices = [(-0.5, -0.9), (0.55, -0.85), (1.05, 0.05), (0.5, 0.85), (-0.55, 0.9), (-1.0, 0.0)]
    body = polygon(vertices, [contact, loaded, contact, Kind.CLAMPED, contact, loaded])
    _, second, _ = body.of(contact)
    solution = with_faces(
        body,
        not_proportional(),
        _with_front(s, Rational(3, 10) + t / 4, 50, SLIP / 2),
        _from_clamp(second.measure - s, Rational(3, 4) - t / 4),
        _from_clamp(s, Rational(1, 2) + t * (1 - t)),
    )
    return Case(
        name="hexagon",
        summary="irregular hexagon with contact on three sides of different directions",
        solution=solution,
        regularity=Regularity(gap=4, pressure=2, moving=True),
        order=1,
        reason="α = 4 > 7/2 and m = 2 > 3/2 on every side give (5.36): order 1 by Prop. 5.4",
        pace=4,
    )


def _from_clamp(place: Expr, c: Expr) -> dict[str, Any]:
    return _with_front(place, c, 900 * pos(place, 2), 25 * t * pos(place, 3) * exp(-4 * place))


def _with_front(place: Expr, c: Expr, scale: Expr, slip: Expr) -> dict[str, Any]:
    return {
        "gap": 4 * (Rational(1, 5) + t) * pos(place - c, 4) / (Rational(1, 4) + (place - c) ** 2),
        "pressure": scale * pos(c - place, 2),
        "level": c - place,
        "profile": cutoff(0.8, QUARTIC),
        "slip": (slip,),
    }

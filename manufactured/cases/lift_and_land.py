"""The whole contact face lifts off and lands again while it slips; the normal velocity jumps at the landing.

The gap w, the contact zone {ψ ≥ 0}, the contact pressure p and the slip z are

    w = 40 (t − t_1)_+² (t_2 − t)_+,   ψ = (t − t_1)(t − t_2),   t_1 = 3/10, t_2 = 7/10,
    p = 3000 t (1 + 4x(1 − x)) (t_1 − t)_+² + [a·40 (t_2 − t_1)² + 60 (t − t_2) (1 + 4x(1 − x))] H(t − t_2),
    z = t(1 + t) sin(2x + 1)/2

on the bottom of the unit square, with the unit step H. The viscosity A has no lateral contraction (λ_A = 0), and
a = A_nnnn = 2.

Predicted order 1: there is no front. w and q are smooth in space, and u̇ is bounded with one jump in time, so that
u ∈ W^{1,∞}(0,T;H²). This gives (5.36), so that Prop. 5.4 applies.

At the landing u̇ jumps by −ẇ(t_2^−) (1 − y) n. For this A, the viscous stress of the jump is balanced by the pressure
−a ẇ(t_2^−) on Γ3 alone. So p jumps, but the loads f_0 and f_2 stay continuous: f ∈ W^{1,1}(0,T;V), while u is only in
W^{1,∞}(0,T;V). The displacement contains a field with this jump because u_n = w (1 − y) + … (``profile.slab``).
"""

from sympy import Rational

from manufactured.body import unit_square
from manufactured.case import Case
from manufactured.cases.shared import SLIP, with_one_face
from manufactured.law import KelvinVoigt, isotropic
from manufactured.profile import slab
from manufactured.regularity import Regularity
from manufactured.symbols import pos, s, t

LIFT, LAND = Rational(3, 10), Rational(7, 10)


def case() -> Case:
    swell = 1 + 4 * s * (1 - s)
    impact = 2 * 40 * (LAND - LIFT) ** 2
    solution = with_one_face(
        unit_square(),
        KelvinVoigt(isotropic(1, 0), isotropic(1, 2), "linear, A without contraction"),
        gap=40 * pos(t - LIFT, 2) * pos(LAND - t, 1),
        pressure=3000 * t * swell * pos(LIFT - t, 2) + (impact + 60 * (t - LAND) * swell) * pos(t - LAND, 0),
        level=(t - LIFT) * (t - LAND),
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

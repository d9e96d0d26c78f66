"""The list of controls: which defect, where, and which row of the ledger must fail."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic

from study.controls import defects
from study.controls.baselines import Baseline, Equivalence, S, StressSweep, Sweep


@dataclass(frozen=True)
class Control(Generic[S]):
    """One deliberate defect.

    Attributes:
        name: of the defect.
        what: is wrong, in a line.
        setting: where it is measured.
        defect: turns what would be measured there into what is measured.
        caught_by: the key of the row that must fail.
    """

    name: str
    what: str
    setting: Baseline[S]
    defect: Callable[[S], S]
    caught_by: str


ORDER, DISCRETE, SHARE, RESIDUAL = "order", "discrete-order-superclose", "time-share", "residual"
CLAMPED, LAW, PREDICTED, ALONE = "clamped", "parallelogram", "leading-term", "alone-stress"
STRESS, STRAIN = "order-stress", "order-strain"
"""Keys of rows of Proposition 5.4, (5.23) and Theorem 4.2."""

FULL, TURNED = Sweep("full-contact", levels=(4, 8, 16)), Sweep("full-contact", angle=0.3, levels=(4, 8, 16))
NONE, FIXED = Sweep("no-contact"), Sweep("fixed-front-off-vertex")
MOVING, MERGING = Sweep("advance-recede"), Sweep("merging-patches")
BOTH, OWN = Equivalence("advance-recede"), StressSweep("natural-front")
"""The smallest settings in which every row holds without a defect and the named row fails with it."""

CONTROLS: tuple[Control[Any], ...] = (
    Control("contact dropped", "V^h in place of K^h", FULL, defects.contact_dropped, ORDER),
    Control("contact two-sided", "v_ν = 0 in place of v_ν ≤ 0", NONE, defects.contact_two_sided, ORDER),
    Control("contact relaxed", "v_ν ≤ √h in place of v_ν ≤ 0", FULL, defects.constraint_relaxed, ORDER),
    Control("contact work", "its sign flipped in the load (3.7)", MOVING, defects.contact_work_sign_flipped, ORDER),
    Control("normal flipped", "v_ν ≥ 0 in place of v_ν ≤ 0", MOVING, defects.normal_flipped, ORDER),
    Control("normal along an axis", "the axis nearest to ν in place of ν", TURNED, defects.normal_along_an_axis, ORDER),
    Control(
        "one active set",
        "the contact solve stops after one iteration",
        MOVING,
        defects.one_active_set_iteration,
        RESIDUAL,
    ),
    Control("clamp short", "Γ1 ends one cell too early", FULL, defects.clamp_one_cell_short, CLAMPED),
    Control("viscosity dropped", "G(u) = F without A u̇", NONE, defects.viscosity_dropped, ORDER),
    Control("elasticity dropped", "A u̇ = F without G(u)", NONE, defects.elasticity_dropped, ORDER),
    Control("law swapped", "G u̇ + A u = F", NONE, defects.viscosity_and_elasticity_swapped, ORDER),
    Control("load late", "the load of the step before", MOVING, defects.load_one_step_late, DISCRETE),
    Control("start at zero", "u_0^h = 0 in place of Π^h u_0", NONE, defects.zero_start, ORDER),
    Control(
        "k like h",
        "backward Euler with k ~ h as if continuous in time",
        MOVING,
        defects.backward_euler_with_k_like_h,
        SHARE,
    ),
    Control("norm of H¹", "(‖v‖² + ‖ε(v)‖²)^½ in place of ‖v‖_V", FIXED, defects.norm_of_h1, PREDICTED),
    Control("norm of L²", "‖v‖ in place of ‖v‖_V", FIXED, defects.norm_of_l2, ORDER),
    Control("norm with G", "(G ε(v), ε(v))^½ in place of ‖v‖_V", FIXED, defects.norm_with_elasticity, PREDICTED),
    Control(
        "one-point quadrature",
        "the error's strain at centres of cells only",
        FIXED,
        defects.one_point_quadrature,
        PREDICTED,
    ),
    Control("sum of roots", "Σ_T ‖·‖_T in place of (Σ_T ‖·‖_T²)^½", FIXED, defects.sum_of_square_roots, ORDER),
    Control("final time only", "errors sampled at t = T only", MERGING, defects.final_time_only, PREDICTED),
    Control("baseline judged", "‖u − Π^h u‖_V in place of ‖u − u^h‖_V", FIXED, defects.baseline_judged, LAW),
    Control(
        "stress from displacement",
        "Problem 3.2 is fed by Problem 3.1",
        BOTH,
        defects.stress_from_displacement,
        ALONE,
    ),
    Control("stress without contact", "σ_ν = 0 in place of σ_ν ≤ 0", OWN, defects.foundation_pulls_nothing, STRESS),
    Control("stress law swapped", "A and G swapped in Problem 3.2", OWN, defects.law_of_stresses_swapped, STRAIN),
    Control("stress without memory", "the strains of the past are 0", OWN, defects.history_forgotten, STRAIN),
    Control("stress without f_2", "σν = 0 in place of f_2 on Γ2", OWN, defects.surface_load_left_out, STRESS),
)

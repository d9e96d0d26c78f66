"""Controls of Propositions 5.3 and 5.4 and (5.23): what is wrong in a solution, or in how its error is measured."""

from __future__ import annotations

from typing import Any

from study.controls import blindness, defects, inaccuracies, mistakes
from study.controls.baselines import Sweep
from study.controls.control import Control
from study.controls.slips import Slip, always

ORDER, DISCRETE, SHARE, RESIDUAL = "order", "discrete-order-superclose", "time-share", "residual"
CLAMPED, LAW, PREDICTED = "clamped", "parallelogram", "leading-term"

FULL, TURNED = Sweep("full-contact", levels=(4, 8, 16)), Sweep("full-contact", angle=0.3, levels=(4, 8, 16))
NONE, FIXED = Sweep("no-contact"), Sweep("fixed-front-off-vertex")
MOVING, MERGING = Sweep("advance-recede"), Sweep("merging-patches")
CROSSED, ROUGH = Sweep("advance-recede", families=("criss-cross",)), Sweep("rough-2", levels=(4, 8, 16, 32))
SOLID = Sweep("cube-two-faces", levels=(6, 9, 12))
CORNERED = Sweep("re-entrant", families=("unstructured", "graded"), levels=(8, 16, 32, 64))
"""The smallest settings in which every row holds without a defect and the named row fails with it."""

MEASURE = "study.statements.prop_5_4.measure"

RATES: tuple[Control[Any], ...] = (
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
        "contact by springs",
        "a stiff foundation in place of v_ν ≤ 0",
        FULL,
        inaccuracies.contact_by_springs,
        "discrete-share",
    ),
    Control("one time behind", "u^h(t − k) in place of u^h(t)", MOVING, inaccuracies.one_time_behind, "size"),
    Control(
        "start at the end", "u_0^h = Π^h u(T) in place of Π^h u_0", NONE, inaccuracies.start_at_the_end, "start-share"
    ),
    Control("size of a mesh", "1/(n − 1) in place of 1/n", FULL, inaccuracies.vertices_inside_counted, "order-fitted"),
    Control("few steps", "an eighth of the time steps", MOVING, inaccuracies.few_steps, "discrete-time-share"),
    Control("load too large", "1.1 F in place of F", CROSSED, inaccuracies.load_too_large, "discrete-order-others"),
    Control("energy for norm", "½‖·‖_V² in place of ‖·‖_V", NONE, inaccuracies.energy_for_norm, PREDICTED),
    Control("rough: elasticity dropped", "A u̇ = F without G(u)", ROUGH, defects.elasticity_dropped, "falling"),
    Control(
        "rough: start at the end",
        "u_0^h = Π^h u(T) in place of Π^h u_0",
        ROUGH,
        inaccuracies.start_at_the_end,
        "falling",
    ),
    Control("rough: law swapped", "G u̇ + A u = F", ROUGH, defects.viscosity_and_elasticity_swapped, "limit"),
    Control("rough: norm of L²", "‖v‖ in place of ‖v‖_V", ROUGH, defects.norm_of_l2, ORDER),
    Control(
        "blind: companion", "the run itself in place of that with k", MOVING, blindness.companion_is_the_run, SHARE
    ),
    Control("blind: solver", "no residual of the contact solves", MOVING, blindness.solver_says_nothing, RESIDUAL),
    Control(
        "blind: quadrature",
        "the same rule in place of a finer one",
        MOVING,
        Slip(MEASURE, "Measurement.quadrature_change", always(0.0)),
        "quadrature",
    ),
    Control(
        "blind: parallelogram",
        "nothing in place of what the parallelogram law misses",
        MOVING,
        Slip(MEASURE, "Measurement.parallelogram", always(0.0)),
        LAW,
    ),
    Control("rough: contact two-sided", "v_ν = 0 in place of v_ν ≤ 0", ROUGH, defects.contact_two_sided, "size"),
    Control("rough: clamp short", "Γ1 ends one cell too early", ROUGH, defects.clamp_one_cell_short, CLAMPED),
    Control(
        "rough, blind: companion",
        "the run itself in place of that with k",
        ROUGH,
        blindness.companion_is_the_run,
        SHARE,
    ),
    Control(
        "rough, blind: solver", "no residual of the contact solves", ROUGH, blindness.solver_says_nothing, RESIDUAL
    ),
    Control(
        "rough, blind: quadrature",
        "the same rule in place of a finer one",
        ROUGH,
        Slip(MEASURE, "Measurement.quadrature_change", always(0.0)),
        "quadrature",
    ),
    Control(
        "rough, blind: parallelogram",
        "nothing in place of what the parallelogram law misses",
        ROUGH,
        Slip(MEASURE, "Measurement.parallelogram", always(0.0)),
        LAW,
    ),
    Control("solid: contact dropped", "V^h in place of K^h", SOLID, defects.contact_dropped, "order-finest"),
    Control(
        "solid: energy for norm",
        "½‖·‖_V² in place of ‖·‖_V",
        SOLID,
        inaccuracies.energy_for_norm,
        "interpolation-order-finest",
    ),
    Control(
        "not graded",
        "meshes that are no finer at a corner",
        CORNERED,
        Slip("study.fem.mesh.unstructured", "Graded.__call__", mistakes.ungraded),
        "order-graded",
    ),
)

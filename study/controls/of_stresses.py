"""Controls of Theorem 4.2, on one mesh and on a stress space of its own."""

from __future__ import annotations

from typing import Any

from study.controls import blindness, defects, stress_slips
from study.controls.baselines import Equivalence, StressSweep
from study.controls.control import Control

ALONE, STRESS, STRAIN = "alone-stress", "order-stress", "order-strain"
BOTH, OWN = Equivalence("advance-recede"), StressSweep("natural-front")
MERGING = StressSweep("merging-patches", levels=(16, 32))

STRESSES: tuple[Control[Any], ...] = (
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
    Control("first step off", "u_1 off by 1e-4, then right", BOTH, blindness.displacement_off_at_first, "displacement"),
    Control("first stress off", "σ_1 off by 1e-4, then right", BOTH, blindness.stress_off_at_first, "stress"),
    Control("stopped early", "gaps of 1e-8 in place of 1e-15", BOTH, stress_slips.STOPPED_EARLY, "allowed"),
    Control("3.2: load late", "the load of the step before in 3.2", BOTH, stress_slips.load_late, "admissibility"),
    Control("3.2: work late", "u of the step before in the work", BOTH, stress_slips.displacement_late, "energy"),
    Control(
        "3.2: contact with gaps",
        "v_ν ≤ 0 at every other vertex in 3.2",
        BOTH,
        stress_slips.gaps_in_contact,
        "membership",
    ),
    Control("blind: comparison", "no distance of 3.2 and 3.1", BOTH, stress_slips.NO_DISTANCE, "alone-displacement"),
    Control("blind: two problems", "3.1 beside itself", BOTH, stress_slips.beside_itself, "displacement"),
    Control(
        "blind: companion of 3.2", "the run itself in place of that with 2k", OWN, stress_slips.COMPANION, "time-share"
    ),
    Control("blind: admissibility", "nothing contradicts (2.4), (2.5)", OWN, stress_slips.ADMISSIBLE, "admissible"),
    Control(
        "sign of the pressure", "σ_ν + σ^h_ν in place of σ_ν − σ^h_ν", OWN, stress_slips.PRESSURE, "order-pressure"
    ),
    Control("sign of multipliers", "moments of −u in place of u", OWN, stress_slips.MOMENTS, "order-displacement"),
    Control("sign of u^h", "moments of −u^h in place of u^h", OWN, stress_slips.BESIDE, "order-primal_displacement"),
    Control(
        "3.1 without A", "Gε(u^h) in place of Aε(δu^h) + Gε(u^h)", OWN, stress_slips.ELASTIC, "order-primal_stress"
    ),
    Control("fronts missed", "f_0 not cut along fronts in 3.2", MERGING, stress_slips.fronts_missed, "time-share"),
    Control("f_2 late", "f_2(t − k) in place of f_2(t)", OWN, stress_slips.surface_load_late, "growth"),
)

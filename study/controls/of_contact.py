"""Defects of the contact force, which an error in V hardly sees."""

from __future__ import annotations

from typing import Any

from study.controls import defects, inaccuracies
from study.controls.baselines import ContactSweep
from study.controls.control import Control

PRESSED, PATCH = ContactSweep("full-contact"), ContactSweep("travelling-patch")
CROSSED = ContactSweep("travelling-patch", "criss-cross")

CONTACT: tuple[Control[Any], ...] = (
    Control("contact load", "1.2 ∫ σ_ν v_ν in (3.7)", PRESSED, defects.contact_load_a_fifth_too_large, "resultant"),
    Control("contact in places", "v_ν ≤ 0 at every other vertex", PRESSED, defects.contact_in_places, "penetration"),
    Control("force: elasticity dropped", "A u̇ = F without G(u)", PRESSED, defects.elasticity_dropped, "order-pressure"),
    Control(
        "force: law swapped",
        "G u̇ + A u = F",
        PRESSED,
        defects.viscosity_and_elasticity_swapped,
        "order-resultant",
    ),
    Control(
        "multipliers",
        "1.2 λ beside the right u^h",
        PATCH,
        defects.multipliers_a_fifth_too_large,
        "order-dual-superclose",
    ),
    Control(
        "multipliers on other meshes",
        "1.2 λ beside the right u^h",
        CROSSED,
        defects.multipliers_a_fifth_too_large,
        "order-dual-other",
    ),
    Control("force: few steps", "an eighth of the time steps", CROSSED, inaccuracies.few_steps, "time-share"),
    Control("contact pulls", "v_ν = 0 in place of v_ν ≤ 0", PATCH, defects.contact_two_sided, "pulling"),
)

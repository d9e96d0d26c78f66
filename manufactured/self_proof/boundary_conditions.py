"""Checks of the boundary conditions (2.3), (2.4) and (2.5) of the contact problem at random points."""

from functools import partial

import numpy as np

from manufactured.body import Kind, Part
from manufactured.exact import ExactSolution, Fields
from manufactured.self_proof.complex_step import gradient, shifted_fields
from manufactured.self_proof.finding import CLAMPED, Finding, at_times, norms, worst
from manufactured.tensors import Array, Points, mandel, traction


def clamped_and_loaded(solution: ExactSolution, rng: np.random.Generator, count: int, instants: Array) -> list[Finding]:
    """Check the boundary conditions u = 0 on Γ1 and σν = f_2 on Γ2.

    This is checked at ``count`` random points of each part and at the times ``instants``.
    """
    inside = solution.at(solution.body.sample(rng, count))
    scale_u = norms(at_times(inside.displacement, instants, count))
    findings = []
    for part in solution.body.of(Kind.CLAMPED):
        x = part.sample(rng, count)
        u = at_times(solution.at(x).displacement, instants, count)
        findings.append(worst(CLAMPED, x, instants, norms(u), scale_u))
    for part in solution.body.of(Kind.LOADED):
        x = part.sample(rng, count)
        load = at_times(partial(solution.at(x).surface_load, part), instants, count)
        expected = at_times(partial(_traction_by_step, solution, part, x), instants, count)
        scale = norms(at_times(inside.stress, instants, count))
        findings.append(worst("(2.4) σν = f_2 on Γ2", x, instants, norms(load - expected), scale))
    return findings


def _traction_by_step(solution: ExactSolution, part: Part, x: Points, times: Array) -> Array:
    """Return the traction Aε(u̇)ν + Gε(u)ν, with strains from derivatives by the complex step, (d, points, times)."""
    shifted = shifted_fields(solution, x)
    rate, strain = (mandel(gradient(shifted, of, times)) for of in (Fields.velocity, Fields.displacement))
    return traction(solution.law.at(x[..., None]).stress(rate, strain), part.normal)


def contact(solution: ExactSolution, rng: np.random.Generator, count: int, instants: Array) -> list[Finding]:
    """Check that displacement and stress have the stated contact data on Γ3: u_ν = g − w, σ_ν = −p, σ_τ = 0.

    This is checked at ``count`` random points of each part and at the times ``instants``.
    """
    inside = solution.at(solution.body.sample(rng, count))
    scale_u = norms(at_times(inside.displacement, instants, count))
    scale_stress = norms(at_times(inside.stress, instants, count))
    findings = []
    for i, face in enumerate(solution.faces, start=1):
        x, normal = face.part.sample(rng, count), face.part.normal
        on_face, fields = solution.on(face, face.part.coordinates(x)[0]), solution.at(x)
        u = np.array([np.tensordot(normal, u, axes=1) for u in at_times(fields.displacement, instants, count)])
        force = [traction(stress, normal) for stress in at_times(fields.stress, instants, count)]
        stress = np.array([np.tensordot(normal, f, axes=1) for f in force])
        tangential = norms([f - np.multiply.outer(normal, sn) for f, sn in zip(force, stress, strict=True)])
        gap, pressure = (at_times(of, instants, count) for of in (on_face.gap, on_face.stated_pressure))
        checks = [
            ("σ_τ = 0", tangential, scale_stress),
            ("w = g − u_ν", abs(u + gap - on_face.initial_gap()), scale_u),
            ("p = −σ_ν", abs(stress + pressure), scale_stress),
        ]
        findings += [worst(f"(2.5) {c} on Γ3,{i}", x, instants, d, scale) for c, d, scale in checks]
    return findings

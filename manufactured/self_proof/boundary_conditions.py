"""The conditions (2.3), (2.4) and (2.5) at random points of the boundary."""

from __future__ import annotations

import numpy as np

from manufactured.body import Kind
from manufactured.exact import ExactSolution, Fields
from manufactured.self_proof.complex_step import gradient, shifted_fields
from manufactured.self_proof.finding import Finding, norms, worst
from manufactured.tensors import Array, mandel, traction


def clamped_and_loaded(solution: ExactSolution, rng: np.random.Generator, count: int, instants: Array) -> list[Finding]:
    """u = 0 on Γ1, σν = f_2 on Γ2."""
    inside = solution.at(solution.body.sample(rng, count))
    scale_u = norms([inside.displacement(t) for t in instants])
    findings = []
    for part in solution.body.of(Kind.CLAMPED):
        x = part.sample(rng, count)
        u = [solution.at(x).displacement(t) for t in instants]
        findings.append(worst("(2.3) u = 0 on Γ1", x, instants, norms(u), scale_u))
    for part in solution.body.of(Kind.LOADED):
        x = part.sample(rng, count)
        fields, shifted = solution.at(x), shifted_fields(solution, x)
        load, law = [fields.surface_load(part, t) for t in instants], solution.law.at(x)
        expected = [
            traction(
                law.stress(
                    mandel(gradient(shifted, Fields.velocity, t)),
                    mandel(gradient(shifted, Fields.displacement, t)),
                ),
                part.normal,
            )
            for t in instants
        ]
        scale = norms([inside.stress(t) for t in instants])
        findings.append(worst("(2.4) σν = f_2 on Γ2", x, instants, norms(np.subtract(load, expected)), scale))
    return findings


def contact(solution: ExactSolution, rng: np.random.Generator, count: int, instants: Array) -> list[Finding]:
    """The lifted fields on Γ3: u_ν = −w, σ_ν = −p, σ_τ = 0."""
    inside = solution.at(solution.body.sample(rng, count))
    scale_u = norms([inside.displacement(t) for t in instants])
    scale_stress = norms([inside.stress(t) for t in instants])
    findings = []
    for i, face in enumerate(solution.faces, start=1):
        x, normal = face.part.sample(rng, count), face.part.normal
        on_face, fields = solution.on(face, face.part.coordinates(x)[0]), solution.at(x)
        u = np.array([np.tensordot(normal, fields.displacement(t), axes=1) for t in instants])
        force = [traction(fields.stress(t), normal) for t in instants]
        stress = np.array([np.tensordot(normal, f, axes=1) for f in force])
        tangential = norms([f - np.multiply.outer(normal, sn) for f, sn in zip(force, stress, strict=True)])
        gap = np.array([on_face.gap(t) for t in instants])
        pressure = np.array([on_face.stated_pressure(t) for t in instants])
        checks = [
            ("σ_τ = 0", tangential, scale_stress),
            ("w = −u_ν", abs(u + gap), scale_u),
            ("p = −σ_ν", abs(stress + pressure), scale_stress),
        ]
        findings += [worst(f"(2.5) {c} on Γ3,{i}", x, instants, d, scale) for c, d, scale in checks]
    return findings

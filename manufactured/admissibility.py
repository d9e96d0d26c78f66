"""A case proves itself before it is used.

At random points and times, with derivatives taken by the complex step (independent of the symbolic
ones the solution is made of), the exact solution must satisfy (2.1)–(2.6), u(t) ∈ K and its stated
contact zone to round-off.

Source of the complex step: J. N. Lyness, C. B. Moler, Numerical differentiation of analytic
functions, SIAM J. Numer. Anal. 4 (1967) 202–210.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import sympy as sp

from manufactured.body import Kind, Part
from manufactured.exact import ExactSolution, Fields
from manufactured.symbols import pos
from manufactured.symbols import t as clock
from manufactured.tensors import Array, Points, basis, mandel, traction

STEP = 1e-30
ROUND_OFF = 1e-9
"""Largest defect relative to the size of the terms that count as round-off."""
INTEGRATION = 1e-5
"""Same for changes of u over ∫u̇, whose integrand has kinks in time where a zone passes."""
JUMP = 0.05
"""Same for changes along a face over integrals of derivatives, which may be singular at a rough front."""
GRID, INSTANTS = 211, 101
"""Points along a face, and times, at which signs and zones are looked at."""
TINY = 1e-150


@dataclass(frozen=True)
class Finding:
    """The largest defect found in one condition.

    Attributes:
        condition: its number in the source and its formula.
        defect: size of the violation relative to the scale of the terms.
        tolerance: what is allowed.
        x, time: where it is attained.
    """

    condition: str
    defect: float
    tolerance: float
    x: tuple[float, ...]
    time: float

    @property
    def passes(self) -> bool:
        # Not (defect > tolerance): a NaN must not pass.
        return self.defect <= self.tolerance

    def __str__(self) -> str:
        place = ", ".join(f"{c:.6g}" for c in self.x)
        word = "holds" if self.passes else "violated"
        return (
            f"{self.condition}: {word}, relative defect {self.defect:.3g} (allowed {self.tolerance:g}) "
            f"at x = ({place}), t = {self.time:.6g}"
        )


class SelfProofError(ValueError):
    """An exact solution violates a condition of Problem 2.1."""

    def __init__(self, name: str, findings: list[Finding]) -> None:
        self.findings = findings
        lines = "\n  ".join(str(finding) for finding in findings)
        super().__init__(
            f"{name} does not prove itself an exact solution:\n  {lines}\n"
            "  change the gap, the pressure, the zone or the law until it does"
        )


def prove(solution: ExactSolution, name: str, seed: int = 0) -> list[Finding]:
    """Check every condition; returns the findings, all passing.

    Raises:
        SelfProofError: lists each violated condition with where and by how much.
    """
    findings = examine(solution, seed)
    failed = [finding for finding in findings if not finding.passes]
    if failed:
        raise SelfProofError(name, failed)
    return findings


def examine(solution: ExactSolution, seed: int = 0, points: int = 40, times: int = 8) -> list[Finding]:
    """The largest defect of every condition at random points and times."""
    rng = np.random.default_rng(seed)
    instants = np.sort(rng.uniform(0, solution.body.T, times))
    inside = solution.body.sample(rng, points)
    return [
        *_kinematics(solution, inside, instants),
        _history(solution, inside),
        _equilibrium(solution, inside, instants),
        *_boundary(solution, rng, points, instants),
        *_contact(solution, rng, points, instants),
        *_signs(solution),
        *_continuity(solution, rng),
        *_layers(solution, rng, points, instants),
        *_factors(solution, rng, points),
    ]


def _worst(
    condition: str, x: Points, instants: Array, defect: Array, scale: Array, tolerance: float = ROUND_OFF
) -> Finding:
    """The largest entry of defect (times, points) relative to the largest entry of scale."""
    defect = np.where(np.isfinite(defect), defect, np.inf)
    when, where = np.unravel_index(np.argmax(defect), defect.shape)
    size = max(float(np.max(np.where(np.isfinite(scale), scale, 0.0))), np.finfo(float).tiny)
    worst = float(defect[when, where])
    return Finding(
        condition, worst / size if worst > 0 else 0.0, tolerance, tuple(map(float, x[:, where])), float(instants[when])
    )


def _size(values: list[Array] | Array) -> Array:
    """Euclidean norm over the component axis of (times, components, points)."""
    return np.linalg.norm(np.asarray(values), axis=1)


def _shifted(solution: ExactSolution, x: Points) -> list[Fields]:
    """The solution at x + i·STEP·e_j for every direction j."""
    found = []
    for j in range(len(x)):
        shifted = x.astype(complex)
        shifted[j] += 1j * STEP
        found.append(solution.at(shifted))
    return found


def _gradient(shifted: list[Fields], field: Callable[[Fields, complex], Array], time: float) -> Array:
    """∂_j field by the complex step, (components, d, ...)."""
    return np.stack([field(fields, time).imag / STEP for fields in shifted], axis=1)


def _kinematics(solution: ExactSolution, x: Points, instants: Array) -> list[Finding]:
    fields, shifted = solution.at(x), _shifted(solution, x)
    strain = [fields.strain(t) for t in instants]
    rate = [fields.strain_rate(t) for t in instants]
    velocity = [fields.velocity(t) for t in instants]
    by_step = [mandel(_gradient(shifted, Fields.displacement, t)) for t in instants]
    rate_by_step = [mandel(_gradient(shifted, Fields.velocity, t)) for t in instants]
    velocity_by_step = [fields.displacement(t + 1j * STEP).imag / STEP for t in instants]
    stress = [fields.stress(t) for t in instants]
    at_points = solution.law.at(x)
    law = [at_points.stress(r, e) for r, e in zip(rate_by_step, by_step, strict=True)]
    return [
        _worst("(2.10) ε(u) = sym ∇u", x, instants, _size(np.subtract(strain, by_step)), _size(strain)),
        _worst("(2.10) ε(u̇) = sym ∇u̇", x, instants, _size(np.subtract(rate, rate_by_step)), _size(rate)),
        _worst("(2.6) u̇ = ∂u/∂t", x, instants, _size(np.subtract(velocity, velocity_by_step)), _size(velocity)),
        _worst("(2.1) σ = Aε(u̇) + Gε(u)", x, instants, _size(np.subtract(stress, law)), _size(stress)),
    ]


def _history(solution: ExactSolution, x: Points) -> Finding:
    """u over each eighth of [0, T] changes by ∫u̇ dt: no jump in time anywhere."""
    fields, T = solution.at(x), solution.body.T
    nodes, weights = np.polynomial.legendre.leggauss(4)
    ends = np.linspace(0, T, 9)
    u = [fields.displacement(t) for t in ends]
    switches, defects = _switches(solution), []
    for start, stop, before, after in zip(ends[:-1], ends[1:], u[:-1], u[1:], strict=True):
        inner = [time for time in switches if start < time < stop]
        panels = np.unique([*np.linspace(start, stop, 9), *inner])
        half = np.diff(panels)[:, None] / 2
        instants = (panels[:-1, None] + half * (1 + nodes)).ravel()
        integral = sum(w * fields.velocity(t) for w, t in zip((half * weights).ravel(), instants, strict=True))
        defects.append(after - before - integral)
    return _worst("(2.6) u(t) = u_0 + ∫u̇ dt", x, ends[1:], _size(defects), _size(u), INTEGRATION)


def _switches(solution: ExactSolution) -> list[float]:
    """Times at which a truncated power of t alone sets in: there u̇ may jump."""
    formulas = [sp.sympify(f) for face in solution.faces for f in (face.gap, face.exponents_in)]
    switches = {front.args[0] for f in formulas for front in f.atoms(pos) if front.args[0].free_symbols == {clock}}
    return [float(root) for switch in switches for root in sp.real_roots(switch, clock)]


def _equilibrium(solution: ExactSolution, x: Points, instants: Array) -> Finding:
    fields, shifted = solution.at(x), _shifted(solution, x)
    force = [fields.body_force(t) for t in instants]
    gradient = [_gradient(shifted, Fields.stress, t) for t in instants]
    divergence = [np.tensordot(basis(solution.law.dim), g, axes=([0, 2], [0, 1])) for g in gradient]
    scale = np.linalg.norm(gradient, axis=(1, 2))
    return _worst("(2.2) Div σ + f_0 = 0", x, instants, _size(np.add(divergence, force)), scale)


def _boundary(solution: ExactSolution, rng: np.random.Generator, count: int, instants: Array) -> list[Finding]:
    inside = solution.at(solution.body.sample(rng, count))
    scale_u = _size([inside.displacement(t) for t in instants])
    findings = []
    for part in solution.body.of(Kind.CLAMPED):
        x = part.sample(rng, count)
        u = [solution.at(x).displacement(t) for t in instants]
        findings.append(_worst("(2.3) u = 0 on Γ1", x, instants, _size(u), scale_u))
    for part in solution.body.of(Kind.LOADED):
        x = part.sample(rng, count)
        fields, shifted = solution.at(x), _shifted(solution, x)
        load, law = [fields.surface_load(part, t) for t in instants], solution.law.at(x)
        expected = [
            traction(
                law.stress(
                    mandel(_gradient(shifted, Fields.velocity, t)),
                    mandel(_gradient(shifted, Fields.displacement, t)),
                ),
                part.normal,
            )
            for t in instants
        ]
        scale = _size([inside.stress(t) for t in instants])
        findings.append(_worst("(2.4) σν = f_2 on Γ2", x, instants, _size(np.subtract(load, expected)), scale))
    return findings


def _contact(solution: ExactSolution, rng: np.random.Generator, count: int, instants: Array) -> list[Finding]:
    """The lifted fields on Γ3: u_ν = −w, σ_ν = −p, σ_τ = 0."""
    inside = solution.at(solution.body.sample(rng, count))
    scale_u = _size([inside.displacement(t) for t in instants])
    scale_stress = _size([inside.stress(t) for t in instants])
    findings = []
    for i, face in enumerate(solution.faces, start=1):
        x, normal = face.part.sample(rng, count), face.part.normal
        on_face, fields = solution.on(face, face.part.coordinates(x)[0]), solution.at(x)
        u = np.array([np.tensordot(normal, fields.displacement(t), axes=1) for t in instants])
        force = [traction(fields.stress(t), normal) for t in instants]
        stress = np.array([np.tensordot(normal, f, axes=1) for f in force])
        tangential = _size([f - np.multiply.outer(normal, sn) for f, sn in zip(force, stress, strict=True)])
        gap = np.array([on_face.gap(t) for t in instants])
        pressure = np.array([on_face.stated_pressure(t) for t in instants])
        checks = [
            ("σ_τ = 0", tangential, scale_stress),
            ("w = −u_ν", abs(u + gap), scale_u),
            ("p = −σ_ν", abs(stress + pressure), scale_stress),
        ]
        findings += [_worst(f"(2.5) {c} on Γ3,{i}", x, instants, d, scale) for c, d, scale in checks]
    return findings


def _signs(solution: ExactSolution) -> list[Finding]:
    """Signs, complementarity and the stated zone on a dense grid of each face and of [0, T]."""
    instants = np.linspace(0, solution.body.T, INSTANTS)
    findings = []
    for i, face in enumerate(solution.faces, start=1):
        s = _grid(face.part)
        fields = solution.on(face, s)
        gap = np.array([fields.gap(t) for t in instants])
        pressure = np.array([fields.pressure(t) for t in instants])
        level = np.array([fields.level(t) for t in instants])
        contact = level >= 0
        # A body at rest touches with w = p = 0 and needs no zone.
        resting = (abs(gap).max(axis=1) == 0) & (abs(pressure).max(axis=1) <= ROUND_OFF * fields.stress_scale())
        # Each on its own scale; on that of the strains times a small number where there is none.
        scale_w = np.maximum(abs(gap), TINY)
        scale_p = np.maximum(abs(pressure), 1e-6 * fields.stress_scale())
        checks = [
            ("u_ν ≤ 0, u ∈ K", np.maximum(-gap, 0), scale_w),
            ("σ_ν ≤ 0", np.maximum(-pressure, 0), scale_p),
            ("w = 0, so σ_ν u_ν = 0, on the stated zone ψ ≥ 0", np.where(contact, abs(gap), 0), scale_w),
            ("p = 0, so σ_ν u_ν = 0, off the stated zone", np.where(contact, 0, abs(pressure)), scale_p),
            (
                "w > 0 off the stated zone",
                np.where(~contact & (gap <= 0) & ~resting[:, None], abs(level), 0),
                abs(level),
            ),
        ]
        x = face.part.point(s)
        findings += [_worst(f"(2.5) {c} on Γ3,{i}", x, instants, d, scale) for c, d, scale in checks]
    return findings


def _grid(part: Part) -> Array:
    """Some GRID points along a segment, GRID^{3/2} or less on a plane part, none on its edges, (d−1, N)."""
    # Not the ends of the face, where a formula may be singular; not a round number of cells.
    low, high = part.outline.min(axis=1), part.outline.max(axis=1)
    count = round(GRID ** (1 if part.dim == 2 else 0.75))
    axes = [a + (b - a) * (np.arange(count) + 0.5) / count for a, b in zip(low, high, strict=True)]
    points = np.array([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")])
    return points[:, part.covers(points, 0.0)]


def _continuity(solution: ExactSolution, rng: np.random.Generator) -> list[Finding]:
    """w, ∇_s w and (q, r) have no jumps along a face, as u ∈ H¹ needs: each changes by the integral of its derivative.

    Along a line through the face in the direction of each coordinate.
    """
    nodes, weights = np.polynomial.legendre.leggauss(6)
    instants = np.linspace(0, solution.body.T, 9)
    findings = []
    for i, face in enumerate(solution.faces, start=1):
        for axis, (low, high) in enumerate(
            zip(face.part.outline.min(axis=1), face.part.outline.max(axis=1), strict=True)
        ):
            start = face.part.coordinates(face.part.sample(rng, 1))[0]
            ends = np.linspace(low, high, 257)
            half = np.diff(ends)[:, None] / 2
            inner = (ends[:-1, None] + half * (1 + nodes)).ravel()
            places = [np.tile(start, line.size) for line in (ends, inner)]
            for place, line in zip(places, (ends, inner), strict=True):
                place[axis] = line
            at_ends, at_inner = (solution.on(face, place) for place in places)
            traces = [(at_ends.traces(t, axis), at_inner.traces(t, axis)) for t in instants]
            for name in traces[0][0]:
                value = np.array([ends_now[name][0] for ends_now, _ in traces])
                slope = np.array([inner_now[name][1] for _, inner_now in traces]).reshape(len(instants), -1, len(nodes))
                defect = abs(np.diff(value, axis=1) - slope @ weights * half[:, 0])
                scale = np.maximum(np.ptp(value, axis=1, keepdims=True), TINY)
                x = face.part.point(places[0][:, 1:])
                findings.append(_worst(f"(2.9) {name} without jumps on Γ3,{i}", x, instants, defect, scale, JUMP))
    return findings


def _layers(solution: ExactSolution, rng: np.random.Generator, count: int, instants: Array) -> list[Finding]:
    """Where a factor of A or G jumps the traction is continuous, or Div σ would have a part on the interface."""
    findings = []
    inside = solution.body.sample(rng, 50 * count)
    size = float(np.ptp(solution.body.vertices, axis=1).max())
    for direction, offset in solution.law.steps:
        normal = np.array(direction)
        onto = inside - np.multiply.outer(normal, normal @ inside - offset)
        x = onto[:, solution.body.contains(onto)][:, :count]
        sides = [solution.at(x + side * 1e-12 * size * normal[:, None]) for side in (-1, 1)]
        forces = [[traction(fields.stress(t), normal) for t in instants] for fields in sides]
        scale = _size([sides[0].stress(t) for t in instants])
        defect = _size(np.subtract(forces[0], forces[1]))
        findings.append(_worst(f"(2.2) σν continuous on {direction}·x = {offset:g}", x, instants, defect, scale))
    return findings


def _factors(solution: ExactSolution, rng: np.random.Generator, count: int) -> list[Finding]:
    """The factors of A and G lie between their stated bounds, on which m_A and L_G rest."""
    x = solution.body.sample(rng, 50 * count)
    findings = []
    for number, name, factor in (("(3.1)", "A", solution.law.A.factor), ("(3.2)", "G", solution.law.G.factor)):
        value = factor(x)
        outside = np.maximum(np.maximum(factor.low - value, value - factor.high), 0)
        findings.append(_worst(f"{number} bounds of the factor of {name}", x, np.zeros(1), outside[None], value[None]))
    return findings


__all__ = ["Finding", "SelfProofError", "examine", "prove"]

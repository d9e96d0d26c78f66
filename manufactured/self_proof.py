"""The self-proof of an exact solution: before it is used, every condition of the contact problem is checked.

At random points and times, the solution must satisfy the equations and inequalities (2.1)–(2.6), be admissible and have
the stated contact zone, up to rounding. Derivatives are computed by the complex step, independently of the symbolic
derivatives in the solution.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import sympy as sp

from manufactured.arguments import Count, Natural, checked
from manufactured.body import Kind, Part
from manufactured.exact import ExactSolution, Fields
from manufactured.face_strain import composite_gauss
from manufactured.symbols import pos
from manufactured.symbols import t as clock
from manufactured.tensors import Array, Points, Tensors, basis, mandel, traction

# The result of checking one condition of the contact problem, and the error that lists all violated conditions.

VALUES_AT_ONCE = 1 << 13
"""Number of values that are evaluated at a time, so that they fit into the processor's cache."""
DEFECT_ROUND_OFF = 1e-9
"""Largest defect, relative to the size of the terms of a condition, that counts as round-off."""


OPEN_IN_CONTACT = "w = 0, so σ_ν w = 0, on the stated zone"
"""Name of the condition that is violated if the gap w is positive somewhere in the stated contact zone."""
INITIAL_GAP_ADVICE = (
    "`gap` is the distance that is left at the time t, 0 where there is contact. If your formula is the distance of "
    "the undeformed body from the foundation, give it as `initial_gap` of ContactFace.linear, and give `gap` a formula "
    "that vanishes in contact, such as pos(-zone, 4)"
)
CLAMPED_CONDITION = "(2.3) u = 0 on Γ1"
"""Name of the condition that is violated if the displacement is not zero on the clamped boundary."""
CLAMPED_ADVICE = (
    "by default the displacement of a contact face ends at the depth 1; `profile=cutoff(depth)` of ContactFace lets it "
    "end above Γ1"
)
ADVICE = {OPEN_IN_CONTACT: INITIAL_GAP_ADVICE, CLAMPED_CONDITION: CLAMPED_ADVICE}
"""Advice what to change if a condition is violated, by the name of the condition or the beginning of its name."""


@dataclass(frozen=True)
class Finding:
    """The largest violation of one condition that was found.

    Attributes:
        condition: the number of the condition in the paper, and its formula.
        defect: the size of the violation, relative to the size of the terms of the condition.
        tolerance: the largest defect that passes.
        x, time: the point and the time of the largest defect.
    """

    condition: str
    defect: float
    tolerance: float
    x: tuple[float, ...]
    time: float

    @property
    def passes(self) -> bool:
        # ``not defect > tolerance`` would let a NaN pass.
        return self.defect <= self.tolerance

    def __str__(self) -> str:
        place = ", ".join(f"{c:.6g}" for c in self.x)
        word = "holds" if self.passes else "violated"
        return (
            f"{self.condition}: {word}, relative defect {self.defect:.3g} (allowed {self.tolerance:g}) "
            f"at x = ({place}), t = {self.time:.6g}"
        )


class SelfProofError(ValueError):
    """Raised if an exact solution violates a condition of Problem 2.1."""

    def __init__(self, name: str, findings: list[Finding]) -> None:
        self.findings = findings
        lines = "\n  ".join(str(finding) for finding in findings)
        advice = "".join(
            f"\n  {words}" for condition, words in ADVICE.items() if any(condition in one.condition for one in findings)
        )
        super().__init__(
            f"{name} does not prove itself an exact solution:\n  {lines}\n"
            f"  change the gap, the pressure, the zone or the law until it does{advice}"
        )


def worst(
    condition: str, x: Points, instants: Array, defect: Array, scale: Array, tolerance: float = DEFECT_ROUND_OFF
) -> Finding:
    """Return the largest violation of a condition over points and times, relative to the largest ``scale``.

    Args:
        condition: the number and formula of the condition.
        x: the points, (d, points).
        instants: the times, (times,).
        defect: the size of the violation, (times, points).
        scale: the size of the terms of the condition at points and times, an array of any shape.
        tolerance: the largest relative violation that passes.
    """
    defect = np.where(np.isfinite(defect), defect, np.inf)
    when, where = np.unravel_index(np.argmax(defect), defect.shape)
    size = max(float(np.max(np.where(np.isfinite(scale), scale, 0.0))), np.finfo(float).tiny)
    largest = float(defect[when, where])
    relative = largest / size if largest > 0 else 0.0
    return Finding(condition, relative, tolerance, tuple(map(float, x[:, where])), float(instants[when]))


def at_times(of: Callable[[Array], Array], instants: Array, points: int) -> Array:
    """Evaluate a field at many times, in blocks that fit into the processor's cache; times become the first axis.

    Args:
        of: a function from times (n,) to values whose last axis has the length n.
        instants: the times.
        points: the number of points at which the field is evaluated.
    """
    together = max(1, VALUES_AT_ONCE // points)
    blocks = (instants[first : first + together] for first in range(0, len(instants), together))
    return np.concatenate([np.moveaxis(of(block), -1, 0) for block in blocks])


def norms(values: list[Array] | Array) -> Array:
    """Return the Euclidean norms of vectors, (times, components, points) → (times, points)."""
    return np.linalg.norm(np.asarray(values), axis=1)


# Derivatives by the complex step: ∂_j f(x) = Im f(x + i δ e_j)/δ, which has no cancellation for small δ.
#
# Source: J. N. Lyness, C. B. Moler, Numerical differentiation of analytic functions, SIAM J. Numer. Anal. 4 (1967)
# 202–210.

STEP = 1e-30


def shifted_fields(solution: ExactSolution, x: Points) -> list[Fields]:
    """Return the fields of the solution at complex points, from which ``gradient`` computes derivatives.

    The points are x + i·STEP·e_j, with one result for every coordinate direction e_j and i the imaginary unit.
    """
    found = []
    for j in range(len(x)):
        shifted = x.astype(complex)
        shifted[j] += 1j * STEP
        found.append(solution.at(shifted))
    return found


def gradient(shifted: list[Fields], field: Callable[[Fields, Any], Array], time: Array | float) -> Array:
    """Return the derivatives ∂_j in space of a field by the complex step, (components, d, ...).

    Args:
        shifted: the result of ``shifted_fields``.
        field: the field, as a function of ``Fields`` and the time.
        time: a time, or times (n,).
    """
    return np.stack([field(fields, time).imag / STEP for fields in shifted], axis=1)


def stress_by_step(solution: ExactSolution, x: Points, shifted: list[Fields], times: Array) -> Tensors:
    """Return the stress Aε(u̇) + Gε(u), with strains from derivatives by the complex step, (D, points, times).

    Args:
        solution: the exact solution.
        x: the points, (d, points).
        shifted: the result of ``shifted_fields`` at the points.
        times: the times, (times,).
    """
    rate, strain = (mandel(gradient(shifted, of, times)) for of in (Fields.velocity, Fields.displacement))
    return solution.law.at(x[..., None]).stress(rate, strain)


# Checks of the conditions inside the body: strain (2.10), velocity (2.6), law (2.1) and equilibrium (2.2).

INTEGRATION = 1e-5
"""Largest accepted relative difference between the change of u and ∫u̇ dt.

It is much larger than rounding, because u̇ has kinks in time where a front passes.
"""
FIRST_PANELS, PANEL_FACTOR, MOST_PANELS = 8, 4, 512
"""Numbers of panels of Gauss's rule in each eighth of [0, T]: the first, the factor to the next one, and the largest.

If T is long, it may contain many periods of a motion, and more panels are needed to resolve them.
"""


def kinematics(solution: ExactSolution, x: Points, instants: Array) -> list[Finding]:
    """Check that strains, velocities and stresses of the solution agree with derivatives of the displacement u.

    The derivatives are computed by the complex step.

    Args:
        solution: the exact solution.
        x: the points, (d, points).
        instants: the times, (times,).
    """
    fields, shifted = solution.at(x), shifted_fields(solution, x)

    def found(of: Callable[[Array], Array]) -> Array:
        return at_times(of, instants, x.shape[1])

    strain, rate, velocity, stress = map(found, (fields.strain, fields.strain_rate, fields.velocity, fields.stress))
    by_step = found(lambda t: mandel(gradient(shifted, Fields.displacement, t)))
    rate_by_step = found(lambda t: mandel(gradient(shifted, Fields.velocity, t)))
    velocity_by_step = found(lambda t: fields.displacement(t + 1j * STEP).imag / STEP)
    stress_of_strains = found(partial(stress_by_step, solution, x, shifted))
    return [
        worst("(2.10) ε(u) = sym ∇u", x, instants, norms(strain - by_step), norms(strain)),
        worst("(2.10) ε(u̇) = sym ∇u̇", x, instants, norms(rate - rate_by_step), norms(rate)),
        worst("(2.6) u̇ = ∂u/∂t", x, instants, norms(velocity - velocity_by_step), norms(velocity)),
        worst("(2.1) σ = Aε(u̇) + Gε(u)", x, instants, norms(stress - stress_of_strains), norms(stress)),
    ]


def history(solution: ExactSolution, x: Points) -> Finding:
    """Check that u does not jump in time: over each eighth of [0, T] it must change by the integral of u̇.

    The number of panels of the integral is increased as long as the defect is too large and decreases. If u jumps, the
    defect does not decrease.
    """
    found, panels = _history(solution, x, FIRST_PANELS), FIRST_PANELS
    while not found.passes and panels < MOST_PANELS:
        panels *= PANEL_FACTOR
        before, found = found, _history(solution, x, panels)
        if not found.defect < before.defect / 2:
            break
    return found


def _history(solution: ExactSolution, x: Points, count: int) -> Finding:
    """Compare the change of u with the integral of u̇, for a number of panels in each eighth of [0, T]."""
    fields, T = solution.at(x), solution.body.T
    ends = np.linspace(0, T, 9)
    u = at_times(fields.displacement, ends, x.shape[1])
    switches, defects = _switches(solution), []
    for (start, stop), (before, after) in zip(pairwise(ends), pairwise(u), strict=True):
        inner = [time for time in switches if start < time < stop]
        panels = np.unique([*np.linspace(start, stop, count + 1), *inner])
        instants, weights = composite_gauss(panels, 4)
        velocity = at_times(fields.velocity, instants, x.shape[1])
        defects.append(after - before - np.tensordot(weights, velocity, axes=1))
    return worst("(2.6) u(t) = u_0 + ∫u̇ dt", x, ends[1:], norms(defects), norms(u), INTEGRATION)


def _switches(solution: ExactSolution) -> list[float]:
    """Return the times at which u̇ may jump: zeros of the arguments of truncated powers that depend on t only."""
    formulas = [f for face in solution.faces for f in (face.gap, face.exponents_in)]
    switches = {front.args[0] for f in formulas for front in f.atoms(pos) if front.args[0].free_symbols == {clock}}
    return [float(root) for switch in switches for root in sp.real_roots(switch, clock)]


def equilibrium(solution: ExactSolution, x: Points, instants: Array) -> Finding:
    """Check that the stress balances the body force, Div σ + f_0 = 0.

    Args:
        solution: the exact solution.
        x: points inside the body, (d, points).
        instants: the times, (times,).
    """
    fields, shifted = solution.at(x), shifted_fields(solution, x)
    force = at_times(fields.body_force, instants, x.shape[1])
    slopes = at_times(lambda t: gradient(shifted, Fields.stress, t), instants, x.shape[1])
    divergence = [np.tensordot(basis(solution.law.dim), g, axes=([0, 2], [0, 1])) for g in slopes]
    scale = np.linalg.norm(slopes, axis=(1, 2))
    return worst("(2.2) Div σ + f_0 = 0", x, instants, norms(np.add(divergence, force)), scale)


# Checks of the boundary conditions (2.3), (2.4) and (2.5) of the contact problem at random points.


def on_boundary(solution: ExactSolution, rng: np.random.Generator, inside: Points, instants: Array) -> list[Finding]:
    """Check the boundary conditions at random points of each part of the boundary.

    They are u = 0 on Γ1, σν = f_2 on Γ2, and u_ν = g − w, σ_ν = −p, σ_τ = 0 on Γ3, with the initial gap g, the gap w
    and the pressure p that the contact faces state.

    Args:
        solution: the exact solution.
        rng: draws the random points.
        inside: points inside the body, (d, points). The sizes of u and σ at these points are the scales of the defects.
            As many random points are drawn on each part.
        instants: the times, (times,).
    """
    fields, count = solution.at(inside), inside.shape[1]
    scale_u = norms(at_times(fields.displacement, instants, count))
    scale_stress = norms(at_times(fields.stress, instants, count))
    findings = []
    for part in solution.body.of(Kind.CLAMPED):
        x = part.sample(rng, count)
        u = at_times(solution.at(x).displacement, instants, count)
        findings.append(worst(CLAMPED_CONDITION, x, instants, norms(u), scale_u))
    for part in solution.body.of(Kind.LOADED):
        x = part.sample(rng, count)
        load = at_times(partial(solution.at(x).surface_load, part), instants, count)
        stresses = at_times(partial(stress_by_step, solution, x, shifted_fields(solution, x)), instants, count)
        expected = [traction(stress, part.normal) for stress in stresses]
        findings.append(worst("(2.4) σν = f_2 on Γ2", x, instants, norms(load - expected), scale_stress))
    for i, face in enumerate(solution.faces, start=1):
        x, normal = face.part.sample(rng, count), face.part.normal
        on_face, fields = solution.on(face, face.part.coordinates(x)[0]), solution.at(x)
        u = normal @ at_times(fields.displacement, instants, count)
        force = at_times(partial(fields.surface_load, face.part), instants, count)
        stress = normal @ force
        tangential = norms(force - stress[:, None] * normal[:, None])
        gap, pressure = (at_times(of, instants, count) for of in (on_face.gap, on_face.stated_pressure))
        checks = [
            ("σ_τ = 0", tangential, scale_stress),
            ("w = g − u_ν", abs(u + gap - on_face.initial_gap()), scale_u),
            ("p = −σ_ν", abs(stress + pressure), scale_stress),
        ]
        findings += [worst(f"(2.5) {c} on Γ3,{i}", x, instants, d, scale) for c, d, scale in checks]
    return findings


# Checks of the contact data on grids of the contact faces and of [0, T]: signs, contact zone and continuity.

ACCEPTED_JUMP = 0.05
"""Largest accepted relative jump of a quantity along a face.

The jump is the change of the quantity minus the integral of its derivative. The number is large because the derivative
may be singular at a front.
"""
FACE_POINTS, CHECKED_TIMES = 211, 101
"""Numbers of points along a face and of times at which signs and the contact zone are checked."""
LEAST_SCALE = 1e-150
"""Lower bound of scales. A relative defect is divided by a scale, which is 0 for a quantity that is zero everywhere."""


def signs(solution: ExactSolution) -> list[Finding]:
    """Check the sign conditions of contact on a dense grid of each contact face and of [0, T].

    Gap and pressure must not be negative, one of them must be 0, and there must be contact exactly in the stated zone
    {ψ ≥ 0}.
    """
    instants = np.linspace(0, solution.body.T, CHECKED_TIMES)
    findings = []
    for i, face in enumerate(solution.faces, start=1):
        s = _grid(face.part)
        fields = solution.on(face, s)
        gap, pressure, level = (
            at_times(of, instants, s.shape[1]) for of in (fields.gap, fields.pressure, fields.level)
        )
        contact = level >= 0
        # A body at rest touches the foundation with w = p = 0 everywhere, so any contact zone is right.
        resting = (abs(gap).max(axis=1) == 0) & (abs(pressure).max(axis=1) <= DEFECT_ROUND_OFF * fields.stress_scale())
        # Every quantity is compared with its own size. If it is zero, a small fraction of the size of stresses is used.
        scale_w = np.maximum(abs(gap), LEAST_SCALE)
        scale_p = np.maximum(abs(pressure), 1e-6 * fields.stress_scale())
        checks = [
            ("u_ν ≤ g, u ∈ K", np.maximum(-gap, 0), scale_w),
            ("σ_ν ≤ 0", np.maximum(-pressure, 0), scale_p),
            (f"{OPEN_IN_CONTACT} ψ ≥ 0", np.where(contact, abs(gap), 0), scale_w),
            ("p = 0, so σ_ν w = 0, off the stated zone", np.where(contact, 0, abs(pressure)), scale_p),
            (
                "w > 0 off the stated zone",
                np.where(~contact & (gap <= 0) & ~resting[:, None], abs(level), 0),
                abs(level),
            ),
        ]
        x = face.part.point(s)
        findings += [worst(f"(2.5) {c} on Γ3,{i}", x, instants, d, scale) for c, d, scale in checks]
    return findings


def _grid(part: Part) -> Array:
    """Return grid points inside a face, (d−1, N): n = FACE_POINTS points on a segment, at most n^{3/2} on a polygon."""
    count = round(FACE_POINTS ** (1 if part.dim == 2 else 0.75))
    # The ends of the face are left out, because a formula may be singular there.
    return part.grid((np.arange(count) + 0.5) / count)


def continuity(solution: ExactSolution, rng: np.random.Generator) -> list[Finding]:
    """Check that gap, its derivative and the strain do not jump along a face; otherwise u would not lie in H¹.

    Along a line in the direction of each coordinate, the change of a quantity must be the integral of its derivative.
    """
    instants = np.linspace(0, solution.body.T, 9)
    findings = []
    for i, face in enumerate(solution.faces, start=1):
        for axis, corners in enumerate(face.part.outline):
            start = face.part.coordinates(face.part.sample(rng, 1))[0]
            ends = np.linspace(corners.min(), corners.max(), 257)
            nodes, weights = composite_gauss(ends, 6)
            places = []
            for along in (ends, nodes):
                place = np.tile(start, along.size)
                place[axis] = along
                places.append(place)
            at_ends, at_nodes = (solution.on(face, place) for place in places)
            traces = [(at_ends.traces(t, axis), at_nodes.traces(t, axis)) for t in instants]
            for name in traces[0][0]:
                value = np.array([ends_now[name][0] for ends_now, _ in traces])
                slope = np.array([nodes_now[name][1] for _, nodes_now in traces])
                change = np.diff(value, axis=1)
                defect = abs(change - (slope * weights).reshape(*change.shape, -1).sum(axis=-1))
                scale = np.maximum(np.ptp(value, axis=1, keepdims=True), LEAST_SCALE)
                x = face.part.point(places[0][:, 1:])
                findings.append(
                    worst(f"(2.9) {name} without jumps on Γ3,{i}", x, instants, defect, scale, ACCEPTED_JUMP)
                )
    return findings


# The self-proof of an exact solution, which checks all conditions of Problem 2.1.
#
# The checks for heterogeneous materials stand here: continuous tractions where a factor jumps, and the bounds of the
# factors.


def traction_at_jumps(solution: ExactSolution, rng: np.random.Generator, count: int, instants: Array) -> list[Finding]:
    """Check that the traction is continuous where a material factor jumps; otherwise Div σ would not be a function.

    Args:
        solution: the exact solution.
        rng: draws the random points.
        count: the largest number of points on each line or plane with a jump.
        instants: the times, (times,).
    """
    findings = []
    inside = solution.body.sample(rng, 50 * count)
    size = solution.body.extent
    for direction, offset in solution.law.steps:
        normal = np.array(direction)
        onto = inside - np.multiply.outer(normal, normal @ inside - offset)
        x = onto[:, solution.body.contains(onto)][:, :count]
        sides = [solution.at(x + side * 1e-12 * size * normal[:, None]) for side in (-1, 1)]
        before, beyond = (at_times(fields.stress, instants, x.shape[1]) for fields in sides)
        defect = norms([traction(jump, normal) for jump in beyond - before])
        findings.append(worst(f"(2.2) σν continuous on {direction}·x = {offset:g}", x, instants, defect, norms(before)))
    return findings


def bounds_of_factors(solution: ExactSolution, rng: np.random.Generator, count: int) -> list[Finding]:
    """Check at random points that the factors of A and G lie between their stated bounds.

    The constants m_A and L_G are computed from these bounds.

    Args:
        solution: the exact solution.
        rng: draws the random points.
        count: 50 · count points are drawn.
    """
    x = solution.body.sample(rng, 50 * count)
    findings = []
    for number, name, factor in (("(3.1)", "A", solution.law.A.factor), ("(3.2)", "G", solution.law.G.factor)):
        value = factor(x)
        outside = np.maximum(np.maximum(factor.low - value, value - factor.high), 0)
        findings.append(worst(f"{number} bounds of the factor of {name}", x, np.zeros(1), outside[None], value[None]))
    return findings


@checked(ValueError)
def prove(solution: ExactSolution, name: str, seed: Natural = 0) -> list[Finding]:
    """Check every condition of Problem 2.1 and return the largest violation of each.

    >>> from manufactured import named
    >>> all(finding.passes for finding in prove(named("full-contact").solution, "full-contact"))
    True

    Args:
        solution: the exact solution.
        name: the name of the solution in the message of an error.
        seed: the seed of the random points and times.

    Raises:
        SelfProofError: a condition is violated by more than its tolerance; the message lists all violated conditions
            with point and time.
    """
    findings = examine(solution, seed)
    failed = [finding for finding in findings if not finding.passes]
    if failed:
        raise SelfProofError(name, failed)
    return findings


@checked(ValueError)
def examine(solution: ExactSolution, seed: Natural = 0, points: Count = 40, times: Count = 8) -> list[Finding]:
    """Return the largest violation of every condition of Problem 2.1 at random points and times.

    Args:
        solution: the exact solution.
        seed: the seed of the random numbers.
        points: the number of points in the body and on each part of its boundary.
        times: the number of times.
    """
    rng = np.random.default_rng(seed)
    instants = np.sort(rng.uniform(0, solution.body.T, times))
    inside = solution.body.sample(rng, points)
    return [
        *kinematics(solution, inside, instants),
        history(solution, inside),
        equilibrium(solution, inside, instants),
        *on_boundary(solution, rng, inside, instants),
        *signs(solution),
        *continuity(solution, rng),
        *traction_at_jumps(solution, rng, points, instants),
        *bounds_of_factors(solution, rng, points),
    ]

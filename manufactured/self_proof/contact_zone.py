"""Checks of the contact data on grids of the contact faces and of [0, T]: signs, contact zone and continuity."""

import numpy as np

from manufactured.body import Part
from manufactured.exact import ExactSolution
from manufactured.self_proof.finding import OPEN_IN_CONTACT, ROUND_OFF, Finding, at_times, worst
from manufactured.tensors import Array

JUMP = 0.05
"""Largest accepted relative jump of a quantity along a face.

The jump is the change of the quantity minus the integral of its derivative. The number is large because the derivative
may be singular at a front.
"""
GRID, INSTANTS = 211, 101
"""Numbers of points along a face and of times at which signs and the contact zone are checked."""
TINY = 1e-150
"""Lower bound of scales. A relative defect is divided by a scale, which is 0 for a quantity that is zero everywhere."""


def signs(solution: ExactSolution) -> list[Finding]:
    """Check that gap and pressure are not negative, that one of them is 0, and that the contact zone is as stated.

    A dense grid of each face and of [0, T] is used.
    """
    instants = np.linspace(0, solution.body.T, INSTANTS)
    findings = []
    for i, face in enumerate(solution.faces, start=1):
        s = _grid(face.part)
        fields = solution.on(face, s)
        gap, pressure, level = (
            at_times(of, instants, s.shape[1]) for of in (fields.gap, fields.pressure, fields.level)
        )
        contact = level >= 0
        # A body at rest touches the foundation with w = p = 0 everywhere, so any contact zone is right.
        resting = (abs(gap).max(axis=1) == 0) & (abs(pressure).max(axis=1) <= ROUND_OFF * fields.stress_scale())
        # Every quantity is compared with its own size. If it is zero, a small fraction of the size of stresses is used.
        scale_w = np.maximum(abs(gap), TINY)
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
    """Return grid points inside a face, (d−1, N): GRID points on a segment, at most GRID^{3/2} on a polygon."""
    # The ends of the face are left out, because a formula may be singular there.
    low, high = part.outline.min(axis=1), part.outline.max(axis=1)
    count = round(GRID ** (1 if part.dim == 2 else 0.75))
    axes = [a + (b - a) * (np.arange(count) + 0.5) / count for a, b in zip(low, high, strict=True)]
    points = np.array([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")])
    return points[:, part.covers(points, 0.0)]


def continuity(solution: ExactSolution, rng: np.random.Generator) -> list[Finding]:
    """Check that gap, its derivative and the strain do not jump along a face; otherwise u would not lie in H¹.

    Along a line in the direction of each coordinate, the change of a quantity must be the integral of its derivative.
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
                findings.append(worst(f"(2.9) {name} without jumps on Γ3,{i}", x, instants, defect, scale, JUMP))
    return findings

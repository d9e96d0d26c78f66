"""Both ways through Problem 5.1 side by side, on one mesh and with the same time steps."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from manufactured.tensors import Array
from study.statements.prop_5_4.experiment import Experiment
from study.statements.recomputed.plain import PlainProblem

ERRORS = "error", "interpolation_error", "discrete_error"
"""Maxima over the nodes in time of the norms in V of u − u^h, u − Π^h u and Π^h u − u^h."""
GAPS = "start", "displacement", "multipliers"
"""Relative differences of both ways: ‖u_0 − ũ_0‖_V, max_n ‖u_n − ũ_n‖_V, and of all λ_n in the Euclidean norm."""
TINY = 1e-12
"""Of the largest ‖ũ_n‖_V: a start that is no larger is zero."""
Course = Sequence[tuple[float, Array, Array]]
"""(t_n, ũ_n, λ̃_n)."""


def recompute(setup: Experiment) -> dict[str, float]:
    """``ERRORS`` by the plain way alone, and ``GAPS``; the scheme is the midpoint rule, of twice the steps."""
    plain = PlainProblem(setup.solution, setup.space.mesh)
    course = list(plain.march(2 * setup.steps))
    return errors(plain, course) | gaps(setup, plain, course)


def errors(plain: PlainProblem, course: Course) -> dict[str, float]:
    """``ERRORS`` of a course."""
    largest = np.zeros(len(ERRORS))
    for time, u, _ in course:
        interpolant = plain.interpolant(time)
        largest = np.maximum(largest, [*plain.distance(time, u, interpolant), plain.norm(interpolant - u)])
    return dict(zip(ERRORS, map(float, largest), strict=True))


def gaps(setup: Experiment, plain: PlainProblem, course: Course) -> dict[str, float]:
    """``GAPS`` between what an experiment computes and a course."""
    missing, forces, difference = [], 0.0, 0.0
    size = max(plain.norm(u) for _, u, _ in course)
    for state, (_, u, multipliers) in zip(setup.scheme.march(setup.problem, 2 * setup.steps), course, strict=True):
        missing.append(plain.norm(state.u - u))
        difference += float(np.sum((state.multipliers - multipliers) ** 2))
        forces += float(np.sum(multipliers**2))
    start = missing[0] / max(plain.norm(course[0][1]), TINY * size)
    pressed = math.sqrt(difference / forces) if forces else float(difference > 0)
    return dict(zip(GAPS, (start, max(missing) / size, pressed), strict=True))

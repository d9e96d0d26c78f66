"""Both ways through Problem 5.1 side by side, on one mesh and with the same time steps."""

from __future__ import annotations

import math
from collections.abc import Iterable

import numpy as np

from manufactured.tensors import Array
from study.statements.prop_5_4.experiment import Experiment
from study.statements.recomputed.plain import Course, PlainProblem

ERRORS = "error", "interpolation_error", "discrete_error"
"""Maxima over the nodes in time of the norms in V of u − u^h, u − Π^h u and Π^h u − u^h."""
GAPS = "start", "displacement", "multipliers"
"""Relative differences of both ways: ‖u_0 − ũ_0‖_V, max_n ‖u_n − ũ_n‖_V, and of all λ_n in the Euclidean norm."""
SAME_LOAD = "displacement_same_load", "multipliers_same_load"
"""The last two for the plain way with the load of the other one, which leaves forms, contact and steps to differ."""
TINY = 1e-12
"""Of the largest ‖ũ_n‖_V: a start that is no larger is zero."""


def recompute(setup: Experiment) -> dict[str, float]:
    """``ERRORS`` by the plain way alone, ``GAPS`` and ``SAME_LOAD``; by the midpoint rule, with twice the steps."""
    plain = PlainProblem(setup.solution, setup.space.mesh)
    course, alike = plain.courses(2 * setup.steps, plain.load, setup.problem.load)
    return errors(plain, course) | gaps(setup, plain, course, alike)


def same_load(setup: Experiment, plain: PlainProblem) -> Course:
    """The plain way with the load of an experiment."""
    (course,) = plain.courses(2 * setup.steps, setup.problem.load)
    return course


def errors(plain: PlainProblem, course: Course) -> dict[str, float]:
    """``ERRORS`` of a course."""
    found = []
    for time, u, _ in course:
        interpolant = plain.interpolant(time)
        found.append([*plain.distance(time, u, interpolant), *plain.norms((interpolant - u)[:, None])])
    return dict(zip(ERRORS, map(float, np.max(found, axis=0)), strict=True))


def gaps(setup: Experiment, plain: PlainProblem, course: Course, loaded_alike: Course) -> dict[str, float]:
    """``GAPS`` between what an experiment computes and a course, and ``SAME_LOAD`` from one with its own load."""
    states = [(s.time, s.u, s.multipliers) for s in setup.scheme.march(setup.problem, 2 * setup.steps)]
    norms = plain.norms(np.stack([u for _, u, _ in course], axis=1))
    forces = _size(multipliers for *_, multipliers in course)
    sizes = max(norms[0], TINY * norms.max()), norms.max(), forces
    apart, alike = _apart(plain, states, course), _apart(plain, states, loaded_alike)
    found = zip((*GAPS, *SAME_LOAD), (*apart, *alike[1:]), (*sizes, *sizes[1:]), strict=True)
    return {name: float(gap / size if size else gap > 0) for name, gap, size in found}


def _apart(plain: PlainProblem, states: Course, course: Course) -> tuple[float, float, float]:
    """‖u_0 − ũ_0‖_V, max_n ‖u_n − ũ_n‖_V, and the difference of all λ_n."""
    pairs = list(zip(states, course, strict=True))
    missing = plain.norms(np.stack([ours - u for (_, ours, _), (_, u, _) in pairs], axis=1))
    return missing[0], missing.max(), _size(ours - forces for (*_, ours), (*_, forces) in pairs)


def _size(vectors: Iterable[Array]) -> float:
    """The Euclidean norm of all together."""
    return math.sqrt(sum(float(np.sum(each**2)) for each in vectors))

"""One computed displacement with its bounds: a row of ``bounds.csv``."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from manufactured.case import Case
from manufactured.data import Data
from manufactured.problems import OpenProblem, problems
from study.bound.discretisation import Discretisation, check_force
from study.bound.enclosing import Enclosure, enclose, known_error
from study.bound.trajectory import Trajectory, compute
from study.fem.mesh import MeshFamily
from study.fem.naming import resolve
from study.solve.evolution import Scheme
from study.solve.steps import PACE

COMPUTED = "case", "family", "scheme", "trajectory", "level", "h", "steps", "expected_order"
BOUNDED = "error", "lowest", "highest", "above", "below", "upper", "lower"
PARTS = "residual", "contact", "oscillation", "bending"
COLUMNS = (*COMPUTED, *BOUNDED, *PARTS)
"""``bounds.csv``.

    case, family, scheme, level, h, steps: what was computed; u_h is P1.
    expected_order: the predicted order, not a number where none is predicted.
    trajectory: "bound" for ũ = u_h, "enclosure" for a better ũ.
    error: max_t ‖u(t) − u_h(t)‖_V over the sampled times.
    lowest, highest: what encloses it, the second over all times.
    above: max_t error/(d + y); the error is below the bound iff this is ≤ 1.
    below: max_t (d − y)_+/error; it is above the lower bound iff this is ≤ 1.
    upper, lower: effectivities max (d + y)/error and min (d − y)_+/error over the times in [T/2, T].
    residual, contact, oscillation, bending: what y is made of, integrals over [0, T].
"""


@dataclass(frozen=True)
class Posed:
    """What a computed displacement approximates: the data of a case, or of a problem whose solution is unknown.

    ``order`` is the predicted one, not a number where none is predicted; ``pace`` says how fast things happen in time.
    """

    name: str
    data: Data
    order: float
    pace: float
    case: Case | None


@lru_cache
def posed(reference: str) -> Posed:
    """The problem of the study with a name, or the case behind a reference."""
    problem = _without_solution().get(reference)
    if problem is not None:
        return Posed(problem.name, problem.data, math.nan if problem.order is None else problem.order, PACE, None)
    case = resolve(reference)
    return Posed(case.name, Data.of(case.solution), case.order, case.pace, case)


@lru_cache
def _without_solution() -> dict[str, OpenProblem]:
    """The problems of the study that have no known solution; their formulas take time to compile."""
    return {problem.name: problem for problem in problems()}


def measure(
    problem: Posed, family: MeshFamily, level: int, scheme: Scheme, steps: int, trajectory: Trajectory
) -> tuple[dict[str, Any], Enclosure]:
    """The row and the bounds over time; what compares with the error is not a number where it is unknown.

    Raises:
        BoundError: f_0 ∉ L²(Ω)².
    """
    check_force(problem.case)
    discretisation = Discretisation(problem.data, family(problem.data.body, level))
    computed = compute(discretisation, scheme, steps)
    found = enclose(discretisation, computed, trajectory, known_error(problem.case, computed))
    late = found.times >= computed.T / 2
    parts = {part: float(np.sum([getattr(interval, part) for interval in found.intervals])) for part in PARTS}
    row = {
        "case": problem.name,
        "family": family.name,
        "scheme": scheme.name,
        "trajectory": trajectory.name,
        "level": level,
        "h": found.h,
        "steps": computed.steps,
        "expected_order": problem.order,
        "error": float(found.error.max()),
        "lowest": found.lowest,
        "highest": found.highest,
        "above": float((found.error / found.upper).max()),
        "below": float((found.lower / found.error).max()),
        "upper": float((found.upper / found.error)[late].max()),
        "lower": float((found.lower / found.error)[late].min()),
    }
    return row | parts, found

"""The rows of ``bounds.csv``: one computed displacement with its bounds."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from manufactured.case import Case
from manufactured.data import Data
from manufactured.problems import Problem
from study.bound.bounded import known_error
from study.bound.discrete_solution import DiscreteSolution, compute
from study.bound.discretisation import Discretisation
from study.bound.enclosing import enclose
from study.bound.refusal import check_force
from study.bound.trajectory import Trajectory
from study.bound.two_sided import Enclosure
from study.fem.mesh import MeshFamily
from study.solve.evolution import Scheme

PACE = 8.0
"""Time steps per n^{2/3} and unit of time, as for the rates."""


@dataclass(frozen=True)
class BoundRow:
    """One line of ``bounds.csv``.

    Attributes:
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

    case: str
    family: str
    scheme: str
    trajectory: str
    level: int
    h: float
    steps: int
    expected_order: float
    error: float
    lowest: float
    highest: float
    above: float
    below: float
    upper: float
    lower: float
    residual: float
    contact: float
    oscillation: float
    bending: float


def steps_for(data: Data, level: int, pace: float = PACE) -> int:
    """pace · T · n^{2/3}."""
    return math.ceil(pace * data.body.T * level ** (2 / 3))


def measure_bound(
    case: Case, family: MeshFamily, level: int, scheme: Scheme, steps: int, trajectory: Trajectory
) -> tuple[BoundRow, Enclosure]:
    """The row for a case with an exact solution, and the bounds over time.

    Raises:
        BoundError: f_0 ∉ L²(Ω)².
    """
    check_force(case)
    discretisation = Discretisation(Data.of(case.solution), family(case.solution.body, level))
    computed = compute(discretisation, scheme, steps)
    found = enclose(discretisation, computed, trajectory, known_error(case, computed))
    return _row(case.name, case.order, family, level, scheme, computed, trajectory, found), found


def measure_problem(
    problem: Problem, family: MeshFamily, level: int, scheme: Scheme, steps: int, trajectory: Trajectory
) -> tuple[BoundRow, Enclosure]:
    """The same for data alone: what compares with the error is not a number."""
    discretisation = Discretisation(problem.data, family(problem.data.body, level))
    computed = compute(discretisation, scheme, steps)
    found = enclose(discretisation, computed, trajectory)
    return _row(
        problem.name,
        math.nan if problem.order is None else problem.order,
        family,
        level,
        scheme,
        computed,
        trajectory,
        found,
    ), found


def _row(
    name: str,
    order: float,
    family: MeshFamily,
    level: int,
    scheme: Scheme,
    computed: DiscreteSolution,
    trajectory: Trajectory,
    found: Enclosure,
) -> BoundRow:
    late = found.times >= computed.T / 2
    return BoundRow(
        case=name,
        family=family.name,
        scheme=scheme.name,
        trajectory=trajectory.name,
        level=level,
        h=found.h,
        steps=computed.steps,
        expected_order=order,
        error=float(found.error.max()),
        lowest=found.lowest,
        highest=found.highest,
        above=float((found.error / found.upper).max()),
        below=float((found.lower / found.error).max()),
        upper=float((found.upper / found.error)[late].max()),
        lower=float((found.lower / found.error)[late].min()),
        **{
            part: float(np.sum([getattr(interval, part) for interval in found.intervals]))
            for part in ("residual", "contact", "oscillation", "bending")
        },
    )

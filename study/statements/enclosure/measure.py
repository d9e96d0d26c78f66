"""One computed displacement with its bounds, for ledgers, tables and the command ``study bound``."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from manufactured.case import Case
from manufactured.data import Data
from manufactured.problems import Problem
from manufactured.tensors import Array
from study.bound.discretisation import BoundError, Setting, refuse_solids
from study.bound.enclosure import Better, Computed, Enclosure, Itself, Trajectory, compute, enclose
from study.fem.gauge import Gauge
from study.fem.mesh import FAMILIES, MeshFamily, boundary_parts
from study.solve.evolution import Scheme
from study.solve.steps import rate_steps


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


@dataclass(frozen=True, eq=False)
class Bounded:
    """A computed displacement with the plain bound and the enclosure of its error."""

    setting: Setting
    computed: Computed
    plain: Enclosure
    enclosure: Enclosure


def check_bound(
    data: Data, family: MeshFamily, levels: Sequence[int], steps: int | None, better: Better
) -> dict[int, int]:
    """Refuse what cannot be bounded before time is spent; returns the steps of every level.

    Raises:
        BoundError: levels, steps or refinements that make no sense, a family that does not serve the body, a body in
            3D or a law without a usable monotonicity constant.
        LoadError: data that no solution can belong to.
        MeshError: a mesh does not fit the parts of the body.
    """
    if not levels or min(levels) < 2 or any(b <= a for a, b in pairwise(levels)):
        raise BoundError(f"levels must be 2 or more and increase, got {' '.join(map(str, levels)) or 'none'}")
    if steps is not None and steps < 1:
        raise BoundError(f"--steps must be 1 or more, got {steps}")
    if better.refinements < 0 or better.shorter < 1:
        raise BoundError(
            "ũ needs 0 or more refinements and 1 or more steps in one of u_h, "
            f"got {better.refinements} and {better.shorter}"
        )
    refuse_solids(data)
    data.check()
    if not family.serves(data.body):
        served = ", ".join(known.name for known in FAMILIES if known.serves(data.body))
        raise BoundError(f"the family {family.name} does not mesh this body; take one of {served or 'none'}")
    for level in levels:
        boundary_parts(Setting(data, family(data.body, level)).mesh, data.body)
    return {level: steps or rate_steps(data.body.T, level) for level in levels}


def check_force(case: Case | None) -> None:
    """Refuse a case with f_0 ∉ L²(Ω)², whose oscillation is infinite and whose load no composite stress balances.

    Raises:
        BoundError: it is one.
    """
    if case is not None and not case.regularity.force_in_L2:
        raise BoundError(
            f"case {case.name}: {case.regularity} has f_0 ∉ L²(Ω)², and the bound needs stresses with Div σ = −P f_0; "
            "take a case with f_0 in L²"
        )


def known_error(case: Case | None, computed: Computed) -> Callable[[float, Array], float] | None:
    """(t, u_h(t)) ↦ ‖u(t) − u_h(t)‖_V, where there is an exact solution."""
    if case is None:
        return None
    gauge = Gauge(case.solution, computed.space)
    return lambda time, u: gauge.distance(gauge.sample(time), u)


def bounded(
    data: Data,
    case: Case | None,
    family: MeshFamily,
    level: int,
    scheme: Scheme,
    steps: int,
    better: Better,
    progress: Callable[[float], object] = lambda time: None,
) -> Bounded:
    """Compute u_h and both bounds."""
    setting = Setting(data, family(data.body, level))
    computed = compute(setting, scheme, steps)
    error = known_error(case, computed)
    return Bounded(
        setting,
        computed,
        enclose(setting, computed, Itself(), error),
        enclose(setting, computed, better, error, progress),
    )


def measure_bound(
    case: Case, family: MeshFamily, level: int, scheme: Scheme, steps: int, trajectory: Trajectory
) -> tuple[BoundRow, Enclosure]:
    """The row for a case with an exact solution, and the bounds over time.

    Raises:
        BoundError: f_0 ∉ L²(Ω)².
    """
    check_force(case)
    setting = Setting(Data.of(case.solution), family(case.solution.body, level))
    computed = compute(setting, scheme, steps)
    found = enclose(setting, computed, trajectory, known_error(case, computed))
    return _row(case.name, case.order, family, level, scheme, computed, trajectory, found), found


def measure_problem(
    problem: Problem, family: MeshFamily, level: int, scheme: Scheme, steps: int, trajectory: Trajectory
) -> tuple[BoundRow, Enclosure]:
    """The same for data alone: what compares with the error is not a number."""
    setting = Setting(problem.data, family(problem.data.body, level))
    computed = compute(setting, scheme, steps)
    found = enclose(setting, computed, trajectory)
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
    computed: Computed,
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

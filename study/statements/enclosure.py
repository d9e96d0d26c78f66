"""Beyond the paper: bounds of the error of the fully discrete scheme, without the exact solution.

**Measured** by ``study.bound``: the error of a displacement u_h that a time scheme computed, bounded from u_h itself
("bound"), and enclosed from both sides by a better trajectory ũ ("enclosure"), at many times. A row of ``bounds.csv``
is one computed displacement; ``enclosures.csv`` has its bounds over time.

**Judged.** No error may lie outside. This is a theorem (``paper/bound.tex``), but the program may be wrong: a row fails
if one sampled error lies outside, for one mesh, scheme or time. How close the ends are is a matter of efficiency. It is
judged where it was announced, for the case with check values, and reported elsewhere. Two enclosures enclose an
observed order, also where the solution is unknown.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

import numpy as np
import pandas as pd

from manufactured.case import Case
from manufactured.data import Data
from manufactured.problems import OpenProblem, problems
from study.bound.discretisation import Discretisation, check_force
from study.bound.enclosing import Enclosure, enclose, known_error, order_interval
from study.bound.trajectory import Refined, SmoothedInTime, Trajectory, compute
from study.fem.mesh import MeshFamily
from study.fem.naming import choose, family_named, resolve
from study.ledger.criterion import Observation, Rule, every, largest
from study.ledger.datafiles import CsvFile, DataFile, Row
from study.ledger.orders import orders
from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED, Span, Verdict, row
from study.ledger.window import Window, around, at_most, positive_at_most
from study.solve.evolution import Scheme
from study.solve.steps import PACE, rate_steps
from study.solve.tableau import SCHEMES
from study.statements.shared import estimates
from study.statements.shared.base import Setting, Statement
from study.statements.shared.meshes import families
from study.statements.shared.scope import Scope

COMPUTED = "case", "family", "scheme", "trajectory", "level", "h", "steps", "expected_order"
BOUNDED = "error", "lowest", "highest", "above", "below", "upper", "lower"
PARTS = "residual", "contact", "oscillation", "bending"
COLUMNS = (*COMPUTED, *BOUNDED, *PARTS)
"""``bounds.csv``.

    case, family, scheme, level, h, steps: the computed displacement u_h, which is P1.
    expected_order: the predicted order, NaN where none is predicted.
    trajectory: "bound" for ũ = u_h, "enclosure" for a better ũ.
    error: max_t ‖u(t) − u_h(t)‖_V over the sampled times.
    lowest, highest: the ends of its enclosure, the second over all times.
    above: max_t error/(d + y); the error is below the bound iff this is ≤ 1.
    below: max_t (d − y)_+/error; the error is above the lower bound iff this is ≤ 1.
    upper, lower: effectivities max (d + y)/error and min (d − y)_+/error over the times in [T/2, T].
    residual, contact, oscillation, bending: the parts of y, integrals over [0, T].
"""
KEY = ("trajectory", "case", "family", "scheme", "level")
BOUNDS = CsvFile("bounds.csv", KEY, COLUMNS)
ENCLOSURES = CsvFile("enclosures.csv", KEY, (*KEY, "time", "error", "distance", "bound"))
TIMES = 96
"""Times of one computation in ``enclosures.csv``."""


# Cases, schemes and meshes.
@dataclass(frozen=True)
class BoundSetting(Setting):
    """The setting of one row of ``bounds.csv``, which also has the name of the scheme of u_h, and how ũ is computed.

    ``case`` may be the name of a problem whose solution is unknown.
    """

    scheme: str
    by: Trajectory

    @property
    def trajectory(self) -> str:
        """The name of ũ, which is the label of the statement."""
        return self.by.name

    @property
    def refinements(self) -> int:
        """Refinements from the mesh of u_h to the mesh of ũ."""
        return self.by.refinements if isinstance(self.by, Refined) else 0


QUICK = (
    ("advance-recede", "one-diagonal", "backward-euler"),
    ("yield-on-a-part", "criss-cross", "bdf2"),
    ("hexagon", "unstructured", "midpoint"),
)
"""Cases whose bounds the quick study computes, with mesh family and scheme: memory, law (3.3), three faces."""
ROTATION = ("one-diagonal", "criss-cross", "shaken", "unstructured", "graded")
"""The full study bounds the errors of the schemes of a case on meshes of these families in turn."""
ROTATION_STARTS = {
    "rotated": "shaken",
    "natural-front": "criss-cross",
    "rough-trace": "shaken",
    "re-entrant": "graded",
    "softening": "criss-cross",
    "double-well": "shaken",
}
"""Where the rotation starts for cases for which this is not the family that the case names first."""
CHECKED, CHECKED_LEVEL = "advance-recede", 32
"""The case with check values, and the level at which the enclosure is announced to be tight."""


def eligible(case: Case) -> bool:
    """Return whether the bound exists: in the plane, with f_0 ∈ L²(Ω)², tensors smooth in every cell."""
    return case.solution.body.dim == 2 and case.regularity.force_in_L2 and not case.regularity.kink


def by_midpoint(case: str, family: str, levels: Sequence[int], by: Trajectory) -> list[BoundSetting]:
    """Return settings on some levels with the midpoint rule."""
    return [BoundSetting(case, family, level, "midpoint", by) for level in levels]


def quick_bounds(cases: Sequence[Case]) -> Iterator[BoundSetting]:
    """Yield one scheme for each quick case, and enclosures on two levels with a known and an unknown solution."""
    studied = {case.name for case in cases}
    for name, family, scheme in QUICK:
        if name in studied:
            yield BoundSetting(name, family, 8, scheme, SmoothedInTime())
    if CHECKED in studied:
        yield from by_midpoint(CHECKED, "one-diagonal", (4, 8), Refined(0, 2))
        yield from by_midpoint("bracket", "graded", (4, 8), Refined(0, 2))


def full_bounds(cases: Sequence[Case]) -> Iterator[BoundSetting]:
    """Yield every case with every scheme, families in turn; enclosures on two levels; problems without a solution."""
    for case in filter(eligible, cases):
        in_turn = families_in_turn(case)
        for family, scheme in zip(in_turn, SCHEMES, strict=True):
            yield BoundSetting(case.name, family, 8, scheme.name, SmoothedInTime())
        yield from by_midpoint(case.name, in_turn[0], (16,), SmoothedInTime())
        yield from by_midpoint(case.name, in_turn[0], (4, 8) if case.name != CHECKED else (), Refined(1, 2))
    if any(case.name == CHECKED for case in cases):
        yield from by_midpoint(CHECKED, "shaken", (8, 16, CHECKED_LEVEL), Refined(1, 4))
        yield from by_midpoint("ramp", "unstructured", (4, 8, 16), Refined(2, 2))
        yield from by_midpoint("bracket", "graded", (4, 8, 16), Refined(1, 2))


def families_in_turn(case: Case) -> list[str]:
    """Return the names of a mesh family for each scheme: those of ``ROTATION`` that can mesh the body, in turn."""
    serving = [family for family in ROTATION if family in families(case)]
    first = serving.index(ROTATION_STARTS.get(case.name, (case.families or serving)[0]))
    return [serving[(first + turn) % len(serving)] for turn in range(len(SCHEMES))]


# Measurement.
@dataclass(frozen=True)
class ResolvedProblem:
    """The problem that a computed displacement approximates: of a case, or one whose solution is unknown.

    ``order`` is the predicted order, NaN where none is predicted; ``pace`` says how fast things happen in time.
    """

    name: str
    data: Data
    order: float
    pace: float
    case: Case | None


@lru_cache
def resolve_problem(reference: str) -> ResolvedProblem:
    """Return the problem of the study with this name, or the problem of the case behind a reference."""
    problem = problems_without_solution().get(reference)
    if problem is not None:
        return ResolvedProblem(
            problem.name, problem.data, math.nan if problem.order is None else problem.order, PACE, None
        )
    case = resolve(reference)
    return ResolvedProblem(case.name, Data.of(case.solution), case.order, case.pace, case)


@lru_cache
def problems_without_solution() -> dict[str, OpenProblem]:
    """Return the problems of the study whose solution is unknown by name; their formulas take time to compile."""
    return {problem.name: problem for problem in problems()}


def measure(
    problem: ResolvedProblem, family: MeshFamily, level: int, scheme: Scheme, steps: int, trajectory: Trajectory
) -> tuple[dict[str, Any], Enclosure]:
    """Return the row of ``bounds.csv`` and the bounds over time; comparisons with an unknown error are NaN.

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


def over_time(found: Enclosure) -> dict[str, list[float]]:
    """Return the columns of ``enclosures.csv``, at no more than TIMES times."""
    chosen = np.unique(np.linspace(0, len(found.times) - 1, TIMES).round().astype(int))
    columns = ("error", "distance", "bound")
    return {
        "time": np.round(found.times[chosen], 9).tolist(),
        **{name: [float(f"{v:.6g}") for v in getattr(found, name)[chosen]] for name in columns},
    }


class Bounds(Statement):
    """The measurement that the statements "bound" and "enclosure" share."""

    file = BOUNDS

    def settings(self, scope: Scope) -> list[BoundSetting]:
        """The cases of the study, and problems without a known solution."""
        found = (full_bounds if scope.full else quick_bounds)(scope.resolved())
        return [setting for setting in found if setting.trajectory == self.label]

    def measure(self, setting: BoundSetting) -> dict[str, Any]:
        """Return a row of ``bounds.csv``, and columns of ``enclosures.csv``."""
        family, scheme = family_named(setting.family), choose("scheme", setting.scheme, SCHEMES)
        row, found = measure(
            resolve_problem(setting.case), family, setting.level, scheme, self.steps(setting), setting.by
        )
        return {"row": row, "times": over_time(found)}

    def records(self, setting: BoundSetting, found: Mapping[str, Any]) -> Iterator[tuple[DataFile, Row]]:
        """One row of ``bounds.csv``, and one of ``enclosures.csv`` for every time."""
        yield BOUNDS, found["row"]
        common = {name: found["row"][name] for name in KEY}
        for values in zip(*found["times"].values(), strict=True):
            yield ENCLOSURES, {**common, **dict(zip(found["times"], values, strict=True))}

    def cost(self, setting: BoundSetting) -> float:
        """By cells of the mesh of ũ and its steps: a time node costs three stress solves of degree 3."""
        shorter = setting.by.shorter if isinstance(setting.by, Refined) else 1
        return 220.0 * setting.level**2 * 4**setting.refinements * self.steps(setting) * shorter

    def memory(self, setting: BoundSetting) -> float:
        return estimates.bound(setting.level, setting.refinements, setting.family)

    def steps(self, setting: BoundSetting) -> int:
        problem = resolve_problem(setting.case)
        return rate_steps(problem.data.body.T, setting.level, problem.pace)


# Criteria. An error must be positive; a lower bound on a coarse mesh may be zero.
ABOVE = largest("above", "largest error / upper bound", positive_at_most(1.0, "at every sampled time"), "above")
BELOW = largest("below", "largest lower bound / error", at_most(1.0, "at every sampled time"), "below")
REACH = Observation(
    largest("upper", "upper bound / error over [T/2, T], largest", Window(), "upper"),
    "this is the distance of an end from the error; the claim is that the end never crosses the error",
)
HERE = f"at n = {CHECKED_LEVEL}"
TIGHT = (
    every("tight-above", f"upper bound / error {HERE}", Window(1.0, 1.15, "over [T/2, T]"), "upper"),
    every("tight-below", f"lower bound / error {HERE}", Window(0.85, 1.0, "over [T/2, T]"), "lower"),
)
ROOM = 0.15
"""Room around a predicted order, as for orders between levels elsewhere."""
LAST = "no claim: the interval from two meshes is wider than the interval from all meshes"
KNOWN = "no claim: it contains the order of the errors whenever the row above holds"
UNPREDICTED = "no claim: neither the solution nor its order is known"


class BoundedError(Bounds):
    """The bound from the computed displacement alone."""

    label = "bound"
    claim = "‖u(t) − u_h(t)‖_V ≤ y(t), from u_h and an admissible stress alone"

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        mine = rows[(rows["trajectory"] == self.label) & rows["known"]]
        return [
            rule.verdict(self, str(case), {"": of_case})
            for case, of_case in mine.groupby("case", sort=False)
            for rule in (ABOVE, REACH)
        ]


class EnclosedError(Bounds):
    """The enclosure of the error by a better trajectory, and the enclosure of the order."""

    label = "enclosure"
    claim = "d(t) − y(t) ≤ ‖u(t) − u_h(t)‖_V ≤ d(t) + y(t), without the exact solution"

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        found: list[Verdict] = []
        for case, mine in rows[rows["trajectory"] == self.label].groupby("case", sort=False):
            known, checked = bool(mine["known"].iloc[0]), mine[mine["level"] == CHECKED_LEVEL]
            rules: list[tuple[Rule, pd.DataFrame]] = [(rule, mine) for rule in (ABOVE, BELOW, REACH) if known]
            rules += [(rule, checked) for rule in TIGHT if case == CHECKED and len(checked)]
            found += [rule.verdict(self, str(case), {"": table}) for rule, table in rules]
            for (family, _), series in mine.groupby(["family", "scheme"], sort=False):
                levels = series.sort_values("h", ascending=False)
                if len(levels) > 1:
                    found.append(self.judge_order(str(case), str(family), levels, known))
                if len(levels) > 2:
                    of_pair = self.judge_order(str(case), str(family), levels.tail(2), known)
                    found.append(replace(of_pair, key="order-last", verdict=REPORTED, expected=LAST))
        return found

    def judge_order(self, case: str, family: str, levels: pd.DataFrame, known: bool) -> Verdict:
        """Return the row for the interval of the order between the coarsest and the finest level.

        Without an exact solution the whole interval must lie in the window of the predicted order, as in every other
        row; the row fails if they have no common point. With an exact solution the interval contains the order of the
        errors whenever these lie inside, so that it is only reported.
        """
        coarse, fine = levels.iloc[0], levels.iloc[-1]
        ratio = math.log(coarse["h"] / fine["h"])
        first, last = ((line["lowest"], line["highest"]) for line in (coarse, fine))
        span = order_interval(first, last, ratio)
        sizes = [line["error"] if known else line["lowest"] + line["highest"] for line in (coarse, fine)]
        observed = float(orders(np.array([coarse["h"], fine["h"]]), np.array(sizes))[0])
        order = math.nan if known else float(fine["expected_order"])
        quantity = f"order of max_t ‖u − u_h‖_V, u_h of the scheme, k with h, n = {coarse['level']} to {fine['level']}"
        if math.isnan(order):
            window, verdict, expected = Window(math.nan, math.nan), REPORTED, KNOWN if known else UNPREDICTED
        else:
            window = around(order, ROOM, "the whole interval")
            verdict, expected = judge_interval(span, window), ""
        return row(self, "order", quantity, window, (observed, span, verdict), case, family, expected)


def judge_interval(span: Span, window: Window) -> str:
    """Return the verdict on an interval: holds inside the window, fails without a common point, otherwise undecided."""
    if window.contains(*span):
        return HOLDS
    return FAILS if span[1] < window.low or span[0] > window.high else UNDECIDED

"""Beyond the paper: bounds of the error of the fully discrete scheme, without the exact solution.

Let u_h be a displacement that a time scheme computed. ``study.bound`` computes an upper bound of its error from u_h
itself (kind "bound"), or bounds from both sides by means of a more accurate displacement ũ (kind "enclosure"). A row of
``bounds.csv`` is one computed displacement; ``enclosures.csv`` has its bounds at many times.

**Judged** is whether every error lies between its bounds. This is a theorem (``paper/enclosure.tex``), but the program
may be wrong: the check fails if one sampled error lies outside, for one mesh, scheme or time. The distance between the
bounds shows their efficiency. It is judged only for CHECKED, the case for which the documentation promises a tight
enclosure, and reported otherwise. Enclosures of the errors on two levels also enclose the observed order, even if the
exact solution is unknown.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
import pandas as pd

from manufactured.case import Case
from manufactured.data import Data
from manufactured.problems import problems
from study.bound.discretisation import Discretisation, check_force
from study.bound.enclosing import Enclosure, enclose, known_error, order_interval
from study.bound.trajectory import Refined, SmoothedInTime, Trajectory, compute
from study.fem.mesh import MeshFamily
from study.fem.naming import choose, family_named, resolve
from study.ledger.check import Groups, consequence, identity
from study.ledger.datafiles import CsvFile, Row
from study.ledger.quantities import orders
from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED, CheckKind, Span, Verdict, row
from study.ledger.window import Window, around, at_most, positive_at_most
from study.solve.evolution import Scheme
from study.solve.steps import PACE, rate_steps
from study.solve.tableau import SCHEMES
from study.statements.shared import estimates
from study.statements.shared.base import Numbers, Records, Setting, Statement
from study.statements.shared.scope import Scope

BOUNDS = CsvFile("bounds.csv")
ENCLOSURES = CsvFile("enclosures.csv")
SAVED_TIMES = 96
"""Number of times for which ``enclosures.csv`` has the bounds of one computed displacement."""


# Cases, schemes and meshes: chosen so that every scheme meets every mesh family at moderate cost.
@dataclass(frozen=True)
class BoundSetting(Setting):
    """A case, a mesh, a time scheme and a kind of bound: the setting of one row of ``bounds.csv``.

    The case may also be a problem whose solution is unknown.

    Attributes:
        scheme: the name of the time scheme that computes the displacement u_h, whose error is bounded.
        by: how a second displacement ũ is computed, from which the bounds follow.
    """

    scheme: str
    by: Trajectory

    @property
    def trajectory(self) -> str:
        """The kind of bound, which is also the label of the statement: "bound" or "enclosure".

        It is named after the displacement ũ in space and time from which the bound is computed: u_h itself, or a more
        accurate one.
        """
        return self.by.name


QUICK = (
    ("advance-recede", "one-diagonal", "backward-euler"),
    ("yield-on-a-part", "criss-cross", "bdf2"),
    ("hexagon", "unstructured", "midpoint"),
)
"""Triples (case, mesh family, scheme) for the quick study. Linear laws and the nonlinear law (3.3) occur."""
FAMILIES_IN_TURN = ("one-diagonal", "criss-cross", "shaken", "unstructured", "graded")
"""Mesh families that are assigned in turn to the time schemes of a case in the full study."""
ROTATION_STARTS = {
    "rotated": "shaken",
    "natural-front": "criss-cross",
    "rough-trace": "shaken",
    "re-entrant": "graded",
    "softening": "criss-cross",
    "double-well": "shaken",
}
"""Mesh families of the first time scheme, for some cases. Other cases start with the first family that they name."""
CHECKED, CHECKED_LEVEL = "advance-recede", 16
"""The case and the level for which the documentation promises a tight enclosure."""


def eligible(case: Case) -> bool:
    """Return whether the error bounds apply to a case.

    They require a plane body, a body force f_0 ∈ L²(Ω)², and operators A and G that are smooth in every cell.
    """
    return case.solution.body.dim == 2 and case.regularity.force_in_L2 and not case.regularity.kink


def by_midpoint(case: str, family: str, levels: Sequence[int], by: Trajectory) -> list[BoundSetting]:
    """Return the settings of a case on one mesh family and the given levels, all with the midpoint rule.

    Args:
        case, family: the names of the case and of the mesh family.
        levels: the levels.
        by: how the second displacement is computed from which the bounds follow.
    """
    return [BoundSetting(case, family, level, "midpoint", by) for level in levels]


def bounds(cases: Sequence[Case], full: bool) -> Iterator[BoundSetting]:
    """Yield the settings of the statements about upper bounds and about enclosures, in the full or the quick study.

    The quick study has upper bounds for the cases in QUICK. It has enclosures on two levels, for one case with a known
    solution and for one problem whose solution is unknown.

    In the full study every case is measured with every time scheme, on the next mesh family of ``FAMILIES_IN_TURN`` for
    each scheme. Enclosures are computed on two levels, but on three for the case ``CHECKED`` and for problems whose
    solution is unknown.
    """
    studied = {case.name for case in cases}
    if not full:
        for name, mesh, method in QUICK:
            if name in studied:
                yield BoundSetting(name, mesh, 6, method, SmoothedInTime())
        if CHECKED in studied:
            yield from by_midpoint(CHECKED, "one-diagonal", (4, 8), Refined(0, 2))
            yield from by_midpoint("bracket", "graded", (4, 8), Refined(0, 2))
        return
    for case in filter(eligible, cases):
        serving = [family for family in FAMILIES_IN_TURN if family_named(family).serves(case.solution.body)]
        first = serving.index(ROTATION_STARTS.get(case.name, (case.families or serving)[0]))
        for turn, scheme in enumerate(SCHEMES, start=first):
            yield BoundSetting(case.name, serving[turn % len(serving)], 8, scheme.name, SmoothedInTime())
        yield from by_midpoint(case.name, serving[first], (16,), SmoothedInTime())
        yield from by_midpoint(case.name, serving[first], (4, 8) if case.name != CHECKED else (), Refined(1, 2))
    if CHECKED in studied:
        yield from by_midpoint(CHECKED, "shaken", (4, 8, CHECKED_LEVEL), Refined(1, 4))
        yield from by_midpoint("ramp", "unstructured", (4, 8, 16), Refined(2, 2))
        yield from by_midpoint("bracket", "graded", (4, 8, 16), Refined(1, 2))


# Measurements are made for problems and not for cases, because problems with unknown solutions are measured as well.
@dataclass(frozen=True)
class ResolvedProblem:
    """The problem that a computed displacement approximates, with a known or an unknown exact solution.

    Attributes:
        name: the name of the case or of the problem.
        data: the data of the problem.
        order: the predicted order of the error, or NaN if no order is predicted.
        pace: the number of time steps per unit of time divided by n^{2/3} at level n, as for a case (``rate_steps``).
        case: the case with the exact solution; None if the exact solution is unknown.
    """

    name: str
    data: Data
    order: float
    pace: float
    case: Case | None


@lru_cache
def resolve_problem(reference: str) -> ResolvedProblem:
    """Return the problem with the given name: a problem whose solution is unknown, or the problem of a case.

    Args:
        reference: the name of the problem or of the case; for a case of a user FILE.py:NAME.
    """
    for problem in open_problems():
        if problem.name == reference:
            order = math.nan if problem.order is None else problem.order
            return ResolvedProblem(problem.name, problem.data, order, PACE, None)
    case = resolve(reference)
    return ResolvedProblem(case.name, Data.of(case.solution), case.order, case.pace, case)


open_problems = lru_cache(problems)
"""Returns the problems whose solutions are unknown. They are cached, because compiling formulas is slow."""


def measure(
    problem: ResolvedProblem, family: MeshFamily, level: int, scheme: Scheme, steps: int, trajectory: Trajectory
) -> tuple[Numbers, Enclosure]:
    """Compute a displacement u_h and bounds of its error ‖u − u_h‖_V on one mesh.

    If the exact solution u is unknown, numbers that depend on the error are NaN.

    Args:
        problem: the problem.
        family, level: the mesh family and the level of the mesh of u_h.
        scheme, steps: the time scheme of u_h, and the number of its steps.
        trajectory: how the displacement is computed from which the bounds follow.

    Returns:
        The row of ``bounds.csv``, and the bounds over time.

    Raises:
        BoundError: the body force is not square integrable, f_0 ∉ L²(Ω)².
    """
    check_force(problem.case)
    discretisation = Discretisation(problem.data, family(problem.data.body, level))
    computed = compute(discretisation, scheme, steps)
    enclosure = enclose(discretisation, computed, trajectory, known_error(problem.case, computed))
    late = enclosure.times >= computed.T / 2
    names = "residual", "contact", "oscillation", "bending"
    parts = {part: np.sum([getattr(interval, part) for interval in enclosure.intervals]) for part in names}
    row = {
        "case": problem.name,
        "family": family.name,
        "scheme": scheme.name,
        "trajectory": trajectory.name,
        "level": level,
        "h": enclosure.h,
        "steps": computed.steps,
        "expected_order": problem.order,
        "error": enclosure.error.max(),
        "lowest": enclosure.lowest,
        "highest": enclosure.highest,
        "above": (enclosure.error / enclosure.upper).max(),
        "below": (enclosure.lower / enclosure.error).max(),
        "upper": (enclosure.upper / enclosure.error)[late].max(),
        "lower": (enclosure.lower / enclosure.error)[late].min(),
    }
    return row | parts, enclosure


class Bounds(Statement):
    """Base class of the statements about upper bounds and about enclosures, which share one measurement."""

    file = BOUNDS

    def settings(self, scope: Scope) -> list[BoundSetting]:
        """Return the settings for the cases of the study and for problems whose solution is unknown."""
        settings = bounds(scope.resolved(), scope.full)
        return [setting for setting in settings if setting.trajectory == self.label]

    def measure(self, setting: BoundSetting) -> Numbers:
        """Compute a displacement and bounds of its error on one mesh.

        Args:
            setting: the case or problem, the mesh, the time scheme and the kind of bound.

        Returns:
            The row of ``bounds.csv`` under the key "row", and columns of ``enclosures.csv`` under the key "times".
        """
        problem = resolve_problem(setting.case)
        family = family_named(setting.family)
        scheme = choose("scheme", setting.scheme, SCHEMES)
        row, enclosure = measure(problem, family, setting.level, scheme, self.steps(setting), setting.by)
        chosen = np.unique(np.linspace(0, len(enclosure.times) - 1, SAVED_TIMES).round().astype(int))
        times: dict[str, list[float]] = {"time": np.round(enclosure.times[chosen], 9).tolist()}
        for name in ("error", "distance", "bound"):
            times[name] = [float(f"{value:.6g}") for value in getattr(enclosure, name)[chosen]]
        return {"row": row, "times": times}

    def records(self, setting: BoundSetting, found: Row) -> Records:
        """Yield the rows of one measurement as pairs (data file, row).

        First comes the row of ``bounds.csv``, then one row of ``enclosures.csv`` for every saved time, which repeats
        the key of the first row.

        Args:
            setting: the setting, which is not used because the measured row contains it.
            found: the result of ``measure``: "row", the row of ``bounds.csv``, and "times", the columns of
                ``enclosures.csv`` with their values at the saved times.
        """
        yield BOUNDS, found["row"]
        common = {name: found["row"][name] for name in BOUNDS.key}
        for line in zip(*found["times"].values(), strict=True):
            yield ENCLOSURES, {**common, **dict(zip(found["times"], line, strict=True))}

    def cost(self, setting: BoundSetting) -> float:
        """Return the expected run time in µs.

        It is proportional to the number of cells times the number of time steps of the displacement from which the
        bounds follow.
        """
        finer = 4**setting.by.refinements * setting.by.shorter if isinstance(setting.by, Refined) else 1
        return 220.0 * setting.level**2 * finer * self.steps(setting)

    def memory(self, setting: BoundSetting) -> float:
        refinements = setting.by.refinements if isinstance(setting.by, Refined) else 0
        return estimates.bound(estimates.triangles(setting.level, setting.family), refinements)

    def steps(self, setting: BoundSetting) -> int:
        problem = resolve_problem(setting.case)
        return rate_steps(problem.data.body.T, setting.level, problem.pace)


# The quotient error / upper bound must be positive. The quotient lower bound / error may be 0, because the lower bound
# may be 0 on coarse meshes.
ABOVE_ERROR = identity("above", "largest error / upper bound", "above", positive_at_most(1.0, "at every sampled time"))
BELOW_ERROR = identity("below", "largest lower bound / error", "below", at_most(1.0, "at every sampled time"))
REACH = consequence(
    "upper",
    "largest upper bound / error over [T/2, T]",
    "upper",
    Window(),
    if_missed="this shows how sharp the bound is; the claim is only that the error never exceeds it",
)
HERE = f"at n = {CHECKED_LEVEL}"
TIGHT = (
    consequence("tight-above", f"upper bound / error {HERE}", "upper", Window(1.0, 1.15, "over [T/2, T]")),
    consequence("tight-below", f"lower bound / error {HERE}", "lower", Window(0.85, 1.0, "over [T/2, T]")),
)
INTERVAL_TOLERANCE = 0.15
"""Tolerance around a predicted order. Other statements use the same tolerance for orders between levels."""
UNPREDICTED = "no claim: neither the solution nor its order is known"


class BoundedError(Bounds):
    """Checks that the upper bound of the error, computed from the displacement u_h alone, is never below the error.

    The quotient bound / error is reported, and no size of it is claimed.
    """

    label = "bound"
    claim = "‖u(t) − u_h(t)‖_V ≤ y(t), where y is computed from u_h and an admissible stress alone"
    checks = ABOVE_ERROR, REACH

    def by_case(self, rows: pd.DataFrame) -> list[tuple[str, Groups]]:
        of_kind = rows[(rows["trajectory"] == self.label) & rows["known"]]
        return [(str(case), {"": of_case}) for case, of_case in of_kind.groupby("case", sort=False)]


class EnclosedError(Bounds):
    """Judges the intervals that are computed for the error ‖u − u_h‖_V and for its order of convergence.

    The intervals of the error follow from a more accurate displacement ũ. If the exact solution is known, they must
    contain the error at every sampled time; for ``CHECKED`` on level ``CHECKED_LEVEL`` their ends must also be within
    15 % of it in [T/2, T]. If the solution is unknown but its order is predicted, the interval of the order must lie in
    a window around this order.
    """

    label = "enclosure"
    claim = "d(t) − y(t) ≤ ‖u(t) − u_h(t)‖_V ≤ d(t) + y(t), without the exact solution"

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        judged: list[Verdict] = []
        for name, of_case in rows[rows["trajectory"] == self.label].groupby("case", sort=False):
            case = str(name)
            known = bool(of_case["known"].iloc[0])
            judged += [rule.verdict(self, case, {"": of_case}) for rule in (ABOVE_ERROR, BELOW_ERROR, REACH) if known]
            checked = of_case[of_case["level"] == CHECKED_LEVEL]
            if case == CHECKED and len(checked):
                judged += [rule.verdict(self, case, {"": checked}) for rule in TIGHT]
            for (family, _), series in of_case.groupby(["family", "scheme"], sort=False):
                levels = series.sort_values("h", ascending=False)
                if len(levels) > 1:
                    judged.append(self.judge_order(case, str(family), levels, known))
                if len(levels) > 2:
                    of_pair = self.judge_order(case, str(family), levels.tail(2), known)
                    judged.append(
                        replace(
                            of_pair,
                            key="order-last",
                            verdict=REPORTED,
                            expected="no claim: two meshes give a wider interval for the order than all meshes",
                        )
                    )
        return judged

    def judge_order(self, case: str, family: str, levels: pd.DataFrame, known: bool) -> Verdict:
        """Return the verdict on the interval that contains the observed order from the coarsest to the finest level.

        If the exact solution is unknown, the whole interval must lie in the window of the predicted order; the check
        fails if interval and window have no common point. If the exact solution is known, the interval is only
        reported, because it contains the observed order whenever the enclosures contain the errors.

        Args:
            case, family: the names of the case and of the mesh family.
            levels: rows of ``bounds.csv``, from coarse to fine.
            known: whether the exact solution is known.
        """
        ends = levels.iloc[[0, -1]]
        sizes = (ends["error"] if known else ends["lowest"] + ends["highest"]).to_numpy()
        observed = float(orders(ends["h"].to_numpy(), sizes)[0])
        first, last = ends[["lowest", "highest"]].itertuples(index=False, name=None)
        span = order_interval(first, last, math.log(ends["h"].iloc[0] / ends["h"].iloc[1]))
        coarse, fine = ends["level"]
        order = math.nan if known else float(ends["expected_order"].iloc[1])
        quantity = f"order of max_t ‖u − u_h‖_V, k proportional to h, n = {coarse} to {fine}"
        if math.isnan(order):
            window = Window(math.nan, math.nan)
            verdict = REPORTED
            expected = (
                "no claim: this interval contains the observed order whenever the errors lie between their bounds"
                if known
                else UNPREDICTED
            )
        else:
            window = around(order, INTERVAL_TOLERANCE, "the whole interval of possible orders")
            verdict = judge_interval(span, window)
            expected = ""
        return row(
            self, "order", quantity, window, (observed, span, verdict), case, family, expected, CheckKind.CONSEQUENCE
        )


def judge_interval(span: Span, window: Window) -> str:
    """Return the verdict on an interval that contains the measured quantity.

    It holds if the interval lies in the window, fails if both are disjoint, and is undecided otherwise.

    Args:
        span: the lower and the upper end of the interval.
        window: the tolerance window.
    """
    if window.contains(*span):
        return HOLDS
    return FAILS if span[1] < window.low or span[0] > window.high else UNDECIDED

"""When Proposition 5.4 holds: order 1, two-sided, with everything that keeps the verdict from being vacuous."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from study.ledger.criterion import Criterion, Groups, Observation, by_family
from study.ledger.measures import ENOUGH, ROUNDING, between_levels, consecutive, exactly, fitted, largest, order
from study.ledger.verdict import FAILS, HOLDS, UNDECIDED, Named, Verdict, row
from study.ledger.window import Window, above_nothing, around, at_least, at_most, between
from study.statements.prop_5_4.evidence import EVIDENCE, SIZES, over
from study.statements.prop_5_4.sweep import Rates
from study.statements.shared.random_meshes import LEADING, apart, in_leading_term

SUPERCLOSE = between(1.5, 2, 0.2, 0.2, "superclose on one-diagonal meshes")
OTHERS = between(1, 2, 0.15, 0.2, "other meshes")
DISCRETE_SHARE = above_nothing(0.6, "of the interpolation error: by Pythagoras both errors differ by ≤ 20 %")
DISCRETE_TIME = above_nothing(0.3, "of the discrete error")
RANDOM = "; random meshes: in the leading term"
"""Of interpolation, in place of h."""
SOLID = around(1, 0.1, RANDOM.removeprefix("; "))
OF_THE_TERM = around(1, 0.15, "least squares, as the error is compared with this term there")
NOT_AT_START = 0.99
"""A largest error this much above the one at t = 0 comes after it."""
FORESEEN = Window(0.8, 1 + ROUNDING, "by Pythagoras: a discrete share of 0.6 leaves 0.8 of it")
AT_START = "as ‖u − Π^h u‖_V is largest near t = 0, where nothing was solved: rows of ‖Π^h u − u^h‖_V say what was"
ENOUGH_AFTER_START = at_least(4)
"""Cases whose largest error must come after t = 0, where something was solved."""


class FirstOrder(Rates):
    """Proposition 5.4 on the exact solutions with (5.36)."""

    label = "Prop. 5.4"
    claim = "‖u − u^h‖_{L∞(0,T;V)} = O(h)"

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        mine = rows[rows["claim"] == self.label]
        found = [
            verdict
            for case, of_case in mine.groupby("case", sort=False)
            for verdict in self.judge_case(str(case), of_case, float(of_case["expected_order"].iloc[0]))
        ]
        return [*found, self._after_start(mine)] if mine["case"].nunique() >= ENOUGH_AFTER_START.low else found

    def judge_case(self, case: str, rows: pd.DataFrame, expected: float) -> list[Verdict]:
        """The rows of a case, from its lines of ``rates.csv``."""
        groups = by_family(rows)
        solid = SOLIDS if int(rows["dim"].iloc[0]) == 3 else ()
        in_h = in_leading_term(groups)
        orders = [criterion.verdict(self, case, in_h) for criterion in (*errors(expected), SIZES)]
        discrete = [criterion.verdict(self, case, chosen) for criterion, chosen in discrete_errors(groups)]
        rest = [rule.verdict(self, case, groups) for rule in (StartShare(), *EVIDENCE)]
        rest += [criterion.verdict(self, case, in_h) for criterion in solid]
        rest += [criterion.verdict(self, case, chosen) for criterion, chosen in leading_term(groups)]
        return [*orders, *discrete, *rest]

    def _after_start(self, rows: pd.DataFrame) -> Verdict:
        """Whether enough cases have their largest error after t = 0."""
        later = (rows["initial_error"] < NOT_AT_START * rows["error"]).groupby(rows["case"]).all()
        judged = *exactly(later.sum()), HOLDS if ENOUGH_AFTER_START.contains(later.sum()) else UNDECIDED
        quantity = f"cases with the supremum after t = 0 (of {len(later)})"
        return row(self, "after-start", quantity, ENOUGH_AFTER_START, judged, "all cases")


def errors(expected: float) -> tuple[Criterion, Criterion]:
    """The order of the error from level to level, and fitted, whose interval must exclude the orders 0 and 2.

    On random meshes they are orders in the leading term of interpolation on them, which is of order h by
    ``leading_term``.
    """
    by_level = around(expected, 0.15, f"every consecutive order{RANDOM}")
    line = around(expected, 0.1, f"least squares; interval in (0, 2){RANDOM}")
    return (
        consecutive("order", "order of the error, level by level", by_level, "error"),
        fitted("order-fitted", "order of the error, fitted", line, "error", ENOUGH + 1, Window(0.0, 2.0)),
    )


SOLIDS = (
    between_levels("order-finest", "order of the error, finest pair", SOLID, "error", 1, ENOUGH),
    between_levels(
        "interpolation-order-finest", "order of ‖u − Π^h u‖_V, finest pair", SOLID, "interpolation_error", 1, ENOUGH
    ),
)
"""In 3D, where few levels can be had, the finest pair alone must be nearer to 1."""


def leading_term(groups: Groups) -> Iterator[tuple[Criterion, Groups]]:
    """On random meshes: that what takes the place of h in the orders of errors there is of order h itself."""
    shaken, _ = apart(groups)
    if shaken:
        quantity = "order in h of the leading term of ‖u − Π^h u‖_V, fitted, random meshes"
        yield order("leading-order", quantity, OF_THE_TERM, LEADING, ENOUGH + 1), shaken


def discrete_errors(groups: Groups) -> Iterator[tuple[Criterion, Groups]]:
    """‖Π^h u − u^h‖_V, what the solver did: its order, its share of the interpolation error, and that of time steps.

    On one-diagonal meshes neighbouring triangles form parallelograms and Π^h u − u^h is superclose, of order 3/2
    (traction boundary) to 2; elsewhere it is at least of the order of the error. At most it is of order 2.
    """
    superclose = {name: group for name, group in groups.items() if name == "one-diagonal"}
    others = {name: group for name, group in groups.items() if name != "one-diagonal"}
    quantity = "order of ‖Π^h u − u^h‖_V,"
    if superclose:
        rule = order("discrete-order-superclose", f"{quantity} superclose", SUPERCLOSE, "discrete_error", ENOUGH)
        yield rule, superclose
    if others:
        yield order("discrete-order-others", f"{quantity} other families", OTHERS, "discrete_error", ENOUGH), others
    share = "‖Π^h u − u^h‖_V / ‖u − Π^h u‖_V"
    yield over("discrete-share", share, DISCRETE_SHARE, "discrete_error", "interpolation_error"), groups
    time = largest("discrete-time-share", "time share of ‖Π^h u − u^h‖_V", DISCRETE_TIME, "discrete_time_share")
    yield time, groups


AFTER_START = Criterion(
    "start-share",
    "error at t = 0 / largest error",
    at_most(NOT_AT_START, "after t = 0, where nothing was solved"),
    lambda group: exactly(np.max((group["initial_error"] / group["error"]).to_numpy())),
    ("initial_error", "error"),
)


@dataclass(frozen=True)
class StartShare:
    """The largest error must come after t = 0, where it would be that of Π^h u_0 and nothing was solved.

    Where it does not, the rows on the error say nothing of what was solved. That is no merit of the case, which is then
    only reported here, and no fault if ‖u − Π^h u‖_V, which is known without solving, is that large at t = 0, too: at
    least FORESEEN of its largest value, and at most that, as u^h(0) = Π^h u_0. Any other start fails.
    """

    def verdict(self, of: Named, case: str, groups: Groups, family: str = "") -> Verdict:
        """The row for a case."""
        found = AFTER_START.verdict(of, case, groups, family)
        rows = pd.concat(groups.values())
        at_start = rows[~(rows["initial_error"] <= NOT_AT_START * rows["error"])]
        if found.verdict == FAILS and FORESEEN.contains(*at_start["initial_error"] / at_start["interpolation_error"]):
            return Observation(replace(AFTER_START, window=Window()), AT_START).verdict(of, case, groups, family)
        return found

"""What is said of a user's own case: a row *fails* only where the data contradict the statement.

The cases of the catalogue were made to be good tests. One that somebody brings may be a poor one: its meshes too
coarse, its time steps too long, its largest error where nothing was solved. Its row is then *undecided, because …*,
with what to do about it. It still fails where

* the last two orders lie outside their window on one side, and the second is nearer by less than a fifth. With
  e = C h^p (1 + c h^q) the distance of the order to p shrinks by 2^{−q}; a limit e∞ > 0 lets it grow;
* errors do not fall at last, or fall ever slower where the limit is to be 0;
* something is not a number, or an identity of the program is violated: residuals, u^h on Γ1, the parallelogram law.

What else is looked at, such as the order of ‖Π^h u − u^h‖_V, is evidence that an order is that of u^h. The statement
does not claim it, and without it there is less to judge by.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from study.ledger.criterion import Groups, by_family
from study.ledger.datafiles import since_before
from study.ledger.measures import ENOUGH
from study.ledger.orders import Array
from study.ledger.verdict import BECAUSE, FAILS, UNDECIDED, Verdict
from study.statements.prop_5_3 import LEVELS as ROUGH_LEVELS

LABELS = "Prop. 5.3", "Prop. 5.4", "(5.23)"
NEARER = 0.8
"""How much of its distance an order may keep from level to level to be called approaching."""
NOT_YET = "not asymptotic yet"
TRY = "try --levels"


@dataclass(frozen=True, eq=False)
class OwnCase:
    """The rows of an own case in ``rates.csv``, by mesh family, with the predicted order."""

    groups: Groups
    expected: float

    @property
    def finer(self) -> str:
        """What to try on finer meshes."""
        levels = sorted({int(level) for group in self.groups.values() for level in group["level"]})
        dim = max(int(group["dim"].iloc[0]) for group in self.groups.values())
        return f"{TRY} {' '.join(map(str, finer(levels, dim)))}"

    def series(self, of: Callable[[pd.DataFrame], Array]) -> list[Array]:
        """A quantity of every family, coarse to fine, without levels where there is none."""
        found = [np.asarray(of(group), dtype=float) for group in self.groups.values()]
        return [values[~np.isnan(values)] for values in found]

    def approaching(self, series: Sequence[Array], target: float, room: float) -> str:
        """Why a target is missed: ``NOT_YET`` or by scatter; nothing if a series stays away from it."""
        ends = [values[-2:] - target for values in series]
        if any(stays_away(end, room) for end in ends):
            return ""
        scattered = any(abs(end[-1]) > max(room, NEARER * abs(end[0])) for end in ends if len(end) == 2)
        return f"{'values scatter' if scattered else NOT_YET}: {self.finer}"


def stays_away(end: Array, room: float) -> bool:
    """Whether the last two distances are beyond the room on one side, and the second is hardly less than the first."""
    if len(end) < 2 or end[0] * end[1] < 0:
        return False
    before, last = abs(end)
    return bool(min(before, last) > room and last > NEARER * before)


def finer(levels: Sequence[int], dim: int) -> list[int]:
    """Levels to try next: without the coarsest, 8 16 32 ↦ 16 32 64, unless they are too few, 8 ↦ 8 16 32."""
    return [*levels[1:], _next(levels, dim)] if len(levels) >= ENOUGH else enough(levels, ENOUGH, dim)


def enough(levels: Sequence[int], needed: int, dim: int) -> list[int]:
    """Levels with so many finer ones that there are as many as needed."""
    found = list(levels)
    while len(found) < needed:
        found.append(_next(found, dim))
    return found


def _next(levels: Sequence[int], dim: int) -> int:
    """A finer level: 32 after 8 16, 15 after 9 12; in space 12 after 8, as twice as fine costs 2⁵ times as much."""
    last, before = levels[-1], levels[-2] if len(levels) > 1 else 0
    if last < 2 * before:
        return 2 * last - before
    return 2 * last if dim == 2 else last + max(1, last // 2)


def least_levels(proposition: str) -> int:
    """How many levels it takes to decide about an order."""
    return ROUGH_LEVELS if proposition == "Prop. 5.3" else ENOUGH


def orders_of(column: str) -> Callable[[pd.DataFrame], Array]:
    """The orders of a column from level to level."""
    return lambda group: since_before(group["h"].to_numpy(), group[column].to_numpy())


def judge_own(verdicts: Sequence[Verdict], rows: pd.DataFrame) -> list[Verdict]:
    """The verdicts on an own case, from those that one of the catalogue would have and its rows of ``rates.csv``."""
    mine = OwnCase(by_family(rows), float(rows["expected_order"].iloc[0]))
    return [_judge(verdict, mine, _disturbed(verdicts)) for verdict in verdicts]


def _judge(verdict: Verdict, mine: OwnCase, disturbed: str) -> Verdict:
    if verdict.label not in LABELS or verdict.verdict not in (FAILS, UNDECIDED) or math.isnan(verdict.observed):
        return verdict
    why = REASONS[verdict.key](mine, verdict) if verdict.key in REASONS else ""
    why = disturbed if disturbed and verdict.key in OF_ERRORS else why
    expected = f"{verdict.expected}{BECAUSE}{why}"
    return replace(verdict, expected=expected, verdict=UNDECIDED) if why else verdict


def _disturbed(verdicts: Sequence[Verdict]) -> str:
    """Why the errors are not those of the meshes, if they are not."""
    failed = {verdict.key for verdict in verdicts if verdict.verdict == FAILS}
    causes = [what for key, what in (("time-share", "time steps"), ("quadrature", "quadrature")) if key in failed]
    verb = "disturbs" if causes == ["quadrature"] else "disturb"
    return f"{' and '.join(causes)} {verb} the errors: mend that first" if causes else ""


def _order(mine: OwnCase, verdict: Verdict) -> str:
    near = mine.approaching(mine.series(orders_of("error")), mine.expected, mine.expected - verdict.window_low)
    return near or (_no_rate(mine, verdict) if verdict.label == "Prop. 5.3" else "")


def _interpolation_order(mine: OwnCase, verdict: Verdict) -> str:
    orders = mine.series(orders_of("interpolation_error"))
    return mine.approaching(orders, mine.expected, mine.expected - verdict.window_low)


def _leading_term(mine: OwnCase, verdict: Verdict) -> str:
    def ratio(group: pd.DataFrame) -> Array:
        return (group["interpolation_error"] / group["predicted_interpolation"]).to_numpy()

    return mine.approaching(mine.series(ratio), 1.0, 1 - verdict.window_low)


def _falling(mine: OwnCase, verdict: Verdict) -> str:
    last = [values[-2:] for values in mine.series(lambda group: group["error"].to_numpy())]
    return f"errors fall on the finest meshes only: {mine.finer}" if all(e[-1] < e[0] for e in last) else ""


def _limit(mine: OwnCase, verdict: Verdict) -> str:
    # Over two refinements, as single orders alternate with the place of a front in its cell.
    over_two = [values[1:] + values[:-1] for values in mine.series(orders_of("error"))]
    slower = any(len(found) < 2 or found[-1] < found[0] for found in over_two)
    return "" if slower else f"errors fall more slowly than h^s, and do not slow down: {mine.finer}"


def _no_rate(mine: OwnCase, verdict: Verdict) -> str:
    return f"Prop. 5.3 claims no rate, and the order that the regularity gives is not seen: {mine.finer}"


def _superclose(mine: OwnCase, verdict: Verdict) -> str:
    if verdict.observed > verdict.window_high:
        return f"what the solver did shrinks faster than it can for long: {NOT_YET}: {mine.finer}"
    return (
        "Π^h u − u^h is not of higher order than the error: the meshes are too coarse for contact, "
        f"{mine.finer}; or load, material or contact is wrong by a little, which the error itself would not show"
    )


def _others(mine: OwnCase, verdict: Verdict) -> str:
    return f"what the solver did, Π^h u − u^h, is not settled on these meshes: {mine.finer}"


def _pace(mine: OwnCase, verdict: Verdict) -> str:
    return "the time steps are too long: raise `pace` of the case, or give a shorter --step"


def _quadrature(mine: OwnCase, verdict: Verdict) -> str:
    return f"the formulas vary too much within a cell: flatten them, or {mine.finer}"


def _share(mine: OwnCase, verdict: Verdict) -> str:
    return f"contact disturbs the error on these meshes more than a good test allows: {mine.finer}"


OF_ERRORS = {"order", "order-fitted", "order-finest", "falling", "limit", "size"}
"""Rows that say nothing while time steps or quadrature disturb the errors."""
REASONS: dict[str, Callable[[OwnCase, Verdict], str]] = {
    "order": _order,
    "order-fitted": _order,
    "order-finest": _order,
    "interpolation-order-finest": _interpolation_order,
    "leading-term": _leading_term,
    "falling": _falling,
    "limit": _limit,
    "order-graded": _no_rate,
    "discrete-order-superclose": _superclose,
    "discrete-order-others": _others,
    "discrete-share": _share,
    "size": _share,
    "time-share": _pace,
    "discrete-time-share": _pace,
    "quadrature": _quadrature,
}
"""Key of a row ↦ why it does not decide, or nothing if the data contradict the statement."""

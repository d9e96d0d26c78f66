"""Verdicts on a user's own case: a row *fails* only where the data contradict the statement.

The cases of the catalogue were made to be good tests. A user's case may be a poor one: its meshes are too coarse, its
time steps too long, or its largest error is at the start, where nothing was solved. Then the row is *undecided,
because …*, with a remedy. It still fails where

* the last two orders lie outside their window on one side, and the second is nearer by less than a fifth. With
  e = C h^p (1 + c h^q) the distance of the order from p shrinks by 2^{−q}; a limit e∞ > 0 lets it grow;
* errors do not fall on the finest meshes, or fall ever slower where the limit must be 0;
* a value is not a number, or an identity of the program is violated: residuals, u^h on Γ1, the parallelogram law.

Other rows, such as the order of ‖Π^h u − u^h‖_V, are evidence that an order is the order of u^h. The statement does not
claim them; if they fail, there is only less evidence. The source says nothing about the contact force either. If its
resultant is wrong by more than its window allows on the finest meshes, these meshes do not resolve contact, and the
orders of the force say nothing, whether they lie in their windows or not.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from manufactured.case import INITIAL_GAP
from study.ledger.criterion import ENOUGH, Groups, by_family
from study.ledger.datafiles import since_before
from study.ledger.orders import Array
from study.ledger.verdict import BECAUSE, FAILS, HOLDS, REPORTED, UNDECIDED, Verdict
from study.statements.contact_force import DUAL_ORDERS, EXACT, ContactForce
from study.statements.prop_5_3 import LEVELS as ROUGH_LEVELS

LABELS = "Prop. 5.3", "Prop. 5.4", "(5.23)", INITIAL_GAP
NEARER = 0.8
"""An order approaches its target if its distance shrinks at least by this factor from level to level."""
NOT_YET = "not asymptotic yet"
TRY = "try --levels"
OF_ERRORS = {"order", "order-extrapolated", "order-finest", "falling", "limit", "size"}
"""Rows that say nothing while time steps or quadrature disturb the errors."""
NO_RATE = "Prop. 5.3 claims no rate, and the order that the regularity gives is not seen: {remedy}"
SHARE = "contact disturbs the error on these meshes more than a good test allows: {remedy}"
PACE = "the time steps are too long: raise `pace` of the case, or give a shorter --step"
REASONS = {
    "order-graded": NO_RATE,
    "discrete-order-others": "what the solver did, Π^h u − u^h, is not settled on these meshes: {remedy}",
    "discrete-share": SHARE,
    "size": SHARE,
    "time-share": PACE,
    "discrete-time-share": PACE,
    "quadrature": "the formulas vary too much within a cell: flatten them, or {remedy}",
}
"""Key of a row that never contradicts the statement ↦ why it is not decided."""
UNRESOLVED = "these meshes do not resolve contact: the force on a face is wrong by {wrong:.0%} on the finest: {remedy}"
FORCE = "the contact force is not settled on these meshes, or it jumps in time, or contact is slightly wrong: {remedy}"


def judge_own(verdicts: Sequence[Verdict], rows: pd.DataFrame) -> list[Verdict]:
    """Return the verdicts on an own case.

    Parameters:
        verdicts: the verdicts that a case of the catalogue would have.
        rows: the rows of the case in ``rates.csv``, with its predicted order.
    """
    groups, expected = by_family(rows), float(rows["expected_order"].iloc[0])
    failed = {verdict.key for verdict in verdicts if verdict.verdict == FAILS and verdict.label in LABELS}
    causes = [what for key, what in (("time-share", "time steps"), ("quadrature", "quadrature")) if key in failed]
    verb = "disturbs" if causes == ["quadrature"] else "disturb"
    disturbed = f"{' and '.join(causes)} {verb} the errors: mend that first" if causes else ""
    found = []
    for verdict in verdicts:
        why = reason_of_force(verdict, verdicts, remedy_of(groups)) if verdict.label == ContactForce.label else ""
        if verdict.label in LABELS and verdict.verdict in (FAILS, UNDECIDED) and not math.isnan(verdict.observed):
            why = disturbed if disturbed and verdict.key in OF_ERRORS else reason(verdict, groups, expected)
        undecided = replace(verdict, expected=f"{verdict.expected}{BECAUSE}{why}", verdict=UNDECIDED)
        found.append(undecided if why else unclaimed(verdict))
    return found


def unclaimed(verdict: Verdict) -> Verdict:
    """Return a row as it is, but as reported if the contact force only misses the gain of half an order.

    Neither the source nor the order of the error needs this gain, which fronts that are a few cells apart delay.
    """
    superclose, other = DUAL_ORDERS[True], DUAL_ORDERS[False]
    missed = (verdict.label, verdict.key, verdict.verdict) == (ContactForce.label, superclose.key, FAILS)
    if not (missed and other.window.contains(verdict.observed)):
        return verdict
    return replace(
        verdict, expected=f"no claim: {verdict.expected}; other meshes: {other.window.text}", verdict=REPORTED
    )


def reason(verdict: Verdict, groups: Groups, expected: float) -> str:
    """Return why a row that does not hold is not decided; nothing if the data contradict the statement.

    Parameters:
        groups: the rows of the case by mesh family, coarse to fine.
        expected: its predicted order.
    """
    remedy, key = remedy_of(groups), verdict.key
    if key in ("order", "order-extrapolated", "order-finest"):
        why = why_missed(series(groups, orders_of("error")), expected, expected - verdict.window_low, remedy)
        return why or (NO_RATE.format(remedy=remedy) if verdict.label == "Prop. 5.3" else "")
    if key == "interpolation-order-finest":
        orders = series(groups, orders_of("interpolation_error"))
        return why_missed(orders, expected, expected - verdict.window_low, remedy)
    if key == "leading-term":
        ratios = series(groups, lambda group: group["interpolation_error"] / group["predicted_interpolation"])
        return why_missed(ratios, 1.0, 1 - verdict.window_low, remedy)
    if key == "falling":
        last = [errors[-2:] for errors in series(groups, lambda group: group["error"])]
        return f"errors fall on the finest meshes only: {remedy}" if all(e[-1] < e[0] for e in last) else ""
    if key == "limit":
        # Over two refinements, since single orders alternate with the place of a front in its cell.
        over_two = [orders[1:] + orders[:-1] for orders in series(groups, orders_of("error"))]
        slower = any(len(found) < 2 or found[-1] < found[0] for found in over_two)
        return "" if slower else f"errors fall more slowly than h^s, and do not slow down: {remedy}"
    if key == "discrete-order-superclose" and verdict.observed > verdict.window_high:
        return f"what the solver did shrinks faster than it can for long: {NOT_YET}: {remedy}"
    if key == "discrete-order-superclose":
        return (
            "Π^h u − u^h is not of higher order than the error: the meshes are too coarse for contact, "
            f"{remedy}; or load, material or contact is wrong by a little, which the error itself would not show"
        )
    return REASONS.get(key, "").format(remedy=remedy)


def reason_of_force(verdict: Verdict, verdicts: Sequence[Verdict], remedy: str) -> str:
    """Return why a row of the contact force is not decided; nothing if it is decided, or an identity is violated.

    Parameters:
        verdict: the row.
        verdicts: all rows of the case.
        remedy: the finer levels to try.
    """
    exact = verdict.key in {rule.key for rule in EXACT}
    if exact or verdict.verdict == REPORTED or math.isnan(verdict.observed):
        return ""
    if verdict.key == "time-share":
        return "" if verdict.verdict == HOLDS else PACE
    for other in verdicts:
        if (other.label, other.key) == (ContactForce.label, "resultant") and other.verdict != HOLDS:
            return UNRESOLVED.format(wrong=other.observed, remedy=remedy)
    return FORCE.format(remedy=remedy) if verdict.verdict != HOLDS and unclaimed(verdict) is verdict else ""


def remedy_of(groups: Groups) -> str:
    """Return the finer levels to try next, for the rows of a case by mesh family."""
    levels = sorted({int(level) for group in groups.values() for level in group["level"]})
    dim = max(int(group["dim"].iloc[0]) for group in groups.values())
    return f"{TRY} {' '.join(map(str, finer(levels, dim)))}"


def series(groups: Groups, of: Callable[[pd.DataFrame], ArrayLike]) -> list[Array]:
    """Return a quantity of every family, coarse to fine, without the levels on which it is not a number."""
    found = [np.asarray(of(group), dtype=float) for group in groups.values()]
    return [values[~np.isnan(values)] for values in found]


def orders_of(column: str) -> Callable[[pd.DataFrame], Array]:
    """Return the function that gives the orders of a column from level to level."""
    return lambda group: since_before(group["h"].to_numpy(), group[column].to_numpy())


def why_missed(series: Sequence[Array], target: float, room: float, remedy: str) -> str:
    """Return why a target is missed: values scatter or are not asymptotic yet; nothing if a series stays away from it.

    A series stays away if its last two values are beyond the room on one side, and the second is hardly nearer.
    """
    ends = [values[-2:] - target for values in series]
    for end in ends:
        if len(end) == 2 and end[0] * end[1] >= 0 and abs(end).min() > room and abs(end[1]) > NEARER * abs(end[0]):
            return ""
    scattered = any(abs(end[-1]) > max(room, NEARER * abs(end[0])) for end in ends if len(end) == 2)
    return f"{'values scatter' if scattered else NOT_YET}: {remedy}"


def finer(levels: Sequence[int], dim: int) -> list[int]:
    """Return levels to try next: without the coarsest, 8 16 32 ↦ 16 32 64; if there are too few, 8 ↦ 8 16 32."""
    return [*levels[1:], _next(levels, dim)] if len(levels) >= ENOUGH else enough(levels, ENOUGH, dim)


def enough(levels: Sequence[int], needed: int, dim: int) -> list[int]:
    """Add finer levels until there are as many as needed."""
    found = list(levels)
    while len(found) < needed:
        found.append(_next(found, dim))
    return found


def _next(levels: Sequence[int], dim: int) -> int:
    """Return a finer level: 32 after 8 16, 15 after 9 12; in space 12 after 8, as 16 would cost 2⁵ times as much."""
    last, before = levels[-1], levels[-2] if len(levels) > 1 else 0
    if last < 2 * before:
        return 2 * last - before
    return 2 * last if dim == 2 else last + max(1, last // 2)


def least_levels(proposition: str) -> int:
    """Return how many levels an order needs to be decided."""
    return ROUGH_LEVELS if proposition == "Prop. 5.3" else ENOUGH

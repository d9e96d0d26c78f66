"""Verdicts on the case of a user: a check *fails* only if the data contradict the statement.

The cases of the catalogue were designed as tests. A user's case may not be suitable. Its meshes may be too coarse or
its time steps too long. Or its largest error is at t = 0, where the error is only an interpolation error. Then a check
that misses its window is *undecided*, and its text names the reason and a remedy. A check still fails if

* the last two orders lie outside the window on the same side, and the second one is hardly nearer to the predicted
  order p: its distance is more than NEARER = 0.8 times the distance of the first. If e = C h^p (1 + c h^q) this
  distance shrinks by 2^{−q}; if the errors have a limit e∞ > 0, it grows;
* errors do not fall on the finest meshes, or fall ever more slowly although the limit must be 0;
* a value is NaN, or an identity is violated: residuals, u^h on Γ1, the parallelogram law.

Some checks, such as the check of the order of ‖Π^h u − u^h‖_V, only show that the observed order belongs to u^h and not
to the interpolation error. The paper does not claim these orders, so such a check is undecided if it misses its window.
The paper claims nothing about the contact force either. If the error of its resultant exceeds its window on the finest
meshes, these meshes do not resolve contact. Then the orders of the force are undecided, whether they lie in their
windows or not.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from manufactured.case import INITIAL_GAP
from study.ledger.check import MIN_LEVELS, Groups, by_family
from study.ledger.datafiles import since_before
from study.ledger.quantities import Array
from study.ledger.verdict import BECAUSE, FAILS, HOLDS, REPORTED, UNDECIDED, Verdict
from study.statements.contact_force import DUAL_ORDERS, EXACT, ContactForce
from study.statements.prop_5_4 import ROUGH_LEVELS

LABELS = "Prop. 5.3", "Prop. 5.4", "(5.23)", "Thm 4.2", INITIAL_GAP
NEARER = 0.8
"""The factor by which the distance of a value from its predicted limit must shrink in a refinement.

If it shrinks less, the value does not approach the limit."""
NOT_YET = "not asymptotic yet"
TRY = "try --levels"
OF_ERRORS = {"order", "order-extrapolated", "order-finest", "falling", "limit", "size"}
"""Keys of the checks that are undecided if time steps or quadrature disturb the errors."""
NO_RATE_CLAIMED = "Prop. 5.3 claims no rate, and the order predicted from the regularity is not observed: {remedy}"
CONTACT_DISTURBS = "contact disturbs the error on these meshes more than a good test allows: {remedy}"
LONG_STEPS = "the time steps are too long: raise `pace` of the case, or give a shorter --step"
REASONS = {
    "order-graded": NO_RATE_CLAIMED,
    "leading-order": f"the interpolation error is {NOT_YET} on these meshes: {{remedy}}",
    "allowed": (
        "the duality gap does not bound the difference of both formulations sharply, as happens if the moduli of "
        "elasticity and viscosity differ by much more than a factor 10"
    ),
    "discrete-order-others": "the discrete error Π^h u − u^h is not asymptotic on these meshes: {remedy}",
    "discrete-order-superclose": (
        "Π^h u − u^h is not of higher order than the error: the meshes are too coarse for contact, {remedy}; or load, "
        "material or contact is wrong by a little, which the error itself would not show"
    ),
    "discrete-share": CONTACT_DISTURBS,
    "size": CONTACT_DISTURBS,
    "time-share": LONG_STEPS,
    "discrete-time-share": LONG_STEPS,
    "quadrature": "the formulas vary too much within a cell: flatten them, or {remedy}",
}
"""Reasons why a check is undecided, by the key of the check. These checks cannot contradict the statement."""
UNRESOLVED = "these meshes do not resolve contact: the force on a face is wrong by {wrong:.0%} on the finest: {remedy}"
FORCE = (
    "the contact force has not converged on these meshes, or it jumps in time, or contact is slightly wrong: {remedy}"
)


def judge_own(verdicts: Sequence[Verdict], rows: pd.DataFrame) -> list[Verdict]:
    """Return the verdicts on the case of a user.

    A check that misses its tolerance window because the case is not suitable as a test is undecided and does not fail.

    Args:
        verdicts: the verdicts that a case of the catalogue would get.
        rows: the rows of the case in ``rates.csv``, with the predicted order.
    """
    groups = by_family(rows)
    expected = float(rows["expected_order"].iloc[0])
    failed = {verdict.key for verdict in verdicts if verdict.verdict == FAILS and verdict.label in LABELS}
    causes = [what for key, what in (("time-share", "time steps"), ("quadrature", "quadrature")) if key in failed]
    verb = "disturbs" if causes == ["quadrature"] else "disturb"
    disturbed = f"{' and '.join(causes)} {verb} the errors: mend that first" if causes else ""
    levels = finer(sorted({*rows["level"].astype(int)}), int(rows["dim"].max()))
    remedy = f"{TRY} {' '.join(map(str, levels))}"
    judged = []
    for verdict in verdicts:
        why = reason_of_force(verdict, verdicts, remedy) if verdict.label == ContactForce.label else ""
        if verdict.label in LABELS and verdict.verdict in (FAILS, UNDECIDED) and not math.isnan(verdict.observed):
            why = disturbed if disturbed and verdict.key in OF_ERRORS else reason(verdict, groups, expected, remedy)
        undecided = replace(verdict, expected=f"{verdict.expected}{BECAUSE}{why}", verdict=UNDECIDED)
        judged.append(undecided if why else unclaimed(verdict))
    return judged


def unclaimed(verdict: Verdict) -> Verdict:
    """Return a verdict, changed to *reported* if it fails only because the contact force is not superclose.

    On one-diagonal meshes the order of the contact force is higher by one half than on other meshes (superclose). The
    paper does not claim this half, and it appears only on fine meshes if contact fronts are a few cells apart.
    """
    superclose, other = DUAL_ORDERS
    missed = (verdict.label, verdict.key, verdict.verdict) == (ContactForce.label, superclose.key, FAILS)
    if not (missed and other.window.contains(verdict.observed)):
        return verdict
    text = f"no claim: {verdict.expected}; other meshes: {other.window.text}"
    return replace(verdict, expected=text, verdict=REPORTED)


def reason(verdict: Verdict, groups: Groups, expected: float, remedy: str) -> str:
    """Return why a check outside its tolerance window is undecided, or "" if the data contradict the statement.

    Args:
        verdict: the verdict on the check.
        groups: the measurements of the case by mesh family, from coarse to fine.
        expected: the predicted order.
        remedy: the finer levels to try, as text.
    """
    key = verdict.key
    if key in ("order", "order-extrapolated", "order-finest"):
        why = why_missed(orders_of(groups, "error"), expected, expected - verdict.window_low, remedy)
        return why or (NO_RATE_CLAIMED.format(remedy=remedy) if verdict.label == "Prop. 5.3" else "")
    if key == "interpolation-order-finest":
        orders = orders_of(groups, "interpolation_error")
        return why_missed(orders, expected, expected - verdict.window_low, remedy)
    if key == "leading-term":
        pairs = [group["interpolation_error"] / group["predicted_interpolation"] for group in groups.values()]
        ratios = [ratio.dropna().to_numpy() for ratio in pairs]
        return why_missed(ratios, 1.0, 1 - verdict.window_low, remedy)
    if key == "falling":
        last = [group["error"].dropna().to_numpy()[-2:] for group in groups.values()]
        return f"errors fall on the finest meshes only: {remedy}" if all(e[-1] < e[0] for e in last) else ""
    if key == "limit":
        # Orders over two refinements, because single orders alternate with the position of the front in its cell.
        over_two = [orders[1:] + orders[:-1] for orders in orders_of(groups, "error")]
        slower = any(len(of_family) < 2 or of_family[-1] < of_family[0] for of_family in over_two)
        return "" if slower else f"errors fall more slowly than h^s, and do not slow down: {remedy}"
    if key == "discrete-order-superclose" and verdict.observed > verdict.window_high:
        return f"Π^h u − u^h falls faster than it can on fine meshes: {NOT_YET}: {remedy}"
    return REASONS.get(key, "").format(remedy=remedy)


def reason_of_force(verdict: Verdict, verdicts: Sequence[Verdict], remedy: str) -> str:
    """Return why a check of the contact force is undecided, or "" if it is decided.

    Checks of identities, which hold up to rounding, are always decided.

    Args:
        verdict: the verdict on the check.
        verdicts: the verdicts on all checks of the case.
        remedy: the finer levels to try, as text.
    """
    exact = verdict.key in {rule.key for rule in EXACT}
    if exact or verdict.verdict == REPORTED or math.isnan(verdict.observed):
        return ""
    if verdict.key == "time-share":
        return "" if verdict.verdict == HOLDS else LONG_STEPS
    for other in verdicts:
        if (other.label, other.key) == (ContactForce.label, "resultant") and other.verdict != HOLDS:
            return UNRESOLVED.format(wrong=other.observed, remedy=remedy)
    return FORCE.format(remedy=remedy) if verdict.verdict != HOLDS and unclaimed(verdict) is verdict else ""


def orders_of(groups: Groups, column: str) -> list[Array]:
    """Return for every mesh family the observed orders of a column from level to level, without NaN.

    Args:
        groups: the measured tables by mesh family, with one row for each level from coarse to fine.
        column: the name of the column with errors.
    """
    series = [since_before(group, column) for group in groups.values()]
    return [orders[~np.isnan(orders)] for orders in series]


def why_missed(series: Sequence[Array], target: float, room: float, remedy: str) -> str:
    """Return why observed values differ from their predicted limit, or "" if coarse meshes do not explain it.

    The reason is that values scatter or are not asymptotic yet. Coarse meshes are no explanation if the last two values
    of a series miss the limit on the same side by more than the tolerance, and the last one is hardly nearer.

    Args:
        series: for every mesh family, the observed values from the coarsest to the finest mesh.
        target: the predicted limit.
        room: the tolerance.
        remedy: the advice to add to the reason.
    """
    ends = [values[-2:] - target for values in series]
    for end in ends:
        if len(end) == 2 and end[0] * end[1] >= 0 and abs(end).min() > room and abs(end[1]) > NEARER * abs(end[0]):
            return ""
    scattered = any(abs(end[-1]) > max(room, NEARER * abs(end[0])) for end in ends if len(end) == 2)
    return f"{'values scatter' if scattered else NOT_YET}: {remedy}"


def finer(levels: Sequence[int], dim: int) -> list[int]:
    """Return all levels for the next run of a user: the given ones and one finer level, without the coarsest.

    For example, 16, 32, 64 follow 8, 16, 32. If fewer than ``MIN_LEVELS`` levels are given, too few to judge an order,
    finer ones are added and none is left out: 8, 16, 32 follow 8.

    Args:
        levels: the given levels, from coarse to fine.
        dim: the dimension of the body.
    """
    needed = len(levels) + 1 if len(levels) >= MIN_LEVELS else MIN_LEVELS
    return enough(levels, needed, dim)[-max(len(levels), MIN_LEVELS) :]


def enough(levels: Sequence[int], needed: int, dim: int) -> list[int]:
    """Return the given levels together with finer levels, so that there are at least ``needed`` levels.

    If the last level is less than twice the level before it, their difference is added: 15 is appended to 9, 12.
    Otherwise, or if there is only one level, the last level is doubled in the plane: 32 is appended to 8, 16. In 3D it
    is multiplied by 3/2, rounded down: 12 is appended to 8, because 16 would cost 2⁵ times more.

    Args:
        levels: the given levels, from coarse to fine.
        needed: the smallest number of levels of the result.
        dim: the dimension of the body.
    """
    extended = list(levels)
    while len(extended) < needed:
        before, last = [0, *extended][-2:]
        doubling = last if dim == 2 else max(1, last // 2)
        extended.append(last + (last - before if last < 2 * before else doubling))
    return extended


def least_levels(proposition: str) -> int:
    """Return how many levels are necessary to judge an order, for a case of the given proposition."""
    return ROUGH_LEVELS if proposition == "Prop. 5.3" else MIN_LEVELS

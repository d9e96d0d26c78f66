"""Verdicts on the guaranteed bound and the enclosure, from ``bounds.csv`` alone.

That no error lies outside is a theorem (Prop. in ``paper/bound.tex``) about an implementation that may be wrong: a row
fails when one sampled error of one mesh, scheme or time does. How close the ends are is a matter of efficiency; it is
judged where it was announced, on the check-value case, and reported elsewhere.
"""

from __future__ import annotations

import math
from collections.abc import Collection

import pandas as pd

from study.bound.observed_order import order_interval
from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED, Verdict, Window

STATEMENTS = {
    "bound": "‖u(t) − u_h(t)‖_V ≤ y(t), from u_h and an admissible stress alone",
    "enclosure": "d(t) − y(t) ≤ ‖u(t) − u_h(t)‖_V ≤ d(t) + y(t), without the exact solution",
}
INSIDE = Window(0.0, 1.0, "≤ 1 at every sampled time")
CHECKED, CHECKED_LEVEL = "advance-recede", 32
"""The case with check values, and the level at which the enclosure is announced to be tight."""
TIGHT_ABOVE = Window(1.0, 1.15, "≤ 1.15 over [T/2, T]")
TIGHT_BELOW = Window(0.85, 1.0, "≥ 0.85 over [T/2, T]")
WIDTH = 0.2
"""Width of an interval for the order that says something."""
UNCLAIMED = "no claim: how far an end is from the error; what is claimed is that it never crosses it"
KNOWN = "no claim: it contains the order of the errors whenever these lie within their bounds, the row above"


def judge_bounds(rows: pd.DataFrame, cases: Collection[str]) -> list[Verdict]:
    """Every verdict that the rows allow; ``cases`` are those with an exact solution, whose errors are known."""
    found: list[Verdict] = []
    for (trajectory, case), mine in rows.groupby(["trajectory", "case"], sort=False):
        label, name = str(trajectory), str(case)
        if name in cases:
            found += _inside(label, name, mine)
        if label == "enclosure":
            found += _tight(name, mine)
            found += _orders(name, mine, name in cases)
    return found


def _inside(label: str, case: str, rows: pd.DataFrame) -> list[Verdict]:
    """No error above the bound, none below the lower bound, and how far the ends are from it."""
    found = [_range(label, case, "largest error / upper bound", rows["above"], INSIDE)]
    if label == "enclosure":
        found.append(_range(label, case, "largest lower bound / error", rows["below"], INSIDE))
    found.append(_range(label, case, "upper bound / error over [T/2, T], largest", rows["upper"], None))
    return found


def _tight(case: str, rows: pd.DataFrame) -> list[Verdict]:
    """How close the ends are on the check-value case."""
    mine = rows[rows["level"] == CHECKED_LEVEL]
    if case != CHECKED or mine.empty:
        return []
    where = f" at n = {CHECKED_LEVEL}"
    return [
        _range("enclosure", case, "upper bound / error" + where, mine["upper"], TIGHT_ABOVE),
        _range("enclosure", case, "lower bound / error" + where, mine["lower"], TIGHT_BELOW),
    ]


def _range(label: str, case: str, quantity: str, values: pd.Series, window: Window | None) -> Verdict:
    low, high = float(values.min()), float(values.max())
    if window is None:
        return Verdict(label, STATEMENTS[label], case, quantity, UNCLAIMED, high, low, high, REPORTED)
    inside = bool(((window.low <= values) & (values <= window.high)).all())
    worst = low if window is TIGHT_BELOW else high
    verdict = HOLDS if inside else FAILS
    return Verdict(label, STATEMENTS[label], case, quantity, window.text, worst, low, high, verdict)


def _orders(case: str, rows: pd.DataFrame, known: bool) -> list[Verdict]:
    """The interval for the order between the coarsest and the finest level of every family and scheme.

    Without an exact solution it has to contain the predicted order and be narrow enough to say anything. With one it
    contains the order of the errors whenever these lie inside, so that it is only reported.
    """
    found = []
    for (family, _), series in rows.groupby(["family", "scheme"], sort=False):
        if len(series) < 2:
            continue
        coarse, fine = (row for _, row in series.sort_values("h", ascending=False).iloc[[0, -1]].iterrows())
        ratio = math.log(coarse["h"] / fine["h"])
        first, last = ((row["lowest"], row["highest"]) for row in (coarse, fine))
        low, high = order_interval(first, last, ratio)
        levels = f"n = {coarse['level']} to {fine['level']} on {family} meshes"
        sizes = [row["error"] if known else row["lowest"] + row["highest"] for row in (coarse, fine)]
        verdict, expected = _contains(low, high, math.nan if known else float(fine["expected_order"]))
        quantity = f"order of max_t ‖u − u_h‖_V, {levels}"
        observed = math.log(sizes[0] / sizes[1]) / ratio
        found.append(
            Verdict("enclosure", STATEMENTS["enclosure"], case, quantity, expected, observed, low, high, verdict)
        )
    return found


def _contains(low: float, high: float, order: float) -> tuple[str, str]:
    """Whether an interval at most WIDTH wide contains an order."""
    if math.isnan(order):
        return REPORTED, KNOWN
    expected = f"contains {order:g}, at most {WIDTH} wide"
    if high - low > WIDTH:
        return UNDECIDED, expected
    return (HOLDS if low <= order <= high else FAILS), expected

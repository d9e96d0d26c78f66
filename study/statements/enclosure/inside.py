"""When bounds hold: no error outside, ends as close as announced, orders enclosed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import pandas as pd

from study.bound.enclosing import order_interval
from study.ledger.criterion import Observation, Rule
from study.ledger.measures import every, largest
from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED, Verdict, row
from study.ledger.window import Window, above_nothing, at_most
from study.statements.enclosure.courses import CHECKED, CHECKED_LEVEL, Bounds

INSIDE, BENEATH = above_nothing(1.0, "at every sampled time"), at_most(1.0, "at every sampled time")
"""An error is not nothing; a lower bound on a coarse mesh may be."""
WIDTH = 0.2
"""Width of an interval for the order that says something."""
LAST = "no claim: what two meshes enclose is wider than what all do"
KNOWN = "no claim: it contains the order of the errors whenever these lie within their bounds, the row above"

ABOVE = largest("above", "largest error / upper bound", INSIDE, "above")
BELOW = largest("below", "largest lower bound / error", BENEATH, "below")
REACH = Observation(
    largest("upper", "upper bound / error over [T/2, T], largest", Window(), "upper"),
    "how far an end is from the error; what is claimed is that it never crosses it",
)
HERE = f"at n = {CHECKED_LEVEL}"
TIGHT = (
    every("tight-above", f"upper bound / error {HERE}", Window(1.0, 1.15, "over [T/2, T]"), "upper"),
    every("tight-below", f"lower bound / error {HERE}", Window(0.85, 1.0, "over [T/2, T]"), "lower"),
)


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
    """The enclosure by a better trajectory, and that of the order."""

    label = "enclosure"
    claim = "d(t) − y(t) ≤ ‖u(t) − u_h(t)‖_V ≤ d(t) + y(t), without the exact solution"

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        found: list[Verdict] = []
        for case, mine in rows[rows["trajectory"] == self.label].groupby("case", sort=False):
            known = bool(mine["known"].iloc[0])
            found += self._rows(str(case), mine, (ABOVE, BELOW, REACH) if known else ())
            checked = mine[mine["level"] == CHECKED_LEVEL]
            found += self._rows(str(case), checked, TIGHT if case == CHECKED and len(checked) else ())
            for (family, _), series in mine.groupby(["family", "scheme"], sort=False):
                if len(series) > 1:
                    found += self._orders(str(case), str(family), series, known)
        return found

    def _rows(self, case: str, rows: pd.DataFrame, rules: tuple[Rule, ...]) -> list[Verdict]:
        return [rule.verdict(self, case, {"": rows}) for rule in rules]

    def _orders(self, case: str, family: str, series: pd.DataFrame, known: bool) -> Iterator[Verdict]:
        """The order over all levels, and beside it, if there are more than two, that of the finest pair."""
        yield self._order(case, family, series, known)
        if len(series) > 2:
            last = series.sort_values("h", ascending=False).tail(2)
            yield replace(self._order(case, family, last, known), key="order-last", verdict=REPORTED, expected=LAST)

    def _order(self, case: str, family: str, series: pd.DataFrame, known: bool) -> Verdict:
        """The interval for the order between the coarsest and the finest level.

        Without an exact solution it has to contain the predicted order and be narrow enough to say anything. With one
        it contains the order of the errors whenever these lie inside, so that it is only reported.
        """
        coarse, fine = (line for _, line in series.sort_values("h", ascending=False).iloc[[0, -1]].iterrows())
        ratio = math.log(coarse["h"] / fine["h"])
        first, last = ((line["lowest"], line["highest"]) for line in (coarse, fine))
        span = order_interval(first, last, ratio)
        sizes = [line["error"] if known else line["lowest"] + line["highest"] for line in (coarse, fine)]
        order = math.nan if known else float(fine["expected_order"])
        quantity = f"order of max_t ‖u − u_h‖_V, u_h of the scheme, k with h, n = {coarse['level']} to {fine['level']}"
        verdict, expected = contains(span, order)
        found = math.log(sizes[0] / sizes[1]) / ratio, span, verdict
        return row(self, "order", quantity, Window(order, order), found, case, family, expected)


def contains(span: tuple[float, float], order: float) -> tuple[str, str]:
    """Whether an interval at most WIDTH wide contains an order, and what is expected in words."""
    if math.isnan(order):
        return REPORTED, KNOWN
    expected = f"contains {order:g}, at most {WIDTH} wide"
    if span[1] - span[0] > WIDTH:
        return UNDECIDED, expected
    return (HOLDS if span[0] <= order <= span[1] else FAILS), expected

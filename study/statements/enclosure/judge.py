"""When bounds hold: no error outside, ends as close as announced, orders enclosed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any

import numpy as np
import pandas as pd

from study.bound.enclosure import Better, Enclosure
from study.bound.observed_order import order_interval
from study.fem.naming import choose, family_named
from study.ledger.criterion import Observation, Rule
from study.ledger.datafiles import CsvFile, DataFile, Row
from study.ledger.measures import every, largest
from study.ledger.verdict import FAILS, HOLDS, REPORTED, UNDECIDED, Verdict, row
from study.ledger.window import Window, at_most
from study.solve.evolution import SCHEMES
from study.solve.steps import paced_steps
from study.statements.enclosure.measure import BoundRow, measure, posed
from study.statements.enclosure.places import CHECKED, CHECKED_LEVEL, BoundSetting, full_bounds, quick_bounds
from study.statements.shared import estimates
from study.statements.shared.scope import Scope

KEY = ("trajectory", "case", "family", "scheme", "level")
BOUNDS = CsvFile("bounds.csv", KEY, tuple(field.name for field in fields(BoundRow)))
ENCLOSURES = CsvFile("enclosures.csv", KEY, (*KEY, "time", "error", "distance", "bound"))
TIMES = 96
"""Times that are kept of one computation."""

INSIDE = at_most(1.0, "at every sampled time")
TIGHT_ABOVE = Window(1.0, 1.15, "over [T/2, T]")
TIGHT_BELOW = Window(0.85, 1.0, "over [T/2, T]")
WIDTH = 0.2
"""Width of an interval for the order that says something."""
KNOWN = "no claim: it contains the order of the errors whenever these lie within their bounds, the row above"

ABOVE = largest("above", "largest error / upper bound", INSIDE, "above")
BELOW = largest("below", "largest lower bound / error", INSIDE, "below")
REACH = Observation(
    largest("upper", "upper bound / error over [T/2, T], largest", Window(), "upper"),
    "how far an end is from the error; what is claimed is that it never crosses it",
)
TIGHT = (
    every("tight-above", f"upper bound / error at n = {CHECKED_LEVEL}", TIGHT_ABOVE, "upper"),
    every("tight-below", f"lower bound / error at n = {CHECKED_LEVEL}", TIGHT_BELOW, "lower"),
)


class Bounds:
    """What both statements have in common: where and how errors are bounded."""

    label: str
    file: DataFile = BOUNDS
    of_every_case: bool = False

    def settings(self, scope: Scope) -> list[BoundSetting]:
        """The cases of the study, and problems without a solution beside them."""
        found = (full_bounds if scope.full else quick_bounds)(scope.resolved())
        return [setting for setting in found if setting.trajectory == self.label]

    def measure(self, setting: BoundSetting) -> dict[str, Any]:
        """A row of ``bounds.csv``, and columns of ``enclosures.csv``."""
        family, scheme = family_named(setting.family), choose("scheme", setting.scheme, SCHEMES)
        bounds = measure(posed(setting.case), family, setting.level, scheme, self.steps(setting), setting.by)
        return {"row": asdict(bounds[0]), "times": over_time(bounds[1])}

    def records(self, setting: BoundSetting, found: Mapping[str, Any]) -> Iterator[tuple[DataFile, Row]]:
        """One row, and one for every time."""
        yield BOUNDS, found["row"]
        common = {name: found["row"][name] for name in KEY}
        for values in zip(*found["times"].values(), strict=True):
            yield ENCLOSURES, {**common, **dict(zip(found["times"], values, strict=True))}

    def cost(self, setting: BoundSetting) -> float:
        """By cells of the mesh of ũ and its steps: a knot costs three stress solves of degree 3."""
        shorter = setting.by.shorter if isinstance(setting.by, Better) else 1
        return 220.0 * setting.level**2 * 4 ** _finer(setting) * self.steps(setting) * shorter

    def memory(self, setting: BoundSetting) -> float:
        """That of stresses on the mesh of ũ."""
        return estimates.bound(setting.level, _finer(setting), setting.family)

    def steps(self, setting: BoundSetting) -> int:
        """Those of rates."""
        problem = posed(setting.case)
        return paced_steps(problem.pace, problem.data.body.T, setting.level)


def _finer(setting: BoundSetting) -> int:
    return setting.by.refinements if isinstance(setting.by, Better) else 0


def over_time(found: Enclosure) -> dict[str, list[float]]:
    """Columns of ``enclosures.csv``, at no more than TIMES times."""
    chosen = np.unique(np.linspace(0, len(found.times) - 1, TIMES).round().astype(int))
    columns = ("error", "distance", "bound")
    return {
        "time": np.round(found.times[chosen], 9).tolist(),
        **{name: [float(f"{v:.6g}") for v in getattr(found, name)[chosen]] for name in columns},
    }


@dataclass(frozen=True)
class UpperBound(Bounds):
    """The bound from the computed displacement alone."""

    label: str = "bound"
    claim: str = "‖u(t) − u_h(t)‖_V ≤ y(t), from u_h and an admissible stress alone"

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        mine = rows[(rows["trajectory"] == self.label) & rows["known"]]
        return [
            rule.verdict(self, str(case), {"": of_case})
            for case, of_case in mine.groupby("case", sort=False)
            for rule in (ABOVE, REACH)
        ]


@dataclass(frozen=True)
class TwoSided(Bounds):
    """The enclosure by a better trajectory, and that of the order."""

    label: str = "enclosure"
    claim: str = "d(t) − y(t) ≤ ‖u(t) − u_h(t)‖_V ≤ d(t) + y(t), without the exact solution"

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        found: list[Verdict] = []
        for case, mine in rows[rows["trajectory"] == self.label].groupby("case", sort=False):
            known = bool(mine["known"].iloc[0])
            found += self._rows(str(case), mine, (ABOVE, BELOW, REACH) if known else ())
            checked = mine[mine["level"] == CHECKED_LEVEL]
            found += self._rows(str(case), checked, TIGHT if case == CHECKED and len(checked) else ())
            for (family, _), series in mine.groupby(["family", "scheme"], sort=False):
                if len(series) > 1:
                    found.append(self._order(str(case), str(family), series, known))
        return found

    def _rows(self, case: str, rows: pd.DataFrame, rules: tuple[Rule, ...]) -> list[Verdict]:
        return [rule.verdict(self, case, {"": rows}) for rule in rules]

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
        quantity = f"order of max_t ‖u − u_h‖_V, n = {coarse['level']} to {fine['level']}"
        observed = math.log(sizes[0] / sizes[1]) / ratio
        verdict, expected = contains(span, order)
        return row(self, "order", quantity, Window(order, order), observed, span, verdict, case, family, expected)


def contains(span: tuple[float, float], order: float) -> tuple[str, str]:
    """Whether an interval at most WIDTH wide contains an order, and what is expected in words."""
    if math.isnan(order):
        return REPORTED, KNOWN
    expected = f"contains {order:g}, at most {WIDTH} wide"
    if span[1] - span[0] > WIDTH:
        return UNDECIDED, expected
    return (HOLDS if span[0] <= order <= span[1] else FAILS), expected

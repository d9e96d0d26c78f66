"""What is claimed of the work of contact, and what is reported."""

from __future__ import annotations

from dataclasses import replace

import pandas as pd

from study.ledger.criterion import Criterion, Observation, by_case
from study.ledger.measures import ENOUGH, consecutive, exactly
from study.ledger.verdict import Verdict
from study.ledger.window import Window, around, at_least
from study.statements.contact_work.measured_work import MeasuredWork
from study.statements.contact_work.total_work import DRAWS

GRID = "one-diagonal"
ROOT = "order of ‖R(·; Π^h u − u)‖^{1/2}"
FIRST_ORDER = around(1, 0.15, "trains of all widths from h/2 to 4h")
COARSE = 32
"""The least level with trains of enough widths on both sides of h."""
BY_CHANCE = "on irregular meshes single orders depend on chance"
HALF = around(0.5, 0.15, "as of a sum of n independent edges")
NOT_RESOLVED = "a train is resolved for h < ℓ/10 only"


def from_32(key: str, quantity: str, column: str, window: Window = FIRST_ORDER) -> Criterion:
    """The order from each level to the next, from n = 32 on."""
    found = consecutive(key, f"{quantity}, level by level from n = 32", window, column)
    return replace(found, measure=lambda group: found.measure(group[group["level"] >= COARSE]), levels=ENOUGH)


GRID_ORDER = from_32("order", f"{ROOT}, on grids", "work")
MEAN_ORDER = from_32("order-mean", f"{ROOT}, R the mean over {DRAWS} times random vertices", "mean work")
SPREAD = from_32("spread", "order of the relative standard deviation of R over random vertices", "spread", HALF)
SINGLE_ORDER = Observation(from_32("order-irregular", f"{ROOT}, on single irregular meshes", "work"), BY_CHANCE)
SHARE = Criterion(
    "share",
    "‖R‖^{1/2} / error, least",
    at_least(0.02, "smooth fronts have 1e-6 … 1e-3"),
    lambda group: exactly((group["work"] / group["error"]).min()),
    ("work", "error"),
)
COST = Criterion(
    "excess-share",
    "‖u^h − u^h_lin‖_V / error, largest",
    Window(),
    lambda group: exactly((group["excess"] / group["error"]).max()),
    ("excess", "error"),
)
REST = (
    Observation(from_32("error", "order of ‖u − u^h‖_V", "error", Window()), NOT_RESOLVED),
    Observation(COST, "what contact costs in V has no bound of its own"),
    Observation(from_32("excess", "order of ‖u^h − u^h_lin‖_V", "excess", Window()), NOT_RESOLVED),
)


class WorkOfContact(MeasuredWork):
    """The root of the work of contact beside the error and the excess over the linear problem."""

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        found = []
        for case, groups in by_case(rows):
            on_grid = {name: table for name, table in groups.items() if name == GRID}
            irregular = {name: table for name, table in groups.items() if name != GRID}
            found += [rule.verdict(self, case, on_grid) for rule in (GRID_ORDER, MEAN_ORDER, SPREAD, SHARE)]
            found += [SINGLE_ORDER.verdict(self, case, irregular)]
            found += [rule.verdict(self, case, groups) for rule in REST]
        return found

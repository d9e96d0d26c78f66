"""Is the regularity (5.36) that Proposition 5.4 asks for needed?"""

from __future__ import annotations

from dataclasses import dataclass

import pandas as pd

from study.ledger.criterion import Observation, by_family
from study.ledger.datafiles import DataFile
from study.ledger.measures import ENOUGH, between_levels
from study.ledger.verdict import Verdict
from study.ledger.window import at_least
from study.statements.prop_5_4.sweep import RATES
from study.statements.shared.base import NothingMeasured

GRADED = "graded"


@dataclass(frozen=True)
class RegularityNeeded(NothingMeasured):
    """The order seen beside the one that the proof of Prop. 5.4 gives for a solution that misses (5.36)."""

    label: str = "(5.36)"
    claim: str = "is the regularity that Prop. 5.4 asks for needed?"
    file: DataFile = RATES

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        found = []
        for case, mine in rows[rows["claim"] == "Prop. 5.3"].groupby("case", sort=False):
            proved = at_least(float(mine["proved_order"].iloc[0]), "the order that the proof gives")
            seen = between_levels("order", "order seen, on uniform meshes", proved, "error", 2, ENOUGH)
            groups = {name: group for name, group in by_family(mine).items() if name != GRADED}
            rule = Observation(seen, "the source claims an order for (5.36) alone")
            found.append(rule.verdict(self, str(case), groups))
        return found

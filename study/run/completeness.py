"""Whether all that was planned was measured."""

from __future__ import annotations

from dataclasses import dataclass

from study.ledger.verdict import HOLDS, UNDECIDED, Verdict, row
from study.ledger.window import at_most


@dataclass(frozen=True)
class Complete:
    """Whether the data are those of the plan: a missing family or level would make a verdict easier."""

    label: str = "data"
    claim: str = "every planned measurement is there"

    def judge(self, planned: set[tuple[str, ...]], found: set[tuple[str, ...]]) -> Verdict:
        """Its only row."""
        missing = sorted(planned - found)
        quantity = "rows of the plan that are missing" + (f", first {' '.join(missing[0])}" if missing else "")
        count = float(len(missing))
        verdict = UNDECIDED if missing else HOLDS
        window = at_most(0, f"of {len(planned)}")
        return row(self, "missing", quantity, window, count, (count, count), verdict, "all cases")

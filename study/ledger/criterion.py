"""From measurements on the levels of some mesh families to rows of the ledger."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import pandas as pd

from study.ledger.verdict import BECAUSE, FAILS, HOLDS, NOWHERE, REPORTED, UNDECIDED, Found, Named, Span, Verdict, row
from study.ledger.window import Window

Groups = dict[str, pd.DataFrame]
"""For every mesh family its levels, coarse to fine: columns level, h and the quantities."""

Measured = tuple[float, Span]
"""(observed value, its range)."""

Measure = Callable[[pd.DataFrame], Measured | None]
"""The levels of one family ↦ what was found, None if these levels cannot tell."""


def by_family(rows: pd.DataFrame) -> Groups:
    """The rows of each mesh family, coarse to fine."""
    return {str(name): group.sort_values("h", ascending=False) for name, group in rows.groupby("family", sort=False)}


def by_case(rows: pd.DataFrame) -> Iterator[tuple[str, Groups]]:
    """The measurements of each case, listed one by one, as one table per mesh family."""
    for case, of_case in rows.groupby("case", sort=False):
        groups = {}
        for family, of_family in of_case.groupby("family", sort=False):
            table = of_family.pivot(index=["level", "h"], columns="quantity", values="value")
            groups[str(family)] = table.reset_index().sort_values("h", ascending=False)
        yield str(case), groups


class Rule(Protocol):
    """What becomes one row of the ledger for every case."""

    def verdict(self, of: Named, case: str, groups: Groups, family: str = "") -> Verdict: ...


@dataclass(frozen=True)
class Criterion:
    """A quantity that has to lie in a window.

    Attributes:
        key: short name of the row.
        quantity: what is looked at, in words.
        window: where it must lie.
        measure: how it comes from the levels of one family.
        needs: the columns that it reads.
        levels: with fewer of them it is undecided.
        spread: where the range of the values must lie, the window unless it is given.
    """

    key: str
    quantity: str
    window: Window
    measure: Measure
    needs: tuple[str, ...]
    levels: int = 1
    spread: Window | None = None

    def verdict(self, of: Named, case: str, groups: Groups, family: str = "") -> Verdict:
        """The row for a case: undecided if the levels of one family cannot tell."""
        complete = [group for group in groups.values() if all(name in group for name in self.needs)]
        enough = [group for group in complete if len(group) >= self.levels]
        found = [value for group in enough if (value := self.measure(group)) is not None]
        decided = bool(found) and len(found) == len(groups)
        judged = self._judge(found) if decided else (math.nan, NOWHERE, UNDECIDED)
        fewest = min(map(len, groups.values()), default=0)
        short = f"{BECAUSE}it takes {self.levels} levels, not {fewest}" if fewest < self.levels else ""
        return row(of, self.key, self.quantity, self.window, judged, case, family, f"{self.window.text}{short}")

    def _judge(self, found: Sequence[Measured]) -> Found:
        values, spans = [value for value, _ in found], [span for _, span in found]
        span = min(low for low, _ in spans), max(high for _, high in spans)
        inside = (self.spread or self.window).contains(*span)
        verdict = FAILS if not self.window.contains(*values) else HOLDS if inside else UNDECIDED
        return self.window.worst(values), span, verdict


@dataclass(frozen=True)
class Observation:
    """A quantity about which no claim is made, for a reason.

    The window of its criterion is the prediction, an unbounded one if there is none.
    """

    criterion: Criterion
    reason: str

    def verdict(self, of: Named, case: str, groups: Groups, family: str = "") -> Verdict:
        """The row for a case, which says whether the prediction agrees."""
        found = self.criterion.verdict(of, case, groups, family)
        agreement = {HOLDS: "agrees", FAILS: "differs", UNDECIDED: "undecided"}[found.verdict]
        expected = f"predicted {self.criterion.window.text}; no claim, as {self.reason}: {agreement}"
        if self.criterion.window == Window():
            expected = f"no claim: {self.reason}"
        return replace(found, expected=expected, verdict=REPORTED)


def judge(of: Named, rows: pd.DataFrame, rules: Sequence[Rule]) -> list[Verdict]:
    """Every rule on every case of measurements that are listed one by one."""
    return [rule.verdict(of, case, groups) for case, groups in by_case(rows) for rule in rules]

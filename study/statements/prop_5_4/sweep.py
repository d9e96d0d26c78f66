"""Where errors are measured: what Propositions 5.3 and 5.4 have in common, each for its cases."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from study.fem.naming import choose, family_named, resolve
from study.ledger.datafiles import CsvFile, DataFile, Row, with_orders
from study.solve.tableau import SCHEMES
from study.statements.prop_5_4.measure import COLUMNS, measure_case
from study.statements.shared import estimates
from study.statements.shared.base import Setting, Statement
from study.statements.shared.scope import Scope

RATES = CsvFile("rates.csv", ("case", "family", "scheme", "level"), ("claim", *COLUMNS), with_orders)


@dataclass(frozen=True, order=True)
class RateSetting(Setting):
    """One row of a rate table: also the name of the time scheme, and its steps."""

    scheme: str
    steps: int


class Rates(Statement):
    """What is measured for a proposition on the cases that are cases of it."""

    file = RATES
    of_every_case = True

    def settings(self, scope: Scope) -> list[RateSetting]:
        """Its cases on all their mesh families and levels."""
        return [
            RateSetting(reference, family.name, n, scope.scheme, scope.steps(case, n))
            for reference, case in zip(scope.cases, scope.resolved(), strict=True)
            if case.proposition == self.label
            for family in scope.families_of(case)
            for n in scope.levels_on(case, family)
        ]

    def measure(self, setting: RateSetting) -> dict[str, Any]:
        case, scheme = resolve(setting.case), choose("scheme", setting.scheme, SCHEMES)
        return measure_case(case, family_named(setting.family), setting.level, scheme, setting.steps)

    def records(self, setting: RateSetting, found: Mapping[str, Any]) -> Iterator[tuple[DataFile, Row]]:
        """The row, for this proposition: what a case is a case of may change without measuring it again."""
        yield self.file, {"claim": self.label, **found}

    def cost(self, setting: RateSetting) -> float:
        """By cells and steps; a cell in space costs more: more components, a denser factor."""
        cells = setting.level**setting.dim * estimates.cells(setting.family)
        return float(cells * setting.steps) * (7 if setting.dim == 2 else 150)

    def memory(self, setting: RateSetting) -> float:
        return estimates.displacement(setting.dim, setting.level, setting.family)

    def steps(self, setting: RateSetting) -> int:
        return setting.steps

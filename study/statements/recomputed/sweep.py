"""Where Problem 5.1 is computed once more: every case, on the coarsest mesh of each family that the study has of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from study.fem.naming import resolve
from study.ledger.datafiles import CsvFile, DataFile, Row
from study.solve.tableau import MIDPOINT
from study.statements.prop_5_4.experiment import Experiment
from study.statements.prop_5_4.sweep import RATES, RateSetting
from study.statements.recomputed.measure import ERRORS, GAPS, SAME_LOAD, recompute
from study.statements.shared import estimates
from study.statements.shared.base import Statement
from study.statements.shared.random_meshes import is_random
from study.statements.shared.scope import Scope

ROUGH = "Prop. 5.3"
"""What a case without (5.36) is a case of."""
NARROW = ("travelling-patch",)
"""Cases with a patch that is two or three cells wide on the coarsest meshes."""
RECOMPUTED = CsvFile("recomputed.csv", RATES.key, (*RATES.key, "h", *ERRORS, *GAPS, *SAME_LOAD))
"""A row of ``rates.csv`` once more: its errors, and the differences of the trajectories, as ``measure`` has them."""


class Again(Statement):
    """The coarsest rows of ``rates.csv``, by the midpoint rule."""

    file = RECOMPUTED
    beside = RATES

    def settings(self, scope: Scope) -> list[RateSetting]:
        """The coarsest level of every case on all families that the study has of it.

        Rough cases, and those whose patch is narrow, are left out on random meshes: there the size of the cells at a
        singularity or below the patch, which is chance, says how well loads and errors are integrated, and the rows
        are about both ways and not about chance.
        """
        return [
            RateSetting(reference, family.name, level, scope.scheme, scope.steps(case, level))
            for reference, case in zip(scope.cases, scope.resolved(), strict=True)
            if scope.scheme == MIDPOINT.name
            for family in scope.families_of(case)
            if not (is_random(family.name) and (case.proposition == ROUGH or case.name in NARROW))
            for level in scope.levels_of(case).all[:1]
        ]

    def measure(self, setting: RateSetting) -> dict[str, float]:
        setup = Experiment.at(setting, MIDPOINT, setting.steps)
        return {"h": setup.space.h, **recompute(setup)}

    def records(self, setting: RateSetting, found: Mapping[str, Any]) -> Iterator[tuple[DataFile, Row]]:
        """The key is that of the row in ``rates.csv``."""
        case = resolve(setting.case).name
        yield self.file, {**{name: getattr(setting, name) for name in self.file.key}, "case": case, **found}

    def cost(self, setting: RateSetting) -> float:
        cells = setting.level**setting.dim * estimates.cells(setting.family)
        return float(cells * setting.steps) * (120 if setting.dim == 2 else 600)

    def memory(self, setting: RateSetting) -> float:
        return estimates.SMALL if setting.dim == 2 else estimates.SOLID

    def steps(self, setting: RateSetting) -> int:
        return setting.steps

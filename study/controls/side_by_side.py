"""Settings of controls whose checks compare two results: a body and its twin, two solvers, an error and its bounds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from typing import Any

import pandas as pd

from study.fem.naming import family_named, resolve
from study.ledger.verdict import UNCLAIMED, Verdict
from study.run.judgement import joined
from study.solve.steps import rate_steps
from study.solve.tableau import MIDPOINT
from study.statements.enclosure import Bounds, BoundSetting, resolve_problem
from study.statements.enclosure import measure as bounded
from study.statements.from_rates import Turned
from study.statements.prop_5_4 import RATES, measure
from study.statements.recomputed import Recomputed, recompute
from study.statements.shared.experiment import Experiment

Defect = Callable[[Experiment], Experiment]


def experiment(case: str, level: int) -> Experiment:
    """Return the experiment of the study on a one-diagonal mesh."""
    known = resolve(case)
    steps = rate_steps(known.solution.body.T, level, known.pace)
    return Experiment.of(known.solution, family_named("one-diagonal"), level, MIDPOINT, steps)


def row_of(setup: Experiment, case: str, level: int) -> dict[str, Any]:
    """Return the line of an experiment in ``rates.csv``."""
    return measure(setup).row(case, "one-diagonal", level)


@dataclass(frozen=True)
class Twins:
    """A case with a rotated body and its twin; several meshes, because on one mesh digits may agree by chance."""

    case: str
    levels: tuple[int, ...]

    def __str__(self) -> str:
        return f"{self.case} and its twin, n = {' '.join(map(str, self.levels))}"

    def verdicts(self, defect: Defect) -> list[Verdict]:
        rows = []
        for name, level in product((self.case, resolve(self.case).twin), self.levels):
            line = row_of(defect(experiment(name, level)), name, level)
            rows.append({**line, "twin": resolve(name).twin})
        return Turned().judge(pd.DataFrame(rows))


@dataclass(frozen=True)
class TwoWays:
    """A case on one mesh, as in ``rates.csv`` and computed again by the second solver."""

    case: str
    level: int

    def __str__(self) -> str:
        return f"{self.case} computed again, n = {self.level}"

    def verdicts(self, defect: Defect) -> list[Verdict]:
        setup = defect(experiment(self.case, self.level))
        line = row_of(setup, self.case, self.level)
        again = {name: line[name] for name in (*RATES.key, "h")} | recompute(setup)
        return Recomputed().judge(
            joined(Recomputed(), {RATES: pd.DataFrame([line]), Recomputed.file: pd.DataFrame([again])})
        )


@dataclass(frozen=True)
class Bounding:
    """Error bounds on given meshes, judged by one of the statements about bounds."""

    statement: Bounds
    settings: tuple[BoundSetting, ...]

    def __str__(self) -> str:
        levels = " ".join(str(setting.level) for setting in self.settings)
        return f"{self.statement.label} for {self.settings[0].case}, n = {levels}"

    def verdicts(self, defect: Callable[[Any], Any]) -> list[Verdict]:
        rows = []
        for setting in self.settings:
            problem, steps = resolve_problem(setting.case), self.statement.steps(setting)
            row, _ = bounded(problem, family_named(setting.family), setting.level, MIDPOINT, steps, setting.by)
            rows.append({**row, "known": problem.case is not None})
        return [verdict for verdict in self.statement.judge(pd.DataFrame(rows)) if verdict.verdict not in UNCLAIMED]

"""What is measured of bounds: rows of ``bounds.csv``, and the course of each in time."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, fields
from typing import Any

import numpy as np

from study.bound.enclosing import Enclosure
from study.bound.trajectory import Refined
from study.fem.naming import choose, family_named
from study.ledger.datafiles import CsvFile, DataFile, Row
from study.solve.steps import rate_steps
from study.solve.tableau import SCHEMES
from study.statements.enclosure.bound_rows import BoundRow, measure, posed
from study.statements.enclosure.where import BoundSetting, full_bounds, quick_bounds
from study.statements.shared import estimates
from study.statements.shared.scope import Scope

KEY = ("trajectory", "case", "family", "scheme", "level")
BOUNDS = CsvFile("bounds.csv", KEY, tuple(field.name for field in fields(BoundRow)))
ENCLOSURES = CsvFile("enclosures.csv", KEY, (*KEY, "time", "error", "distance", "bound"))
TIMES = 96
"""Times that are kept of one computation."""


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
        shorter = setting.by.shorter if isinstance(setting.by, Refined) else 1
        return 220.0 * setting.level**2 * 4 ** _finer(setting) * self.steps(setting) * shorter

    def memory(self, setting: BoundSetting) -> float:
        """That of stresses on the mesh of ũ."""
        return estimates.bound(setting.level, _finer(setting), setting.family)

    def steps(self, setting: BoundSetting) -> int:
        """Those of rates."""
        problem = posed(setting.case)
        return rate_steps(problem.data.body.T, setting.level, problem.pace)


def _finer(setting: BoundSetting) -> int:
    return setting.by.refinements if isinstance(setting.by, Refined) else 0


def over_time(found: Enclosure) -> dict[str, list[float]]:
    """Columns of ``enclosures.csv``, at no more than TIMES times."""
    chosen = np.unique(np.linspace(0, len(found.times) - 1, TIMES).round().astype(int))
    columns = ("error", "distance", "bound")
    return {
        "time": np.round(found.times[chosen], 9).tolist(),
        **{name: [float(f"{v:.6g}") for v in getattr(found, name)[chosen]] for name in columns},
    }

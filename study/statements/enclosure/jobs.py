"""The pieces of work behind ``bounds.csv`` and ``enclosures.csv``."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from manufactured.case import Case
from manufactured.data import Data
from manufactured.problems import Problem, problems
from study.bound.enclosure import Better, Enclosure, Trajectory
from study.fem.naming import choose, family_named, resolve
from study.run import resources as memory
from study.run.job import fingerprint
from study.solve.evolution import Scheme
from study.solve.steps import rate_steps
from study.solve.tableau import SCHEMES
from study.statements.enclosure.measure import measure_bound, measure_problem

TIMES = 96
"""Times that are kept of one computation."""


@dataclass(frozen=True)
class BoundJob:
    """One row of ``bounds.csv`` with its times in ``enclosures.csv``.

    Attributes:
        problem: name or reference of a case, or name of a problem whose solution is unknown.
        trajectory: ``Itself()`` or a ``Better``.
    """

    problem: str
    family: str
    scheme: str
    level: int
    trajectory: Trajectory

    @property
    def key(self) -> str:
        name = self._problem().name
        return f"{self.trajectory.name}__{name}__{self.family}__{self.scheme}__{self.level:05d}"

    @property
    def cost(self) -> float:
        shorter = self.trajectory.shorter if isinstance(self.trajectory, Better) else 1
        # A knot costs three stress solves of degree 3.
        return 220.0 * self.level**2 * 4**self._finer * self.steps * shorter

    @property
    def memory(self) -> float:
        return memory.bound(self.level, self._finer, self.family)

    @property
    def _finer(self) -> int:
        return self.trajectory.refinements if isinstance(self.trajectory, Better) else 0

    @property
    def steps(self) -> int:
        found = self._problem()
        if isinstance(found, Problem):
            return rate_steps(found.data.body.T, self.level)
        return rate_steps(found.solution.body.T, self.level, found.pace)

    def _problem(self) -> Case | Problem:
        return _without_solution().get(self.problem) or resolve(self.problem)

    def parts(self) -> tuple[Any, Scheme]:
        return family_named(self.family), choose("scheme", self.scheme, SCHEMES)

    def fingerprint(self) -> str:
        found = self._problem()
        data = found.data if isinstance(found, Problem) else Data.of(found.solution)
        return fingerprint(
            data.body, data.law, data.formulas_of, *self.parts(), self.level, self.steps, self.trajectory
        )

    def run(self) -> dict[str, Any]:
        problem, (family, scheme) = self._problem(), self.parts()
        settings = family, self.level, scheme, self.steps, self.trajectory
        row, found = (
            measure_problem(problem, *settings) if isinstance(problem, Problem) else measure_bound(problem, *settings)
        )
        return {"row": asdict(row), "times": _times(found)}


@lru_cache
def _without_solution() -> dict[str, Problem]:
    """The problems of the study that have no known solution; their formulas take time to compile."""
    return {problem.name: problem for problem in problems()}


def _times(found: Enclosure) -> dict[str, list[float]]:
    """Columns of ``enclosures.csv``, at no more than TIMES times."""
    chosen = np.unique(np.linspace(0, len(found.times) - 1, TIMES).round().astype(int))
    columns = ("error", "distance", "bound")
    return {
        "time": np.round(found.times[chosen], 9).tolist(),
        **{name: [float(f"{v:.6g}") for v in getattr(found, name)[chosen]] for name in columns},
    }

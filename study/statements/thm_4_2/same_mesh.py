"""Theorem 4.2 on one mesh: the two problems agree at every step, within what the duality gaps of the solver allow."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, fields
from typing import Any

import numpy as np
import pandas as pd

from manufactured.case import Case
from study.fem.mesh import MeshFamily
from study.fem.naming import family_named, resolve
from study.ledger.criterion import Criterion, Measured, by_family
from study.ledger.datafiles import CsvFile, DataFile, Row
from study.ledger.measures import largest
from study.ledger.verdict import Verdict
from study.ledger.window import at_most
from study.statements.shared import estimates
from study.statements.shared.base import Setting
from study.statements.shared.scope import Scope
from study.statements.thm_4_2.gaps import gaps, problems


@dataclass(frozen=True)
class EquivalenceRow:
    """One line of ``equivalence.csv``: what was compared and the ``Gaps``.

    Attributes:
        form: the space of strains, whose duals the stresses are.
    """

    case: str
    form: str
    level: int
    h: float
    steps: int
    displacement_gap: float
    stress_gap: float
    admissibility: float
    energy_gap: float
    membership: float
    displacement_bound: float
    stress_bound: float
    family: str


def compare(case: Case, family: MeshFamily, level: int, steps: int) -> EquivalenceRow:
    """Solve both problems for a case."""
    displacements, stresses = problems(case.solution, family, level)
    found = gaps(displacements, stresses, steps)
    return EquivalenceRow(case.name, "strains of V^h", level, stresses.space.h, steps, *found, family.name)


EQUIVALENCE = CsvFile(
    "equivalence.csv", ("case", "family", "level"), tuple(field.name for field in fields(EquivalenceRow))
)

AGREEMENT = at_most(1e-7, "at every step")
ALLOWED = at_most(1.0, "proved")
SHARP = at_most(1e-5, "32 steps, each the root of a gap of 1e-15, and norms 10 apart")


def allowed(key: str, what: str, gap: str, bound: str) -> Criterion:
    """A gap over what the duality gaps allow for it, on every level."""

    def measure(group: pd.DataFrame) -> Measured:
        ratios = (group[gap] / group[bound]).to_numpy()
        return float(ratios.max()), (float(ratios.min()), float(ratios.max()))

    return Criterion(key, f"{what} of Problem 3.2 − 3.1 / what the gap allows", ALLOWED, measure, (gap, bound))


def _sharp(group: pd.DataFrame) -> Measured:
    bounds = np.maximum(group["displacement_bound"], group["stress_bound"]).to_numpy()
    return float(bounds.max()), (float(bounds.min()), float(bounds.max()))


RULES = (
    allowed("displacement", "displacement", "displacement_gap", "displacement_bound"),
    allowed("stress", "stress", "stress_gap", "stress_bound"),
    Criterion(
        "allowed",
        "what the gap allows / size of the solution",
        SHARP,
        _sharp,
        ("displacement_bound", "stress_bound"),
    ),
    largest("admissibility", "σ^h ∈ Σ^h(t)", AGREEMENT, "admissibility"),
    largest("energy", "(σ, ε(u))_Q = (f, u)_V, (4.14)", AGREEMENT, "energy_gap"),
    largest("membership", "u ∈ K^h though never imposed", AGREEMENT, "membership"),
)


@dataclass(frozen=True)
class SameMesh:
    """Problem 3.2 on the strains of V^h against Problem 3.1, by backward Euler with k ~ h/2."""

    label: str = "Thm 4.2"
    claim: str = "Problem 3.2 on the strains of V^h and Problem 3.1 have one solution"
    file: DataFile = EQUIVALENCE
    of_every_case: bool = True

    def settings(self, scope: Scope) -> list[Setting]:
        """Every case on coarse levels, for the interior point method is for small problems."""
        return [
            Setting(reference, family.name, n)
            for reference, case in zip(scope.cases, scope.resolved(), strict=True)
            for family in scope.families_of(case)[: None if scope.every_family else 1]
            for n in (scope.equivalence if case.solution.body.dim == 2 else scope.solid_equivalence)
        ]

    def measure(self, setting: Setting) -> dict[str, Any]:
        """A row of ``equivalence.csv``."""
        case, family = resolve(setting.case), family_named(setting.family)
        return asdict(compare(case, family, setting.level, self.steps(setting)))

    def records(self, setting: Setting, found: Mapping[str, Any]) -> Iterator[tuple[DataFile, Row]]:
        """The row."""
        yield self.file, found

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        groups = {str(case): by_family(mine) for case, mine in rows.groupby("case", sort=False)}
        return [rule.verdict(self, case, of_case) for case, of_case in groups.items() for rule in RULES]

    def cost(self, setting: Setting) -> float:
        """By cells and steps."""
        dim = resolve(setting.case).solution.body.dim
        return float(setting.level**dim * self.steps(setting)) * (70 if dim == 2 else 1000)

    def memory(self, setting: Setting) -> float:
        """That of the interior point method."""
        return estimates.equivalence(resolve(setting.case).solution.body.dim, setting.level, setting.family)

    def steps(self, setting: Setting) -> int:
        """Two for every cell along a side."""
        return 2 * setting.level

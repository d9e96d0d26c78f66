"""Base classes of statements: where a statement is measured, what is measured, and when it holds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd

from study.fem.naming import resolve
from study.ledger.criterion import Rule, by_family, judge
from study.ledger.datafiles import CsvFile, DataFile, Row
from study.ledger.verdict import Verdict
from study.statements.shared import estimates
from study.statements.shared.scope import Scope


@dataclass(frozen=True, order=True)
class Setting:
    """A case on one mesh: the case by its name in the catalogue or as FILE.py:NAME, a mesh family, and a level n."""

    case: str
    family: str
    level: int

    @property
    def dim(self) -> int:
        """The dimension of the body."""
        return resolve(self.case).solution.body.dim


REPORTED = "_reported"
"""Suffix of the columns of another data file after it is joined to the file of a statement."""


class Statement:
    """A numbered statement of the paper, or a question beyond it. Two instances of one class are equal.

    A subclass sets the attributes and overrides ``measure``; a statement that is judged from the rows of another one
    measures nothing. By default a measurement is one row of the data file, and each criterion is applied to every case.

    Attributes:
        label: the number of the statement.
        claim: the statement in words.
        file: the data file with the rows from which it is judged.
        beside: another data file; its columns are joined to the rows with the same key as ``NAME_reported``.
        rules: the criteria, each of which gives one row of the ledger for every case.
        quick, full: the settings of the quick and of the full study.
        of_every_case: whether it is measured on every case of a run, also on cases of users.
        initial_gap: whether it is measured on cases with an initial gap, too, which the paper does not have.
        of_own_cases: whether ``settings`` has the cases of users, too, if the statement is not measured on every case.
    """

    label: str
    claim: str
    file: DataFile
    joined_file: CsvFile | None = None
    rules: Sequence[Rule] = ()
    quick: Sequence[Any] = ()
    full: Sequence[Any] = ()
    of_every_case: bool = False
    initial_gap: bool = False
    of_own_cases: bool = False

    def planned(self, scope: Scope) -> Sequence[Any]:
        """Return the settings of a study on the cases that the statement is about."""
        return self.settings(scope if self.initial_gap else scope.of_the_paper())

    def places(self, full: bool) -> Sequence[Any]:
        """Return the settings of the full or of the quick study."""
        return self.full if full else self.quick

    def settings(self, scope: Scope) -> Sequence[Any]:
        """Return the settings of a study: of all places those whose case is studied."""
        return [setting for setting in self.places(scope.full) if setting.case in scope.cases]

    def measure(self, setting: Any) -> Mapping[str, Any]:
        """Measure one setting and return named numbers."""
        raise NotImplementedError(f"{type(self).__name__}: nothing is measured")

    def records(self, setting: Any, found: Mapping[str, Any]) -> Iterator[tuple[DataFile, Row]]:
        """Yield the rows of a measurement with their data files."""
        yield self.file, found

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        """Return rows of the ledger from the rows of its data file, joined with the predictions for their cases."""
        cases = [(str(case), by_family(mine)) for case, mine in rows.groupby("case", sort=False)]
        return [rule.verdict(self, case, groups) for case, groups in cases for rule in self.rules]

    def cost(self, setting: Any) -> float:
        """Return the expected time of ``measure`` in µs."""
        return 0.0

    def memory(self, setting: Any) -> float:
        """Return the estimated largest memory of the process of ``measure`` in bytes."""
        return estimates.SMALL

    def steps(self, setting: Any) -> int:
        """Return the number of time steps, which is part of the cache key; 0 if ``measure`` chooses them."""
        return 0

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other)

    def __hash__(self) -> int:
        return hash(type(self))


SEED = 2002
"""Seed of all random numbers in measurements."""
EVOLVING = ("full-contact", "advance-recede", "travelling-patch", "yield-and-release", "yield-on-a-part")
"""Cases that represent all others when trajectories are measured: linear laws, moving fronts, law (3.3)."""
SOFTENING = ("softening", "double-well")
"""A linear and a nonlinear case whose G is not monotone: they satisfy (3.2) and no more."""
LISTED = CsvFile(
    "statements.csv",
    ("label", "case", "family", "level"),
    ("label", "case", "family", "level", "h", "quantity", "value"),
)
"""Measurements of most statements, one row for each number."""


class ListedNumbers(Statement):
    """A statement whose numbers are listed one by one in ``statements.csv``.

    Attributes:
        effort: time of a measurement relative to most others at the same level.
    """

    file: DataFile = LISTED
    effort: float = 1.0

    def records(self, setting: Setting, found: Mapping[str, float]) -> Iterator[tuple[DataFile, Row]]:
        """Yield a row for every number except the mesh size."""
        common = {"label": self.label, **vars(setting), "h": found["h"]}
        for quantity, value in found.items():
            if quantity != "h":
                yield self.file, {**common, "quantity": quantity, "value": value}

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        return judge(self, rows, self.rules)

    def cost(self, setting: Setting) -> float:
        """Return the expected time in µs by level and dimension alone."""
        return self.effort * float(setting.level**2) * (230 if setting.dim == 2 else 30_000)

    def memory(self, setting: Setting) -> float:
        """Return the largest memory of all such statements at the level."""
        return estimates.statement(setting.dim, setting.level)


def grid(cases: Sequence[str], families: Sequence[str], levels: Sequence[int]) -> list[Setting]:
    """Return the settings of every case on every family and level."""
    return [Setting(case, family, n) for case in cases for family in families for n in levels]


def with_h(h: float, values: Mapping[str, float]) -> dict[str, float]:
    """Return the mesh size and numbers as one mapping, as ``ListedNumbers.measure`` must."""
    return {"h": h, **{name: float(value) for name, value in values.items()}}

"""Base classes of statements: settings, a measurement at each setting, and criteria for the measured numbers."""

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
"""Suffix of the columns that are added from ``Statement.joined_file``."""


class Statement:
    """A numbered statement of the paper, or a statement of this study. Two instances of one class are equal.

    A subclass sets the attributes and overrides ``measure``, unless it is judged from the measurements of another
    statement. By default a measurement is one row of the data file, and each criterion is applied to every case.

    Attributes:
        label: the number of the statement.
        claim: the claim in words.
        file: the data file with the rows from which the statement is judged.
        joined_file: a second data file or None. Its columns are added to the rows of ``file`` that have the same key,
            under the names ``NAME_reported``.
        rules: the criteria, each of which gives one row of the ledger for every case.
        quick, full: the settings of the quick and of the full study.
        of_every_case: whether the statement is measured on every case of a run, including the cases of users.
        initial_gap: whether the statement is also measured on cases with an initial gap; the paper has no such gap.
        of_own_cases: whether ``settings`` includes the cases of users although ``of_every_case`` is false.
        outside_catalogue: whether the cases of ``quick`` and ``full`` are not in the catalogue. The statement is then
            measured if the whole catalogue is studied.
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
    outside_catalogue: bool = False

    def planned(self, scope: Scope) -> Sequence[Any]:
        """Return the settings of a study, without cases with an initial gap unless ``initial_gap`` is set."""
        return self.settings(scope if self.initial_gap else scope.of_the_paper())

    def places(self, full: bool) -> Sequence[Any]:
        """Return the settings of the full or of the quick study."""
        return self.full if full else self.quick

    def settings(self, scope: Scope) -> Sequence[Any]:
        """Return the settings whose case belongs to the study."""
        if self.outside_catalogue:
            return self.places(scope.full) if scope.whole else []
        return [setting for setting in self.places(scope.full) if setting.case in scope.cases]

    def measure(self, setting: Any) -> Mapping[str, Any]:
        """Measure one setting and return named numbers."""
        raise NotImplementedError(f"{type(self).__name__}: nothing is measured")

    def records(self, setting: Any, found: Mapping[str, Any]) -> Iterator[tuple[DataFile, Row]]:
        """Yield the rows of a measurement with their data files."""
        yield self.file, found

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        """Return the rows of the ledger.

        Args:
            rows: rows of the data file, with the predictions for their cases.
        """
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
"""The cases on which trajectories are measured: they have linear laws, moving fronts and the law (3.3)."""
SOFTENING = ("softening", "double-well")
"""A case with a linear and a case with a nonlinear G that is Lipschitz, as (3.2) requires, but not monotone."""
LISTED = CsvFile(
    "statements.csv",
    ("label", "case", "family", "level"),
    ("label", "case", "family", "level", "h", "quantity", "value"),
)
"""The data file of most statements, with one row for each measured number."""


class ListedNumbers(Statement):
    """A statement whose numbers are listed one by one in ``statements.csv``.

    Attributes:
        effort: run time of a measurement divided by the run time of a typical statement at the same level.
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
        """Return the expected time in µs, which is estimated from the level and the dimension."""
        return self.effort * float(setting.level**2) * (230 if setting.dim == 2 else 30_000)

    def memory(self, setting: Setting) -> float:
        """Return the estimated memory in bytes, from the level and the dimension."""
        return estimates.statement(setting.dim, setting.level)


def grid(cases: Sequence[str], families: Sequence[str], levels: Sequence[int]) -> list[Setting]:
    """Return the settings of every case on every family and level."""
    return [Setting(case, family, n) for case in cases for family in families for n in levels]


def with_h(h: float, values: Mapping[str, float]) -> dict[str, float]:
    """Return the result of ``ListedNumbers.measure``: the mesh size under the key "h", and the given numbers."""
    return {"h": h, **{name: float(value) for name, value in values.items()}}

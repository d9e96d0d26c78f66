"""What stands in the ledger: where it is measured, what is measured, and when it holds."""

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
    """One measurement: a case, by its name in the catalogue or FILE.py:NAME, on the mesh of a family at level n."""

    case: str
    family: str
    level: int

    @property
    def dim(self) -> int:
        """The dimension of the body."""
        return resolve(self.case).solution.body.dim


REPORTED = "_reported"
"""Behind the name of a column of another file."""


class Statement:
    """A numbered statement of the source, or a question beyond it; two of one class are equal.

    By itself it is judged by what others measure, and a measurement is one row of a file.

    Attributes:
        label: its number.
        claim: what it says in words.
        file: the data file with the rows that it is judged by.
        beside: another file, whose columns are put beside those of the rows with the same key, as ``NAME_reported``.
        rules: what is judged of every case.
        quick, full: cases of the catalogue, families and levels of the quick and of the full study.
        of_every_case: whether it is measured on every case of a run, those of users too.
    """

    label: str
    claim: str
    file: DataFile
    beside: CsvFile | None = None
    rules: Sequence[Rule] = ()
    quick: Sequence[Any] = ()
    full: Sequence[Any] = ()
    of_every_case: bool = False

    def places(self, full: bool) -> Sequence[Any]:
        """``full`` or ``quick``, unless they depend on what meshes serve a body."""
        return self.full if full else self.quick

    def settings(self, scope: Scope) -> Sequence[Any]:
        """Where it is measured in a study of some cases: the places with one of them."""
        return [setting for setting in self.places(scope.full) if setting.case in scope.cases]

    def measure(self, setting: Any) -> Mapping[str, Any]:
        """Named numbers for one setting."""
        raise NotImplementedError(f"{type(self).__name__}: nothing is measured")

    def records(self, setting: Any, found: Mapping[str, Any]) -> Iterator[tuple[DataFile, Row]]:
        """The rows that a measurement gives to data files."""
        yield self.file, found

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        """Rows of the ledger from the rows of its data file, with what is predicted of their cases; solves nothing."""
        cases = [(str(case), by_family(mine)) for case, mine in rows.groupby("case", sort=False)]
        return [rule.verdict(self, case, groups) for case, groups in cases for rule in self.rules]

    def cost(self, setting: Any) -> float:
        """Expected time of ``measure`` in µs."""
        return 0.0

    def memory(self, setting: Any) -> float:
        """Bytes that the process of ``measure`` takes at most, by estimate."""
        return estimates.SMALL

    def steps(self, setting: Any) -> int:
        """Time steps that follow from the setting, part of what a result is known by; 0 if ``measure`` sets them."""
        return 0

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other)

    def __hash__(self) -> int:
        return hash(type(self))


SEED = 2002
"""Of whatever is random in a measurement."""
EVOLVING = ("full-contact", "advance-recede", "travelling-patch", "yield-and-release", "yield-on-a-part")
"""Cases that stand for others where something is measured of trajectories: linear laws, moving fronts, law (3.3)."""
SOFTENING = ("softening", "double-well")
"""Cases whose G is not monotone, linear and not: of them (3.2) holds and no more."""
LISTED = CsvFile(
    "statements.csv",
    ("label", "case", "family", "level"),
    ("label", "case", "family", "level", "h", "quantity", "value"),
)
"""Measurements of most statements: a row for each number."""


class ListedNumbers(Statement):
    """A statement whose numbers are listed one by one in ``statements.csv``.

    Attributes:
        effort: how many times as long as most it takes at the same level.
    """

    file: DataFile = LISTED
    effort: float = 1.0

    def records(self, setting: Setting, found: Mapping[str, float]) -> Iterator[tuple[DataFile, Row]]:
        """A row for every number but the mesh size."""
        common = {"label": self.label, **vars(setting), "h": found["h"]}
        for quantity, value in found.items():
            if quantity != "h":
                yield self.file, {**common, "quantity": quantity, "value": value}

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        return judge(self, rows, self.rules)

    def cost(self, setting: Setting) -> float:
        """By level and dimension alone."""
        return self.effort * float(setting.level**2) * (230 if setting.dim == 2 else 30_000)

    def memory(self, setting: Setting) -> float:
        """The largest of all such statements."""
        return estimates.statement(setting.dim, setting.level)


def grid(cases: Sequence[str], families: Sequence[str], levels: Sequence[int]) -> list[Setting]:
    """Every case on every family and level."""
    return [Setting(case, family, n) for case in cases for family in families for n in levels]


def with_h(h: float, values: Mapping[str, float]) -> dict[str, float]:
    """What ``measure`` returns of numbers that are listed one by one."""
    return {"h": h, **{name: float(value) for name, value in values.items()}}

"""What stands in the ledger: where it is measured, what is measured, and when it holds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import pandas as pd

from study.fem.naming import resolve
from study.ledger.datafiles import CsvFile, DataFile, Row
from study.ledger.verdict import Verdict
from study.statements.shared import estimates
from study.statements.shared.scope import Scope


@dataclass(frozen=True, order=True)
class Setting:
    """One measurement: a case on one mesh.

    Attributes:
        case: name in the catalogue, or FILE.py:NAME.
        family: name of the mesh family.
        level: n.
    """

    case: str
    family: str
    level: int


class Statement(Protocol):
    """A numbered statement of the source, or a question beyond it.

    Attributes:
        label: its number.
        claim: what it says in words.
        file: the data file with the rows that it is judged by.
        of_every_case: whether it is measured on every case of a run, those of users too.
    """

    @property
    def label(self) -> str: ...
    @property
    def claim(self) -> str: ...
    @property
    def file(self) -> DataFile: ...
    @property
    def of_every_case(self) -> bool: ...

    def settings(self, scope: Scope) -> Sequence[Any]:
        """Where it is measured in a study of some cases."""
        ...

    def measure(self, setting: Any) -> Mapping[str, Any]:
        """Named numbers for one setting."""
        ...

    def records(self, setting: Any, found: Mapping[str, Any]) -> Iterator[tuple[DataFile, Row]]:
        """The rows that a measurement gives to data files."""
        ...

    def judge(self, rows: pd.DataFrame) -> list[Verdict]:
        """Rows of the ledger from the rows of its data file, with what is predicted of their cases; solves nothing."""
        ...

    def cost(self, setting: Any) -> float:
        """Expected time of ``measure`` in µs."""
        ...

    def memory(self, setting: Any) -> float:
        """Bytes that the process of ``measure`` takes at most, by estimate."""
        ...

    def steps(self, setting: Any) -> int:
        """Time steps that follow from the setting, which is part of what a result is known by; 0 for none."""
        ...


LISTED = CsvFile(
    "statements.csv",
    ("label", "case", "family", "level"),
    ("label", "case", "family", "level", "h", "quantity", "value"),
)
"""Measurements of most statements: a row for each number."""


class ListedNumbers:
    """What statements have in common whose numbers are listed one by one in ``statements.csv``.

    They say with ``places(full)`` on which cases of the catalogue, families and levels they are measured in the quick
    or the full study.
    """

    label: str
    file: DataFile = LISTED
    of_every_case: bool = False

    def places(self, full: bool) -> list[Setting]:
        """Where it is measured in the quick or the full study."""
        raise NotImplementedError

    def settings(self, scope: Scope) -> list[Setting]:
        """The places with a case of the study."""
        return [setting for setting in self.places(scope.full) if setting.case in scope.cases]

    def records(self, setting: Setting, found: Mapping[str, float]) -> Iterator[tuple[DataFile, Row]]:
        """A row for every number but the mesh size."""
        common = {"label": self.label, **vars(setting), "h": found["h"]}
        for quantity, value in found.items():
            if quantity != "h":
                yield self.file, {**common, "quantity": quantity, "value": value}

    def cost(self, setting: Setting) -> float:
        """By level and dimension alone."""
        dim = resolve(setting.case).solution.body.dim
        return float(setting.level**2) * (230 if dim == 2 else 30_000)

    def memory(self, setting: Setting) -> float:
        """The largest of all such statements."""
        return estimates.statement(resolve(setting.case).solution.body.dim, setting.level)

    def steps(self, setting: Setting) -> int:
        """None, or as many as ``measure`` takes by itself."""
        return 0


class NothingMeasured:
    """What statements have in common that are judged by measurements of others, or by none."""

    of_every_case: bool = False

    def settings(self, scope: Scope) -> list[Setting]:
        """None."""
        return []

    def measure(self, setting: Setting) -> Mapping[str, float]:
        """Never called."""
        raise NotImplementedError(f"{type(self).__name__}: nothing is measured")

    def records(self, setting: Setting, found: Mapping[str, float]) -> Iterator[tuple[DataFile, Row]]:
        """None."""
        return iter(())

    def cost(self, setting: Setting) -> float:
        """Nothing."""
        return 0.0

    def memory(self, setting: Setting) -> float:
        """Nothing."""
        return 0.0

    def steps(self, setting: Setting) -> int:
        """None."""
        return 0


def grid(cases: Sequence[str], families: Sequence[str], levels: Sequence[int]) -> list[Setting]:
    """Every case on every family and level."""
    return [Setting(case, family, n) for case in cases for family in families for n in levels]


def with_h(h: float, values: Mapping[str, float]) -> dict[str, float]:
    """What ``measure`` returns of numbers that are listed one by one."""
    return {"h": h, **{name: float(value) for name, value in values.items()}}

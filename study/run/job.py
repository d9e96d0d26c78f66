"""One piece of work of a run: a statement, measured in one setting."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from study.fem.naming import name_of
from study.ledger.datafiles import DataFile, Row
from study.run.fingerprint import fingerprint
from study.statements.shared.base import Setting, Statement


@dataclass(frozen=True)
class Job:
    """What a statement measures in one setting; small, and can be sent to other processes."""

    statement: Statement
    setting: Setting

    @property
    def identity(self) -> tuple[str, ...]:
        """The name of its data file and the key of its rows there, as text."""
        known = {"label": self.statement.label, "case": name_of(self.setting.case)}
        key = (str(known.get(column) or getattr(self.setting, column)) for column in self.statement.file.key)
        return self.statement.file.name, *key

    @property
    def key(self) -> str:
        """The name of its file among finished work."""
        kind, *key = (re.sub(r"[^\w.]+", "-", part).strip("-") for part in self.identity)
        return "__".join([kind.removesuffix(".csv"), *(f"{part:0>5}" if part.isdigit() else part for part in key)])

    @property
    def cost(self) -> float:
        """Expected time in µs."""
        return self.statement.cost(self.setting)

    @property
    def memory(self) -> float:
        """Bytes that its process takes at most."""
        return self.statement.memory(self.setting)

    def fingerprint(self) -> str:
        """A hash of all that its result depends on."""
        return fingerprint(self.statement, self.setting)

    def run(self) -> Mapping[str, Any]:
        """Measure."""
        return self.statement.measure(self.setting)

    def records(self, found: Mapping[str, Any]) -> Iterator[tuple[DataFile, Row]]:
        """The rows that its result gives to data files."""
        return self.statement.records(self.setting, found)

"""What data must say before they are looked at: their plan, and what is predicted of their cases.

A run records what it is about (``recorded``). From that alone, the catalogue, and the files of its own cases where they
are still there, everything follows that was not measured. Of an own case whose file is gone the record is believed.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from manufactured.case import Case
from study.fem.naming import resolve
from study.ledger.datafiles import DataError, made_by
from study.run.case_line import describe
from study.run.plan import Plan
from study.statements.shared.scope import Levels, Scope

NAMES = ("plane", "rough", "solid")


def recorded(scope: Scope, directory: Path) -> dict[str, Any]:
    """What a run is about, for its provenance: its scope, and the lines of its own cases, files relative to it."""
    names = [portable(name, directory) for name in scope.cases]
    own = {name: describe(case) for name, case in zip(names, scope.resolved(), strict=True) if ":" in name}
    return {"scope": {**asdict(scope), "cases": names}, "own_cases": own}


def portable(reference: str, directory: Path) -> str:
    """FILE.py:NAME with the path as seen from a directory; other names as they are."""
    file, colon, name = reference.rpartition(":")
    return f"{Path(os.path.relpath(file, directory)).as_posix()}:{name}" if colon else reference


@dataclass(frozen=True)
class Foreseen:
    """What data must say.

    Attributes:
        plan: what was to be measured; None if the file of an own case is gone.
        cases: the cases that can be looked up.
        lines: of ``cases.csv``.
    """

    plan: Plan | None
    cases: dict[str, Case]
    lines: list[dict[str, Any]]

    @classmethod
    def of(cls, made: Mapping[str, Any], directory: Path) -> Foreseen:
        """From the provenance of a run.

        Raises:
            DataError: it does not say what the run is about.
            UsageError: the file of an own case does not define it any longer.
        """
        if not {"scope", "own_cases"} <= set(made):
            raise DataError(
                f"{directory}/data/provenance.json does not say what the run was about, as an older version wrote it: "
                f"`{made_by(directory)}` with the options of then writes it again; what is measured is kept"
            )
        scope, own = made["scope"], made["own_cases"]
        references = [found(reference, directory) for reference in scope["cases"]]
        cases = [resolve(reference) if reference else None for reference in references]
        lines = [describe(case) if case else own[name] for case, name in zip(cases, scope["cases"], strict=True)]
        whole = None not in references
        plan = Plan.of(read_scope({**scope, "cases": tuple(references)})) if whole else None
        return cls(plan, {case.name: case for case in cases if case}, lines)

    @property
    def gone(self) -> set[str]:
        """The cases whose file is gone."""
        return {str(line["case"]) for line in self.lines} - set(self.cases)

    def proposition(self, case: str) -> str:
        """The numbered statement that a case is a case of, "" for one that is none of the run."""
        of_case = [line["statements"] for line in self.lines if line["case"] == case]
        return str(of_case[0]).partition(", ")[0] if of_case else ""


def found(reference: str, directory: Path) -> str | None:
    """A recorded reference as it is resolved, None if its file is gone."""
    file, colon, name = reference.rpartition(":")
    if not colon:
        return reference
    path = (directory / file).resolve()
    return f"{path}:{name}" if path.is_file() else None


def read_scope(values: Mapping[str, Any]) -> Scope:
    """A scope from its fields as JSON has them."""
    lists = {name: tuple(values[name]) for name in ("equivalence", "solid_equivalence")}
    own = tuple((name, read_levels(levels)) for name, levels in values["own"])
    return Scope(**{**values, **lists, **{name: read_levels(values[name]) for name in NAMES}, "own": own})


def read_levels(values: Mapping[str, Any]) -> Levels:
    """Levels from their fields as JSON has them."""
    return Levels(tuple(values["all"]), tuple(values["first"]))

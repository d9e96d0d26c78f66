"""What made the data of a finished run, what it promised to contain and whether it does, and where the code is."""

from __future__ import annotations

import inspect
import platform
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from study.ledger.errors import UsageError
from study.ledger.measures import exactly
from study.ledger.verdict import HOLDS, UNDECIDED, Verdict, row
from study.ledger.window import at_most
from study.run.code import ROOT
from study.run.fingerprint import packages
from study.run.foreseen import recorded
from study.run.plan import Plan
from study.run.store import FORMAT, Store, require_format
from study.statements import STATEMENTS
from study.statements.unmeasured import Listed


def provenance(plan: Plan, directory: Path) -> dict[str, Any]:
    """What made the data in a directory: format, what they are about, plan, versions.

    No date, so that equal runs give equal files.
    """
    return {
        "format": FORMAT,
        "study": version("signorini-study"),
        "plan": plan.scope.name,
        **recorded(plan.scope, directory),
        "planned": plan.keys(),
        "statements": sources(),
        "python": platform.python_version(),
        "machine": platform.machine(),
        "packages": packages(),
    }


def sources() -> dict[str, dict[str, Any]]:
    """Return for each label the files of its ``code``, from the root of the repository, and its ``data`` files."""
    complete = Path(inspect.getfile(Complete)).relative_to(ROOT).as_posix()
    found: dict[str, dict[str, Any]] = {Complete.label: {"code": [complete], "data": ["provenance.json"]}}
    for statement in STATEMENTS:
        file = Path(inspect.getfile(type(statement))).relative_to(ROOT).as_posix()
        data = "claims.csv" if isinstance(statement, Listed) else statement.file.name
        of = found.setdefault(statement.label, {"code": [], "data": []})
        for name, one in (("code", file), ("data", data)):
            of[name] += [one] if one not in of[name] else []
    return found


def read_provenance(directory: Path) -> dict[str, Any]:
    """``provenance.json`` of a finished run.

    Raises:
        UsageError: there is none.
        StoreError: it is of another format, or damaged.
    """
    path = directory / "data" / "provenance.json"
    if not path.is_file():
        raise UsageError(f"{path.parent} holds no finished run; make one with: study run --out {directory}")
    content = Store.read(path)
    require_format(path, content)
    assert content is not None
    return content


def protect(plan: Plan, directory: Path) -> None:
    """Refuse a run that would replace a larger one on disk.

    Raises:
        UsageError: rows of the finished run are not in the plan.
    """
    if (directory / "data" / "provenance.json").exists():
        lost = {tuple(key) for key in read_provenance(directory)["planned"]} - set(plan.keys())
        if lost:
            raise UsageError(
                f"{directory} holds a run with {len(lost)} rows that this one does not have (such as "
                f"{' '.join(min(lost))}); give another directory with --out, or remove that one"
            )


@dataclass(frozen=True)
class Complete:
    """Whether the data are those of the plan: a missing family or level would make a verdict easier."""

    label: str = "data"
    claim: str = "every planned measurement is there"

    def judge(self, planned: set[tuple[str, ...]], found: set[tuple[str, ...]]) -> Verdict:
        """Its only row."""
        missing = sorted(planned - found)
        quantity = "rows of the plan that are missing" + (f", first {' '.join(missing[0])}" if missing else "")
        judged = *exactly(len(missing)), UNDECIDED if missing else HOLDS
        return row(self, "missing", quantity, at_most(0, f"of {len(planned)}"), judged, "all cases")

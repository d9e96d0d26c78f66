"""The provenance of the data of a run: the plan, the code and versions that made the data, and checksums.

A run records its scope in ``data/provenance.json``. The plan and the predictions can be computed again from the scope,
the catalogue and the files of the user's cases (``Expectation``). If the file of a case no longer exists, the recorded
values are used.
"""

from __future__ import annotations

import hashlib
import inspect
import os
import platform
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from manufactured.case import Case
from study.fem.naming import resolve
from study.ledger.criterion import exactly
from study.ledger.datafiles import DataError, made_by
from study.ledger.files import UsageError
from study.ledger.verdict import HOLDS, UNDECIDED, Verdict, row
from study.ledger.window import at_most
from study.run.case_line import describe
from study.run.fingerprint import ROOT, packages
from study.run.plan import Plan
from study.run.store import FORMAT, Store, require_format
from study.statements import STATEMENTS
from study.statements.shared.scope import Levels, Scope
from study.statements.unmeasured import Listed

SUMS = "sha256"
"""The key of ``provenance.json`` for the checksums: names of files in ``data`` and the SHA-256 of their text."""


def provenance(plan: Plan, directory: Path) -> dict[str, Any]:
    """Return the content of ``provenance.json``, without checksums.

    It has no date, so that equal runs give equal files. Paths of users' cases are relative to the directory.
    """
    scope = plan.scope
    names = [relative_reference(name, directory) for name in scope.cases]
    own = {name: describe(case) for name, case in zip(names, scope.resolved(), strict=True) if ":" in name}
    return {
        "format": FORMAT,
        "study": version("signorini-study"),
        "plan": scope.name,
        "scope": {**asdict(scope), "cases": names},
        "own_cases": own,
        "planned": plan.keys(),
        "statements": sources(),
        "python": platform.python_version(),
        "machine": platform.machine(),
        "packages": packages(),
    }


def sources() -> dict[str, dict[str, Any]]:
    """Return for each label its ``code`` files, relative to the root of the repository, and its ``data`` files."""
    complete = Path(inspect.getfile(Complete)).relative_to(ROOT).as_posix()
    entries: dict[str, dict[str, Any]] = {Complete.label: {"code": [complete], "data": ["provenance.json"]}}
    for statement in STATEMENTS:
        code = Path(inspect.getfile(type(statement))).relative_to(ROOT).as_posix()
        data = "claims.csv" if isinstance(statement, Listed) else statement.file.name
        entry = entries.setdefault(statement.label, {"code": [], "data": []})
        for name, value in (("code", code), ("data", data)):
            entry[name] += [value] if value not in entry[name] else []
    return entries


def read_provenance(directory: Path) -> dict[str, Any]:
    """Return the content of ``provenance.json`` of a finished run.

    Raises:
        UsageError: the directory has no such file.
        StoreError: the file is of another format, or damaged.
    """
    path = directory / "data" / "provenance.json"
    if not path.is_file():
        raise UsageError(f"{path.parent} holds no finished run; make one with: study run --out {directory}")
    content = Store.read(path)
    require_format(path, content)
    assert content is not None
    return content


def refuse_to_replace(plan: Plan, directory: Path) -> None:
    """Raise UsageError if the run on disk has rows that the plan lacks, because a new run would lose them."""
    if (directory / "data" / "provenance.json").exists():
        lost = {tuple(key) for key in read_provenance(directory)["planned"]} - set(plan.keys())
        if lost:
            raise UsageError(
                f"{directory} holds a run with {len(lost)} rows that this one does not have (such as "
                f"{' '.join(min(lost))}); give another directory with --out, or remove that one"
            )


@dataclass(frozen=True)
class Complete:
    """The first check of the ledger: a missing mesh family or level would make other checks easier to satisfy."""

    label: str = "data"
    claim: str = "all planned measurements are present"

    def judge(self, planned: set[tuple[str, ...]], measured: set[tuple[str, ...]]) -> Verdict:
        """Return the check; it is undecided if planned rows are missing."""
        missing = sorted(planned - measured)
        quantity = "missing measurements" + (f", first {' '.join(missing[0])}" if missing else "")
        judged = *exactly(len(missing)), UNDECIDED if missing else HOLDS
        return row(self, "missing", quantity, at_most(0, f"of {len(planned)}"), judged, "all cases")


@dataclass(frozen=True)
class Expectation:
    """The values in the data of a run that are known without a measurement.

    Attributes:
        plan: the jobs; None if the file of a user's case no longer exists.
        cases: the cases that can be resolved, by name.
        lines: the lines of ``cases.csv``.
    """

    plan: Plan | None
    cases: dict[str, Case]
    lines: list[dict[str, Any]]

    @classmethod
    def of(cls, record: Mapping[str, Any], directory: Path) -> Expectation:
        """Return the expectation from the provenance of a run.

        Raises:
            DataError: an older version wrote the provenance, without the scope.
            UsageError: the file of a user's case no longer defines it.
        """
        if not {"scope", "own_cases"} <= set(record):
            raise DataError(
                f"{directory}/data/provenance.json has no scope, because an older version wrote it: "
                f"`{made_by(directory)}` with the same options writes it again; finished measurements are kept"
            )
        scope, own = record["scope"], record["own_cases"]
        references = [resolve_path(reference, directory) for reference in scope["cases"]]
        cases = [resolve(reference) if reference else None for reference in references]
        lines = [describe(case) if case else own[name] for case, name in zip(cases, scope["cases"], strict=True)]
        plan = None if None in references else Plan.of(read_scope({**scope, "cases": tuple(references)}))
        return cls(plan, {case.name: case for case in cases if case}, lines)

    @property
    def gone(self) -> set[str]:
        """The names of the cases whose file no longer exists."""
        return {str(line["case"]) for line in self.lines} - set(self.cases)

    def proposition(self, case: str) -> str:
        """Return the proposition whose hypotheses a case satisfies; an empty text if the case is not in the run."""
        statements = [line["statements"] for line in self.lines if line["case"] == case]
        return str(statements[0]).partition(", ")[0] if statements else ""


def relative_reference(reference: str, directory: Path) -> str:
    """Return FILE.py:NAME with the path relative to a directory; return other references unchanged."""
    file, colon, name = reference.rpartition(":")
    return f"{Path(os.path.relpath(file, directory)).as_posix()}:{name}" if colon else reference


def resolve_path(reference: str, directory: Path) -> str | None:
    """Return a recorded reference with its full path; None if its file is gone; catalogue names are unchanged."""
    file, colon, name = reference.rpartition(":")
    if not colon:
        return reference
    path = (directory / file).resolve()
    return f"{path}:{name}" if path.is_file() else None


def read_scope(values: Mapping[str, Any]) -> Scope:
    """Return a scope from its fields in JSON."""

    def levels(fields: Mapping[str, Any]) -> Levels:
        return Levels(tuple(fields["all"]), tuple(fields["first"]))

    lists = {name: tuple(values[name]) for name in ("equivalence", "solid_equivalence")}
    by_kind = {name: levels(values[name]) for name in ("plane", "rough", "solid")}
    return Scope(**{**values, **lists, **by_kind, "own": tuple((name, levels(of)) for name, of in values["own"])})


def text_sum(path: Path) -> str:
    """Return the SHA-256 of a text file with Unix line ends, because git may change line ends."""
    return hashlib.sha256(path.read_bytes().replace(b"\r\n", b"\n")).hexdigest()


def sums_of(data: Path, paths: Iterable[Path]) -> dict[str, str]:
    """Return the checksums of files in a data directory, by their names relative to it."""
    return {path.relative_to(data).as_posix(): text_sum(path) for path in sorted(paths)}


def compare_sums(directory: Path) -> set[Path]:
    """Compare the data files of a run with the checksums in its provenance; return the files that have a checksum.

    Raises:
        DataError: a file is missing or was changed after the run.
    """
    data = directory / "data"
    recorded: dict[str, str] = read_provenance(directory).get(SUMS, {})
    for name, expected in recorded.items():
        path = data / name
        if not path.is_file() or text_sum(path) != expected:
            what = "was changed after the run that wrote it" if path.is_file() else "is missing"
            raise DataError(f"{path} {what}: restore it, or make it again with `{made_by(directory)}`")
    return {data / name for name in recorded}

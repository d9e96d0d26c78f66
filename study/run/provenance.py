"""The provenance of the data of a run: what was planned, which code and versions made the data, and their checksums.

A run records its scope in ``data/provenance.json``. The scope, the catalogue and the files of the user's cases
determine the plan and the predictions again (``Expectation``). If the file of a case is gone, the record is believed.
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
"""The entry of ``provenance.json`` with the checksums: name of a file in ``data`` ↦ SHA-256 of its text."""


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
    """Return for each label the files of its ``code``, from the root of the repository, and its ``data`` files."""
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
    """Refuse a run that would replace a larger one; UsageError if the run on disk has rows that the plan lacks."""
    if (directory / "data" / "provenance.json").exists():
        lost = {tuple(key) for key in read_provenance(directory)["planned"]} - set(plan.keys())
        if lost:
            raise UsageError(
                f"{directory} holds a run with {len(lost)} rows that this one does not have (such as "
                f"{' '.join(min(lost))}); give another directory with --out, or remove that one"
            )


@dataclass(frozen=True)
class Complete:
    """The first row of the ledger: a missing mesh family or level would make other rows easier to satisfy."""

    label: str = "data"
    claim: str = "all planned measurements are present"

    def judge(self, planned: set[tuple[str, ...]], measured: set[tuple[str, ...]]) -> Verdict:
        """Return the row; undecided if planned rows are missing."""
        missing = sorted(planned - measured)
        quantity = "missing measurements" + (f", first {' '.join(missing[0])}" if missing else "")
        judged = *exactly(len(missing)), UNDECIDED if missing else HOLDS
        return row(self, "missing", quantity, at_most(0, f"of {len(planned)}"), judged, "all cases")


@dataclass(frozen=True)
class Expectation:
    """What the data of a run must say, as far as nothing has to be measured for it.

    Attributes:
        plan: the jobs; None if the file of a user's case is gone.
        cases: the cases that can be looked up, by name.
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
            UsageError: the file of a user's case does not define it any longer.
        """
        if not {"scope", "own_cases"} <= set(record):
            raise DataError(
                f"{directory}/data/provenance.json does not say what the run was about, as an older version wrote it: "
                f"`{made_by(directory)}` with the options of then writes it again; what is measured is kept"
            )
        scope, own = record["scope"], record["own_cases"]
        references = [resolve_path(reference, directory) for reference in scope["cases"]]
        cases = [resolve(reference) if reference else None for reference in references]
        lines = [describe(case) if case else own[name] for case, name in zip(cases, scope["cases"], strict=True)]
        plan = None if None in references else Plan.of(read_scope({**scope, "cases": tuple(references)}))
        return cls(plan, {case.name: case for case in cases if case}, lines)

    @property
    def gone(self) -> set[str]:
        """The names of the cases whose file is gone."""
        return {str(line["case"]) for line in self.lines} - set(self.cases)

    def proposition(self, case: str) -> str:
        """Return the proposition whose hypotheses a case satisfies; "" for a case that is not part of the run."""
        statements = [line["statements"] for line in self.lines if line["case"] == case]
        return str(statements[0]).partition(", ")[0] if statements else ""


def relative_reference(reference: str, directory: Path) -> str:
    """Return FILE.py:NAME with the path relative to a directory; other references unchanged."""
    file, colon, name = reference.rpartition(":")
    return f"{Path(os.path.relpath(file, directory)).as_posix()}:{name}" if colon else reference


def resolve_path(reference: str, directory: Path) -> str | None:
    """Return a recorded reference with its full path, None if its file is gone; catalogue names unchanged."""
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
    """Return the SHA-256 of a text file with Unix line ends, whatever line ends git has given it."""
    return hashlib.sha256(path.read_bytes().replace(b"\r\n", b"\n")).hexdigest()


def sums_of(data: Path, paths: Iterable[Path]) -> dict[str, str]:
    """Return the checksums of some files in a data directory, by their names relative to it."""
    return {path.relative_to(data).as_posix(): text_sum(path) for path in sorted(paths)}


def compare_sums(directory: Path) -> set[Path]:
    """Compare the data files of a run with the checksums in its provenance; returns the files that have one.

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

"""The provenance of the data of a run: a record of how they were made, in ``data/provenance.json``.

The file has the scope and the plan of the run, the commit of the code, the versions of Python and of the libraries, the
code and data files of each statement, and checksums of the data files. The plan and the predictions can also be
computed again from the scope, the catalogue of cases and the files of users' cases (``recorded_plan``).
"""

from __future__ import annotations

import inspect
import os
import platform
import subprocess
from contextlib import suppress
from dataclasses import asdict, replace
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path

from pandas import DataFrame

from study.ledger.datafiles import DataError, Key, made_by, nested_keys, planned_keys, read_uncompressed
from study.ledger.files import Json, StoreError, UsageError
from study.ledger.verdict import HOLDS, UNDECIDED, CheckKind, Verdict, row
from study.ledger.window import at_most
from study.run.fingerprint import ROOT, packages
from study.run.plan import Plan
from study.run.store import STORE_FORMAT, Store, require_format
from study.statements import STATEMENTS
from study.statements.shared.scope import Levels, Scope
from study.statements.unmeasured import Listed

SUMS = "sha256"
"""The key in ``provenance.json`` for the checksums: name of a file in ``data`` ↦ SHA-256 of its text."""


def provenance(plan: Plan, directory: Path) -> Json:
    """Return the content of ``provenance.json`` without the checksums.

    It contains no date, so that equal runs give equal files.

    Parameters:
        plan: the plan of the run.
        directory: the result directory, to which the paths of users' cases are relative.
    """
    scope = plan.scope
    names = []
    for reference in scope.cases:
        file, colon, name = reference.rpartition(":")
        names.append(f"{Path(os.path.relpath(file, directory)).as_posix()}:{name}" if colon else reference)
    return dict(
        format=STORE_FORMAT,
        study=version("signorini-study"),
        **commit(),
        plan=scope.name,
        scope={**asdict(scope), "cases": names},
        planned=nested_keys(plan.keys()),
        statements=sources(),
        python=platform.python_version(),
        machine=platform.machine(),
        packages=packages(),
    )


def commit() -> Json:
    """Return the commit of the code, and whether no file of ``study`` and ``manufactured`` differs from the commit.

    Without a git repository, as after an installation from a wheel, the commit is empty.

    Returns:
        A dict with the keys "commit", the hash of the commit or "", and "clean", whether no file differs from it.
    """
    name = ""
    changes = ""
    # A package that is installed below another repository does not belong to it.
    if (ROOT / ".git").exists():
        with suppress(OSError, subprocess.CalledProcessError):
            name = _git("rev-parse", "HEAD")
            changes = _git("status", "--porcelain", "--untracked-files=all", "--", "study", "manufactured")
    return {"commit": name, "clean": bool(name) and not changes}


def _git(*words: str) -> str:
    return subprocess.run(["git", *words], cwd=ROOT, check=True, capture_output=True, text=True).stdout.strip()


def sources() -> dict[str, Json]:
    """Return the code files and the data files of each statement.

    Returns:
        Label of the statement, such as "Prop. 5.4" ↦ {"code": paths of files relative to the root of the
        repository, "data": names of files in ``data``}.
    """
    places: list[tuple[type, str, str]] = [(Complete, Complete.label, "provenance.json")]
    for statement in STATEMENTS:
        data = "claims.csv" if isinstance(statement, Listed) else statement.file.name
        places.append((type(statement), statement.label, data))
    files = [(label, Path(inspect.getfile(kind)).relative_to(ROOT).as_posix(), data) for kind, label, data in places]
    of_labels = DataFrame(files, columns=["label", "code", "data"]).groupby("label", sort=False)
    return of_labels.agg(lambda paths: [*dict.fromkeys(paths)]).to_dict("index")


def read_provenance(directory: Path) -> Json:
    """Return the content of ``provenance.json`` in a result directory, with the keys of planned rows as a list.

    Raises:
        UsageError: the directory has no such file.
        StoreError: the file has another format or is damaged, or a part of it has another type than expected.
    """
    path = directory / "data" / "provenance.json"
    if not path.is_file():
        raise UsageError(f"{path.parent} holds no finished run; make one with: study run --out {directory}")
    content = Store.read(path)
    require_format(path, content)
    assert content is not None
    try:
        content.get(SUMS, {}).items()
        return {**content, "planned": planned_keys(content)}
    except (AttributeError, TypeError) as error:
        raise damaged(directory, error) from error


def damaged(directory: Path, error: Exception) -> StoreError:
    """Return the error for a provenance record with entries of other types or names than expected.

    Parameters:
        directory: the result directory.
        error: the exception that was raised when the record was read.
    """
    data = directory / "data"
    return StoreError(
        f"{data}/provenance.json is damaged, or another version wrote it ({error}): restore it, or remove {data} and "
        "run again"
    )


def refuse_to_replace(plan: Plan, directory: Path) -> None:
    """Raise UsageError if a run would lose data.

    Data are lost if the directory has rows of an earlier run that are not in the plan of this run.
    """
    if (directory / "data" / "provenance.json").exists():
        lost = set(read_provenance(directory)["planned"]) - set(plan.keys())
        if lost:
            raise UsageError(
                f"{directory} holds a run with {len(lost)} rows that this one does not have (such as "
                f"{' '.join(min(lost))}); give another directory with --out, or remove that one"
            )


class Complete:
    """The first check, that is the first row of ``claims.csv``: no planned measurement is missing.

    Without this check, a missing mesh family or level could make other checks hold.
    """

    label = "data"
    claim = "all planned measurements are present"

    def judge(self, planned: set[Key], measured: set[Key]) -> Verdict:
        """Return the verdict on completeness: undecided if the tables lack rows that were planned.

        Parameters:
            planned: the keys of the planned rows.
            measured: the keys of the rows in the tables.
        """
        missing = sorted(planned - measured)
        quantity = "missing measurements" + (f", first {' '.join(missing[0])}" if missing else "")
        count = float(len(missing))
        judged = count, (count, count), UNDECIDED if missing else HOLDS
        return row(
            self, "missing", quantity, at_most(0, f"of {len(planned)}"), judged, "all cases", kind=CheckKind.ACCURACY
        )


def recorded_plan(record: Json, directory: Path) -> Plan:
    """Return the plan of a run, computed again from its recorded scope (cases, mesh families, levels, time scheme).

    Nothing is measured.

    Parameters:
        record: the content of ``provenance.json``.
        directory: the result directory, to which the paths of users' cases are relative.

    Raises:
        DataError: the provenance was written by an older version and lacks the scope.
        StoreError: the scope is damaged.
        UsageError: the file of a user's case does not exist, or does not define the case.
    """
    if "scope" not in record:
        raise DataError(
            f"{directory}/data/provenance.json has no scope, because an older version wrote it: "
            f"`{made_by(directory)}` with the same options writes it again; finished measurements are kept"
        )
    try:
        scope = read_scope(record["scope"])
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise damaged(directory, error) from error
    cases = []
    for reference in scope.cases:
        file, colon, name = reference.rpartition(":")
        cases.append(f"{(directory / file).resolve()}:{name}" if colon else reference)
    return Plan.of(replace(scope, cases=tuple(cases)))


def read_scope(values: Json) -> Scope:
    """Return the scope of a run: its cases, mesh families, levels and time scheme.

    Parameters:
        values: the attributes of the scope in ``provenance.json``, in which tuples became lists.
    """

    def levels(fields: Json) -> Levels:
        return Levels(tuple(map(int, fields["all"])), tuple(map(int, fields["first"])))

    lists = {name: tuple(values[name]) for name in ("equivalence", "solid_equivalence")}
    by_kind = {name: levels(values[name]) for name in ("plane", "rough", "solid")}
    return Scope(**{**values, **lists, **by_kind, "own": tuple((name, levels(of)) for name, of in values["own"])})


def text_sum(path: Path) -> str:
    """Return the SHA-256 of the text in a file, which may be compressed by gzip.

    The text is hashed with Unix line ends, because git may change line ends, and uncompressed, because versions of zlib
    compress equal texts differently. If a file cannot be uncompressed, its bytes are hashed.
    """
    try:
        content = read_uncompressed(path)
    except ValueError:
        content = path.read_bytes()
    return sha256(content.replace(b"\r\n", b"\n")).hexdigest()


def compare_sums(directory: Path) -> set[Path]:
    """Compare the data files of a run with the checksums in its provenance.

    Returns:
        The files with a checksum.

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

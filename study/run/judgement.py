"""Writes the data files of a run from the results of its jobs, reads them, and judges them.

Judging needs the data files only: nothing is solved, and the checks in ``claims.csv`` follow from the other files.
"""

from collections.abc import Iterable, Mapping
from dataclasses import asdict
from json import dumps
from pathlib import Path

from pandas import DataFrame

from manufactured.catalogue import NAMES
from study.fem.naming import describe, resolve
from study.ledger.compare import difference
from study.ledger.datafiles import (
    CsvFile,
    DataError,
    DataFile,
    Row,
    expected_orders,
    made_by,
    read_csv,
    table_text,
    write_csv,
)
from study.ledger.files import Paths, write_text
from study.ledger.schema import SCHEMA
from study.ledger.verdict import Verdicts
from study.run.plan import Job, Jobs, Plan
from study.run.provenance import SUMS, Complete, provenance, read_provenance, text_sum
from study.run.store import Store
from study.statements import STATEMENTS
from study.statements.enclosure import BOUNDS, ENCLOSURES
from study.statements.own_cases import judge_own
from study.statements.prop_5_4 import RATES
from study.statements.shared.base import JOINED_SUFFIX, LISTED, Statement
from study.statements.unmeasured import Listed

PREDICTED = ["case", "expected_order", "proved_order", "twin"]
"""Columns of ``cases.csv`` that are fixed before anything is measured."""


def data_files() -> list[DataFile]:
    """Return all files into which measurements are written."""
    return list(dict.fromkeys([*(statement.file for statement in STATEMENTS), ENCLOSURES]))


def stored_rows(jobs: Iterable[Job], store: Store) -> dict[DataFile, list[Row]]:
    """Return the rows of data files that follow from the stored results of jobs; all results must be stored."""
    rows: dict[DataFile, list[Row]] = {}
    for job in jobs:
        result = store.load(job.key, job.fingerprint())
        assert result is not None, job.key
        for file, row in job.statement.records(job.setting, result):
            rows.setdefault(file, []).append(row)
    return rows


def judge_stored(jobs: Jobs, store: Store) -> Verdicts:
    """Judge the stored results of jobs of one statement and one case, before the data files are written.

    Parameters:
        jobs: at least one job; all have the same statement and the same case.
        store: contains the results of the jobs.

    Returns:
        The checks. The list is empty if these results do not suffice: the statement compares them with another file; or
        they are not rows of a table; or the case is a user's case and the results are not rows of ``rates.csv``, the
        table of errors, without which no user's case is judged.
    """
    statement = jobs[0].statement
    case = jobs[0].case
    file = statement.file
    if statement.joined_file or (case not in NAMES and file != RATES):
        return []
    rows = stored_rows(jobs, store)
    if not isinstance(file, CsvFile) or file not in rows:
        return []
    table = predicted(DataFrame(rows[file]), DataFrame([describe(resolve(case))]))
    return with_reasons(statement.judge(table), table)


def collect(plan: Plan, store: Store) -> None:
    """Write all data files of a run from the stored results of its jobs, with ``cases.csv`` and ``provenance.json``.

    Parameters:
        plan: the plan; the results of all its jobs must be stored.
        store: the result directory.
    """
    rows = stored_rows(plan.jobs, store)
    written = Paths()
    for file in data_files():
        written += file.write(store.data, rows.get(file, []))
    write_csv(store.data / "cases.csv", DataFrame([describe(case) for case in plan.scope.resolved()]))
    sums = {path.relative_to(store.data).as_posix(): text_sum(path) for path in sorted(written)}
    content = {**provenance(plan, store.directory), SUMS: sums}
    write_text(store.data / "provenance.json", dumps(content, separators=(",", ":")) + "\n")


def read_tables(directory: Path) -> dict[CsvFile, DataFrame]:
    """Return all tables of measurements in a result directory.

    Raises:
        DataError: a table is missing or damaged, a number is missing, or a row is repeated; the message names file and
            line.
    """
    return {file: file.read(directory) for file in data_files() if isinstance(file, CsvFile)}


def judge(directory: Path) -> Verdicts:
    """Judge the data in a result directory, write the checks into ``claims.csv`` and return them.

    Raises:
        UsageError: the directory has no data.
        StoreError, DataError: data are of another format, missing or damaged.
    """
    judged = verdicts(directory)
    write_csv(claims_file(directory), claims(judged))
    return judged


def claims_file(directory: Path) -> Path:
    """Return the path of ``claims.csv``, the table of all checks, in a result directory."""
    return directory / "data" / "claims.csv"


def compare_claims(directory: Path, judged: Verdicts) -> None:
    """Raise DataError if ``claims.csv`` is missing or differs from the checks that follow from the data.

    Parameters:
        directory: the result directory.
        judged: the checks that follow from the data, the result of ``verdicts``.
    """
    path = claims_file(directory)
    again = f"`study tables --out {directory}` writes it again"
    if not path.is_file():
        raise DataError(f"{path} is missing: {again}")
    if differs := difference(path, table_text(claims(judged)), frozenset(SCHEMA["claims.csv"].numbers)):
        raise DataError(f"{differs}: {again}")


def claims(judged: Verdicts) -> DataFrame:
    """Return checks as the table ``claims.csv``."""
    return DataFrame([asdict(verdict) for verdict in judged])


def verdicts(directory: Path) -> Verdicts:
    """Compare the data in a result directory with the statements and return all checks; nothing is solved or written.

    A statement is a claim of the paper or of this study. A check compares one measured quantity, such as an order of
    convergence, with the interval that a statement permits. It has a verdict: holds, fails, undecided, missed or
    reported (``study.ledger.verdict``).

    Raises:
        UsageError: the directory has no data.
        StoreError, DataError: data are of another format, missing or damaged.
    """
    planned = set(read_provenance(directory)["planned"])
    tables = read_tables(directory)
    cases = read_csv(directory, "cases.csv", PREDICTED)
    _refuse_gaps(directory, tables)
    measured = set().union(*(file.keys(table) for file, table in tables.items()))
    judged = {file: predicted(table, cases) for file, table in tables.items()}
    # Some statements also need files that ``study run`` does not write, such as the errors of other codes.
    external = {statement.joined_file for statement in STATEMENTS if statement.joined_file} - set(tables)
    judged |= {file: file.read(directory) for file in external}
    rows = [Complete().judge(planned, measured)]
    for statement in STATEMENTS:
        if isinstance(statement.file, CsvFile):
            rows += judge_statement(statement, joined(statement, judged))
    return with_reasons(rows, judged[RATES])


def predicted(table: DataFrame, cases: DataFrame) -> DataFrame:
    """Return a table of measurements with what is known in advance about the case of each row.

    Parameters:
        table: a table with a column ``case``.
        cases: the table ``cases.csv``.

    Returns:
        The table with the new columns ``expected_order`` and ``proved_order``, the orders of convergence that are
        predicted and that are proved for the case; ``twin``, the case whose solution is the same in another position;
        and ``known``, whether the exact solution is known. A column that the table has already is not changed.
    """
    new = [name for name in PREDICTED if name not in table or name == "case"]
    return table.merge(cases[new], on="case", how="left").assign(known=table.case.isin(cases.case).to_numpy())


def joined(statement: Statement, tables: Mapping[CsvFile, DataFrame]) -> DataFrame:
    """Return the rows by which a statement is judged.

    Some statements compare their measurements with the measurements in another file. Then the columns of the other file
    are added, with the suffix ``JOINED_SUFFIX`` in their names.

    Parameters:
        statement: the statement.
        tables: data file ↦ its table.
    """
    assert isinstance(statement.file, CsvFile)
    own_rows = tables[statement.file]
    key = list(statement.file.key)
    if statement.joined_file is None:
        return own_rows
    joined_rows = tables[statement.joined_file].set_index(key).add_suffix(JOINED_SUFFIX).reset_index()
    return own_rows.merge(joined_rows, on=key, how="left")


def with_reasons(verdicts: Verdicts, rates: DataFrame) -> Verdicts:
    """Judge the checks of users' cases again (``judge_own``), and return all checks.

    A tolerance window is the interval in which a measured quantity must lie. In a user's case it may lie outside for
    another reason than a wrong statement: the meshes or the time steps are too coarse, for example, or the formulas
    vary too much within a cell. Then the check is undecided, and its text gives the reason. Without such a reason its
    verdict remains, except that a missed order of the contact force that no statement claims is only reported.

    Parameters:
        verdicts: all checks, of the catalogue and of users' cases.
        rates: the table ``rates.csv`` with the columns that ``predicted`` adds.
    """
    judged = {
        case: iter(judge_own([verdict for verdict in verdicts if verdict.case == case], rows))
        for case, rows in rates.groupby("case")
        if case not in NAMES
    }
    return [next(judged[verdict.case]) if verdict.case in judged else verdict for verdict in verdicts]


def judge_statement(statement: Statement, rows: DataFrame) -> Verdicts:
    """Return the checks of a statement; an empty list if the table has no rows of the statement.

    Parameters:
        statement: the statement.
        rows: the table of the data file of the statement; several statements may use the same file.
    """
    of_all = statement.file != LISTED or isinstance(statement, Listed)
    own_rows = rows if of_all else rows[rows.label == statement.label]
    return statement.judge(own_rows) if len(own_rows) else []


def _refuse_gaps(directory: Path, tables: dict[CsvFile, DataFrame]) -> None:
    """Raise DataError if ``cases.csv`` lacks a measured case, or an error bound has no values over time."""
    of_every_case = [statement.file for statement in STATEMENTS if statement.of_every_case]
    for file, table in tables.items():
        if file in of_every_case:
            expected_orders(directory, table)
    bounds, courses = ({key[1:] for key in file.keys(tables[file])} for file in (BOUNDS, ENCLOSURES))
    if without := bounds - courses:
        path = f"{directory}/data/enclosures.csv"
        again = f"make it with `{made_by(directory)}`"
        raise DataError(f"{path} lacks {' '.join(min(without))}: {again}")

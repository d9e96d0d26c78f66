"""``study check``: compare the data of a run with other data from which they follow, or with a new measurement.

Without a new measurement, the recorded plan is compared with the plan that its scope gives now, the rows with the plan,
``cases.csv`` with the catalogue, and columns with each other (``relations``); no derived column is trusted. With
``--again N`` a random sample of the rows is measured again.
"""

from __future__ import annotations

import tempfile
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from study.ledger.codes import Codes
from study.ledger.compare import Comparison, Tolerance, compare, difference
from study.ledger.datafiles import CsvFile, DataError, Row, line, made_by, read_csv, table_text, write_csv
from study.ledger.files import UsageError
from study.run.executor import Pool, execute
from study.run.judgement import PREDICTED, read_tables
from study.run.plan import Job
from study.run.provenance import Expectation, read_provenance
from study.run.relations import CODE_RELATIONS, FOLDERS, RELATIONS
from study.run.store import Store
from study.statements.enclosure import BOUNDS, ENCLOSURES

SHOWN = 3
"""Number of breaches that a message lists for each relation."""


@dataclass(frozen=True)
class Verified:
    """Numbers of compared items, and the cases whose files no longer exist."""

    rows: int
    files: int
    planned: int
    relations: int
    cases: int
    gone: tuple[str, ...]

    def __str__(self) -> str:
        rest = f"; not compared, because their files no longer exist: {', '.join(self.gone)}" if self.gone else ""
        return (
            f"{self.rows} rows in {self.files} files belong to the {self.planned} planned measurements; "
            f"{self.relations} relations hold in all of them; predictions of {self.cases} cases{rest}"
        )


def verify(directory: Path) -> Verified:
    """Compare the data of a run with its plan, its predictions and each other.

    Raises:
        UsageError: the directory has no data.
        StoreError, DataError: data are of another format, missing, damaged or edited; the message names file, line and
            column, the value and the expected value.
    """
    record = read_provenance(directory)
    again = f"make them again with `{made_by(directory)}`; finished measurements are kept"
    expectation = Expectation.of(record, directory)
    planned = _plan(directory, record, expectation, again)
    tables = read_tables(directory)
    for file, table in tables.items():
        _refuse_unplanned(directory, file, table, planned, again)
    # Predictions come from the catalogue or the file of a case, or from the record of the run if that file is gone.
    path = directory / "data" / "cases.csv"
    read_csv(directory, path.name, PREDICTED)
    if found := difference(path, table_text(pd.DataFrame(expectation.lines))):
        raise DataError(f"{found}: the second is the prediction of the catalogue or of the case's file; {again}")
    broken = [[*map(str, relation(tables, expectation))] for relation in RELATIONS]
    of_codes = [(codes, folder) for folder in FOLDERS if (codes := Codes.read(directory, folder))]
    broken += [[*map(str, relation(*data))] for data in of_codes for relation in CODE_RELATIONS]
    if count := sum(map(len, broken)):
        said = "\n".join(breach for breaches in broken for breach in breaches[:SHOWN])
        raise DataError(f"data in {directory} were edited or damaged, in {count} places such as\n{said}\n{again}")
    rows, gone = sum(map(len, tables.values())), tuple(sorted(expectation.gone))
    return Verified(rows, len(tables), len(planned), len(broken), len(expectation.cases), gone)


def _plan(directory: Path, record: dict[str, Any], expectation: Expectation, again: str) -> set[tuple[str, ...]]:
    """Return the recorded plan; DataError if it is empty, has repeated entries, or differs from its scope's plan."""
    recorded = [tuple(key) for key in record["planned"]]
    where = f"{directory}/data/provenance.json"
    if not recorded:
        raise DataError(f"{where} has an empty plan: {again}")
    if repeated := [key for key, count in Counter(recorded).items() if count > 1]:
        raise DataError(f"{where} plans {' '.join(repeated[0])} twice: {again}")
    if expectation.plan and (other := set(recorded) ^ set(expectation.plan.keys())):
        first, plans = min(other), "plans" if min(other) in recorded else "does not plan"
        raise DataError(
            f"{where} {plans} {' '.join(first)}, which disagrees with its scope ({len(recorded)} rows are recorded, "
            f"{len(expectation.plan.keys())} follow from the scope): {again}"
        )
    return set(recorded)


def _refuse_unplanned(
    directory: Path, file: CsvFile, table: pd.DataFrame, planned: set[tuple[str, ...]], again: str
) -> None:
    """Refuse rows that are not planned; values over time belong to bounds. Missing rows are reported by the ledger."""
    name = BOUNDS.name if file == ENCLOSURES else file.name
    keys = zip(*(table[column].astype(str) for column in file.key), strict=True)
    for row, key in enumerate(keys):
        if (name, *key) not in planned:
            raise DataError(
                f"{directory}/data/{file.name}, line {line(row)}: {' '.join(key)} is not among the {len(planned)} "
                f"measurements of the plan: {again}"
            )


# Measuring again.

LEAST_COST = 0.3e6
"""Least cost in µs with which a measurement is weighted; otherwise the cheapest few would be drawn too often."""


def planned_jobs(directory: Path) -> tuple[Job, ...]:
    """Return every measurement that gives rows to the tables in a directory.

    Pictures are left out, because other processors number the cells of unstructured meshes of symmetric bodies
    differently.

    Raises:
        UsageError: there are no data, or the file of a user's case no longer exists.
    """
    expectation = Expectation.of(read_provenance(directory), directory)
    if expectation.plan is None:
        gone = ", ".join(sorted(expectation.gone))
        raise UsageError(f"--again needs the files of all cases; the files of {gone} no longer exist: put them back")
    return tuple(job for job in expectation.plan.jobs if isinstance(job.statement.file, CsvFile))


def draw_jobs(jobs: Sequence[Job], count: int, seed: int) -> list[Job]:
    """Return a random sample of measurements without repetition; the same seed gives the same sample.

    A measurement is drawn with probability proportional to 1 / cost. The expected time of one draw is then the harmonic
    mean of all costs, about 0.4 s for the full study, however long the most expensive measurement takes.

    Args:
        jobs: all measurements of the plan.
        count: size of the sample; all measurements if there are fewer.
        seed: seed of the random generator, 0 or more.
    """
    weights = 1 / np.maximum([job.cost for job in jobs], LEAST_COST)
    size = min(count, len(jobs))
    drawn = np.random.default_rng(seed).choice(len(jobs), size, replace=False, p=weights / weights.sum())
    return [jobs[i] for i in drawn]


def expected_seconds(jobs: Sequence[Job]) -> float:
    """Return the expected computing time of measurements in seconds."""
    return float(np.maximum([job.cost for job in jobs], LEAST_COST).sum()) / 1e6


def compare_again(
    directory: Path, jobs: Sequence[Job], pool: Pool, tolerance: Tolerance, notify: Callable[[float], None]
) -> Comparison:
    """Measure again and compare the measured columns with the rows on disk; derived columns are not compared.

    Returns:
        The differences; ``old`` are the rows in ``directory``, ``new`` the rows measured now.

    Raises:
        UsageError: a measurement needs more memory than is available.
        JobsError: a measurement failed.
        DataError: a data file is missing or damaged.
    """
    with tempfile.TemporaryDirectory() as temporary:
        old, new = Path(temporary) / "old", Path(temporary) / "new"
        store = Store(new)
        execute(jobs, store, pool, notify)
        rows: dict[CsvFile, list[Row]] = {}
        for job in jobs:
            result = store.load(job.key, job.fingerprint())
            assert result is not None, job.key
            for file, row in job.records(result):
                assert isinstance(file, CsvFile), file.name
                rows.setdefault(file, []).append(row)
        for file, measured in rows.items():
            table = pd.DataFrame(measured, columns=list(file.columns))
            write_csv(new / "data" / file.name, table)
            # Only the rows on disk that were measured again are compared, without derived columns.
            committed, key = file.read(directory), list(file.key)
            on_disk, wanted = (pd.MultiIndex.from_frame(rows_of[key].astype(str)) for rows_of in (committed, table))
            write_csv(old / "data" / file.name, committed.loc[on_disk.isin(wanted), list(file.columns)])
        return compare(old, new, tolerance)

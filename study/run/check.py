"""Checks the data of a run for later changes: the functions of ``study check``.

The recorded plan is compared with the plan that its scope gives now, the rows of all tables with the plan, and
``cases.csv`` with the catalogue of cases. Nothing is measured for this. With ``--again N``, a random sample of the rows
is also measured again.
"""

import tempfile
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from study.ledger.codes import FOLDER, MARCHES, Codes
from study.ledger.compare import Comparison, Tolerance, compare, difference
from study.ledger.datafiles import CsvFile, DataError, Key, line, made_by, read_csv, table_text, write_csv
from study.ledger.files import Json, UsageError
from study.run.executor import Notify, Pool, execute
from study.run.judgement import PREDICTED, read_tables, stored_rows
from study.run.plan import Job
from study.run.provenance import Expectation, commit, read_provenance
from study.run.store import Store
from study.statements.enclosure import BOUNDS, ENCLOSURES


def verify(directory: Path) -> str:
    """Compare the data of a run with its plan and with the predictions for its cases.

    Returns:
        A sentence with the numbers of rows, files, planned measurements and cases that were compared, and the cases
        that were not compared because their files no longer exist.

    Raises:
        UsageError: the directory has no data.
        StoreError, DataError: data are of another format, missing, damaged or edited; the message names file, line and
            column, the value and the expected value.
    """
    record = read_provenance(directory)
    again = f"make them again with `{made_by(directory)}`; finished measurements are kept"
    expectation = Expectation(record, directory)
    planned = _plan(directory, record, expectation, again)
    tables = read_tables(directory)
    for file, table in tables.items():
        _refuse_unplanned(directory, file, table, planned, again)
    # Predicted orders come from the catalogue, or from the file of a user's case. If this file no longer exists, the
    # predictions in the provenance of the run are used.
    path = directory / "data" / "cases.csv"
    read_csv(directory, path.name, PREDICTED)
    if differs := difference(path, table_text(pd.DataFrame(expectation.lines))):
        raise DataError(f"{differs} from the catalogue or from the file of the case: {again}")
    for folder in (FOLDER, MARCHES):
        Codes.read(directory, folder)
    rows, gone = sum(map(len, tables.values())), ", ".join(sorted(expectation.gone))
    return (
        f"measured with the catalogue of commit {record.get('commit') or 'unknown'}: "
        f"{rows} rows in {len(tables)} files belong to the {len(planned)} planned measurements; "
        f"the predictions of {len(expectation.cases)} cases agree with the definitions of the cases"
        f"{'; not compared, because their files no longer exist: ' if gone else ''}{gone}"
    )


def _plan(directory: Path, record: Json, expectation: Expectation, again: str) -> set[Key]:
    """Return the keys of all measurements in the recorded plan of a run.

    Raises:
        DataError: the plan is empty, repeats a key, or differs from the plan that the same commit makes of the recorded
            scope.
    """
    recorded = record["planned"]
    where = f"{directory}/data/provenance.json"
    if not recorded or len({*recorded}) < len(recorded):
        raise DataError(f"{where} has an empty plan, or plans a measurement twice: {again}")
    # A newer program may plan more. What an older one has measured stands.
    differing = set(recorded) ^ set(expectation.plan.keys() if expectation.plan else recorded)
    if differing and record.get("commit") == commit()["commit"]:
        first, plans = min(differing), "plans" if min(differing) in recorded else "does not plan"
        raise DataError(f"{where} {plans} {' '.join(first)}, which disagrees with its scope: {again}")
    return set(recorded)


def _refuse_unplanned(directory: Path, file: CsvFile, table: pd.DataFrame, planned: set[Key], again: str) -> None:
    """Raise DataError if a table has a row that is not in the plan of the run.

    Rows that are in the plan but not in the table are no error here. The first check of the ledger reports them.
    """
    # The plan lists each error bound once. The values of a bound over time, in another file, have the same key.
    name = BOUNDS.name if file == ENCLOSURES else file.name
    keys = zip(*(table[column].astype(str) for column in file.key), strict=True)
    for row, key in enumerate(keys):
        if (name, *key) not in planned:
            raise DataError(
                f"{directory}/data/{file.name}, line {line(row)}: {' '.join(key)} is not among the {len(planned)} "
                f"measurements of the plan: {again}"
            )


# Functions that measure a sample of the rows again.


def planned_jobs(directory: Path) -> tuple[Job, ...]:
    """Return all jobs, that is measurements, whose rows are in the tables of a result directory.

    Jobs for pictures are left out. On other processors, the cells of unstructured meshes of symmetric bodies may be
    numbered differently, so that pictures differ.

    Raises:
        UsageError: there are no data, or the file of a user's case no longer exists.
    """
    record = read_provenance(directory)
    expectation = Expectation(record, directory)
    if expectation.plan is None:
        gone = ", ".join(sorted(expectation.gone))
        raise UsageError(f"--again needs the files of all cases; the files of {gone} no longer exist: put them back")
    return tuple(job for job in expectation.plan.jobs if job.identity in set(record["planned"]))


def draw_jobs(jobs: Sequence[Job], count: int, seed: int) -> list[Job]:
    """Return a random sample of jobs without repetition.

    A job is drawn with a probability proportional to 1 / cost. So the expected time of one draw is the harmonic mean of
    all costs, about 0.4 s for the full study, even if some jobs take very long.

    Parameters:
        jobs: all jobs of the plan.
        count: size of the sample; if there are fewer jobs, all are returned.
        seed: seed of the random generator, 0 or more; the same seed gives the same sample.
    """
    weights = 1 / np.array([job.cost for job in jobs])
    size = min(count, len(jobs))
    drawn = np.random.default_rng(seed).choice(len(jobs), size, replace=False, p=weights / weights.sum())
    return [jobs[i] for i in drawn]


def expected_seconds(jobs: Sequence[Job]) -> float:
    """Return the expected computing time of jobs in seconds."""
    return sum(job.cost for job in jobs) / 1e6


def compare_again(directory: Path, jobs: Sequence[Job], pool: Pool, tolerance: Tolerance, notify: Notify) -> Comparison:
    """Run jobs again and compare the new measurements with the rows on disk.

    Only measured columns are compared, not columns that are derived from them.

    Parameters:
        directory: the result directory.
        jobs: the jobs that are run again.
        pool: runs the jobs.
        tolerance: the permitted differences.
        notify: called with each finished job.

    Returns:
        The differences; ``old`` means the rows in ``directory``, ``new`` the rows that were measured now.

    Raises:
        UsageError: a measurement needs more memory than is available.
        JobsError: a measurement failed.
        DataError: a data file is missing or damaged.
    """
    with tempfile.TemporaryDirectory() as temporary:
        old, new = Path(temporary) / "old", Path(temporary) / "new"
        store = Store(new)
        execute(jobs, store, pool, notify)
        for file, measured in stored_rows(jobs, store).items():
            assert isinstance(file, CsvFile), file.name
            table = pd.DataFrame(measured, columns=list(file.columns))
            write_csv(new / "data" / file.name, table)
            # From the file on disk, only the rows that were measured again are compared, without derived columns.
            committed, key = file.read(directory), list(file.key)
            on_disk, wanted = (pd.MultiIndex.from_frame(rows_of[key].astype(str)) for rows_of in (committed, table))
            write_csv(old / "data" / file.name, committed.loc[on_disk.isin(wanted), list(file.columns)])
        return compare(old, new, tolerance)

"""Measures a random sample of the committed rows again and compares the numbers: ``study check --again N``."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from study.ledger.compare import Comparison, Tolerance, compare
from study.ledger.datafiles import CsvFile, Row, write_csv
from study.ledger.files import UsageError
from study.run.executor import Pool, execute
from study.run.plan import Job
from study.run.provenance import Expectation, read_provenance
from study.run.store import Store

LEAST_COST = 0.3e6
"""Cost in µs that a cheaper measurement counts with: no measurement takes less, and without this the cheapest few
measurements would be drawn again and again."""


def planned_jobs(directory: Path) -> tuple[Job, ...]:
    """Returns every measurement that gives rows to the tables in a directory.

    Pictures are left out: on unstructured meshes of bodies with symmetries the cells are numbered otherwise on another
    processor.

    Raises:
        UsageError: there are no data, or the file of a user's own case is gone.
    """
    expectation = Expectation.of(read_provenance(directory), directory)
    if expectation.plan is None:
        gone = ", ".join(sorted(expectation.gone))
        raise UsageError(f"--again needs the files of all cases, and those of {gone} are gone; put them back")
    return tuple(job for job in expectation.plan.jobs if isinstance(job.statement.file, CsvFile))


def draw_jobs(jobs: Sequence[Job], count: int, seed: int) -> list[Job]:
    """Returns a random sample of measurements without repetition; the same seed gives the same sample.

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
    """Returns the expected computing time of some measurements in seconds."""
    return float(np.maximum([job.cost for job in jobs], LEAST_COST).sum()) / 1e6


def compare_again(
    directory: Path, jobs: Sequence[Job], pool: Pool, tolerance: Tolerance, notify: Callable[[float], None]
) -> Comparison:
    """Measures again and compares the measured columns with the rows on disk; derived columns are not compared.

    Returns:
        The differences; ``old`` are the rows in ``directory``, ``new`` the rows measured now.

    Raises:
        UsageError: a measurement needs more memory than there is.
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
            write_csv(old / "data" / file.name, _same_rows(file, directory, table))
        return compare(old, new, tolerance)


def _same_rows(file: CsvFile, directory: Path, measured: pd.DataFrame) -> pd.DataFrame:
    """Return the rows on disk with the keys of the measured rows, without derived columns."""
    table = file.read(directory)
    on_disk, wanted = (pd.MultiIndex.from_frame(rows[list(file.key)].astype(str)) for rows in (table, measured))
    return table.loc[on_disk.isin(wanted), list(file.columns)]

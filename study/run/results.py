"""The data files of a run: written from the results of its jobs, and read again with a check of every cell."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd

from study.ledger.datafiles import TEXT, CsvFile, DataFile, Row, made_by, refuse_repeated, refuse_words, write_csv
from study.ledger.files import write_text
from study.run.case_line import describe
from study.run.plan import Plan
from study.run.provenance import SUMS, provenance, sums_of
from study.run.store import Store
from study.statements import STATEMENTS
from study.statements.enclosure import BOUNDS, ENCLOSURES
from study.statements.shared.base import LISTED

WITHIN = {LISTED.name: ["quantity"], ENCLOSURES.name: ["time"]}
"""The columns that tell the rows of one measurement apart."""
MAY_BE_EMPTY = {
    BOUNDS.name: ["expected_order", "error", "above", "below", "upper", "lower"],
    ENCLOSURES.name: ["error"],
}
"""Columns of numbers that are empty where the exact solution is unknown."""


def data_files() -> list[DataFile]:
    """Return all files that measurements are written to."""
    return list(dict.fromkeys([*(statement.file for statement in STATEMENTS), ENCLOSURES]))


def collect(plan: Plan, store: Store) -> None:
    """Write the data files of a plan, and its provenance, from the stored results of its jobs."""
    rows: dict[DataFile, list[Row]] = {file: [] for file in data_files()}
    written: list[Path] = []
    for job in plan.jobs:
        result = store.load(job.key, job.fingerprint())
        assert result is not None, job.key
        for file, row in job.records(result):
            rows[file].append(row)
    for file, rows_of_file in rows.items():
        written += file.write(store.data, rows_of_file)
    write_csv(store.data / "cases.csv", pd.DataFrame([describe(case) for case in plan.scope.resolved()]))
    content = {**provenance(plan, store.directory), SUMS: sums_of(store.data, written)}
    write_text(store.data / "provenance.json", json.dumps(content, separators=(",", ":")) + "\n")


def read_tables(directory: Path) -> dict[CsvFile, pd.DataFrame]:
    """Return all tables of measurements of a run.

    Raises:
        DataError: a table is missing or damaged, has no number where one belongs, or a row twice; names file and line.
    """
    return {file: read_checked(file, directory) for file in data_files() if isinstance(file, CsvFile)}


def read_checked(file: CsvFile, directory: Path) -> pd.DataFrame:
    """Return one table of measurements; raises DataError like ``read_tables``."""
    table, path = file.read(directory), directory / "data" / file.name
    remedy, may_be_empty = f"make it again with `{made_by(directory)}`", MAY_BE_EMPTY.get(file.name, [])
    numbers = [name for name in file.columns if name not in TEXT]
    refuse_words(path, table, [name for name in numbers if name not in may_be_empty], remedy)
    derived = [name for name in table if name not in TEXT and name not in numbers]
    refuse_words(path, table, [*may_be_empty, *derived], remedy, empty=True)
    refuse_repeated(path, table, [*file.key, *WITHIN.get(file.name, [])], remedy)
    return table

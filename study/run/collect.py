"""The data files of a run, from its finished jobs."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd

from study.ledger.datafiles import DataFile, Row, write_csv
from study.ledger.files import write_text
from study.run.case_line import describe
from study.run.plan import Plan
from study.run.provenance import provenance
from study.run.store import Store
from study.run.sums import SUMS, sums_of
from study.statements import STATEMENTS
from study.statements.enclosure import ENCLOSURES


def collect(plan: Plan, store: Store) -> None:
    """Write the data files of a plan from its finished jobs."""
    rows: dict[DataFile, list[Row]] = {file: [] for file in data_files()}
    written: list[Path] = []
    for job in plan.jobs:
        found = store.load(job.key, job.fingerprint())
        assert found is not None, job.key
        for file, row in job.records(found):
            rows[file].append(row)
    for file, found_rows in rows.items():
        written += file.write(store.data, found_rows)
    write_csv(store.data / "cases.csv", pd.DataFrame([describe(case) for case in plan.scope.resolved()]))
    content = {**provenance(plan, store.directory), SUMS: sums_of(store.data, written)}
    write_text(store.data / "provenance.json", json.dumps(content, separators=(",", ":")) + "\n")


def data_files() -> list[DataFile]:
    """The files that measurements go to."""
    return list(dict.fromkeys([*(statement.file for statement in STATEMENTS), ENCLOSURES]))

"""Compare the data of a run with what can be derived again: recomputes no solution and trusts no derived column.

Compared are the recorded plan with the plan that its scope gives now, the rows with the plan, ``cases.csv`` with the
catalogue, and columns with each other (``relations``).
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from study.ledger.codes import Codes
from study.ledger.compare import difference
from study.ledger.datafiles import CsvFile, DataError, line, made_by, read_csv, table_text
from study.run.judgement import PREDICTED
from study.run.provenance import Expectation, read_provenance
from study.run.relations import CODE_RELATIONS, FOLDERS, RELATIONS
from study.run.results import read_tables
from study.statements.enclosure import BOUNDS, ENCLOSURES

SHOWN = 3
"""Breaches that a message lists of each relation."""


@dataclass(frozen=True)
class Verified:
    """Numbers of what was compared, and the cases whose files are gone."""

    rows: int
    files: int
    planned: int
    relations: int
    cases: int
    gone: tuple[str, ...]

    def __str__(self) -> str:
        rest = f"; not looked up, as their files are gone: {', '.join(self.gone)}" if self.gone else ""
        return (
            f"{self.rows} rows in {self.files} files are those of the {self.planned} measurements planned; "
            f"{self.relations} relations hold in all of them; predictions of {self.cases} cases{rest}"
        )


def verify(directory: Path) -> Verified:
    """Compare the data of a run with its plan, its predictions and each other.

    Raises:
        UsageError: the directory has no data.
        StoreError, DataError: data are of another format, missing, damaged or edited; names file, line and column, the
            value there and the expected one.
    """
    record = read_provenance(directory)
    again = f"make them again with `{made_by(directory)}`; what is measured is kept"
    expectation = Expectation.of(record, directory)
    planned = _plan(directory, record, expectation, again)
    tables = read_tables(directory)
    for file, table in tables.items():
        _refuse_unplanned(directory, file, table, planned, again)
    _compare_cases(directory, expectation, again)
    broken = [[*map(str, relation(tables, expectation))] for relation in RELATIONS]
    of_codes = [(codes, folder) for folder in FOLDERS if (codes := Codes.read(directory, folder))]
    broken += [[*map(str, relation(*data))] for data in of_codes for relation in CODE_RELATIONS]
    if count := sum(map(len, broken)):
        said = "\n".join(breach for breaches in broken for breach in breaches[:SHOWN])
        raise DataError(f"data in {directory} were edited or damaged, in {count} places such as\n{said}\n{again}")
    rows, gone = sum(map(len, tables.values())), tuple(sorted(expectation.gone))
    return Verified(rows, len(tables), len(planned), len(broken), len(expectation.cases), gone)


def _plan(directory: Path, record: dict[str, Any], expectation: Expectation, again: str) -> set[tuple[str, ...]]:
    """Return the recorded plan; DataError if it is empty, repeats itself, or its scope gives another plan now."""
    recorded = [tuple(key) for key in record["planned"]]
    where = f"{directory}/data/provenance.json"
    if not recorded:
        raise DataError(f"{where} plans nothing, so that nothing could be missing: {again}")
    if repeated := [key for key, count in Counter(recorded).items() if count > 1]:
        raise DataError(f"{where} plans {' '.join(repeated[0])} twice: {again}")
    if expectation.plan and (other := set(recorded) ^ set(expectation.plan.keys())):
        first, plans = min(other), "plans" if min(other) in recorded else "does not plan"
        raise DataError(
            f"{where} {plans} {' '.join(first)}, its scope does otherwise ({len(recorded)} rows are recorded, "
            f"{len(expectation.plan.keys())} follow from the scope): {again}"
        )
    return set(recorded)


def _refuse_unplanned(
    directory: Path, file: CsvFile, table: pd.DataFrame, planned: set[tuple[str, ...]], again: str
) -> None:
    """Refuse rows that are not planned; values over time belong to bounds. Missing rows are for the ledger."""
    name = BOUNDS.name if file == ENCLOSURES else file.name
    keys = zip(*(table[column].astype(str) for column in file.key), strict=True)
    for row, key in enumerate(keys):
        if (name, *key) not in planned:
            raise DataError(
                f"{directory}/data/{file.name}, line {line(row)}: {' '.join(key)} is not among the {len(planned)} "
                f"measurements of the plan: {again}"
            )


def _compare_cases(directory: Path, expectation: Expectation, again: str) -> None:
    """Compare the predictions with the catalogue, the file of a case, or the record of the run if that file is gone."""
    path = directory / "data" / "cases.csv"
    read_csv(directory, path.name, PREDICTED)
    if found := difference(path, table_text(pd.DataFrame(expectation.lines))):
        raise DataError(f"{found}: the catalogue, or the file of the case, predicts the latter; {again}")

"""Whether the data of a run are those of its plan, and say what they must: nothing is solved, and nothing believed.

What is compared: the plan with the one that the recorded scope gives now, the rows with the plan, the lines of
``cases.csv`` with the catalogue, and columns with each other (``relations``).
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from study.ledger.codes import Codes
from study.ledger.datafiles import CsvFile, DataError, line, made_by, read_csv, table_text
from study.ledger.differing import difference
from study.run.code_relations import CODE_RELATIONS, FOLDERS
from study.run.foreseen import Foreseen
from study.run.judgement import PREDICTED
from study.run.measured import read_tables
from study.run.provenance import read_provenance
from study.run.relations import RELATIONS
from study.statements.enclosure import BOUNDS, ENCLOSURES

SHOWN = 3
"""Findings that are listed of every relation."""


@dataclass(frozen=True)
class Verified:
    """What was compared, and what could not be."""

    rows: int
    files: int
    planned: int
    relations: int
    cases: int
    gone: tuple[str, ...]

    def __str__(self) -> str:
        believed = ", ".join(self.gone)
        rest = f"; not looked up, as their files are gone: {believed}" if self.gone else ""
        return (
            f"{self.rows} rows in {self.files} files are those of the {self.planned} measurements planned; "
            f"{self.relations} relations hold in all of them; predictions of {self.cases} cases{rest}"
        )


def verify(directory: Path) -> Verified:
    """Compare data, plan and predictions.

    Raises:
        UsageError: no data.
        StoreError, DataError: data of another format, missing, damaged or edited; names file, line and column, what
            stands there and what was expected.
    """
    made = read_provenance(directory)
    again = f"make them again with `{made_by(directory)}`; what is measured is kept"
    foreseen = Foreseen.of(made, directory)
    planned = _plan(directory, made, foreseen, again)
    tables = read_tables(directory)
    for file, table in tables.items():
        _refuse_unplanned(directory, file, table, planned, again)
    _compare_cases(directory, foreseen, again)
    broken = [[*map(str, relation(tables, foreseen))] for relation in RELATIONS]
    others = [(codes, folder) for folder in FOLDERS if (codes := Codes.read(directory, folder))]
    broken += [[*map(str, relation(*found))] for found in others for relation in CODE_RELATIONS]
    if count := sum(map(len, broken)):
        said = "\n".join(breach for breaches in broken for breach in breaches[:SHOWN])
        raise DataError(f"data in {directory} were edited or damaged, in {count} places such as\n{said}\n{again}")
    rows, gone = sum(map(len, tables.values())), tuple(sorted(foreseen.gone))
    return Verified(rows, len(tables), len(planned), len(broken), len(foreseen.cases), gone)


def _plan(directory: Path, made: dict[str, Any], foreseen: Foreseen, again: str) -> set[tuple[str, ...]]:
    """The recorded plan, if it is what the scope gives now."""
    recorded = [tuple(key) for key in made["planned"]]
    where = f"{directory}/data/provenance.json"
    if not recorded:
        raise DataError(f"{where} plans nothing, so that nothing could be missing: {again}")
    if repeated := [key for key, count in Counter(recorded).items() if count > 1]:
        raise DataError(f"{where} plans {' '.join(repeated[0])} twice: {again}")
    if foreseen.plan and (other := set(recorded) ^ set(foreseen.plan.keys())):
        first, plans = min(other), "plans" if min(other) in recorded else "does not plan"
        raise DataError(
            f"{where} {plans} {' '.join(first)}, its scope does otherwise ({len(recorded)} rows are recorded, "
            f"{len(foreseen.plan.keys())} follow from the scope): {again}"
        )
    return set(recorded)


def _refuse_unplanned(
    directory: Path, file: CsvFile, table: pd.DataFrame, planned: set[tuple[str, ...]], again: str
) -> None:
    """Refuse rows that no plan asked for; courses in time are those of bounds. What is missing is for the ledger."""
    name = BOUNDS.name if file == ENCLOSURES else file.name
    keys = zip(*(table[column].astype(str) for column in file.key), strict=True)
    for row, key in enumerate(keys):
        if (name, *key) not in planned:
            raise DataError(
                f"{directory}/data/{file.name}, line {line(row)}: {' '.join(key)} is not among the {len(planned)} "
                f"measurements of the plan: {again}"
            )


def _compare_cases(directory: Path, foreseen: Foreseen, again: str) -> None:
    """Predictions are those of the catalogue, or of the file of a case, or of the record of the run."""
    path = directory / "data" / "cases.csv"
    read_csv(directory, path.name, PREDICTED)
    if found := difference(path, table_text(pd.DataFrame(foreseen.lines))):
        raise DataError(f"{found}: the catalogue, or the file of the case, predicts the latter; {again}")

"""The tables of measurements of a run, read without trust: numbers are numbers, and no row stands twice."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from study.ledger.datafiles import TEXT, CsvFile, made_by, refuse_repeated, refuse_words
from study.run.collect import data_files
from study.statements.enclosure import BOUNDS, ENCLOSURES
from study.statements.shared.base import LISTED

WITHIN = {LISTED.name: ["quantity"], ENCLOSURES.name: ["time"]}
"""The columns that tell the rows of one measurement apart."""
OPEN = {BOUNDS.name: ["expected_order", "error", "above", "below", "upper", "lower"], ENCLOSURES.name: ["error"]}
"""Columns of numbers that are empty where the solution is unknown."""


def read_tables(directory: Path) -> dict[CsvFile, pd.DataFrame]:
    """All tables of measurements.

    Raises:
        DataError: one is missing or damaged, has no number where one belongs, or a row twice; names file and line.
    """
    return {file: read_measured(file, directory) for file in data_files() if isinstance(file, CsvFile)}


def read_measured(file: CsvFile, directory: Path) -> pd.DataFrame:
    """One table; DataError as ``read_tables``."""
    table, path = file.read(directory), directory / "data" / file.name
    mend, open_ = f"make it again with `{made_by(directory)}`", OPEN.get(file.name, [])
    numbers = [name for name in file.columns if name not in TEXT]
    refuse_words(path, table, [name for name in numbers if name not in open_], mend)
    derived = [name for name in table if name not in TEXT and name not in numbers]
    refuse_words(path, table, [*open_, *derived], mend, empty=True)
    refuse_repeated(path, table, [*file.key, *WITHIN.get(file.name, [])], mend)
    return table

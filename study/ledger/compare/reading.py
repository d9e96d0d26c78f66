"""Data files as columns of text with the line of every row, so that an error can name file, line and column."""

from __future__ import annotations

import csv
import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from study.ledger.datafiles import DataError

COMMANDS = {"controls.csv": "study controls", "seeds.csv": "study seeds"}
"""File ↦ what writes it, where ``study run`` does not."""


@dataclass(frozen=True)
class ReadTable:
    """A data file as it is written.

    Attributes:
        path: where it is.
        columns: name ↦ the cells as text, all columns of one length.
        lines: the line on which each row ends.
    """

    path: Path
    columns: dict[str, list[str]]
    lines: list[int]

    def __len__(self) -> int:
        return len(self.lines)

    def has_number(self, column: str) -> bool:
        return any(map(_is_number, self.columns[column]))

    def numbers(self, column: str) -> NDArray[np.float64]:
        """The cells of a column, NaN for an empty one.

        Raises:
            DataError: one of them is no number; names file, line and column.
        """
        for cell, line in zip(self.columns[column], self.lines, strict=True):
            if cell and not _is_number(cell):
                raise DataError(
                    f"{self.path}, line {line}: {column} is {cell!r}, expected a number: {again(self.path)}"
                )
        return np.array([float(cell or "nan") for cell in self.columns[column]])


def read_bytes(path: Path) -> bytes:
    """The content of a file; DataError if it may not be read, or if it is a table that ends within a line."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise DataError(f"cannot read {path}: {error.strerror or error}; make it readable") from error
    if path.suffix == ".csv" and not content.endswith(b"\n"):
        raise DataError(f"{path} is truncated, its last line has no end: {again(path)}")
    return content


def read_table(path: Path, content: bytes) -> ReadTable:
    """The table in the content of a CSV file.

    Raises:
        DataError: it is none: not text, an open quotation, a line of another length, a column that is there twice.
    """
    rows: list[list[str]] = []
    lines: list[int] = []
    try:
        reader = csv.reader(io.StringIO(content.decode("utf-8"), newline=""), strict=True)
        for row in reader:
            rows.append(row)
            lines.append(reader.line_num)
    except (UnicodeDecodeError, csv.Error) as error:
        raise DataError(f"{path} is not a table ({error}): {again(path)}") from error
    head = rows[0]
    if twice := sorted({name for name in head if head.count(name) > 1}):
        raise DataError(f"{path} has the columns {', '.join(twice)} twice: {again(path)}")
    for row, line in zip(rows, lines, strict=True):
        if len(row) != len(head):
            raise DataError(f"{path}, line {line}: {len(row)} entries, expected {len(head)}: {again(path)}")
    columns = {name: [row[i] for row in rows[1:]] for i, name in enumerate(head)}
    return ReadTable(path, columns, lines[1:])


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def again(path: Path) -> str:
    """How to mend a data file, DIR/data/NAME or DIR/data/pictures/NAME."""
    directory = next((parent.parent for parent in path.parents if parent.name == "data"), path.parent)
    return f"make it again with `{COMMANDS.get(path.name, 'study run')} --out {directory}`"

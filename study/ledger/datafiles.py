"""The data files of a run: defines their columns and keys, reads them with a check of every cell, and writes them."""

import gzip
import shlex
import zlib
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from json import dumps, loads
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from pandas import DataFrame, Series

from study.ledger.files import Json, Paths, write_packed, write_text
from study.ledger.schema import SCHEMA, TEXT_COLUMNS
from study.ledger.verdict import HOLDS, VERDICTS, CheckKind
from study.orders import consecutive_orders

SHOWN_RATES = ["h", "dofs", "steps", "error", "order", "at", "interpolation_error", "discrete_error", "time_share"]
"""Columns of ``rates.csv`` without which tables and figures cannot be made."""
SERIES = ["claim", "case", "family", "scheme"]


Key = tuple[str, ...]
"""Texts that identify a row: the name of its file, and the cells of the key columns."""
Row = Mapping[str, Any]


class DataError(ValueError):
    """Raised if a data file is missing, damaged or edited.

    The message names the file and the command that writes it again.
    """


def read_csv(directory: Path, name: str, columns: Collection[str] = ()) -> DataFrame:
    """Return the table in the file ``directory/data/name`` of a run.

    Parameters:
        directory: the result directory.
        name: name of the file, a key of ``SCHEMA``.
        columns: columns that the table must have, besides those that identify a row.

    Raises:
        DataError: see ``read_checked``.
    """
    command = SCHEMA[name].command
    again = f"{command} --out {directory}" if command else made_by(directory)
    return read_checked(directory / "data" / name, name, again, columns)


def read_checked(path: Path, name: str, command: str, columns: Collection[str] = ()) -> DataFrame:
    """Return a table whose cells have the units of ``SCHEMA``: text, numbers, or empty cells where they are allowed.

    Columns of ``SCHEMA`` that the file lacks are skipped, so that files of an older program can be read.

    Parameters:
        path: the file.
        name: the name of the table in ``SCHEMA``.
        command: the command that wrote the file, for messages.
        columns: the columns that the file must have in addition to the key of the table.

    Raises:
        DataError: the file is missing or damaged, a number is missing or is no number, or a row is repeated; the
            message names file, line and column.
    """
    table = SCHEMA[name]
    mend = f"make it again with `{command}`"
    key = [*table.key, *table.within]
    frame = read_table(path, (*key, *columns), command)
    for column in table.numbers:
        if column in frame:
            cells = frame[column]
            wrong = pd.to_numeric(cells, errors="coerce").isna()
            if table.columns[column].empty:
                wrong &= cells.notna()
            if wrong.any():
                # Rows are counted: in rows with too many cells, pandas takes the first cells for labels.
                row = wrong.argmax()
                cell = cells.astype(object).fillna("").iloc[row]
                raise DataError(f"{path}, line {line(row)}, column {column}: found {cell!r}, expected a number; {mend}")
    refuse_repeated(path, frame, key, mend)
    return frame


def made_by(directory: Path) -> str:
    """Return the command line that wrote a result directory, from its provenance; else ``study run``."""
    try:
        command = loads((directory / "data" / "provenance.json").read_text(encoding="utf-8"))["scope"]["command"]
    except (OSError, ValueError, LookupError, TypeError):
        command = "study run"
    return f"{command} --out {shlex.quote(str(directory))}"


def nested_keys(keys: Iterable[Sequence[str]]) -> Json:
    """Return the keys of rows as nested dictionaries, which store each common beginning once.

    Parameters:
        keys: the keys of rows, each with at least two texts, such as ("rates.csv", …, "8").

    Returns:
        First text ↦ second text ↦ … ↦ list of the last texts of all keys that begin with these texts.
    """
    tree: Json = {}
    for *start, before_last, last in keys:
        branch = tree
        for text in start:
            branch = branch.setdefault(text, {})
        branch.setdefault(before_last, []).append(last)
    return tree


def planned_keys(provenance: Json) -> list[Key]:
    """Return the keys of the rows that a run planned, from the content of its ``provenance.json``.

    The entry ``planned`` has the form that ``nested_keys`` returns. Without this entry the list is empty.
    """

    def flatten(tree: Json, start: Key) -> Iterator[Key]:
        for text, rest in tree.items():
            if isinstance(rest, dict):
                yield from flatten(rest, (*start, text))
            else:
                yield from ((*start, text, last) for last in rest)

    return [*flatten(provenance.get("planned", {}), ())]


def read_table(path: Path, columns: Collection[str], command: str) -> DataFrame:
    """Return a table from a CSV file; empty cells of text are "", empty cells of numbers are NaN.

    Parameters:
        path: the file; if its name ends in ``.gz``, it is uncompressed first.
        columns: the columns that the table must have.
        command: the command that wrote the file, for messages.

    Raises:
        DataError: the file does not exist, is not a table, ends within a line, or lacks a column.
    """
    if not path.is_file():
        raise DataError(f"{path} is missing: make it with `{command}`")
    again = f"make it again with `{command}`"
    try:
        # Only empty cells are read as NaN. A word such as "nan" or "null" is text, because no command writes it.
        kinds = dict.fromkeys(TEXT_COLUMNS, str)
        content = read_uncompressed(path)
        frame = pd.read_csv(BytesIO(content), dtype=kinds, keep_default_na=False, na_values=[""], low_memory=False)  # type: ignore[arg-type]
    except ValueError as error:
        raise DataError(f"{path} is not a table ({error}): {again}") from error
    if not content.endswith(b"\n"):
        raise DataError(f"{path} is truncated, because its last line is incomplete: {again}")
    if lacking := [column for column in columns if column not in frame]:
        raise DataError(f"{path} lacks the columns {', '.join(lacking)}: {again}")
    return frame.fillna(dict.fromkeys([name for name in frame if name in TEXT_COLUMNS], ""))


def read_uncompressed(path: Path) -> bytes:
    """Return the content of a file; if its name ends in ``.gz``, the content is uncompressed.

    Raises:
        ValueError: the name ends in ``.gz``, but the content is not complete or not compressed by gzip.
    """
    content = path.read_bytes()
    try:
        return gzip.decompress(content) if path.suffix == ".gz" else content
    except (gzip.BadGzipFile, EOFError, zlib.error) as error:
        raise ValueError(f"not a complete gzip file: {error}") from error


def line(row: int) -> int:
    """Return the line of a data file with row ``row`` of the table, counted from 0; line 1 has the column names."""
    return row + 2


def refuse_repeated(path: Path, table: DataFrame, key: Sequence[str], mend: str) -> None:
    """Raise an error if two rows of a table have the same key.

    Parameters:
        path: the file, for the message.
        table: the content of the file.
        key: the columns that identify a row.
        mend: how to mend the file, for the message.

    Raises:
        DataError: a key is repeated; the message names both lines.
    """
    keys = table[[*key]]
    if (again := keys.duplicated()).any():
        row = again.argmax()
        first = (keys == keys.iloc[row]).all(axis=1).argmax()
        names = ", ".join(f"{name} {cell}" for name, cell in keys.iloc[row].items())
        raise DataError(
            f"{path}, line {line(row)}: the row {names} is also in line {line(first)}, expected once; {mend}"
        )


def write_csv(path: Path, table: DataFrame) -> Path:
    """Write a table as CSV with 12 digits and Unix line ends, and return the path.

    If writing is interrupted, the old file remains.
    """
    return write_text(path, table_text(table))


def table_text(table: DataFrame) -> str:
    """Return the text of the CSV file that ``write_csv`` writes."""
    return table.to_csv(index=False, float_format="%.12g", lineterminator="\n")


@dataclass(frozen=True)
class CsvFile:
    """A CSV file of measurements.

    Attributes:
        name: name of the file in the folder ``data``, a key of ``SCHEMA``.
        derived: columns that are computed from measured ones, such as observed orders.
        derive: function that returns the table to be written, given the table of measured columns.
    """

    name: str
    derived: tuple[str, ...] = ()
    derive: Callable[[DataFrame], DataFrame] = DataFrame.copy

    @property
    def key(self) -> tuple[str, ...]:
        """The columns that identify a measurement."""
        return SCHEMA[self.name].key

    @property
    def columns(self) -> list[str]:
        """The measured columns."""
        return [name for name in SCHEMA[self.name].columns if name not in self.derived]

    def write(self, data: Path, rows: Sequence[Row]) -> Paths:
        """Write all rows into the file in the folder ``data`` and return its path, as a list.

        Raises:
            KeyError: a row has a column that ``SCHEMA`` does not describe.
        """
        # The steps of a setting follow from its level in files that have no column for them.
        known = {*self.columns, "steps"}
        unknown = set().union(*rows) - known
        if unknown:
            raise KeyError(f"{self.name}: describe {', '.join(sorted(unknown))} in study/ledger/schema.py")
        return [write_csv(data / self.name, self.derive(DataFrame(rows, columns=self.columns)))]

    def read(self, directory: Path) -> DataFrame:
        """Return the table from the file in a result directory; raises DataError if it is missing or damaged."""
        return read_csv(directory, self.name)

    def keys(self, table: DataFrame) -> list[Key]:
        """Return the keys of all rows of a table, as texts, in the order of the rows.

        A key is a tuple of the name of the file and the cells of the key columns.
        """
        return [(self.name, *row) for row in table[[*self.key]].astype(str).itertuples(index=False, name=None)]


@dataclass(frozen=True)
class JsonFiles:
    """A folder with one JSON file, compressed by gzip, for each measurement.

    Attributes:
        name: name of the folder in the folder ``data``.
        key: one column, whose values are the names of the files.
    """

    name: str
    key: tuple[str, ...]

    def write(self, data: Path, rows: Sequence[Row]) -> Paths:
        """Write one file for each row and return the paths.

        The JSON text has no spaces after separators, which makes the files a tenth smaller.
        """
        texts = {row[self.key[0]]: dumps(row, separators=(",", ":")) + "\n" for row in rows}
        return [write_packed(data / self.name / f"{name}.json.gz", text) for name, text in texts.items()]


DataFile = CsvFile | JsonFiles
"""A file or folder into which measurements are written."""


def read_rates(directory: Path) -> DataFrame:
    """Return the table ``rates.csv``, sorted by levels, with a new column ``discrete_order``.

    This column has the observed orders of the discrete error, the distance between the interpolant of the exact
    solution and the computed solution.

    Raises:
        DataError: the file is missing or damaged, a number is missing or infinite, or a row is repeated.
    """
    rates = read_csv(directory, "rates.csv", SHOWN_RATES)
    # Figures cannot show infinite errors.
    numbers = [name for name in SCHEMA["rates.csv"].numbers if name in rates]
    if (infinite := np.isinf(rates[numbers])).any(axis=None):
        row = infinite.any(axis=1).argmax()
        raise DataError(
            f"{directory / 'data' / 'rates.csv'}, line {line(row)}: found an infinite number, expected a finite one; "
            f"make it again with `{made_by(directory)}`"
        )
    series = rates.groupby(SERIES, sort=False).ngroup()
    rates = rates.iloc[np.lexsort([rates.level, series])].reset_index(drop=True)
    return rates.assign(discrete_order=in_series(rates, "discrete_error"))


def expected_orders(directory: Path, rates: DataFrame) -> dict[str, float]:
    """Return case ↦ expected order of the error, from ``cases.csv``.

    Raises:
        DataError: the file is missing or damaged, or lacks a case of the table ``rates``.
    """
    cases = read_csv(directory, "cases.csv", ("case", "expected_order"))
    orders = dict(zip(cases.case, cases.expected_order.astype(float), strict=True))
    if unknown := sorted(set(rates.case) - set(orders)):
        lacking = f"{directory / 'data' / 'cases.csv'} lacks the cases {', '.join(unknown)}"
        raise DataError(f"{lacking}: make it again with `{made_by(directory)}`")
    return orders


def read_claims(directory: Path) -> DataFrame:
    """Return ``claims.csv``, the table of all checks.

    Raises:
        DataError: the file is missing or damaged, or has an unknown verdict.
    """
    claims = read_csv(directory, "claims.csv", SCHEMA["claims.csv"].columns)
    unknown = sorted(set(claims.verdict) - set(VERDICTS))
    if unknown:
        raise DataError(
            f"{directory / 'data' / 'claims.csv'} has the verdicts {', '.join(unknown)}, expected "
            f"{', '.join(VERDICTS)}: make it again with `study tables --out {directory}`"
        )
    return claims


def count_verdicts(claims: DataFrame) -> dict[str, int]:
    """Return verdict ↦ number of checks with this verdict, perhaps 0; ``claims`` has rows of ``claims.csv``."""
    return claims.verdict.value_counts().reindex(VERDICTS, fill_value=0).to_dict()


def count_kinds(claims: DataFrame) -> dict[str, int]:
    """Return kind of check (``CheckKind``) ↦ number of checks of this kind that hold, perhaps 0.

    Parameters:
        claims: rows of ``claims.csv``, the table of all checks.
    """
    kinds = claims[claims.verdict == HOLDS].kind
    return kinds.value_counts().reindex([*CheckKind], fill_value=0).to_dict()


def by_claim(claims: DataFrame) -> Iterator[tuple[str, str, DataFrame]]:
    """Divide rows of ``claims.csv``, the table of all checks, by statements, in the order of the table.

    Yields:
        For each statement its label, claim in words, and checks. Two claims may have the same label.
    """
    for (label, claim), rows in claims.groupby(["label", "statement"], sort=False):
        yield label, claim, rows


def with_orders(table: DataFrame) -> DataFrame:
    """Return a table with a new column ``order`` after ``time_share``: the observed orders of the column ``error``.

    The order in a row is that between the level before and its own, as ``in_series`` returns it.
    """
    completed = table.copy()
    completed.insert(table.columns.get_loc("time_share") + 1, "order", in_series(table, "error"))
    return completed


def in_series(table: DataFrame, column: str) -> Series:
    """Return for each row of a table the observed order of a column between this level and the level before, (rows,).

    Rows with the same proposition, case, mesh family and time scheme belong together. The order is NaN on the first
    level.
    """
    orders = Series(nan, table.index)
    for _, group in table.groupby(SERIES, sort=False):
        orders[group.index] = since_before(group, column)
    return orders


def since_before(table: DataFrame, column: str) -> NDArray[np.float64]:
    """Return for each level the observed order between this level and the level before, (levels,).

    The order is NaN on the first level. It is also NaN if an error is zero, negative or not finite.

    Parameters:
        table: a table with one row for each level, coarse to fine, and the column h.
        column: the column with the errors.
    """
    h = table["h"].to_numpy()
    error = table[column].to_numpy()
    orders = consecutive_orders(h, np.where(error > 0, error, nan))
    return np.append(nan, np.where(np.diff(h) < 0, orders, nan))

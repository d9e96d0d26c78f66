"""The tables of a run in CSV, Markdown and LaTeX: errors, ledger, equivalence, stresses, bounds and defects.

Numbers have four significant digits, orders three decimals. The three files of a table contain the same texts.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from study.ledger import faults
from study.ledger.datafiles import read_claims, read_csv, read_rates, since_before
from study.ledger.files import write_text
from study.ledger.text import cell
from study.present.article import article
from study.present.notation import encode, folding, longtable, prose, read_page


def write_tables(directory: Path) -> list[Path]:
    """Write all tables into ``directory/tables`` and, for a full run, the LaTeX files for the papers.

    Raises:
        DataError: a data file is missing or lacks a column; then nothing is written.
    """
    return [write_text(path, text) for path, text in texts(directory).items()]


def texts(directory: Path) -> dict[Path, str]:
    """Return path ↦ text of the files that ``write_tables`` writes; raises the same errors."""
    layouts = RATES, SHORT_LEDGER, EQUIVALENCE, STRESSES, BOUNDS, FAULTS
    tables = [layout.table(directory) for layout in layouts if layout.is_measured(directory)]
    found = {path: text for table in tables for path, text in table.texts(directory / "tables").items()}
    return found | article(directory)


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes:
        name: name in the CSV file.
        heading: heading in the other files.
        alignment: alignment in LaTeX.
        names: whether the cells are identifiers, which contain no formulas.
        form: the format of numbers, such as "{:.3f}"; if it is empty, numbers have four significant digits.
    """

    name: str
    heading: str
    alignment: str = "r"
    names: bool = False
    form: str = ""

    def text(self, value: Hashable) -> str:
        """Return a value of this column as text."""
        return self.form.format(value) if self.form and not pd.isna(value) else cell(value)

    def latex(self, text: str) -> str:
        """Return a text of this column as LaTeX."""
        return prose(text) if self.names else encode(text)


COLUMNS: dict[str, list[dict[str, Any]]] = read_page("tables")
"""Name of a table ↦ groups of columns: kind, a key of ``KINDS`` ↦ names and headings, and perhaps their width."""
KINDS: dict[str, dict[str, Any]] = {
    "words": {"alignment": "l"},
    "names": {"alignment": "l", "names": True},
    "numbers": {},
    "orders": {"form": "{:.3f}"},
    "percent": {"form": "{:.2g}"},
}
"""Kind of columns ↦ their attributes."""


def columns(name: str) -> list[Column]:
    """Return the columns of a table, given its name in ``COLUMNS``."""
    found = []
    for group in COLUMNS[name]:
        width = {"alignment": folding(group["width"])} if "width" in group else {}
        ((kind, headings),) = ((key, value) for key, value in group.items() if key != "width")
        found += [Column(column, heading, **KINDS[kind] | width) for column, heading in headings.items()]
    return found


@dataclass(frozen=True)
class Table:
    """A table whose cells are texts.

    Attributes:
        name: the name of its files.
        columns: the columns.
        cells: the texts.
        grouped: the number of columns, from the first, whose cells are headings of groups of rows.
    """

    name: str
    columns: Sequence[Column]
    cells: pd.DataFrame
    grouped: int = 0

    @property
    def rows(self) -> list[list[str]]:
        """The texts of all cells, row by row."""
        return self.cells[[column.name for column in self.columns]].to_numpy().tolist()

    def of_case(self, case: str, without: Sequence[str]) -> Table:
        """Return the table of the rows of one case, without the columns whose names are in ``without``."""
        columns = [column for column in self.columns if column.name not in without]
        return Table(self.name, columns, self.cells[self.cells["case"] == case])

    def texts(self, directory: Path) -> dict[Path, str]:
        """Return path ↦ text of the CSV, Markdown and LaTeX files of the table in a directory."""
        keys, rest = self.columns[: self.grouped], self.columns[self.grouped :]
        rule = ["--:" if column.alignment == "r" else ":--" for column in rest]
        lines, groups = [], []
        for values, frame in self.cells.groupby([column.name for column in keys], sort=False):
            rows = frame[[column.name for column in rest]].to_numpy().tolist()
            lines += [f"## {_plain(', '.join(filter(None, values)))}", ""]
            table = [map(_plain, [column.heading for column in rest]), rule, *(map(_plain, row) for row in rows)]
            lines += [*("| " + " | ".join(line) + " |" for line in table), ""]
            title = ", ".join(column.latex(value) for column, value in zip(keys, values, strict=True) if value)
            latex = [[column.latex(text) for column, text in zip(rest, row, strict=True)] for row in rows]
            groups.append((title, latex))
        headings, alignments = [encode(column.heading) for column in rest], [column.alignment for column in rest]
        forms = {
            "csv": self.cells.to_csv(index=False, lineterminator="\n"),
            "md": "\n".join(lines),
            "tex": longtable(headings, alignments, groups),
        }
        return {directory / f"{self.name}.{form}": text for form, text in forms.items()}


def _plain(text: str) -> str:
    """Return a text in which characters that have a meaning in Markdown are escaped."""
    return re.sub(r"([\\|*_<#])", r"\\\1", text)


@dataclass(frozen=True)
class Layout:
    """How a table is made from a data file of a run.

    Attributes:
        name: the name of the table and, unless ``read`` is given, of its data file.
        columns: the columns.
        grouped: the number of columns, from the first, whose cells are headings of groups of rows.
        read: function that returns the values of the columns for a result directory; if it is None, they are read.
        optional: whether the data file may be missing.
    """

    name: str
    columns: Sequence[Column]
    grouped: int
    read: Callable[[Path], pd.DataFrame] | None = None
    optional: bool = False

    def is_measured(self, directory: Path) -> bool:
        """Return whether the table can be made: whether an optional data file exists."""
        return not self.optional or (directory / "data" / f"{self.name}.csv").is_file()

    def table(self, directory: Path) -> Table:
        """Return the table of a result directory; raise DataError if its data file is missing or lacks a column."""
        names = [column.name for column in self.columns]
        values = self.read(directory) if self.read else read_csv(directory, f"{self.name}.csv", names)
        cells = {column.name: [column.text(value) for value in values[column.name]] for column in self.columns}
        return Table(self.name, self.columns, pd.DataFrame(cells, dtype=str), self.grouped)


def _rates(directory: Path) -> pd.DataFrame:
    rates = read_rates(directory)
    return rates.assign(time_share_percent=100 * rates["time_share"])


def _checks(directory: Path) -> pd.DataFrame:
    """Return ``claims.csv`` with empty cells ``low`` and ``high`` instead of the range −∞ to ∞.

    This range means that nothing was measured.
    """
    claims = read_claims(directory)
    unmeasured = (claims["low"] == -math.inf) & (claims["high"] == math.inf)
    return claims.assign(low=claims["low"].mask(unmeasured), high=claims["high"].mask(unmeasured))


def _merged_checks(directory: Path) -> pd.DataFrame:
    """Return the checks with one row for all cases that agree in statement, quantity, expectation and verdict.

    The row has the range of their observed values, the smallest low end and the largest high end.
    """

    def few_names(cases: pd.Series) -> str:
        names = cases.unique()
        return ", ".join(names) if len(names) <= 3 else f"{len(names)} cases"

    shared = ["label", "statement", "quantity", "expected", "verdict"]
    lines = _checks(directory).groupby(shared, sort=False, dropna=False).agg(
        case=("case", few_names), least=("observed", "min"), most=("observed", "max"), low=("low", "min"),
        high=("high", "max"),
    )  # fmt: skip
    return lines.reset_index()


def _faults(directory: Path) -> pd.DataFrame:
    return faults.summary(read_csv(directory, "faults.csv"))


def _stresses(directory: Path) -> pd.DataFrame:
    """Return ``stresses.csv`` with the order of the error of the stress, from the coarsest level to the finest."""
    measured = [column.name for column in STRESSES.columns if column.name not in ("order", "time_share_percent")]
    rows = read_csv(directory, "stresses.csv", [*measured, "h", "time_share"])
    shown = rows.assign(order=math.nan, time_share_percent=100 * rows["time_share"])
    series = [frame.sort_values("level") for _, frame in shown.groupby(["case", "family"], sort=False)]
    series = [one.assign(order=since_before(one["h"].to_numpy(), one["stress"].to_numpy())) for one in series]
    return pd.concat(series) if series else shown


RATES = Layout("rates", columns("rates"), 4, _rates)
"""Errors and orders on all levels."""
LEDGER = Layout("ledger", columns("ledger"), 2, _checks)
"""All checks with windows, observations and verdicts."""
SHORT_LEDGER = Layout("ledger", columns("short_ledger"), 2, _merged_checks)
"""All checks, with one row for cases that agree."""
EQUIVALENCE = Layout("equivalence", columns("equivalence"), 2)
"""Differences between the solutions of Problems 3.1 and 3.2."""
STRESSES = Layout("stresses", columns("stresses"), 2, _stresses)
"""Errors of Problem 3.2 with a separate space for stresses."""
BOUNDS = Layout("bounds", columns("bounds"), 2)
"""Error bounds, and their ratios to the error."""
FAULTS = Layout("faults", columns("faults"), 2, _faults, optional=True)
"""Deliberate faults, and in how many cases they are noticed."""

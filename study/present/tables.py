"""The tables of a run in CSV, Markdown and LaTeX: errors, ledger, equivalence, stresses, bounds and faults.

Numbers have four significant digits, orders three decimals. The three files of a table contain the same texts.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Sequence
from dataclasses import dataclass
from math import nan
from pathlib import Path

import pandas as pd
from pandas import DataFrame, Series

from study.ledger.controls import summary
from study.ledger.datafiles import read_claims, read_csv, read_rates, since_before
from study.ledger.files import Json
from study.ledger.text import cell
from study.ledger.verdict import NOWHERE
from study.present.templates import encode, folding, prose, read_page, render

TextFiles = dict[Path, str]
"""Path ↦ text of a file."""
TABLE_COLUMNS: dict[str, list[Json]] = read_page("tables")
"""Name of a table ↦ groups of columns: the kind of the columns ↦ names and headings, and perhaps their width."""


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes:
        name: name in the CSV file.
        heading: heading in the Markdown and LaTeX files.
        kind: what the cells contain: "words" are texts, in which formulas are recognised and set as LaTeX formulas;
            "names" are identifiers such as the name of a case, in which nothing is a formula; "numbers" have four
            significant digits, "orders" three decimals.
        width: the fraction of the line at which LaTeX folds the text; None if it is not folded.
    """

    name: str
    heading: str
    kind: str
    width: float | None = None

    @property
    def is_number(self) -> bool:
        """Whether the cells are numbers, which are aligned on the right."""
        return self.kind in ("numbers", "orders")

    @property
    def alignment(self) -> str:
        """The alignment in LaTeX."""
        return folding(self.width) if self.width else "r" if self.is_number else "l"

    def text(self, value: Hashable) -> str:
        """Return a value of this column as text."""
        return f"{value:.3f}" if self.kind == "orders" and not pd.isna(value) else cell(value)

    def latex(self, text: str) -> str:
        """Return a text of this column as LaTeX."""
        return prose(text) if self.kind == "names" else encode(text)


@dataclass(frozen=True)
class Table:
    """A table of texts.

    Attributes:
        name: the name of its files.
        columns: the columns.
        cells: the texts.
        grouped: the number of columns, from the first, whose cells are headings of groups of rows.
    """

    name: str
    columns: Sequence[Column]
    cells: DataFrame
    grouped: int = 0

    @classmethod
    def of(cls, name: str, values: DataFrame, grouped: int = 2) -> Table:
        """Return a table whose columns are described in ``page/tables.toml``.

        Parameters:
            name: the name of the table in that file.
            values: the values, with at least these columns.
            grouped: the number of columns, from the first, whose cells are headings of groups of rows.
        """
        columns = columns_of(name)
        cells = {column.name: [column.text(value) for value in values[column.name]] for column in columns}
        return cls(name, columns, DataFrame(cells, dtype=str), grouped)

    @property
    def rows(self) -> list[list[str]]:
        """The texts of all cells, row by row."""
        return self.cells.to_numpy().tolist()

    def of_case(self, case: str) -> Table:
        """Return the table of the rows of one case, without the columns ``case`` and ``claim``."""
        columns = [column for column in self.columns if column.name not in ("case", "claim")]
        rows = self.cells.loc[self.cells.case == case, [column.name for column in columns]]
        return Table(self.name, columns, rows)

    def texts(self, directory: Path) -> TextFiles:
        """Return path ↦ text of the CSV, Markdown and LaTeX files of the table in a directory."""
        groups = [
            (titles, rows.iloc[:, self.grouped :].to_numpy().tolist())
            for titles, rows in self.cells.groupby([*self.cells.columns[: self.grouped]], sort=False)
        ]
        columns = self.columns[self.grouped :]
        texts = {form: render(f"table.{form}.j2", columns=columns, groups=groups) for form in ("md", "tex")}
        texts["csv"] = self.cells.to_csv(index=False, lineterminator="\n")
        return {directory / f"{self.name}.{form}": text for form, text in texts.items()}


def columns_of(name: str) -> list[Column]:
    """Return the columns of a table, given its name in ``TABLE_COLUMNS``."""
    columns = []
    for group in TABLE_COLUMNS[name]:
        width = group.get("width")
        for kind, headings in group.items():
            if kind != "width":
                columns += [Column(key, heading, kind, width) for key, heading in headings.items()]
    return columns


def rates(directory: Path) -> Table:
    """Return the table of errors and orders on all levels."""
    values = read_rates(directory)
    return Table.of("rates", values.assign(time_share_percent=100 * values.time_share), grouped=4)


def all_checks(directory: Path) -> DataFrame:
    """Return ``claims.csv`` with empty cells ``low`` and ``high`` instead of the range −∞ to ∞.

    This range means that nothing was measured.
    """
    claims = read_claims(directory)
    ends = claims[["low", "high"]]
    return claims.assign(**ends.mask((ends == [*NOWHERE]).all(axis=1)))


def ledger(directory: Path) -> Table:
    """Return the ledger: one row for all cases that agree in statement, quantity, expectation and verdict.

    The row has the range of their observed values, the smallest low end and the largest high end.
    """

    def few_names(cases: Series) -> str:
        names = cases.unique()
        return ", ".join(names) if len(names) <= 3 else f"{len(names)} cases"

    shared = ["label", "statement", "quantity", "expected", "verdict"]
    lines = all_checks(directory).groupby(shared, sort=False, dropna=False).agg(
        case=("case", few_names), least=("observed", "min"), most=("observed", "max"), low=("low", "min"),
        high=("high", "max"),
    )  # fmt: skip
    return Table.of("ledger", lines.reset_index())


def equivalence(directory: Path) -> Table:
    """Return the table of differences between the solutions of Problems 3.1 and 3.2."""
    return Table.of("equivalence", _read(directory, "equivalence"))


def stresses(directory: Path) -> Table:
    """Return the table of errors of Problem 3.2 with its own space for stresses, with the orders of the stress."""
    values = _read(directory, "stresses", "h", "time_share")
    values = values.assign(order=nan, time_share_percent=100 * values.time_share)
    series = [rows.sort_values("level") for _, rows in values.groupby(["case", "family"], sort=False)]
    for rows in series:
        rows["order"] = since_before(rows, "stress")
    return Table.of("stresses", pd.concat(series) if series else values)


def bounds(directory: Path) -> Table:
    """Return the table of error bounds and their ratios to the error, a row for each case and mesh.

    Parameters:
        directory: the result directory, which has ``data/bounds.csv``.
    """
    return Table.of("bounds", _read(directory, "bounds"))


def faults(directory: Path) -> Table | None:
    """Return the table of deliberate faults, and in how many cases they are noticed; None if they were not measured."""
    measured = (directory / "data" / "faults.csv").is_file()
    return Table.of("faults", summary(read_csv(directory, "faults.csv"))) if measured else None


RUN_TABLES: tuple[Callable[[Path], Table | None], ...] = (rates, ledger, equivalence, stresses, bounds, faults)


def _read(directory: Path, name: str, *more: str) -> DataFrame:
    """Return the data file of a table; raise DataError if it is missing or lacks a column of the table."""
    derived = ("order", "time_share_percent") if name == "stresses" else ()
    names = [column.name for column in columns_of(name) if column.name not in derived]
    return read_csv(directory, f"{name}.csv", [*names, *more])

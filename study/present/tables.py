"""Tables from the data files: rates, ledger, equivalence, stresses and bounds as CSV, Markdown and LaTeX.

Short ones for a terminal are in ``terminal``.

Nothing is solved here. The files show numbers to four significant digits and all hold the same text, so
that they agree digit for digit; orders have three decimals.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from study.ledger.datafiles import DataError, read_claims, read_csv, read_rates, with_order
from study.ledger.files import write_text, write_whole
from study.ledger.rounding import cell
from study.present.article.fragments import write_article
from study.present.latex import encode, longtable, prose
from study.present.terminal import ledger_text, rates_text

__all__ = ["DataError", "ledger_text", "rates_text", "write_tables"]

EQUIVALENCE = ["case", "form", "level", "h", "steps", "displacement_gap", "stress_gap", "admissibility", "energy_gap"]
EQUIVALENCE += ["membership"]
STRESSES = ["case", "family", "level", "h", "steps", "unknowns", "stress", "stress_sup", "best", "strain", "pressure"]
STRESSES += ["displacement", "primal_stress", "primal_displacement", "time_share"]


def write_tables(directory: Path) -> list[Path]:
    """Write every table as csv, md and tex under ``directory/tables``, and what the article takes from a full run.

    Returns the files. The LaTeX files are longtables to \\input outside any float; they need the
    packages array, booktabs and longtable.

    Raises:
        DataError: a data file is missing or lacks a column; nothing is written then.
    """
    makers = rates_table, ledger_table, equivalence_table, stress_table, bounds_table
    tables = [make(directory) for make in makers]
    return [path for table in tables for path in table.write(directory / "tables")] + write_article(directory)


@dataclass(frozen=True)
class Column:
    """A column of a table: its name in the CSV file, its heading in the others, how LaTeX aligns it.

    ``names`` marks identifiers, in which LaTeX must not look for mathematics; ``form`` formats numbers
    that are not shown to four significant digits.
    """

    name: str
    heading: str
    alignment: str = "r"
    names: bool = False
    form: str = ""

    def text(self, value: Hashable) -> str:
        """The text of a cell of this column."""
        return self.form.format(value) if self.form and not pd.isna(value) else cell(value)


@dataclass(frozen=True)
class Table:
    """A table of text cells; LaTeX puts the first ``grouped`` columns on lines of their own above their rows."""

    name: str
    columns: Sequence[Column]
    cells: pd.DataFrame
    grouped: int

    def write(self, directory: Path) -> list[Path]:
        """The three files."""
        return [
            write_whole(
                directory / f"{self.name}.csv", lambda part: self.cells.to_csv(part, index=False, lineterminator="\n")
            ),
            write_text(directory / f"{self.name}.md", self.markdown()),
            write_text(directory / f"{self.name}.tex", self.latex()),
        ]

    def markdown(self) -> str:
        """A pipe table; characters with a meaning in Markdown are escaped."""
        shown = self.cells.map(lambda cell: re.sub(r"([\\|*_<])", r"\\\1", cell))
        shown.columns = [column.heading.replace("_", r"\_") for column in self.columns]
        sides = ["right" if column.alignment == "r" else "left" for column in self.columns]
        return str(shown.to_markdown(index=False, disable_numparse=True, colalign=sides)) + "\n"

    def latex(self) -> str:
        """A longtable with booktabs rules."""
        keys, rest = list(self.columns[: self.grouped]), list(self.columns[self.grouped :])
        groups: list[tuple[str, list[list[str]]]] = []
        for values, rows in self.cells.groupby([column.name for column in keys], sort=False):
            title = ", ".join(_latex(column, value) for column, value in zip(keys, values, strict=True) if value)
            body = rows[[column.name for column in rest]].to_numpy()
            groups.append((title, [[_latex(c, cell) for c, cell in zip(rest, row, strict=True)] for row in body]))
        return longtable([encode(column.heading) for column in rest], [column.alignment for column in rest], groups)


def rates_table(directory: Path) -> Table:
    """Per claim, case, family and scheme, from ``rates.csv``: the error of every level and what qualifies it.

    The order of the discrete error is computed here from ``discrete_error`` and ``h``; the time share
    is given in per cent.
    """
    rates = read_rates(directory)
    columns = [
        Column("claim", "claim", "l"),
        Column("case", "case", "l", names=True),
        Column("family", "meshes", "l", names=True),
        Column("scheme", "scheme", "l", names=True),
        Column("level", "level"),
        Column("h", "h"),
        Column("dofs", "dofs"),
        Column("steps", "steps"),
        Column("error", "‖u − u^h‖_V"),
        Column("order", "order", form="{:.3f}"),
        Column("at", "at t ="),
        Column("interpolation_error", "‖u − Π^h u‖_V"),
        Column("discrete_error", "‖Π^h u − u^h‖_V"),
        Column("discrete_order", "order", form="{:.3f}"),
        Column("time_share_percent", "time, %"),
    ]
    shown = rates.assign(time_share_percent=100 * rates["time_share"])
    return _table("rates", columns, shown, grouped=4)


def ledger_table(directory: Path) -> Table:
    """Every verdict with its expectation and interval, grouped by statement, from ``claims.csv``."""
    columns = [
        Column("label", "statement", "l"),
        Column("statement", "what it says", "l"),
        Column("case", "case", r">{\raggedright\arraybackslash}p{0.17\linewidth}", names=True),
        Column("quantity", "quantity", r">{\raggedright\arraybackslash}p{0.26\linewidth}"),
        Column("expected", "expected", r">{\raggedright\arraybackslash}p{0.14\linewidth}"),
        Column("observed", "observed"),
        Column("low", "low"),
        Column("high", "high"),
        Column("verdict", "verdict", "l"),
    ]
    return _table("ledger", columns, read_claims(directory), grouped=2)


def equivalence_table(directory: Path) -> Table:
    """How far Problem 3.2 is from Problem 3.1, grouped by case and form, from ``equivalence.csv``."""
    columns = [
        Column("case", "case", "l", names=True),
        Column("form", "form of Problem 3.2", "l"),
        Column("level", "level"),
        Column("h", "h"),
        Column("steps", "steps"),
        Column("displacement_gap", "displacements"),
        Column("stress_gap", "stresses"),
        Column("admissibility", "admissibility"),
        Column("energy_gap", "energy"),
        Column("membership", "membership"),
        Column("displacement_bound", "allowed displ."),
        Column("stress_bound", "allowed stress"),
    ]
    return _table("equivalence", columns, read_csv(directory, "equivalence.csv", EQUIVALENCE), grouped=2)


def bounds_table(directory: Path) -> Table:
    """How close the guaranteed bounds are, grouped by kind and case, from ``bounds.csv``."""
    columns = [
        Column("trajectory", "kind", "l"),
        Column("case", "case", "l", names=True),
        Column("family", "meshes", "l", names=True),
        Column("scheme", "scheme", "l", names=True),
        Column("level", "level"),
        Column("lowest", "max error ≥"),
        Column("error", "max error"),
        Column("highest", "max error ≤"),
        Column("upper", "upper / error", form="{:.3f}"),
        Column("lower", "lower / error", form="{:.3f}"),
        Column("residual", "∫ r"),
        Column("oscillation", "∫ η"),
        Column("contact", "∫ c"),
    ]
    return _table("bounds", columns, read_csv(directory, "bounds.csv", [c.name for c in columns]), grouped=2)


def stress_table(directory: Path) -> Table:
    """Problem 3.2 on its own stress space, grouped by case and mesh family, from ``stresses.csv``; time in per cent."""
    columns = [
        Column("case", "case", "l", names=True),
        Column("family", "meshes", "l", names=True),
        Column("level", "level"),
        Column("steps", "steps"),
        Column("unknowns", "unknowns"),
        Column("stress", "‖σ − σ^h‖_Q"),
        Column("order", "order", form="{:.3f}"),
        Column("stress_sup", "largest in t"),
        Column("best", "best possible"),
        Column("strain", "strains"),
        Column("pressure", "pressure"),
        Column("displacement", "multipliers"),
        Column("primal_stress", "to σ(u^h)"),
        Column("primal_displacement", "to u^h"),
        Column("time_share_percent", "time, %"),
    ]
    rows = read_csv(directory, "stresses.csv", STRESSES)
    series = [with_order(frame, "stress") for _, frame in rows.groupby(["case", "family"], sort=False)]
    shown = pd.concat(series) if series else rows.assign(order=[])
    return _table("stresses", columns, shown.assign(time_share_percent=100 * shown["time_share"]), grouped=2)


def _table(name: str, columns: Sequence[Column], frame: pd.DataFrame, grouped: int) -> Table:
    text = {column.name: [column.text(value) for value in frame[column.name]] for column in columns}
    return Table(name, columns, pd.DataFrame(text, dtype=str), grouped)


def _latex(column: Column, text: str) -> str:
    return prose(text) if column.names else encode(text)

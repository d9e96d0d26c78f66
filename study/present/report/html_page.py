"""The page: everything on it, read from the data files, and set by its template."""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined

from study.ledger.datafiles import read_claims, read_csv
from study.ledger.files import write_text
from study.ledger.rounding import cell, significant
from study.present.report.case_page import CasePage, Rows, case_pages, count_verdicts
from study.present.report.svg_chart import typeset
from study.present.tables import Column, bounds_table, ledger_table

CONTROLS = [
    Column("defect", "defect", "l", names=True),
    Column("what", "what is wrong", "l"),
    Column("setting", "measured on", "l", names=True),
    Column("label", "statement", "l"),
    Column("quantity", "row", "l"),
    Column("expected", "expected", "l"),
    Column("observed", "observed"),
    Column("verdict", "verdict", "l"),
    Column("caught", "caught", "l"),
]


@dataclass(frozen=True)
class LedgerGroup:
    """A statement: its rows of the ledger (case, quantity, expected, observed, low, high, verdict) and their judge."""

    label: str
    says: str
    counts: dict[str, int]
    judges: list[str]
    rows: list[list[str]]


@dataclass(frozen=True)
class Content:
    """The whole page."""

    counts: dict[str, int]
    groups: list[LedgerGroup]
    cases: list[CasePage]
    bounds: Rows
    controls: Rows | None
    provenance: dict[str, Any]
    files: Rows

    @property
    def rows(self) -> int:
        """How many rows the ledger has."""
        return sum(self.counts.values())

    @property
    def labels(self) -> list[str]:
        """The labels of the statements, each once."""
        return list(dict.fromkeys(group.label for group in self.groups))

    @property
    def places(self) -> list[str]:
        """What the rows of the ledger are about: cases, and where in the paper there are slips."""
        return list(dict.fromkeys(row[0] for group in self.groups for row in group.rows if row[0]))

    @property
    def names(self) -> set[str]:
        """The cases that have a page."""
        return {case.name for case in self.cases}


def read_content(directory: Path, provenance: dict[str, Any]) -> Content:
    """Everything, from ``directory/data``; ``provenance`` is what ``provenance.json`` there holds.

    Raises:
        DataError: a data file is missing, damaged or older than the page needs.
    """
    claims = read_claims(directory)
    return Content(
        counts=count_verdicts(claims),
        groups=_groups(directory, provenance.get("statements", {})),
        cases=case_pages(directory, claims),
        bounds=Rows.of(bounds_table(directory), "Enclosures of errors, of cases and of problems without a solution"),
        controls=_controls(directory),
        provenance=provenance,
        files=_files(directory),
    )


def _groups(directory: Path, made: dict[str, dict[str, Any]]) -> list[LedgerGroup]:
    """The ledger by statement, in its order; a label that stands for two statements makes two groups."""
    cells: pd.DataFrame = ledger_table(directory).cells
    columns = ["case", "quantity", "expected", "observed", "low", "high", "verdict"]
    code = {label: list(statement["code"]) for label, statement in made.items()}
    return [
        LedgerGroup(label, says, count_verdicts(rows), code.get(label, []), rows[columns].to_numpy().tolist())
        for (label, says), rows in cells.groupby(["label", "statement"], sort=False)
    ]


def _controls(directory: Path) -> Rows | None:
    """The deliberate defects, where there are data of them."""
    if not (directory / "data" / "controls.csv").is_file():
        return None
    names = [column.name for column in CONTROLS]
    frame = read_csv(directory, "controls.csv", names)
    cells = [[cell(value) for value in row] for row in frame[names].to_numpy()]
    return Rows("Deliberate defects and the row of the ledger that has to fail", CONTROLS, cells)


def _files(directory: Path) -> Rows:
    """The data files that the page was made from, by what is in them."""
    data = directory / "data"
    paths = sorted([*data.glob("*.csv"), *data.glob("*.json"), *data.glob("pictures/*.json")])
    contents = {path.relative_to(data).as_posix(): path.read_bytes() for path in paths}
    cells = [
        [name, significant(len(content) / 1000), sha256(content).hexdigest()] for name, content in contents.items()
    ]
    columns = [Column("file", "file", "l", names=True), Column("size", "kB"), Column("sha", "SHA-256", "l", names=True)]
    return Rows("The data files behind this page", columns, cells)


def write_report(directory: Path, provenance: dict[str, Any]) -> Path:
    """Write ``directory/report.html`` from the files under ``directory/data``; returns its path.

    ``provenance`` is what ``data/provenance.json`` holds, as the command has read and checked it.

    Raises:
        StoreError: the directory cannot be written.
        DataError: a data file is missing, damaged or older than the page needs; nothing is written then.
    """
    environment = Environment(
        loader=PackageLoader("study.present.report", "page"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
    )
    environment.filters |= {"typeset": typeset, "number": significant}
    content = read_content(directory, provenance)
    return write_text(directory / "report.html", environment.get_template("page.html").render(content=content) + "\n")

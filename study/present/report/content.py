"""Everything on the page, read from the data files: numbers are texts here, as in ``results/tables``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

import pandas as pd

from study.ledger.datafiles import DataError, read_claims, read_csv, read_rates
from study.ledger.verdict import VERDICTS
from study.present.report.film import read_film
from study.present.report.plots import Chart, Strip, convergence, enclosure, finest_orders
from study.present.report.sources import sources
from study.present.tables import Column, Table, bounds_table, equivalence_table, ledger_table, rates_table, stress_table
from study.present.terminal import cell, significant
from study.run.provenance import read_provenance

CASES = ["case", "summary", "dimension", "law", "zone", "regularity", "expected_order", "proved_order", "reason"]
ENCLOSURES = ["trajectory", "case", "family", "scheme", "level", "time", "error", "distance", "bound"]
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
class Rows:
    """A table of texts."""

    caption: str
    columns: list[Column]
    cells: list[list[str]]

    @classmethod
    def of(cls, table: Table, caption: str, case: str | None = None, without: Sequence[str] = ()) -> Rows:
        """The rows of a table of the study, of one case or of all, without some columns."""
        shown = table.cells if case is None else table.cells[table.cells["case"] == case]
        columns = [column for column in table.columns if column.name not in without]
        return cls(caption, columns, shown[[column.name for column in columns]].to_numpy().tolist())


@dataclass(frozen=True)
class Group:
    """A statement: its rows of the ledger (case, quantity, expected, observed, low, high, verdict) and their judge."""

    label: str
    says: str
    counts: dict[str, int]
    judges: list[str]
    rows: list[list[str]]


@dataclass(frozen=True)
class Case:
    """The page of a case."""

    name: str
    summary: str
    facts: dict[str, str]
    counts: dict[str, int]
    predicted: str
    seen: str
    strip: Strip | None
    charts: list[tuple[str, Chart]]
    film: dict[str, Any]
    tables: list[Rows]


@dataclass(frozen=True)
class Content:
    """The whole page."""

    counts: dict[str, int]
    groups: list[Group]
    cases: list[Case]
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
        """What the rows of the ledger are about: cases, and where in the source the slips are."""
        return list(dict.fromkeys(row[0] for group in self.groups for row in group.rows if row[0]))

    @property
    def names(self) -> set[str]:
        """The cases that have a page."""
        return {case.name for case in self.cases}


def read_content(directory: Path) -> Content:
    """Everything, from ``directory/data``.

    Raises:
        UsageError, StoreError: there is no finished run, or it is of another format.
        DataError: a data file is missing, damaged or older than the page needs.
    """
    provenance = read_provenance(directory)
    claims = read_claims(directory)
    return Content(
        counts=_count(claims),
        groups=_groups(directory, claims),
        cases=_Cases(directory, claims).all(),
        bounds=Rows.of(bounds_table(directory), "Enclosures of errors, of cases and of problems without a solution"),
        controls=_controls(directory),
        provenance=provenance,
        files=_files(directory),
    )


def _count(claims: pd.DataFrame) -> dict[str, int]:
    return {verdict: int((claims["verdict"] == verdict).sum()) for verdict in VERDICTS}


def _groups(directory: Path, claims: pd.DataFrame) -> list[Group]:
    """The ledger by statement, in its order; a label whose files say two things makes two groups."""
    judges = sources()
    cells = ledger_table(directory).cells
    columns = ["case", "quantity", "expected", "observed", "low", "high", "verdict"]
    return [
        Group(label, says, _count(rows), judges.get(label, []), rows[columns].to_numpy().tolist())
        for (label, says), rows in cells.groupby(["label", "statement"], sort=False)
    ]


@dataclass(frozen=True)
class _Cases:
    """Reads what the pages of cases share."""

    directory: Path
    claims: pd.DataFrame

    def all(self) -> list[Case]:
        """The cases in the order of ``cases.csv``."""
        listed = read_csv(self.directory, "cases.csv", CASES)
        rates = read_rates(self.directory)
        series = read_csv(self.directory, "enclosures.csv", ENCLOSURES)
        tables = [
            (rates_table(self.directory), "Errors on every mesh", ["case", "claim"]),
            (stress_table(self.directory), "The stress problem on its own space", ["case"]),
            (equivalence_table(self.directory), "The stress problem on the strains of V^h", ["case"]),
            (bounds_table(self.directory), "Guaranteed bounds of the error", ["case"]),
        ]
        return [
            self._case(
                fact,
                rates[rates["case"] == fact["case"]],
                series[series["case"] == fact["case"]],
                [Rows.of(table, caption, fact["case"], without) for table, caption, without in tables],
            )
            for fact in listed.to_dict("records")
        ]

    def _case(self, fact: dict[Any, Any], rates: pd.DataFrame, series: pd.DataFrame, tables: list[Rows]) -> Case:
        name, expected = str(fact["case"]), float(fact["expected_order"])
        orders = sorted(finest_orders(rates).values())
        return Case(
            name=name,
            summary=str(fact["summary"]),
            facts={
                "law": str(fact["law"]),
                "contact zone": str(fact["zone"]),
                "regularity": str(fact["regularity"]),
                "dimension": str(fact["dimension"]),
                "predicted order": f"{expected:.4g}",
                "proved order": "" if pd.isna(fact["proved_order"]) else f"{float(fact['proved_order']):.4g}",
                "why": str(fact["reason"]),
            },
            counts=_count(self.claims[self.claims["case"] == name]),
            predicted=f"{expected:.4g}",
            seen=" – ".join(dict.fromkeys(f"{order:.3f}" for order in orders[:1] + orders[-1:])),
            strip=Strip.of(rates, expected) if orders else None,
            charts=_charts(rates, expected, series[series["trajectory"] == "enclosure"]),
            film=self._film(name),
            tables=[table for table in tables if table.cells],
        )

    def _film(self, name: str) -> dict[str, Any]:
        path = self.directory / "data" / "pictures" / f"{name}.json"
        if not path.is_file():
            raise DataError(f"{path} is missing: make it with `study run --out {self.directory}`")
        return read_film(path)


def _charts(rates: pd.DataFrame, expected: float, enclosed: pd.DataFrame) -> list[tuple[str, Chart]]:
    """The plots of a case with their captions, of what was measured of it."""
    charts = []
    if len(rates):
        caption = f"Error (lines) and discrete error (dots); the dashes have the slope {expected:.4g}"
        charts.append((caption, convergence(rates, expected)))
    if len(enclosed):
        family, scheme = enclosed[["family", "scheme"]].iloc[-1]
        shown = enclosed[(enclosed["family"] == family) & (enclosed["scheme"] == scheme)]
        charts.append((f"Enclosure of the error over time, {family} meshes, {scheme}", enclosure(shown)))
    return charts


def _controls(directory: Path) -> Rows | None:
    """The deliberate defects, where there are data of them."""
    if not (directory / "data" / "controls.csv").is_file():
        return None
    names = [column.name for column in CONTROLS]
    frame = read_csv(directory, "controls.csv", names)
    cells = [[cell(value) for value in row] for row in frame[names].to_numpy()]
    return Rows("Deliberate defects and the row that noticed", CONTROLS, cells)


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

"""What the page shows of each case."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from study.ledger.datafiles import count_verdicts, read_csv, read_rates
from study.present.charts.convergence_chart import convergence_chart, finest_orders
from study.present.charts.enclosure_chart import enclosure_charts
from study.present.charts.palette import looks
from study.present.report.film import read_film
from study.present.report.svg_chart import SvgChart
from study.present.tables import Column, Table, bounds_table, equivalence_table, rates_table, stress_table

CASES = ["case", "summary", "dimension", "law", "zone", "regularity", "expected_order", "proved_order", "reason"]
ENCLOSURES = ["trajectory", "case", "family", "scheme", "level", "time", "error", "distance", "bound"]


@dataclass(frozen=True)
class Rows:
    """A table of texts; ``letters`` names those that explain its symbols."""

    caption: str
    columns: list[Column]
    cells: list[list[str]]
    letters: str

    @classmethod
    def of(cls, table: Table, caption: str, case: str | None = None, without: Sequence[str] = ()) -> Rows:
        """The rows of a table of the study, of one case or of all, without some columns."""
        shown = table.cells if case is None else table.cells[table.cells["case"] == case]
        columns = [column for column in table.columns if column.name not in without]
        return cls(caption, columns, shown[[column.name for column in columns]].to_numpy().tolist(), table.name)


@dataclass(frozen=True)
class OrderStrip:
    """Orders from 0 to ``HIGHEST`` as coordinates from 0 to ``WIDTH``: the predicted one, and those observed."""

    HIGHEST = 1.5
    WIDTH = 150

    predicted: float
    observed: list[tuple[float, str]]

    @classmethod
    def of(cls, rates: pd.DataFrame, expected: float, orders: dict[str, float]) -> OrderStrip:
        """From the order on every mesh family, in the colour of the family."""
        look = looks(rates["family"])
        return cls(cls._at(expected), [(cls._at(order), look[family].colour) for family, order in orders.items()])

    @classmethod
    def _at(cls, order: float) -> float:
        return round(cls.WIDTH * min(max(order / cls.HIGHEST, 0.0), 1.0), 1)


@dataclass(frozen=True)
class CasePage:
    """One case: what it is, its verdicts, its orders, its motion, charts and tables."""

    name: str
    summary: str
    facts: dict[str, str]
    counts: dict[str, int]
    predicted: str
    observed: str
    strip: OrderStrip | None
    charts: list[SvgChart]
    film: dict[str, Any]
    tables: list[Rows]


def case_pages(directory: Path, claims: pd.DataFrame) -> list[CasePage]:
    """The cases in the order of ``cases.csv``; DataError for a data file that is missing or damaged."""
    listed = read_csv(directory, "cases.csv", CASES).to_dict("records")
    rates, enclosures = read_rates(directory), read_csv(directory, "enclosures.csv", ENCLOSURES)
    tables = [
        (rates_table(directory), "Errors on every mesh", ["case", "claim"]),
        (stress_table(directory), "The stress problem on its own space", ["case"]),
        (equivalence_table(directory), "The stress problem on the strains of V^h", ["case"]),
        (bounds_table(directory), "Bounds of the error", ["case"]),
    ]
    pages = []
    for fact in listed:
        name = fact["case"]
        verdicts, errors, bounds = (frame[frame["case"] == name] for frame in (claims, rates, enclosures))
        rows = [Rows.of(table, caption, name, without) for table, caption, without in tables]
        pages.append(_case_page(fact, verdicts, errors, bounds, read_film(directory, name), rows))
    return pages


def _case_page(
    fact: dict[Any, Any],
    claims: pd.DataFrame,
    rates: pd.DataFrame,
    enclosures: pd.DataFrame,
    film: dict[str, Any],
    tables: list[Rows],
) -> CasePage:
    expected = float(fact["expected_order"])
    found = finest_orders(rates, refinements=2)
    orders = sorted(found.values())
    charts = [convergence_chart(rates, expected)] if len(rates) else []
    charts += [chart for _, chart in enclosure_charts(enclosures)]
    return CasePage(
        name=fact["case"],
        summary=fact["summary"],
        facts={
            "law": fact["law"],
            "contact zone": fact["zone"],
            "regularity": fact["regularity"],
            "dimension": str(fact["dimension"]),
            "predicted order": f"{expected:.4g}",
            "proved order": "" if pd.isna(fact["proved_order"]) else f"{float(fact['proved_order']):.4g}",
            "why": fact["reason"],
        },
        counts=count_verdicts(claims),
        predicted=f"{expected:.4g}",
        observed=" – ".join(dict.fromkeys(f"{order:.3f}" for order in orders[:1] + orders[-1:])),
        strip=OrderStrip.of(rates, expected, found) if orders else None,
        charts=list(map(SvgChart, charts)),
        film=film,
        tables=[table for table in tables if table.cells],
    )

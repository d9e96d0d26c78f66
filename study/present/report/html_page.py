"""The page: the data files set by its template."""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from study.ledger.datafiles import by_claim, count_verdicts, read_claims, read_rates
from study.ledger.files import write_text
from study.ledger.rounding import significant
from study.present.charts import palette
from study.present.charts.collapsed_chart import collapsed_chart
from study.present.report.case_page import Rows, case_pages
from study.present.report.letters import LETTERS, MEANINGS
from study.present.report.svg_chart import SvgChart, typeset
from study.present.tables import bounds_table, controls_table, ledger_table, names, numbers


@dataclass(frozen=True)
class LedgerGroup:
    """A statement: its rows of the ledger (case, quantity, expected, observed, low, high, verdict) and their judge."""

    label: str
    says: str
    counts: dict[str, int]
    judges: list[str]
    rows: list[list[str]]


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
    environment.globals["palette"] = palette
    environment.filters |= {"typeset": typeset, "number": significant}
    page = environment.get_template("page.html").render(content=_content(directory, provenance))
    return write_text(directory / "report.html", page + "\n")


def _content(directory: Path, provenance: dict[str, Any]) -> dict[str, Any]:
    """What the template sets."""
    claims, controls = read_claims(directory), controls_table(directory)
    groups, cases = _groups(directory, provenance.get("statements", {})), case_pages(directory, claims)
    return {
        "counts": count_verdicts(claims),
        "meanings": MEANINGS,
        "letters": LETTERS,
        # The case with most contact faces in the plane, where most can be seen.
        "shown": max(cases, key=lambda case: (len(case.film["view"]) == 2) * len(case.film["faces"])),
        "collapsed": _collapsed(directory),
        "rows": len(claims),
        "groups": groups,
        "labels": list(dict.fromkeys(group.label for group in groups)),
        # What rows are about: cases, and where in the paper there are slips.
        "places": list(dict.fromkeys(row[0] for group in groups for row in group.rows if row[0])),
        "cases": cases,
        "names": {case.name for case in cases},
        "bounds": Rows.of(bounds_table(directory), "Enclosures of errors, of cases and of problems without a solution"),
        "controls": controls and Rows.of(controls, "Deliberate defects and the row of the ledger that has to fail"),
        "provenance": provenance,
        "files": _files(directory),
    }


def _groups(directory: Path, made: dict[str, dict[str, Any]]) -> list[LedgerGroup]:
    """The ledger by statement, in its order; a label that stands for two statements makes two groups."""
    cells = ledger_table(directory).cells
    columns = ["case", "quantity", "expected", "observed", "low", "high", "verdict"]
    code = {label: list(statement["code"]) for label, statement in made.items()}
    return [
        LedgerGroup(label, says, count_verdicts(rows), code.get(label, []), rows[columns].to_numpy().tolist())
        for label, says, rows in by_claim(cells)
    ]


def _collapsed(directory: Path) -> SvgChart | None:
    """The errors of all cases of Prop. 5.4 in one chart, where there are any."""
    rates = read_rates(directory)
    smooth = rates[rates["claim"] == "Prop. 5.4"]
    return SvgChart(collapsed_chart(smooth)) if len(smooth) else None


def _files(directory: Path) -> Rows:
    """The data files that the page was made from, by what is in them."""
    data = directory / "data"
    paths = sorted([*data.glob("*.csv"), *data.glob("*.json"), *data.glob("pictures/*.json")])
    contents = {path.relative_to(data).as_posix(): path.read_bytes() for path in paths}
    cells = [
        [name, significant(len(content) / 1000), sha256(content).hexdigest()] for name, content in contents.items()
    ]
    columns = [*names(file="file"), *numbers(size="kB"), *names(sha="SHA-256")]
    return Rows("The data files behind this page", columns, cells, "")

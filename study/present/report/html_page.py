"""The page from its template."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from study.ledger.files import write_text
from study.ledger.rounding import significant
from study.present.report.content import read_content
from study.present.report.typeset import typeset


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

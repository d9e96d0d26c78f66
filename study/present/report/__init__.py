"""One self-contained HTML page from the data files: the ledger with filters, tables, plots, a page for every case.

Nothing is solved here, and the page asks no network for anything.
"""

from __future__ import annotations

from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined

from study.ledger.files import write_text
from study.present.report.content import read_content
from study.present.report.typeset import typeset
from study.present.terminal import significant


def write_report(directory: Path) -> Path:
    """Write ``directory/report.html`` from the files under ``directory/data``; returns its path.

    Raises:
        UsageError, StoreError: there is no finished run, or it is of another format.
        DataError: a data file is missing, damaged or older than the page needs; nothing is written then.
    """
    environment = Environment(
        loader=PackageLoader("study.present.report", "page"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
    )
    environment.filters |= {"typeset": typeset, "number": significant}
    content = read_content(directory)
    return write_text(directory / "report.html", environment.get_template("page.html").render(content=content) + "\n")

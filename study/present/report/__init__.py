"""One self-contained HTML page from the data files: the ledger with filters, tables, charts, a page for every case.

Nothing is solved here, and the page asks no network for anything.
"""

from study.present.report.html_page import write_report

__all__ = ["write_report"]

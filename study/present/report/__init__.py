"""One HTML page from the data files, which asks no network for anything: ledger, tables, charts, every case."""

from study.present.report.html_page import write_report

__all__ = ["write_report"]

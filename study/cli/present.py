"""``study tables``, ``study figures`` and ``study report``: present the data in a result directory."""

from __future__ import annotations

import argparse

from study.cli.common import check_jobs, draw, listed
from study.cli.options import OK
from study.ledger.text import folded
from study.present.figures import drawings
from study.present.report import write_report
from study.present.tables import write_tables
from study.run.executor import Processes
from study.run.judgement import claims_file, judge
from study.run.provenance import read_provenance
from study.run.store import Store


def do_tables(options: argparse.Namespace) -> int:
    """Judge the data and write ``claims.csv`` and the tables; return 0."""
    read_provenance(options.out)
    with Store(options.out).steady():
        judge(options.out)
        print(folded(f"written: {listed([claims_file(options.out), *write_tables(options.out)])}"))
    return OK


def do_report(options: argparse.Namespace) -> int:
    """Write the report, one HTML page; return 0."""
    with Store(options.out).steady():
        print(write_report(options.out, read_provenance(options.out)))
    return OK


def do_figures(options: argparse.Namespace) -> int:
    """Draw all figures; return 0."""
    check_jobs(options.jobs)
    read_provenance(options.out)
    with Processes(options.jobs) as executor, Store(options.out).steady():
        print(folded(f"written: {listed(draw(options.out, executor, drawings))}"))
    return OK

"""``study sensitivity``: how small a defect may be that the verdicts still see."""

from __future__ import annotations

import argparse

from study.cli.common import check_jobs, progress_bar
from study.cli.exits import FAILED, OK
from study.controls.sensitivity import MOST, PLACES, run_sensitivity, sensitivity_text, write_sensitivity
from study.run.processes import Processes
from study.run.store import Store


def do_sensitivity(options: argparse.Namespace) -> int:
    """``study sensitivity``: the smallest relative defect of every piece that turns a row red, and the row."""
    check_jobs(options.jobs)
    store = Store(options.out)
    store.check()
    with Processes(min(options.jobs, len(PLACES))) as executor, store.locked():
        with progress_bar(len(PLACES)) as bar:
            table = run_sensitivity(executor, bar.update)
        written = write_sensitivity(options.out, table)
    print(f"\n{sensitivity_text(table)}")
    print(f"data: {written}")
    return OK if (table["amount"] < MOST).all() else FAILED

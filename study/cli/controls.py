"""What the verdicts are worth: ``study controls`` with deliberate defects (``seeds``: on other random meshes)."""

from __future__ import annotations

import argparse

from study.cli.common import check_jobs, progress_bar
from study.cli.exits import FAILED, OK
from study.controls import table
from study.controls.run_controls import controls_text, run_controls, settings, write_controls
from study.run.processes import Processes
from study.run.store import Store


def do_controls(options: argparse.Namespace) -> int:
    """``study controls``: measure with every defect and without one, write what caught it."""
    check_jobs(options.jobs)
    store = Store(options.out)
    store.check()
    chosen = table.CONTROLS
    with Processes(options.jobs) as executor, store.locked():
        with progress_bar(len(settings(chosen)) + len(chosen)) as bar:
            bar.set_description(f"{len(chosen)} defects")
            findings = run_controls(chosen, executor, store, bar.update)
        written = write_controls(options.out, findings)
    print(f"\ndata: {written}\n\n{controls_text(findings)}")
    return OK if all(finding.passes for finding in findings) else FAILED

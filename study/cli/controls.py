"""``study controls`` tests that deliberate defects of the study are noticed by its checks.

``study sensitivity`` finds the smallest defects that are noticed.
"""

import argparse

from study.cli.common import progress_bar
from study.cli.options import FAILED, OK
from study.controls import table
from study.controls.run_controls import controls_text, run_controls, settings, write_controls
from study.controls.sensitivity import MOST, PLACES, run_sensitivity, sensitivity_text
from study.ledger.datafiles import write_csv
from study.run.executor import Processes
from study.run.store import Store


def do_controls(options: argparse.Namespace) -> int:
    """Measure with and without each deliberate defect, and write which defects the checks noticed.

    Returns:
        0 if all defects are noticed, else 1.
    """
    store = Store(options.out)
    store.check()
    controls = table.CONTROLS
    with Processes(options.jobs) as executor, store.locked():
        with progress_bar(len(settings(controls)) + len(controls), f"{len(controls)} defects") as bar:
            findings = run_controls(controls, executor, store, bar.update)
        written = write_controls(options.out, findings)
    print(f"\ndata: {written}\n\n{controls_text(findings)}")
    return OK if all(finding.passes for finding in findings) else FAILED


def do_sensitivity(options: argparse.Namespace) -> int:
    """Find for each part of the problem the smallest defect that makes a check fail, and write these defects.

    Returns:
        0 if each part has such a defect, else 1.
    """
    store = Store(options.out)
    store.check()
    with Processes(min(options.jobs, len(PLACES))) as executor, store.locked():
        with progress_bar(len(PLACES)) as bar:
            amounts = run_sensitivity(executor, bar.update)
        written = write_csv(options.out / "data" / "sensitivity.csv", amounts)
    print(f"\n{sensitivity_text(amounts)}")
    print(f"data: {written}")
    return OK if (amounts["amount"] < MOST).all() else FAILED

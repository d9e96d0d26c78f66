"""What the verdicts are worth: ``study controls`` with deliberate defects, ``study seeds`` on other random meshes."""

from __future__ import annotations

import argparse

from study.cli.common import FAILED, OK, check_jobs, measure, progress_bar
from study.controls import register
from study.controls.alarms import seeded, tally, text, write_seeds
from study.controls.run_controls import controls_text, run_controls, settings, write_controls
from study.ledger.errors import UsageError
from study.run.execute import Pool
from study.run.processes import Processes
from study.run.store import Store


def do_controls(options: argparse.Namespace) -> int:
    """``study controls``: measure with every defect and without one, write what caught it."""
    check_jobs(options.jobs)
    store = Store(options.out)
    store.check()
    chosen = register.CONTROLS
    with Processes(options.jobs) as executor, store.locked():
        with progress_bar(len(settings(chosen)) + len(chosen)) as bar:
            bar.set_description(f"{len(chosen)} defects")
            findings = run_controls(chosen, executor, store, bar.update)
        written = write_controls(options.out, findings)
    print(f"\ndata: {written}\n\n{controls_text(findings)}")
    return OK if all(finding.passes for finding in findings) else FAILED


def do_seeds(options: argparse.Namespace) -> int:
    """``study seeds``: the quick study on shaken meshes of other seeds, and how often a row does not hold."""
    check_jobs(options.jobs)
    if options.seeds < 1:
        raise UsageError(f"--seeds must be 1 or more, got {options.seeds}")
    Store(options.out).check()
    found = {}
    with Processes(options.jobs) as processes:
        pool = Pool.of(processes)
        for seed in range(options.seeds):
            store = Store(options.out / "seeds" / str(seed))
            with store.locked():
                found[seed] = measure(seeded(seed), store, pool)
    table = tally(found)
    written = write_seeds(options.out, table)
    print(f"\ndata: {written}\n\n{text(table)}")
    return FAILED if table.loc[table["claimed"] == "yes", "alarms"].any() else OK

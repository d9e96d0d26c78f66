"""``study controls``: deliberate defects that the verdicts must catch."""

from __future__ import annotations

import argparse

from study.cli.common import FAILED, OK, Commands, check_jobs, jobs_option, out_option, progress_bar
from study.controls import register
from study.controls.run_controls import controls_text, run_controls, settings, write_controls
from study.run.processes import Processes
from study.run.store import Store


def add(commands: Commands) -> None:
    """The command and its options."""
    controls = commands.add_parser(
        "controls", help="deliberate defects that the verdicts must catch; exit 0 all caught"
    )
    jobs_option(controls)
    out_option(controls)
    controls.set_defaults(command=do_controls)


def do_controls(options: argparse.Namespace) -> int:
    """``study controls``: measure with every defect and without one, write what caught it."""
    check_jobs(options.jobs)
    store = Store(options.out)
    store.check()
    chosen = register.CONTROLS
    with Processes(options.jobs) as executor, store.locked():
        with progress_bar(len(settings(chosen)) + len(chosen)) as bar:
            bar.set_description(f"{len(chosen)} defects")
            findings = run_controls(chosen, executor, bar.update)
        written = write_controls(options.out, findings)
    print(f"\n{controls_text(findings)}")
    print(f"data: {written}")
    return OK if all(finding.passes for finding in findings) else FAILED

"""``study export``: tasks for other people's codes."""

from __future__ import annotations

import argparse

from manufactured.self_proof import prove
from study.cli.common import OK
from study.fem.naming import family_named, resolve
from study.ledger.errors import UsageError
from study.run.task_data import INSTANTS, frozen, march, with_foundation, write_task
from study.run.tasks import Task
from study.solve.steps import require_steps


def do_export(options: argparse.Namespace) -> int:
    """``study export``."""
    case = resolve(options.case)
    _check(options)
    prove(case.solution, f"case {case.name}")
    T = case.solution.body.T
    instants = options.instants or [T * part for part in INSTANTS]
    for family in options.family:
        for level in options.levels:
            task = Task(case, family_named(family), level)
            if options.mode == "frozen":
                data = frozen(task, instants, options.scale)
            else:
                data = march(task, options.steps or level, options.scale)
            if options.foundation is not None:
                data = with_foundation(data, options.foundation)
            path = write_task(options.to, data)
            print(f"{path}  {path.stat().st_size / 1000:.1f} kB")
    return OK


def _check(options: argparse.Namespace) -> None:
    if min(options.levels) < 2:
        raise UsageError(f"--levels must be 2 or more, got {min(options.levels)}")
    if options.mode == "march" and options.instants:
        raise UsageError("--instants are those of --mode frozen; a march has equal steps, say how many with --steps")
    if options.mode == "frozen" and options.steps is not None:
        raise UsageError("--steps are those of --mode march; give the --instants of frozen problems")
    if options.steps is not None:
        if options.steps < 1:
            raise UsageError(f"--steps must be 1 or more, got {options.steps}")
        require_steps(options.steps)

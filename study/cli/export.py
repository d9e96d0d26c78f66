"""``study export``: writes contact problems as files for other codes."""

import argparse

from manufactured.case import Case
from manufactured.self_proof import prove
from study.cli.options import OK
from study.fem.mesh import MeshError, boundary_parts
from study.fem.naming import family_named, resolve
from study.ledger.files import UsageError
from study.run.executor import available, require
from study.run.plan import quick
from study.run.tasks import TaskStore, frozen, march, with_foundation, write_task
from study.solve.steps import require_steps
from study.statements.shared import estimates
from study.statements.shared.meshes import fits
from study.statements.shared.tasks import FROZEN_TIMES, Task

MOST_LEVELS = 12
"""Levels next to the one that was asked for that are tried if its mesh does not fit the body."""


def do_export(options: argparse.Namespace) -> int:
    """Write one file for each case, mesh family and level; return 0.

    By default, each case is written on the mesh families on which the quick study measures it.
    """
    cases = [resolve(name) for name in options.case]
    if repeated := {case.name for case in cases if [other.name for other in cases].count(case.name) > 1}:
        raise UsageError(f"two cases have the name {', '.join(sorted(repeated))}; give each case once")
    wanted = []
    for case in cases:
        _check(options, case)
        families = [family_named(name) for name in options.family] if options.family else quick().families_of(case)
        wanted += [Task(case, family, level) for family in families for level in options.levels]
    marches = options.mode == "march"
    for task in wanted:
        steps = options.steps or task.level if marches else len(options.instants or FROZEN_TIMES)
        need = estimates.task(task.solution.body.dim, task.level, task.family.name, steps)
        require(f"level {task.level}", need, available())
        _require_mesh(task)
    for case in cases:
        prove(case.solution, f"case {case.name}")
    with TaskStore(options.out).locked():
        for task in wanted:
            # A ``Task`` keeps its mesh and factorisations. A new one for each file frees the memory of the one before.
            fresh = Task(task.case, task.family, task.level)
            if marches:
                data = march(fresh, options.steps or task.level, options.scale)
            else:
                data = frozen(fresh, _instants(options, task.case), options.scale)
            if options.foundation is not None:
                data = with_foundation(data, options.foundation)
            path = write_task(options.out, data)
            print(f"{path}  {path.stat().st_size / 1000:.1f} kB")
    return OK


def _require_mesh(task: Task) -> None:
    """Raise UsageError, which names the case and levels that would do, unless the mesh fits the body."""
    body = task.solution.body
    try:
        boundary_parts(task.family(body, task.level), body)
    except MeshError as error:
        near = sorted(range(1, 2 * task.level), key=lambda level: abs(level - task.level))[:MOST_LEVELS]
        fit = [str(level) for level in near if fits(task.family, body, level)][:3]
        mend = f"; levels that would do: {', '.join(fit)}" if fit else ""
        where = f"case {task.case.name} on {task.family.name} meshes of level {task.level}"
        raise UsageError(f"{where}: {error}{mend}") from error


def _instants(options: argparse.Namespace, case: Case) -> list[float]:
    return options.instants or [case.solution.body.T * part for part in FROZEN_TIMES]


def _check(options: argparse.Namespace, case: Case) -> None:
    """Raise UsageError for options that cannot be used, before anything is written."""
    if options.mode == "march" and options.instants:
        raise UsageError("--instants belong to --mode frozen; for --mode march give the number of --steps")
    if options.mode == "frozen" and options.steps is not None:
        raise UsageError("--steps belong to --mode march; for --mode frozen give --instants")
    if options.steps is not None:
        require_steps(options.steps)
    instants, T = _instants(options, case), case.solution.body.T
    if min(instants) < 0 or max(instants) > T:
        raise UsageError(f"--instants must lie in [0, {T:g}], got {', '.join(f'{t:g}' for t in instants)}")
    if options.foundation is not None and case.solution.body.dim != 2:
        raise UsageError("--foundation meshes foundations in the plane only; leave it out for a body in space")

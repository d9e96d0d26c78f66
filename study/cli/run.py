"""``study run``: measures, writes data and judges them; with ``--figures`` it also writes tables and figures."""

import shlex
import sys
from argparse import Namespace
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from study.cli.common import ProgressBar, code_of, job_progress, known_undecided, tell_written
from study.fem.naming import absolute, choose, name_of
from study.ledger.datafiles import read_claims
from study.ledger.files import Json
from study.ledger.text import folded
from study.present.outcome import ledger_text, orders_text, rates_text
from study.run.executor import Pool, connected, execute, local_pool, prove, refuse_too_large, save_proofs, unfinished
from study.run.judgement import collect, judge, judge_stored
from study.run.plan import PLANE_LEVELS, Job, Jobs, Plan, full, quick
from study.run.provenance import read_provenance, refuse_to_replace
from study.run.store import Store
from study.solve.tableau import SCHEMES
from study.statements.own_cases import enough, least_levels
from study.statements.shared.scope import Levels, Scope

RESULT_PLACES = {"quick": Path("results/quick"), "full": Path("results")}
"""Default result directories of the quick and the full study."""


def do_run(options: Namespace) -> int:
    """Run the study: measure, write data and judge them; with ``--figures``, also write tables and figures.

    Returns:
        0 if all checks hold, 1 if a check fails, 3 if a check is undecided; ``code_of`` describes it in detail.

    Raises:
        UsageError, SelfProofError, MeshError, StoreError: bad input; raised before anything is computed.
    """
    choose("scheme", options.scheme, SCHEMES)
    known_undecided(options.undecided)
    scope = scope_from_options(options)
    scope.check()
    warn_of_few_levels(scope)
    directory = options.out or RESULT_PLACES[options.plan]
    store = Store(directory)
    if options.levels:
        scope = with_levels_of(directory, scope)
    plan = Plan.of(scope)
    # Cache keys need all cases. Workers that are forked afterwards inherit the cases and need not make them again.
    missing = unfinished(plan.jobs, store)
    # More processes than jobs would have nothing to do.
    workers = min(options.jobs, len(plan.jobs))
    with connected(options.cluster, scope.cases) if options.cluster else local_pool(workers) as pool:
        refuse_too_large(missing, pool)
        # The meshes of the quick and the full study are known to fit.
        if options.case or options.levels:
            plan.check()
        # A user's case is refused before the result directory exists.
        proofs = prove(plan.stages()[0], scope.cases, store, pool)
        with store.locked():
            save_proofs(proofs, store)
            measure(plan, store, pool)
            verdicts = judge(directory)
    data = ", ".join(path.name for path in sorted(store.data.glob("[!.]*")))
    print("\n" + folded(f"data: {store.data}/{data}"))
    if options.figures:
        # Imported only to draw, because Matplotlib takes half a second.
        from study.cli.present import write_overview

        with store.locked():
            written = write_overview(options, directory)
        tell_written(written)
    print(f"\n{rates_text(directory)}")
    print(ledger_text(read_claims(directory), orders_text(directory)))
    return code_of(verdicts, options.undecided)


def measure(plan: Plan, store: Store, pool: Pool) -> None:
    """Make the measurements (jobs) of a plan whose results are not stored, and write the data files.

    Parameters:
        plan: the scope of the study and its jobs.
        store: the result directory with the stored results.
        pool: the processes that make the measurements.
    """
    refuse_to_replace(plan, store.directory)
    store.check()
    left = unfinished(plan.jobs, store)
    with job_progress(left, f"{len(left)} jobs") as bar:
        for stage in plan.stages():
            save_proofs(prove(stage, plan.scope.cases, store, pool), store)
            execute(stage, store, pool, verdict_printer(stage, store, bar))
        collect(plan, store)


def verdict_printer(jobs: Jobs, store: Store, bar: ProgressBar) -> Callable[[Job], None]:
    """Return a function that moves a progress bar, and prints the verdicts on a statement when they can be judged.

    The function is called with each finished job. The verdicts on a statement for a case are printed when all its
    measurements are finished. Statements that are judged from several files are left out.

    Parameters:
        jobs: all jobs of the stage.
        store: the result directory, from which the measurements are read.
        bar: the progress bar.
    """
    left = Counter((job.statement, job.case) for job in unfinished(jobs, store))

    def tell(job: Job) -> None:
        bar.add(job)
        group = job.statement, job.case
        left[group] -= 1
        if left[group] == 0:
            all_jobs = [other for other in jobs if (other.statement, other.case) == group]
            if counts := Counter(verdict.verdict for verdict in judge_stored(all_jobs, store)):
                words = ", ".join(f"{count} {verdict}" for verdict, count in counts.items())
                bar.write(f"{job.statement.label}, {name_of(job.case)}: {words}", file=sys.stderr)

    return tell


def with_levels_of(directory: Path, scope: Scope) -> Scope:
    """Return a scope (cases and their levels) to which the levels of an earlier run in this directory are added.

    They are added for each case that has levels in the scope on which the earlier run did not measure it. Such a case
    is then measured on old and new levels together. All other cases keep the levels of the scope.

    Parameters:
        directory: the result directory; without an earlier run in it, the scope is returned unchanged.
        scope: the scope.
    """
    if not (directory / "data" / "provenance.json").exists():
        return scope
    planned = read_provenance(directory)["planned"]
    for case in scope.resolved():
        given = set(scope.levels_of(case).all)
        had, compared = (
            {int(row[-1]) for row in planned if row[:2] == (name, case.name)}
            for name in ("rates.csv", "equivalence.csv")
        )
        if not had or not given - had:
            continue
        if had - given:
            old, new = (" ".join(map(str, sorted(levels))) for levels in (had, given - had))
            print(f"study: {directory} has {case.name} on the levels {old}: {new} added", file=sys.stderr)
        own = (*scope.own, (case.name, Levels(tuple(sorted(had | given)))))
        equivalence = "equivalence" if case.solution.body.dim == 2 else "solid_equivalence"
        both: Json = {equivalence: tuple(sorted(compared | {*getattr(scope, equivalence)}))}
        scope = replace(scope, own=own, **both)
    return scope


def warn_of_few_levels(scope: Scope) -> None:
    """Print a warning for each case that has too few levels for a verdict on an observed order."""
    for case in scope.resolved():
        needed = least_levels(case.proposition)
        given = scope.levels_of(case).all
        if len(given) < needed:
            print(
                f"study: {case.name}: a verdict on an order needs {needed} levels, not only "
                f"{' '.join(map(str, given))}; give {needed} or more, such as --levels "
                f"{' '.join(map(str, enough(given, needed, case.solution.body.dim)))}",
                file=sys.stderr,
            )


def scope_from_options(options: Namespace) -> Scope:
    """Return the scope of the quick or full study, changed by the options for cases, levels and time steps."""
    study = {"quick": quick, "full": full}[options.plan]()
    scope = replace(study, scheme=options.scheme, k=options.step, command=command_line(options))
    if options.case:
        cases = tuple(map(absolute, options.case))
        alone = scope.plane if scope.full else PLANE_LEVELS
        scope = replace(scope, cases=cases, plane=alone, every_family=True, statements=False)
    if options.levels:
        levels = Levels(tuple(options.levels))
        # Theorem 4.2 is tested on coarse levels only, because the interior-point method solves only small problems.
        plane, solid = ([n for n in options.levels if n <= most] for most in (8, 6))
        scope = replace(
            scope,
            plane=levels,
            rough=levels,
            solid=levels,
            own=(),
            equivalence=tuple(plane) or scope.equivalence[:1],
            solid_equivalence=tuple(solid[:1]) or scope.solid_equivalence,
        )
    return scope


def command_line(options: Namespace) -> str:
    """Return the command line of ``study run`` with the given options, but for those that change no result."""
    words = ["study", "run"]
    if options.plan == "full":
        words.append("--full")
    for name, usual in (("case", None), ("levels", None), ("scheme", "midpoint"), ("step", None)):
        value = getattr(options, name)
        if value != usual:
            values = value if isinstance(value, list) else [value]
            words += [f"--{name}", *map(str, values)]
    return shlex.join(words)

"""``study run``: refuse bad input, compute, write data, judge, present."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from pathlib import Path

from study.cli.common import check_jobs, draw, listed, measure
from study.cli.exits import FAILED, OK
from study.cli.typed import run_line
from study.fem.naming import absolute, choose
from study.ledger.datafiles import read_claims
from study.ledger.terminal import folded
from study.ledger.verdict import Verdict, all_pass
from study.present.figures import drawings, overview
from study.present.outcome import ledger_text, rates_text
from study.present.tables import write_tables
from study.run.cluster import connected
from study.run.execute import Pool, refuse_too_large, unfinished
from study.run.judgement import judge
from study.run.plan import Plan, full, quick
from study.run.processes import Processes
from study.run.provenance import read_provenance
from study.run.store import Store
from study.solve.tableau import SCHEMES
from study.statements.own_cases import TRY, enough, finer, least_levels
from study.statements.shared.scope import Levels, Scope

PLACES = {"quick": Path("results/quick"), "full": Path("results")}
"""Where a run of a plan goes unless it is told."""


def do_run(options: argparse.Namespace) -> int:
    """``study run``: refuse bad input, compute, write data, judge, present."""
    choose("scheme", options.scheme, SCHEMES)
    check_jobs(options.jobs)
    scope = chosen(options)
    scope.check()
    warn_of_few_levels(scope)
    store = Store(options.out or PLACES[options.plan])
    if options.levels:
        scope = with_levels_of(store.directory, scope)
    plan = Plan.of(scope)
    # More processes than there is work would only be started.
    with (
        Processes(min(options.jobs, max(len(plan.jobs), len(scope.cases)))) as processes,
        _pool(options.cluster, plan, processes) as pool,
    ):
        refuse_too_large(unfinished(plan.jobs, store), pool)
        plan.check(processes.map)
        with store.locked():
            measure(plan, store, pool)
            # Neither verdicts nor figures wait for the other.
            judged = processes.submit(concluded, store.directory)
            # Drawing all takes as long as a third of the quick study.
            drawn = draw(store.directory, processes, drawings if options.case else overview)
            verdicts, tables = judged.result()
    data = "rates.csv, equivalence.csv, claims.csv, cases.csv, provenance.json, pictures/"
    print(f"\n{folded(f'data: {store.data}/{data}')}")
    print(folded(f"written: {listed([*tables, *drawn])}"))
    print(f"\n{rates_text(store.directory)}")
    print(ledger_text(read_claims(store.directory)))
    if any(TRY in verdict.expected for verdict in verdicts):
        print(f"on finer meshes: {on_finer_meshes(options, scope, store.directory)}")
    return OK if all_pass(verdicts) else FAILED


def concluded(directory: Path) -> tuple[list[Verdict], list[Path]]:
    """Judge the data, and show it in tables: the verdicts, and the files of the tables."""
    return judge(directory), write_tables(directory)


def with_levels_of(directory: Path, scope: Scope) -> Scope:
    """A scope with the levels that a directory has of its cases, where it asks for others beside them."""
    if not (directory / "data" / "provenance.json").exists():
        return scope
    planned = read_provenance(directory)["planned"]
    for case in scope.resolved():
        given = set(scope.levels_of(case).all)
        had, compared = (
            {int(row[-1]) for row in planned if row[:2] == [name, case.name]}
            for name in ("rates.csv", "equivalence.csv")
        )
        if not had or not given - had:
            continue
        if had - given:
            print(
                f"study: {directory} has {case.name} on the levels {spaced(had)}: {spaced(given - had)} added",
                file=sys.stderr,
            )
        scope = replace(scope, own=(*scope.own, (case.name, Levels(tuple(sorted(had | given))))))
        if case.solution.body.dim == 2:
            scope = replace(scope, equivalence=tuple(sorted(compared | {*scope.equivalence})))
        else:
            scope = replace(scope, solid_equivalence=tuple(sorted(compared | {*scope.solid_equivalence})))
    return scope


def spaced(levels: Iterable[int]) -> str:
    """Levels in order."""
    return " ".join(map(str, sorted(levels)))


def on_finer_meshes(options: argparse.Namespace, scope: Scope, directory: Path) -> str:
    """The same command on finer meshes, into a directory beside."""
    cases = scope.resolved()
    dim = max(case.solution.body.dim for case in cases)
    levels = finer(sorted({level for case in cases for level in scope.levels_of(case).all}), dim)
    return run_line(options, levels, directory.with_name(f"{directory.name}-finer"))


def warn_of_few_levels(scope: Scope) -> None:
    """Say beforehand where there are too few levels to decide anything about orders."""
    for case in scope.resolved():
        needed, given = least_levels(case.proposition), scope.levels_of(case).all
        if len(given) < needed:
            print(
                f"study: {case.name}: an order takes {needed} levels, nothing is decided about it with "
                f"{' '.join(map(str, given))}; give {needed} or more, such as --levels "
                f"{' '.join(map(str, enough(given, needed, case.solution.body.dim)))}",
                file=sys.stderr,
            )


def chosen(options: argparse.Namespace) -> Scope:
    """The quick or the full study, or what the options make of it."""
    study = {"quick": quick, "full": full}[options.plan]()
    scope = replace(study, scheme=options.scheme, k=options.step, command=run_line(options))
    if options.case:
        scope = replace(scope, cases=tuple(map(absolute, options.case)), every_family=True, statements=False)
    if options.levels:
        levels = Levels(tuple(options.levels))
        # The interior point method is for small problems, whatever the levels of the others.
        plane, solid = ([n for n in options.levels if n <= most] for most in (16, 6))
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


def _pool(cluster: str | None, plan: Plan, processes: Processes) -> AbstractContextManager[Pool]:
    return connected(cluster, plan.scope.cases) if cluster else nullcontext(Pool.of(processes))

"""The ``study`` command."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import BrokenExecutor
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from pathlib import Path

import pandas as pd
from tqdm import tqdm

from manufactured.admissibility import SelfProofError, examine
from manufactured.body import BodyError
from manufactured.case import Case, CaseError
from manufactured.catalogue import catalogue
from manufactured.data import LoadError
from manufactured.law import LawError
from manufactured.symbols import FormulaError
from study.bound.discretisation import BoundError
from study.bound.enclosure import Better
from study.bound.report import levels, series, text, write
from study.controls import register
from study.controls.judge import controls_text, run_controls, settings, write_controls
from study.controls.seeds import SEEDS, seeded, tally, write_seeds
from study.controls.seeds import text as seeds_text
from study.fem.mesh import MeshError
from study.fem.naming import UsageError, absolute, choose, family_named, resolve, resolve_data
from study.ledger.datafiles import DataError
from study.ledger.files import StoreError
from study.ledger.orders import RatesError
from study.ledger.published import TableError, as_json, as_text, read_table, report
from study.ledger.verdict import HOLDS, REPORTED, Verdict
from study.present.figures import Drawing, draw_figures, draw_one, drawings, enclosure, overview
from study.present.junit import write_junit
from study.present.report import write_report
from study.present.show import count_images, draw_show
from study.present.tables import write_tables
from study.present.terminal import ledger_text, rates_text
from study.run import resources as memory
from study.run.cluster import connected
from study.run.collect import collect, describe
from study.run.execute import JobsError, Pool, execute, refuse_too_large, unfinished
from study.run.judgement import check
from study.run.plan import Levels, Plan, full, quick
from study.run.processes import Processes
from study.run.provenance import protect, read_provenance
from study.run.showcase import LEVELS, STEPS, solve_showcase
from study.run.store import Store
from study.solve.evolution import SCHEMES
from study.statements.enclosure.measure import Bounded, bounded, check_bound, check_force

OK, FAILED, USAGE = 0, 1, 2

REFUSALS = (
    UsageError,
    SelfProofError,
    BodyError,
    BoundError,
    CaseError,
    LoadError,
    LawError,
    FormulaError,
    MeshError,
    StoreError,
    DataError,
    TableError,
    RatesError,
)
"""Errors that say what was given, what was expected and how to mend it: printed without a traceback."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns its exit code: 0 all claims hold, 1 one does not, 2 usage."""
    options = parser().parse_args(arguments)
    try:
        return int(options.command(options))
    except REFUSALS as error:
        print(f"study: {error}", file=sys.stderr)
        return USAGE
    except JobsError as error:
        print(f"study: {error}", file=sys.stderr)
        return FAILED
    except BrokenExecutor:
        print(
            "study: a worker process was killed, perhaps for want of memory: run the same command again, with fewer "
            "--jobs if it does not help; what is finished is kept",
            file=sys.stderr,
        )
        return FAILED
    except KeyboardInterrupt:
        print("study: interrupted; finished jobs are kept, the same command does the rest", file=sys.stderr)
        return 130


def parser() -> argparse.ArgumentParser:
    """The commands and their options."""
    top = argparse.ArgumentParser(prog="study", description="Verify the claims of Barboteu, Han and Sofonea (2002).")
    commands = top.add_subparsers(required=True, metavar="COMMAND")

    cases = commands.add_parser("cases", help="list the exact solutions")
    cases.add_argument("--json", action="store_true", help="as JSON")
    cases.set_defaults(command=list_cases)

    sweep = commands.add_parser("run", help="measure, judge, write tables and figures; resumes where it was stopped")
    size = sweep.add_mutually_exclusive_group()
    size.add_argument("--quick", dest="plan", action="store_const", const=quick, help="about a minute (default)")
    size.add_argument("--full", dest="plan", action="store_const", const=full, help="all levels")
    sweep.add_argument("--case", action="extend", nargs="+", metavar="NAME|FILE.py:NAME", help="only these cases")
    sweep.add_argument("--levels", nargs="+", type=int, metavar="N", help="cells along a side, increasing")
    sweep.add_argument("--scheme", default="midpoint", help="time scheme (default midpoint)")
    sweep.add_argument("--step", type=float, metavar="K", help="time step at every level (default: each case's pace)")
    _jobs(sweep)
    sweep.add_argument(
        "--cluster", metavar="ADDRESS", help="measure on the workers of a Dask scheduler, tcp://HOST:PORT"
    )
    _out(sweep)
    sweep.set_defaults(command=do_run, plan=quick)

    check = commands.add_parser("check", help="judge the data on disk; nothing is solved")
    check.add_argument("--junit", type=Path, metavar="FILE", help="also write the verdicts as JUnit XML")
    _out(check)
    check.set_defaults(command=do_check)

    controls = commands.add_parser(
        "controls", help="deliberate defects that the verdicts must catch; exit 0 all caught"
    )
    _jobs(controls)
    _out(controls)
    controls.set_defaults(command=do_controls)

    seeds = commands.add_parser("seeds", help="the verdicts on other random meshes; exit 0 all hold on all of them")
    seeds.add_argument("--seeds", type=int, default=SEEDS, metavar="N", help=f"how many (default {SEEDS})")
    _jobs(seeds)
    _out(seeds)
    seeds.set_defaults(command=do_seeds)

    published = commands.add_parser("rates", help="orders of a published or foreign error table")
    published.add_argument("file", type=Path, metavar="FILE.csv", help="columns h or n, and one or more of errors")
    published.add_argument("--expected", type=float, metavar="P", help="judge the orders against this one")
    published.add_argument("--json", action="store_true", help="as JSON")
    published.set_defaults(command=do_rates)

    bound = commands.add_parser("bound", help="enclose the error of a computed displacement, exact solution or not")
    bound.add_argument("problem", metavar="NAME|FILE.py:NAME", help="a case, a problem without a solution, or your own")
    bound.add_argument("--levels", nargs="+", type=int, default=[8, 16], metavar="N", help="increasing (default 8 16)")
    bound.add_argument("--family", default="unstructured", help="mesh family (default unstructured)")
    bound.add_argument("--scheme", default="midpoint", help="time scheme of u_h (default midpoint)")
    bound.add_argument("--steps", type=int, metavar="N", help="time steps of u_h at every level")
    bound.add_argument("--refine", type=int, default=1, metavar="R", help="refinements of the mesh of ũ (default 1)")
    bound.add_argument("--shorter", type=int, default=4, metavar="Q", help="steps of ũ in one of u_h (default 4)")
    bound.add_argument("--out", type=Path, default=Path("bounds"), metavar="DIR", help="directory (default bounds)")
    bound.set_defaults(command=do_bound)

    look = commands.add_parser("show", help="storyboard, animation and ParaView files of a case, solved on one mesh")
    look.add_argument("case", metavar="NAME|FILE.py:NAME", help="a case")
    look.add_argument("--level", type=int, metavar="N", help="cells along a side (default 24, in 3D 9)")
    look.add_argument("--out", type=Path, default=Path("shows"), metavar="DIR", help="directory (default shows)")
    look.set_defaults(command=do_show)

    page = commands.add_parser("report", help="make one HTML page of the data on disk, to be read without a network")
    _out(page)
    page.set_defaults(command=do_report)

    tables = commands.add_parser("tables", help="make the tables again from the data on disk")
    _out(tables)
    tables.set_defaults(command=do_tables)

    figures = commands.add_parser("figures", help="draw the figures again from the data on disk")
    _jobs(figures)
    _out(figures)
    figures.set_defaults(command=do_figures)
    return top


def _jobs(command: argparse.ArgumentParser) -> None:
    command.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="processes (default: all cores)")


def _out(command: argparse.ArgumentParser) -> None:
    command.add_argument("--out", type=Path, default=Path("results"), metavar="DIR", help="directory (default results)")


def list_cases(options: argparse.Namespace) -> int:
    """``study cases``."""
    found = [describe(case) for case in catalogue()]
    if options.json:
        print(json.dumps(found, indent=2, ensure_ascii=False))
        return OK
    for case in found:
        print(f"{case['case']:<24}{case['dimension']}D  order {case['expected_order']:<5g}{case['statements']}")
        print(f"    {case['summary']}; {case['regularity']}; law {case['law']}")
    return OK


def do_run(options: argparse.Namespace) -> int:
    """``study run``: refuse bad input, compute, write data, judge, present."""
    plan = options.plan()
    choose("scheme", options.scheme, SCHEMES)
    _check_jobs(options.jobs)
    plan = replace(plan, scheme=options.scheme, k=options.step)
    if options.case:
        plan = replace(plan, cases=tuple(map(absolute, options.case)), every_family=True, statements=False)
    if options.levels:
        levels = Levels(tuple(options.levels))
        # The interior point method is for small problems, whatever the levels of the others.
        plane, solid = ([n for n in options.levels if n <= most] for most in (16, 6))
        plan = replace(
            plan,
            plane=levels,
            rough=levels,
            solid=levels,
            own=(),
            equivalence=tuple(plane) or plan.equivalence[:1],
            solid_equivalence=tuple(solid[:1]) or plan.solid_equivalence,
        )
    plan.check_settings()
    store = Store(options.out)
    with Processes(options.jobs) as processes, _pool(options.cluster, plan, processes) as pool:
        refuse_too_large(unfinished(plan.jobs, store), pool)
        plan.check(processes.map)
        with store.locked():
            verdicts = _measure(plan, store, pool)
            written = write_tables(store.directory)
            # Drawing all takes as long as a third of the quick study.
            written += _draw(store.directory, processes, drawings if options.case else overview)
    print(f"\n{rates_text(options.out)}")
    print(ledger_text(options.out))
    print(f"data: {store.data}/rates.csv, equivalence.csv, claims.csv, cases.csv, provenance.json, pictures/")
    print("written: " + ", ".join(sorted({f"{path.parent}/*{path.suffix}" for path in written})))
    return _exit(verdicts)


def _pool(cluster: str | None, plan: Plan, processes: Processes) -> AbstractContextManager[Pool]:
    return connected(cluster, plan.cases) if cluster else nullcontext(Pool.of(processes))


def _measure(plan: Plan, store: Store, pool: Pool) -> list[Verdict]:
    """Measure what is missing in a directory of one's own; collect and judge all of it."""
    protect(plan, store.directory)
    store.check()
    jobs = plan.jobs
    with _bar(round(sum(job.cost for job in jobs))) as bar:
        bar.set_description(f"{len(jobs)} jobs")
        execute(jobs, store, pool, lambda cost: bar.update(round(cost)))
        collect(plan, store)
    return check(store.directory)


def do_check(options: argparse.Namespace) -> int:
    """``study check``."""
    with Store(options.out).steady():
        verdicts = check(options.out)
    if options.junit:
        write_junit(options.junit, verdicts)
    print(ledger_text(options.out))
    return _exit(verdicts)


def do_controls(options: argparse.Namespace) -> int:
    """``study controls``: measure with every defect and without one, write what caught it."""
    _check_jobs(options.jobs)
    store = Store(options.out)
    store.check()
    controls = register.CONTROLS
    with Processes(options.jobs) as executor, store.locked():
        with _bar(len(settings(controls)) + len(controls)) as bar:
            bar.set_description(f"{len(controls)} defects")
            findings = run_controls(controls, executor, bar.update)
        written = write_controls(options.out, findings)
    print(f"\n{controls_text(findings)}")
    print(f"data: {written}")
    return OK if all(finding.passes for finding in findings) else FAILED


def do_seeds(options: argparse.Namespace) -> int:
    """``study seeds``: the quick study on shaken meshes of other seeds, and how often a row does not hold."""
    _check_jobs(options.jobs)
    if options.seeds < 1:
        raise UsageError(f"--seeds must be 1 or more, got {options.seeds}")
    found = {}
    with Processes(options.jobs) as processes:
        pool = Pool.of(processes)
        for seed in range(options.seeds):
            store = Store(options.out / "seeds" / str(seed))
            with store.locked():
                found[seed] = _measure(seeded(seed), store, pool)
    table = tally(found)
    written = write_seeds(options.out, table)
    print(f"\n{seeds_text(table)}")
    print(f"data: {written}")
    return FAILED if table.loc[table["claimed"] == "yes", "alarms"].any() else OK


def do_rates(options: argparse.Namespace) -> int:
    """``study rates``."""
    h, columns = read_table(options.file)
    found = [report(name, h, errors, options.expected) for name, errors in columns.items()]
    if options.json:
        print(json.dumps([as_json(column) for column in found], indent=2))
    else:
        print("\n".join(as_text(column) for column in found))
    return OK if all(column.verdict in (None, HOLDS) for column in found) else FAILED


def do_bound(options: argparse.Namespace) -> int:
    """``study bound``: compute, enclose, write, draw."""
    name, data, case = resolve_data(options.problem)
    scheme, family = choose("scheme", options.scheme, SCHEMES), family_named(options.family)
    better = Better(options.refine, options.shorter)
    check_force(case)
    if case:
        _prove(case)
    plan = check_bound(data, family, options.levels, options.steps, better)
    finest = max(plan)
    memory.require(f"level {finest}", memory.bound(finest, better.refinements, family.name), memory.available())
    found: dict[int, Bounded] = {}
    for level, steps in plan.items():
        with _bar(100) as bar:
            bar.set_description(f"level {level}")

            def progress(time: float, bar: tqdm = bar) -> None:
                bar.update(round(100 * time / data.body.T) - bar.n)

            found[level] = bounded(data, case, family, level, scheme, steps, better, progress)
    table, over_time = levels(found), pd.concat([series(level, one) for level, one in found.items()])
    written = write(options.out / name, table, over_time, found)
    written += draw_one(options.out / name, enclosure("enclosure", over_time, name))
    print(f"\n{text(name, table, over_time)}\n")
    print("written: " + ", ".join(map(str, written)))
    inside = all(one.enclosure.contains and one.plain.contains for one in found.values())
    return OK if case is None or inside else FAILED


def do_show(options: argparse.Namespace) -> int:
    """``study show``: solve once, draw, write for ParaView."""
    case = resolve(options.case)
    level = LEVELS[case.solution.body.dim] if options.level is None else options.level
    if level < 2:
        raise UsageError(f"--level must be 2 or more, got {level}")
    _prove(case)
    directory = options.out / case.name
    with _bar(STEPS + 1) as bar:
        bar.set_description(case.name)
        solved = solve_showcase(case, level, directory, bar.update)
    with _bar(count_images(solved.picture)) as bar:
        bar.set_description("images")
        shown = draw_show(solved.picture, solved.series, directory, bar.update)
    for path in shown.written:
        print(path)
    for line in shown.left_out:
        print(f"left out: {line}")
    return OK


def do_tables(options: argparse.Namespace) -> int:
    """``study tables``."""
    read_provenance(options.out)
    with Store(options.out).steady():
        for path in write_tables(options.out):
            print(path)
    return OK


def do_report(options: argparse.Namespace) -> int:
    """``study report``."""
    with Store(options.out).steady():
        print(write_report(options.out, read_provenance(options.out)))
    return OK


def do_figures(options: argparse.Namespace) -> int:
    """``study figures``."""
    _check_jobs(options.jobs)
    read_provenance(options.out)
    with Processes(options.jobs) as executor, Store(options.out).steady():
        for path in _draw(options.out, executor, drawings):
            print(path)
    return OK


def _draw(directory: Path, processes: Processes, chosen: Callable[[Path], list[Drawing]]) -> list[Path]:
    """Draw figures, and show how far that is."""
    with _bar(0) as bar:

        def show(done: int, total: int, name: str) -> None:
            bar.total = total
            bar.set_description(f"figure {name}", refresh=False)
            bar.update()

        return draw_figures(directory, chosen, processes.map, show)


def _prove(case: Case) -> None:
    """Refuse a case that is not an exact solution; SelfProofError says where."""
    if failed := [finding for finding in examine(case.solution) if not finding.passes]:
        raise SelfProofError(f"case {case.name}", failed)


def _check_jobs(jobs: int) -> None:
    if jobs < 1:
        raise UsageError(f"--jobs must be 1 or more, got {jobs}")


def _bar(total: int) -> tqdm:
    """Progress on standard error, with fewer lines where nobody watches."""
    return tqdm(
        total=total,
        unit="",
        bar_format="{l_bar}{bar}| {elapsed}<{remaining}",
        mininterval=0.5 if sys.stderr.isatty() else 10,
    )


def _exit(verdicts: list[Verdict]) -> int:
    """0 iff every claim holds; undecided is not a pass, and what is only reported claims nothing."""
    return OK if verdicts and all(verdict.verdict in (HOLDS, REPORTED) for verdict in verdicts) else FAILED

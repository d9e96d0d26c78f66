"""``study bound``: compute displacements, enclose their errors, write and draw; resumes after Ctrl-C."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial
from typing import Any

import pandas as pd
from tqdm import tqdm

from manufactured.self_proof import prove
from study.bound import bounded
from study.bound.discretisation import check_force
from study.bound.trajectory import Refined
from study.cli.adapt import do_adapt
from study.cli.common import listed, progress_bar
from study.cli.options import FAILED, OK
from study.fem.naming import choose, family_named, resolve_data
from study.ledger.text import folded
from study.present.figures import draw_one, enclosure
from study.run.executor import available, require
from study.run.fingerprint import of_problem
from study.run.store import Store
from study.solve.steps import rate_steps
from study.solve.tableau import SCHEMES
from study.statements.shared import estimates


def do_bound(options: argparse.Namespace) -> int:
    """Enclose the error at each level; 0 if the solution is unknown or every error lies in its enclosure."""
    if options.adapt is not None:
        return do_adapt(options)
    name, data, case = resolve_data(options.problem)
    scheme, family = choose("scheme", options.scheme, SCHEMES), family_named(options.family)
    refined = Refined(options.refine, options.shorter)
    check_force(case)
    # Before check_bound makes meshes.
    finest = max(options.levels)
    require(f"level {finest}", estimates.bound(finest, refined.refinements, family.name), available())
    bounded.check_bound(data, family, options.levels, options.steps, refined)
    if case:
        prove(case.solution, f"case {case.name}")
    plan = {level: options.steps or rate_steps(data.body.T, level) for level in options.levels}
    store = Store(options.out / name, written=(".",))
    with store.locked():
        kept = []
        for level, steps in plan.items():
            made_by = of_problem(data, case, (family, level, scheme, steps, refined))
            compute = partial(bounded.bounded_solution, data, case, family, level, scheme, steps, refined)
            kept.append(_level(store, level, made_by, compute, data.body.T))
        table = bounded.levels([one["row"] for one in kept])
        over_time = pd.concat([pd.DataFrame(one["series"]) for one in kept])
        written = bounded.write(store.directory, table, over_time)
        written += [bounded.trajectory_file(store.directory, level) for level in plan]
        written += draw_one(store.directory, enclosure("enclosure", over_time, name))
    print(folded(f"written: {listed(written)}"))
    found = bounded.text(name, table, over_time, kept[-1]["sentences"])
    print(f"\n{found}\n")
    return OK if case is None or all(one["inside"] for one in kept) else FAILED


def _level(
    store: Store, level: int, made_by: str, compute: Callable[..., bounded.BoundedSolution], T: float
) -> dict[str, Any]:
    """Return the record of a level, from disk or computed."""
    key, trajectory = f"level-{level}", bounded.trajectory_file(store.directory, level)
    kept = store.load(key, made_by) if trajectory.is_file() else None
    if kept is not None:
        return kept
    with progress_bar(100) as bar:
        bar.set_description(f"level {level}")

        def progress(time: float, bar: tqdm = bar) -> None:
            bar.update(round(100 * time / T) - bar.n)

        found = compute(progress)
    bounded.write_trajectory(store.directory, level, found)
    record = bounded.record(level, found)
    store.save(key, made_by, record)
    return record

"""``study bound``: computes displacements and encloses their errors without the exact solution.

Levels are meshes from coarse to fine. Finished levels are stored, so that the command continues after Ctrl-C.
"""

from __future__ import annotations

import argparse
from functools import partial
from typing import Any

import pandas as pd

from manufactured.self_proof import prove
from manufactured.static import Static
from study.bound import bounded
from study.bound.discretisation import check_force
from study.bound.trajectory import Refined
from study.cli.adapt import do_adapt
from study.cli.common import listed, with_progress
from study.cli.displacement import do_displacement
from study.cli.options import FAILED, OK
from study.fem.naming import choose, family_named, resolve_data
from study.ledger.files import UsageError
from study.ledger.text import folded
from study.present.drawing import draw_one
from study.present.figures import enclosure
from study.run.executor import available, require
from study.run.fingerprint import of_problem
from study.run.store import Store
from study.solve.tableau import SCHEMES
from study.statements.shared import estimates


def do_bound(options: argparse.Namespace) -> int:
    """Enclose the error on each level, and write tables and figures.

    Returns:
        0 if the exact solution is unknown, or if every error lies in its enclosure; otherwise 1.
    """
    if options.displacement and options.adapt is not None:
        raise UsageError("--adapt computes the displacements itself: give --adapt or --displacement, not both")
    if not options.displacement and (options.field or options.nearest):
        raise UsageError("--field and --nearest need a file: give it with --displacement FILE")
    if options.displacement:
        return do_displacement(options)
    if options.adapt is not None:
        return do_adapt(options)
    name, data, case = resolve_data(options.problem)
    scheme, family = choose("scheme", options.scheme, SCHEMES), family_named(options.family)
    refined = Refined(options.refine, options.shorter)
    check_force(case)
    # The memory is checked first, because ``check_bound`` makes meshes, which may need more than there is.
    finest = max(options.levels)
    require(f"level {finest}", estimates.bound(finest, refined.refinements, family.name), available())
    bounded.check_bound(data, family, options.levels, options.steps, refined)
    if case:
        prove(case.solution, f"case {case.name}")
    static = isinstance(data, Static)
    plan = {level: bounded.steps_on(data, level, options.steps) for level in options.levels}
    store = Store(options.out / name, written=(".",))
    with store.locked():
        kept = []
        for level, steps in plan.items():

            def compute(level: int = level, steps: int = steps) -> dict[str, Any]:
                solve = partial(bounded.bounded_solution, data, case, family, level, scheme, steps, refined)
                found = with_progress(f"level {level}", data.body.T, solve)
                bounded.write_displacement(bounded.trajectory_file(store.directory, level), found.computed)
                return bounded.record(level, found)

            made_by = of_problem(data, case, (family, level, scheme, steps, refined, static))
            trajectory = bounded.trajectory_file(store.directory, level)
            kept.append(store.cached(f"level-{level}", made_by, compute, trajectory))
        table = bounded.levels([one["row"] for one in kept])
        over_time = pd.concat([pd.DataFrame(one["series"]) for one in kept])
        written = bounded.write(store.directory, table, over_time)
        written += [bounded.trajectory_file(store.directory, level) for level in plan]
        if not static:  # The figure shows bounds over time.
            written += draw_one(store.directory, enclosure("enclosure", over_time, name))
    print(folded(f"written: {listed(written)}"))
    sentences = [*kept[-1]["sentences"], *bounded.contact_sentences(data.body)]
    found = bounded.text(name, table, over_time, sentences, bounded.norm_of(data))
    print(f"\n{found}\n")
    return OK if case is None or all(one["inside"] for one in kept) else FAILED

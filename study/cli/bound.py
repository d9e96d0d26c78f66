"""``study bound``: compute, enclose, write, draw."""

from __future__ import annotations

import argparse

import pandas as pd
from tqdm import tqdm

from manufactured.self_proof import prove
from study.bound.bounded import BoundedSolution, bounded_solution, check_bound, levels, series, text, write
from study.bound.discretisation import check_force
from study.bound.trajectory import Refined
from study.cli.common import FAILED, OK, progress_bar
from study.fem.naming import choose, family_named, resolve_data
from study.present.figures import draw_one, enclosure
from study.run.resources import available, require
from study.solve.steps import rate_steps
from study.solve.tableau import SCHEMES
from study.statements.shared import estimates


def do_bound(options: argparse.Namespace) -> int:
    """``study bound``: compute, enclose, write, draw."""
    name, data, case = resolve_data(options.problem)
    scheme, family = choose("scheme", options.scheme, SCHEMES), family_named(options.family)
    refined = Refined(options.refine, options.shorter)
    check_force(case)
    if case:
        prove(case.solution, f"case {case.name}")
    check_bound(data, family, options.levels, options.steps, refined)
    plan = {level: options.steps or rate_steps(data.body.T, level) for level in options.levels}
    finest = max(plan)
    require(f"level {finest}", estimates.bound(finest, refined.refinements, family.name), available())
    found: dict[int, BoundedSolution] = {}
    for level, steps in plan.items():
        with progress_bar(100) as bar:
            bar.set_description(f"level {level}")

            def progress(time: float, bar: tqdm = bar) -> None:
                bar.update(round(100 * time / data.body.T) - bar.n)

            found[level] = bounded_solution(data, case, family, level, scheme, steps, refined, progress)
    table, over_time = levels(found), pd.concat([series(level, one) for level, one in found.items()])
    written = write(options.out / name, table, over_time, found)
    written += draw_one(options.out / name, enclosure("enclosure", over_time, name))
    sentences = found[finest].enclosure.evidence.sentences
    print(f"\n{text(name, table, over_time, sentences)}\n")
    print("written: " + ", ".join(map(str, written)))
    inside = all(one.enclosure.contains and one.plain.contains for one in found.values())
    return OK if case is None or inside else FAILED

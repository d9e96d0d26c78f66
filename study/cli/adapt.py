"""``study bound --adapt``: refines mesh and time steps until the error bound is at most a tolerance.

Each mesh is written when it is finished, so that the command continues after Ctrl-C.
"""

import argparse
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.tri import Triangulation

from study.bound import adaptive, bounded
from study.bound.adaptive import Stage
from study.bound.discretisation import check_force
from study.bound.trajectory import Refined
from study.cli.common import tell_written
from study.cli.options import FAILED, OK
from study.cli.problem import contact_edges, draw_problem
from study.fem.naming import choose, family_named, resolve_data
from study.ledger.files import Json, UsageError, write_text
from study.ledger.text import up
from study.present.bounds import NORM, SHOWN, adaptive_text
from study.present.charts import AdaptiveRefinement
from study.present.drawing import draw_one
from study.present.figures import figure
from study.run.executor import require_bound
from study.run.fingerprint import of_data, of_problem
from study.run.store import Store
from study.solve.steps import STEPS_LIMIT
from study.solve.tableau import SCHEMES


def do_adapt(options: argparse.Namespace) -> int:
    """Refine mesh and time steps until the error bound is at most the tolerance; write results and a figure.

    Returns:
        0 if the tolerance is reached, otherwise 1. If the exact solution is known, 1 is also returned if a true error
        is larger than its upper bound or smaller than its lower bound.
    """
    name, data, case = resolve_data(options.problem)
    scheme, family = choose("scheme", options.scheme, SCHEMES), family_named(options.family)
    level = min(options.levels)
    check_force(case)
    tolerance = adaptive.tolerance_from(options.adapt)
    bounded.check_bound(data, family, [level], options.steps, Refined(0, 1))
    stage = Stage(family(data.body, level), bounded.steps_on(data, level, options.steps))
    store = Store(options.out / name, written=(".",))
    results: list[Json] = []
    with store.locked():
        store.begin(of_data(data))
        while True:
            number = len(results)
            # The tolerance only decides when to stop. It is not part of the cache key, so stored meshes can be used
            # with another tolerance.
            cache_key = of_problem(data, case, (stage.mesh.p, stage.mesh.t, stage.steps, scheme))
            path = adaptive.stage_file(store.directory, number)

            def compute(stage: Stage = stage, number: int = number, path: Path = path) -> Json:
                found = adaptive.adapted(data, case, stage, scheme)
                shares = {"shares": found.shares.cells, "in_time": np.array(found.shares.time)}
                bounded.write_displacement(path, found.computed, **shares)
                return adaptive.record(number, found)

            results.append(store.cached(f"adapted-{number}", cache_key, compute, path))
            rows = adaptive.table([one["row"] for one in results])
            table = write_text(store.directory / "adaptive.csv", rows.to_csv(index=False))
            print(f"mesh {number}: {stage.cells} cells, bound {up(rows['bound'].iloc[-1], SHOWN)}", flush=True)
            with np.load(path) as arrays:
                following = adaptive.next_stage(stage, arrays["shares"], float(arrays["in_time"]))
                at_vertices = arrays["times"], arrays["u"]
            edges, closed = contact_edges(data, stage.mesh, at_vertices[1][-1])
            reached = tolerance.reached(rows.iloc[-1])
            stopped = "" if reached else _limit(following, options.cells)
            if reached or stopped:
                break
            stage = following
        # If ``study bound`` has written the bounds on uniform meshes for this problem, the figure shows them, too.
        levels = store.directory / "levels.csv"
        uniform = pd.read_csv(levels) if levels.is_file() else pd.DataFrame()
        written = [table, *(adaptive.stage_file(store.directory, number) for number in range(len(results)))]
        error = "max " * data.in_time + NORM[data.in_time]
        shown = Triangulation(*stage.mesh.p, stage.mesh.t.T)
        result = AdaptiveRefinement(name, error, shown, edges, closed, rows, uniform)
        written += draw_one(store.directory, figure("adaptive", result, about=name))
        written += draw_problem(store.directory, name, data, ((stage.mesh.p, stage.mesh.t), at_vertices))
    tell_written(written)
    sentences = [*results[-1]["sentences"], *bounded.contact_sentences(data.body)]
    print("\n" + "\n".join(adaptive_text(name, rows, str(tolerance), stopped, sentences, data.in_time)) + "\n")
    return OK if reached and all(one["inside"] for one in results if case) else FAILED


def _limit(stage: Stage, cells: int) -> str:
    """Return the reason why the next mesh is too large; an empty text if it is not.

    Parameters:
        stage: the next mesh and its number of time steps.
        cells: largest permitted number of cells.
    """
    if stage.cells > cells:
        return f"the next mesh has {stage.cells} cells, and {cells} are permitted: raise --cells or the tolerance"
    if stage.steps > STEPS_LIMIT:
        needed = f"the next mesh needs {stage.steps} time steps"
        return f"{needed}, and at most {STEPS_LIMIT} are permitted: raise the tolerance"
    try:
        require_bound(f"the next mesh of {stage.cells} cells", stage.cells, 0)
    except UsageError as error:
        return str(error)
    return ""

"""``study bound``: encloses the errors of displacements that it computes or reads, without the exact solution.

Finished meshes are stored, so that the command continues after Ctrl-C.
"""

import argparse
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd

from manufactured.case import Case
from manufactured.data import Data
from manufactured.self_proof import prove
from study.bound import bounded
from study.bound.discretisation import check_force
from study.bound.problem import place
from study.bound.trajectory import Refined
from study.cli.adapt import do_adapt
from study.cli.common import tell_written, with_progress
from study.cli.displacement import Displacement, displacements_in_files
from study.cli.options import FAILED, OK
from study.cli.problem import OUTPUT, MeshInTime, draw_problem
from study.fem.mesh import MeshFamily
from study.fem.naming import choose, family_named, resolve_data
from study.ledger.files import Json, UsageError
from study.ledger.text import folded
from study.present.bounds import text, worst_tenth
from study.present.drawing import draw_one
from study.present.figures import figure
from study.present.problem import error_map
from study.run.executor import require_bound
from study.run.fingerprint import of_data, of_problem
from study.run.store import Store
from study.solve.tableau import SCHEMES
from study.statements.shared import estimates


def do_bound(options: argparse.Namespace) -> int:
    """Enclose the error of the displacement on each mesh, and write tables and figures.

    Returns:
        0 if the exact solution is unknown, or if every error lies in its enclosure; otherwise 1.
    """
    if options.displacement and options.adapt is not None:
        raise UsageError("--adapt computes the displacements itself: give --adapt or --displacement, not both")
    if not options.displacement and (options.field or options.nearest or options.step is not None):
        raise UsageError("--field, --step and --nearest need a file: give it with --displacement FILE")
    if options.adapt is not None:
        return do_adapt(options)
    name, data, case = resolve_data(options.problem)
    refined = Refined(options.refine, options.shorter)
    check_force(case)
    find = displacements_in_files if options.displacement else computed_displacements
    directory, displacements = find(options, name, data, case, refined)
    if case:
        prove(case.solution, f"case {case.name}")
    store = Store(directory, written=(".",))
    with store.locked():
        store.begin(of_data(data))
        rows = [store.cached(one.key, one.cache_key, one.compute, *one.files) for one in displacements]
        table = bounded.levels([row["row"] for row in rows])
        over_time = pd.concat([pd.DataFrame(row["series"]) for row in rows])
        written = bounded.write(store.directory, table, over_time)
        written += [file for one in displacements for file in one.files]
        one_of_each_size = table["level"].is_unique
        if data.in_time and one_of_each_size:
            # Its data are in enclosure.csv already, rounded outwards.
            drawing = replace(figure("enclosure", over_time, name), table=lambda: None)
            written += draw_one(store.directory, drawing)
        solved = displacements[-1].shown()
        written += draw_problem(store.directory, name, data, solved)
        vertices, triangles = solved[0]
        squares = rows[-1]["on_cells"]
        if any(squares):
            written += draw_one(store.directory, error_map(name, vertices, triangles, squares), OUTPUT)
    tell_written(written)
    names = [one.file_name for one in displacements if one.file_name]
    if data.in_time and not one_of_each_size:
        print("no figure: it shows one mesh of each size, and two files have meshes of the same size")
    for one in displacements:
        if one.remark:
            print(folded(one.remark))
    sentences = [*rows[-1]["sentences"], *bounded.contact_sentences(data.body)]
    if any(squares):
        worst = vertices[:, triangles[:, int(np.argmax(squares))]].mean(axis=1)
        sentences.append(f"{worst_tenth(squares)}; the worst one is near x = {place(worst)}")
    last = pd.DataFrame(rows[-1]["series"])
    print(f"\n{text(name, table, last, sentences, data.in_time, names or None)}\n")
    return OK if case is None or all(row["inside"] for row in rows) else FAILED


def computed_displacements(
    options: argparse.Namespace, name: str, data: Data, case: Case | None, refined: Refined
) -> tuple[Path, list[Displacement]]:
    """Return the result directory, and for each level the displacement that is to be computed.

    Parameters:
        options: the options of the command.
        name, data, case: name and data of the problem, and the case with its exact solution, or None.
        refined: how the mesh and the time steps are refined for the bound.
    """
    scheme, family = choose("scheme", options.scheme, SCHEMES), family_named(options.family)
    check_levels(options, data, family, refined)
    directory = options.out / name

    def displacement(level: int) -> Displacement:
        steps, file = bounded.steps_on(data, level, options.steps), bounded.trajectory_file(directory, level)

        def compute() -> Json:
            solve = partial(bounded.bounded_solution, data, case, family, level, scheme, steps, refined)
            found = with_progress(f"level {level}", data.body.T, solve)
            bounded.write_displacement(file, found.computed)
            return bounded.record(level, found)

        cache_key = of_problem(data, case, (family, level, scheme, steps, refined))

        def shown() -> MeshInTime:
            with np.load(file) as arrays:
                return (arrays["p"], arrays["t"]), (arrays["times"], arrays["u"])

        return Displacement(f"level-{level}", cache_key, compute, (file,), shown)

    return directory, [displacement(level) for level in options.levels]


def check_levels(options: argparse.Namespace, data: Data, family: MeshFamily, refined: Refined) -> None:
    """Refuse levels whose meshes are too large or do not fit the body, and problems that cannot be bounded.

    The memory is checked first, because ``check_bound`` makes meshes, which may need more than there is.
    """
    finest = max(options.levels)
    require_bound(f"level {finest}", estimates.triangles(finest, family.name), refined.refinements)
    bounded.check_bound(data, family, options.levels, options.steps, refined)

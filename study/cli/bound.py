"""``study bound`` encloses the errors of displacements, without the exact solution; ``study certify`` proves bounds.

The displacements are computed or read from files. With ``--adapt``, mesh and time steps are refined until the error
bound is at most a tolerance. Finished meshes are stored, so that the command continues after Ctrl-C.
"""

import shlex
from argparse import Namespace
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from hashlib import sha256
from itertools import count
from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.tri import Triangulation
from pandas import DataFrame
from skfem import Mesh

from manufactured.body import Kind
from manufactured.case import Case
from manufactured.data import Data
from manufactured.self_proof import prove
from manufactured.static import Static
from manufactured.tensors import Array
from study.bound import adaptive, bounded, fields
from study.bound.adaptive import Stage, adapted, next_stage, stage_file, tolerance_from
from study.bound.bounded import (
    check_bound,
    check_problem,
    contact_sentences,
    steps_on,
    trajectory_file,
    write_displacement,
)
from study.bound.discretisation import check_force
from study.bound.given import bounded_displacement, given
from study.bound.problem import place
from study.bound.trajectory import Computed, Refined
from study.certify import checker
from study.certify.certified import check_certifiable, make_certificate, write
from study.cli.common import tell_written, with_progress
from study.cli.options import FAILED, OK
from study.cli.problem import PROBLEM_OUTPUT, MeshInTime, error_map, problem_drawing
from study.fem.mesh import MeshedBody, MeshFamily
from study.fem.naming import choose, family_named, resolve_data
from study.ledger.files import Json, Paths, UsageError, write_text
from study.ledger.text import folded, up
from study.present.charts import AdaptiveRefinement
from study.present.drawing import draw_one
from study.present.figures import figure
from study.present.outcome import NORM, SHOWN, adaptive_text, bounds_text, worst_tenth
from study.run.executor import require_bound
from study.run.fingerprint import of_data, of_problem
from study.run.store import Store
from study.solve.steps import STEPS_LIMIT, rate_steps
from study.solve.tableau import SCHEMES, Tableau
from study.statements.shared.estimates import triangles

CLOSED_GAP = 1e-9
"""A vertex of the contact boundary Γ3 counts as in contact up to this gap, relative to the largest displacement."""


@dataclass(frozen=True)
class Displacement:
    """A displacement on one mesh whose error is to be enclosed.

    Attributes:
        key: the name under which the result of ``compute`` is stored.
        cache_key: hash of everything on which this result depends; a stored result with another one is not used.
        compute: function without arguments that encloses the error, and first computes the displacement if no file has
            it. It returns the bounds as a dict, described in ``bounded.record``.
        shown: function without arguments that returns mesh and displacement for the picture.
        files: files that ``compute`` writes.
        file_name, remark: name of the file with the given displacement, and a line about its content; empty if the
            displacement is computed.
    """

    key: str
    cache_key: str
    compute: Callable[[], Json]
    shown: Callable[[], MeshInTime]
    files: tuple[Path, ...] = ()
    file_name: str = ""
    remark: str = ""


def do_bound(options: Namespace) -> int:
    """Enclose the error of the displacement on each mesh, and write tables and figures.

    Returns:
        0 if the exact solution is unknown, or if every error lies in its enclosure; otherwise 1.
    """
    if options.displacement and options.adapt is not None:
        raise UsageError("--adapt computes the displacements itself: give --adapt or --displacement, not both")
    if not options.displacement and (options.field or options.nearest or options.step is not None):
        raise UsageError("--field, --step and --nearest need a file: give it with --displacement FILE")
    if options.adapt is not None:
        return adapt(options)
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
        over_time = pd.concat([DataFrame(row["series"]) for row in rows])
        written = bounded.write(directory, table, over_time)
        written += [file for one in displacements for file in one.files]
        one_of_each_size = table.level.is_unique
        if data.in_time and one_of_each_size:
            # Its data are in enclosure.csv already, rounded outwards.
            drawing = replace(figure("enclosure", over_time, name), table=lambda: None)
            written += draw_one(directory, drawing)
        solved = displacements[-1].shown()
        written += draw_one(directory, problem_drawing(name, data, solved), PROBLEM_OUTPUT)
        vertices, triangles = solved[0]
        finest = rows[-1]
        squares = finest["on_cells"]
        if any(squares):
            written += draw_one(directory, error_map(name, vertices, triangles, squares), PROBLEM_OUTPUT)
    tell_written(written)
    if data.in_time and not one_of_each_size:
        print("no figure: it shows one mesh of each size, and two files have meshes of the same size")
    for one in displacements:
        if one.remark:
            print(folded(one.remark))
    sentences = [*finest["sentences"], *contact_sentences(data.body)]
    if any(squares):
        worst = vertices[:, triangles[:, np.argmax(squares)]].mean(axis=1)
        sentences.append(f"{worst_tenth(squares)}; the worst one is near x = {place(worst)}")
    last = DataFrame(finest["series"])
    names = [one.file_name for one in displacements if one.file_name]
    print(f"\n{bounds_text(name, table, last, sentences, data.in_time, names)}\n")
    return OK if case is None or all(row["inside"] for row in rows) else FAILED


def scheme_and_family(options: Namespace) -> tuple[Tableau, MeshFamily]:
    """Return the time scheme and the mesh family of the options."""
    return choose("scheme", options.scheme, SCHEMES), family_named(options.family)


def computed_displacements(
    options: Namespace, name: str, data: Data, case: Case | None, refined: Refined
) -> tuple[Path, list[Displacement]]:
    """Return the result directory, and for each level the displacement that is to be computed.

    Parameters:
        options: the options of the command.
        name, data, case: name and data of the problem, and the case with its exact solution, or None.
        refined: how the mesh and the time steps are refined for the bound.
    """
    scheme, family = scheme_and_family(options)
    check_levels(options, data, family, refined)
    directory = options.out / name

    def displacement(level: int) -> Displacement:
        steps = steps_on(data, level, options.steps)
        file = trajectory_file(directory, level)

        def compute() -> Json:
            solve = partial(bounded.bounded_solution, data, case, family, level, scheme, steps, refined)
            found = with_progress(f"level {level}", data.body.T, solve)
            write_displacement(file, found.computed)
            return bounded.record(level, found)

        def shown() -> MeshInTime:
            with np.load(file) as arrays:
                return (arrays["p"], arrays["t"]), (arrays["times"], arrays["u"])

        cache_key = of_problem(data, case, (family, level, scheme, steps, refined))
        return Displacement(f"level-{level}", cache_key, compute, shown, (file,))

    return directory, [displacement(level) for level in options.levels]


def check_levels(options: Namespace, data: Data, family: MeshFamily, refined: Refined) -> None:
    """Refuse levels whose meshes are too large or do not fit the body, and problems that cannot be bounded.

    The memory is checked first, because ``check_bound`` makes meshes, which may need more memory than the machine has.

    Parameters:
        options: the options of the command, with ``levels`` and ``steps``.
        data: the data of the problem.
        family: the mesh family.
        refined: how the mesh and the time steps are refined for the bound.

    Raises:
        UsageError: the finest mesh needs too much memory, or has too many triangles.
        BoundError: no bound can be computed, or levels do not increase; ``check_bound`` has all reasons.
        LoadError: no solution can exist for the data.
        MeshError: a mesh does not fit the parts of the body.
    """
    finest = max(options.levels)
    require_bound(f"level {finest}", triangles(finest, family.name), refined.refinements)
    check_bound(data, family, options.levels, options.steps, refined)


def displacements_in_files(
    options: Namespace, name: str, data: Data, case: Case | None, refined: Refined
) -> tuple[Path, list[Displacement]]:
    """Return the result directory, and the displacements in the files of --displacement, from coarse to fine meshes.

    ``fields.read`` describes the formats of the files.

    Parameters:
        options: the options of the command.
        name, data, case: name and data of the problem, and the case with its exact solution, or None.
        refined: how the mesh and the time steps are refined for the bound.

    Raises:
        BoundError: a file cannot be read, or no bound can be computed.
        LoadError: no solution can exist for the data.
        UsageError: there is too little memory to bound the error on a mesh, or its refined mesh has more triangles than
            ``FACTORISED`` in ``study.statements.shared.estimates``.
    """
    check_problem(data, options.steps, refined)
    read = []
    for path in options.displacement:
        field = fields.read(path, options.field, options.step)
        cells = len(field.triangles)
        what = f"{path} with {cells} triangles and --refine {refined.refinements}"
        require_bound(what, cells, refined.refinements)
        read.append((path, given(data, **vars(field), steps=options.steps, nearest=options.nearest)))
    # The meshes are sorted, because observed orders are computed between consecutive meshes.
    read.sort(key=lambda pair: -pair[1].h)
    displacements = []
    for number, (path, u_h) in enumerate(read):
        mesh = u_h.mesh

        def compute(path: Path = path, u_h: Computed = u_h) -> Json:
            found = with_progress(str(path), u_h.T, partial(bounded_displacement, data, u_h, refined, case))
            return bounded.record(u_h.level, found)

        def shown(u_h: Computed = u_h) -> MeshInTime:
            return (u_h.mesh.p, u_h.mesh.t), (u_h.times, u_h.at_vertices)

        # Files may have millions of numbers, which would take long as texts.
        arrays = sha256(b"".join(array.tobytes() for array in (mesh.p, mesh.t, u_h.times, u_h.nodes)))
        cache_key = of_problem(data, case, (arrays.hexdigest(), u_h.steps, u_h.remarks, refined))
        remark = f"{path}: degree {u_h.degree}, {mesh.t.shape[1]} triangles, h = {u_h.h:.4g}"
        displacements.append(
            Displacement(f"displacement-{number}", cache_key, compute, shown, file_name=path.name, remark=remark)
        )
    return options.out / "-".join([name, *dict.fromkeys(path.stem for path, _ in read)]), displacements


# Adaptive refinement.


def adapt(options: Namespace) -> int:
    """Refine mesh and time steps until the error bound is at most the tolerance; write results and a figure.

    Returns:
        0 if the tolerance is reached, otherwise 1. If the exact solution is known, 1 is also returned if a true error
        is larger than its upper bound or smaller than its lower bound.
    """
    name, data, case = resolve_data(options.problem)
    scheme, family = scheme_and_family(options)
    level = min(options.levels)
    check_force(case)
    tolerance = tolerance_from(options.adapt)
    check_bound(data, family, [level], options.steps, Refined(0, 1))
    stage = Stage(family(data.body, level), steps_on(data, level, options.steps))
    directory = options.out / name
    store = Store(directory, written=(".",))
    results: list[Json] = []
    paths: Paths = []
    with store.locked():
        store.begin(of_data(data))
        for number in count():
            mesh = stage.mesh
            # The tolerance only decides when to stop. It is not part of the cache key, so stored meshes can be used
            # with another tolerance.
            cache_key = of_problem(data, case, (mesh.p, mesh.t, stage.steps, scheme))
            path = stage_file(directory, number)
            compute = partial(_adapted, data, case, stage, scheme, number, path)
            results.append(store.cached(f"adapted-{number}", cache_key, compute, path))
            paths.append(path)
            rows = adaptive.table([one["row"] for one in results])
            table = write_text(directory / "adaptive.csv", rows.to_csv(index=False))
            print(f"mesh {number}: {stage.cells} cells, bound {up(rows.bound.iloc[-1], SHOWN)}", flush=True)
            with np.load(path) as arrays:
                following = next_stage(stage, arrays["shares"], float(arrays["in_time"]))
                at_vertices = arrays["times"], arrays["u"]
            reached = tolerance.reached(rows.iloc[-1])
            stopped = "" if reached else _limit(following, options.cells)
            if reached or stopped:
                break
            stage = following
        # If ``study bound`` has written the bounds on uniform meshes for this problem, the figure shows them, too.
        levels = directory / "levels.csv"
        uniform = pd.read_csv(levels) if levels.is_file() else DataFrame()
        edges, closed = contact_edges(data, mesh, at_vertices[1][-1])
        shown = Triangulation(*mesh.p, mesh.t.T)
        result = AdaptiveRefinement(
            name, "max " * data.in_time + NORM[data.in_time], shown, edges, closed, rows, uniform
        )
        drawn = draw_one(directory, figure("adaptive", result, case=name))
        solved = (mesh.p, mesh.t), at_vertices
        drawn += draw_one(directory, problem_drawing(name, data, solved), PROBLEM_OUTPUT)
    tell_written([table, *paths, *drawn])
    sentences = [*results[-1]["sentences"], *contact_sentences(data.body)]
    print("\n" + "\n".join(adaptive_text(name, rows, str(tolerance), stopped, sentences, data.in_time)) + "\n")
    return OK if reached and all(one["inside"] for one in results if case) else FAILED


def _adapted(data: Data, case: Case | None, stage: Stage, scheme: Tableau, number: int, path: Path) -> Json:
    """Compute and bound the displacement on one mesh, write it into a file, and return the record of the mesh."""
    found = adapted(data, case, stage, scheme)
    shares = {"shares": found.shares.cells, "in_time": np.array(found.shares.time)}
    write_displacement(path, found.computed, **shares)
    return adaptive.record(number, found)


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


def contact_edges(data: Data, mesh: Mesh, displacement: Array) -> tuple[Array, Array]:
    """Return the edges of the contact boundary Γ3, and which of them are in contact.

    Args:
        data: the problem.
        mesh: the mesh.
        displacement: the values of the displacement at the vertices, (2, vertices).

    Returns:
        The end points of the n edges on Γ3, (2, 2, n), and for each edge whether both end points are in contact, (n,).
    """
    # Bodies without contact have no array to concatenate, so each list starts with an empty array.
    ends = [np.empty((2, 2, 0))]
    closed = [np.empty(0, dtype=bool)]
    size = max(abs(displacement).max(), np.finfo(float).tiny)
    for part, facets in MeshedBody(mesh, data.body).on(Kind.CONTACT):
        vertices = mesh.facets[:, facets]
        ends.append(mesh.p[:, vertices])
        opening = -np.einsum("d,den->en", part.normal, displacement[:, vertices])
        closed.append((opening <= CLOSED_GAP * size).all(axis=0))
    return np.concatenate(ends, axis=2), np.concatenate(closed)


# Certificates.


def do_certify(options: Namespace) -> int:
    """Write a certificate (proof of an error bound) for each mesh, check all; return the checker's exit code."""
    name, data, _ = resolve_data(options.problem)
    scheme, family = scheme_and_family(options)
    refined = Refined(options.refine, options.shorter)
    if isinstance(data, Static):
        raise UsageError(f"{name} is a static problem, for which there are no certificates: take `study bound`")
    if not data.body.of(Kind.CONTACT):
        raise UsageError(f"{name} has no contact side, for which there are no certificates: take `study bound`")
    check_certifiable(data)
    if options.refine > checker.REFINEMENTS:
        raise UsageError(f"--refine {options.refine}: a certificate allows at most {checker.REFINEMENTS} refinements")
    check_levels(options, data, family, refined)
    paths = []
    store = Store(options.out / name, written=(".",))
    with store.locked():
        store.begin(of_data(data))
        for level in options.levels:
            steps = options.steps or rate_steps(data.body.T, level)
            compute = partial(make_certificate, data, family, level, scheme, steps, refined)
            found = with_progress(f"level {level}", data.body.T, compute)
            paths.append(write(store.directory / f"certificate-{level}.json.gz", found))
    tell_written(paths, "; now they are checked\n")
    code = checker.main([str(path) for path in paths])
    print(f"\nto check them without this package, with a copy of {checker.__file__}:")
    print(f"python checker.py {shlex.join(map(str, paths))}")
    return code or OK

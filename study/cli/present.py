"""``study tables``, ``study figures`` and ``study report`` present the data of a run; ``study show`` draws a case."""

import shutil
from argparse import Namespace
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from functools import partial
from math import nan
from pathlib import Path

import numpy as np
from matplotlib import rcParams

from manufactured.case import Case
from manufactured.self_proof import prove
from manufactured.tensors import full
from study.cli.common import progress_bar, tell_written
from study.cli.options import OK
from study.cli.problem import PROBLEM_OUTPUT, problem_drawing
from study.fem.mesh import MeshFamily
from study.fem.naming import resolve_data
from study.ledger.files import Json, Paths, UsageError
from study.ledger.text import folded
from study.present.article import write_tables
from study.present.drawing import ARTICLE, Drawing, Output, draw_one, in_style
from study.present.figures import drawings, drawings_of, overview
from study.present.report import write_report
from study.present.show import NO_FFMPEG, TimeSeries, draw_show, find_ffmpeg, vtk_mesh
from study.run.executor import Processes, require
from study.run.judgement import claims_file, compare_claims, judge, verdicts
from study.run.provenance import read_provenance
from study.run.store import Store
from study.solve.motion import Motion, von_mises
from study.statements import pictures
from study.statements.pictures import FAMILY, LEVEL, PICTURE_STEPS, contact_weights
from study.statements.shared import estimates
from study.statements.shared.scope import regular


def do_tables(options: Namespace) -> int:
    """Judge the data, and write ``claims.csv`` and the tables; return 0."""
    directory = options.out
    read_provenance(directory)
    with Store(directory).steady():
        judge(directory)
        tell_written([claims_file(directory), *write_tables(directory)])
    return OK


def do_report(options: Namespace) -> int:
    """Write the report, one HTML page; return 0.

    Raises:
        DataError: ``claims.csv`` differs from the checks that follow from the data; then no report is written.
    """
    directory = options.out
    with Processes(options.jobs) as processes, Store(directory).steady():
        compare_claims(directory, verdicts(directory))
        print(write_report(directory, read_provenance(directory), processes.map))
    return OK


def do_figures(options: Namespace) -> int:
    """Draw all figures of the data, or those that ``--case``, ``--overview`` or ``--only`` choose; return 0."""
    output = Output(options.use, tuple(options.format or ()), options.dpi, options.style)
    with in_style(output):
        latex = rcParams["pgf.texsystem"]
    if "pgf" in output.suffixes and not shutil.which(latex):
        raise UsageError(f"--format pgf needs {latex}, which is not installed: install LaTeX, or choose another format")
    data = options.data or options.out
    read_provenance(data)
    # If the figures go into another directory, its files might belong to somebody else.
    other = Store(options.out, written=("figures",)).locked() if options.data else nullcontext()
    with other, Processes(options.jobs) as processes, Store(data).steady():
        found = drawings_of(data, options.case or (), options.only or (), options.use == "slides")
        chosen = [drawing for drawing in found if not (options.overview and drawing.case)]
        tell_written(draw(options.out, processes, chosen, output))
    return OK


def write_overview(options: Namespace, directory: Path) -> Paths:
    """Write the tables and figures of a run, and return their files.

    Figures of single cases are only drawn if the user has selected cases. For all cases they take too long.
    """
    chosen = drawings(directory) if options.case else overview(directory)
    with Processes(options.jobs) as processes:
        return [*write_tables(directory), *draw(directory, processes, chosen)]


def draw(directory: Path, processes: Processes, chosen: Sequence[Drawing], output: Output = ARTICLE) -> Paths:
    """Draw figures with their texts in txt files and their data in csv files, show the progress, and return the files.

    Parameters:
        directory: the result directory.
        processes: worker processes, which draw the figures.
        chosen: the figures.
        output: use, formats, resolution and style of the figures.
    """
    written: Paths = []
    drawn = processes.map(partial(draw_one, output.folder(directory), output=output), chosen)
    with progress_bar(len(chosen)) as bar:
        for drawing, paths in zip(chosen, drawn, strict=True):
            bar.set_description(f"figure {drawing.name}", refresh=False)
            bar.update()
            written += paths
    return written


# Solving and drawing a case.

SHOWN_EVERY = 2
"""Every second time step is shown."""
SHOWN_LEVELS = {2: LEVEL, 3: 9}
"""Dimension ↦ default level (cells along a side). In 3D it is a multiple of the number of parts into which a
face of the cube is divided."""


def solve_showcase(case: Case, family: MeshFamily, level: int, notify: Callable[[], object]) -> tuple[Json, TimeSeries]:
    """Solve a case on one mesh for display.

    Parameters:
        case: the case.
        family, level: the mesh family, and the number of cells of the mesh along a side.
        notify: called after each of the PICTURE_STEPS + 1 times.

    Returns:
        The data of a picture, in the format of ``pictures/CASE.json.gz``; and fields on the whole mesh over time.

    Raises:
        MeshError: the mesh of this level does not fit the body.
    """
    motion = Motion.of(case.solution, family, level, PICTURE_STEPS, notify)
    return pictures.record(case.name, motion, SHOWN_EVERY), mesh_series(motion, SHOWN_EVERY)


def affordable_family(case: Case, level: int) -> MeshFamily:
    """Return the mesh family with which a case is shown, after checking that there is enough memory.

    Raises:
        UsageError: no mesh family can mesh the body, or there is not enough memory for this level.
    """
    dim = case.solution.body.dim
    family = FAMILY if dim == 2 else regular(case)
    require(f"level {level}", estimates.displacement(dim, level, family.name))
    return family


def mesh_series(motion: Motion, every: int) -> TimeSeries:
    """Return fields on the mesh of a solved case, at every ``every``-th time.

    Fields at the vertices are ``displacement``, ``velocity``, and on the contact boundary ``gap`` and ``pressure``
    (``gap_1``, ``gap_2``, … if this boundary has several faces; other vertices have NaN). Fields on the cells, constant
    on each, are ``stress`` and ``von_mises``.

    Parameters:
        motion: the solved case, with its displacement, stress and contact force at all times.
        every: the step between the times that are used.
    """
    space = motion.space
    mesh = space.mesh
    weights = contact_weights(space)
    ends = np.cumsum([len(vertices) for _, vertices in space.contact])
    series = []
    for frame in motion.frames[::every]:
        at_vertices = {"displacement": space.nodal(frame.u), "velocity": space.nodal(frame.velocity)}
        gaps = np.split(-frame.normal, ends)
        pressures = np.split(frame.multipliers / weights, ends)
        for number, (_, vertices) in enumerate(space.contact):
            suffix = f"_{number + 1}" if len(space.contact) > 1 else ""
            for name, values in (("gap", gaps[number]), ("pressure", pressures[number])):
                field = np.full(mesh.nvertices, nan)
                field[vertices] = values
                at_vertices[name + suffix] = field
        in_cells = {"stress": full(frame.stress), "von_mises": von_mises(frame.stress)}
        series.append((frame.time, vtk_mesh(mesh.p, mesh.t, at_vertices, in_cells)))
    return series


def do_show(options: Namespace) -> int:
    """Solve a case on one mesh, draw it, and write files for ParaView; or draw a problem as it is stated. Return 0."""
    name, data, case = resolve_data(options.case)
    if case is None:
        with Store(options.out / name, written=(".",)).locked():
            tell_written(draw_one(options.out / name, problem_drawing(name, data), PROBLEM_OUTPUT))
        return OK
    level = SHOWN_LEVELS[case.solution.body.dim] if options.level is None else options.level
    if options.mp4 and not find_ffmpeg():
        raise UsageError(f"--mp4: {NO_FFMPEG}")
    prove(case.solution, f"case {case.name}")
    family = affordable_family(case, level)
    directory = options.out / case.name
    with Store(directory, written=(".",)).locked():
        with progress_bar(PICTURE_STEPS + 1, case.name) as bar:
            record, series = solve_showcase(case, family, level, bar.update)
        # There are a storyboard and a frame for each time.
        with progress_bar(1 + len(record["times"]), "images") as bar:
            written, left_out = draw_show(record, series, directory, bar.update)
    tell_written(written)
    for line in left_out:
        print(folded(f"left out: {line}"))
    return OK

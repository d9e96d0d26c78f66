"""``study show``: solves a case on one mesh, draws it, and writes files for ParaView."""

import argparse

from manufactured.self_proof import prove
from study.cli.common import progress_bar, tell_written
from study.cli.options import OK
from study.cli.problem import draw_problem
from study.fem.naming import resolve_data
from study.ledger.files import UsageError
from study.ledger.text import folded
from study.present.show import NO_FFMPEG, draw_show, find_ffmpeg
from study.run.showcase import SHOWN_LEVELS, SHOWN_STEPS, affordable_family, solve_showcase
from study.run.store import Store


def do_show(options: argparse.Namespace) -> int:
    """Solve a case on one mesh, draw it, and write files for ParaView; or draw a problem as it is stated. Return 0."""
    name, data, case = resolve_data(options.case)
    if case is None:
        with Store(options.out / name, written=(".",)).locked():
            tell_written(draw_problem(options.out / name, name, data))
        return OK
    level = SHOWN_LEVELS[case.solution.body.dim] if options.level is None else options.level
    if options.mp4 and not find_ffmpeg():
        raise UsageError(f"--mp4: {NO_FFMPEG}")
    prove(case.solution, f"case {case.name}")
    family = affordable_family(case, level)
    directory = options.out / case.name
    with Store(directory, written=(".",)).locked():
        with progress_bar(SHOWN_STEPS + 1, case.name) as bar:
            record, series = solve_showcase(case, family, level, bar.update)
        # There are a storyboard and a frame for each time.
        with progress_bar(1 + len(record["times"]), "images") as bar:
            written, left_out = draw_show(record, series, directory, bar.update)
    tell_written(written)
    for line in left_out:
        print(folded(f"left out: {line}"))
    return OK

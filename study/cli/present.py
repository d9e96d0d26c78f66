"""``study tables``, ``study figures`` and ``study report``: present the data in a result directory."""

import argparse
import shutil
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path

from matplotlib import rcParams

from study.cli.common import progress_bar, tell_written
from study.cli.options import OK
from study.ledger.files import UsageError
from study.present.article import write_tables
from study.present.drawing import ARTICLE, Drawing, Output, draw_figures, in_style
from study.present.figures import drawings, drawings_of, overview
from study.present.report import write_report
from study.run.executor import Processes
from study.run.judgement import claims_file, compare_claims, judge, verdicts
from study.run.provenance import read_provenance
from study.run.store import Store


def do_tables(options: argparse.Namespace) -> int:
    """Judge the data, and write ``claims.csv`` and the tables; return 0."""
    read_provenance(options.out)
    with Store(options.out).steady():
        judge(options.out)
        tell_written([claims_file(options.out), *write_tables(options.out)])
    return OK


def do_report(options: argparse.Namespace) -> int:
    """Write the report, one HTML page, unless data and ``claims.csv`` contradict each other; return 0."""
    with Processes(options.jobs) as executor, Store(options.out).steady():
        compare_claims(options.out, verdicts(options.out))
        print(write_report(options.out, read_provenance(options.out), executor.map))
    return OK


def do_figures(options: argparse.Namespace) -> int:
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
    with other, Processes(options.jobs) as executor, Store(data).steady():
        found = drawings_of(data, options.case or (), options.only or (), options.use == "slides")
        chosen = [drawing for drawing in found if not (options.overview and drawing.case)]
        tell_written(draw(options.out, executor, chosen, output))
    return OK


def write_overview(options: argparse.Namespace, directory: Path) -> list[Path]:
    """Write the tables and figures of a run, and return their files.

    Figures of single cases are only drawn if the user has selected cases. For all cases they take too long.
    """
    chosen = drawings(directory) if options.case else overview(directory)
    with Processes(options.jobs) as processes:
        return [*write_tables(directory), *draw(directory, processes, chosen)]


def draw(directory: Path, processes: Processes, chosen: Sequence[Drawing], output: Output = ARTICLE) -> list[Path]:
    """Draw figures, show the progress, and return the files.

    Parameters:
        directory: the result directory.
        processes: worker processes, which draw the figures.
        chosen: the figures.
        output: use, formats, resolution and style of the figures.
    """
    with progress_bar(0) as bar:

        def show(done: int, total: int, name: str) -> None:
            bar.total = total
            bar.set_description(f"figure {name}", refresh=False)
            bar.update()

        return draw_figures(directory, chosen, processes.map, show, output)

"""The commands, their options and exit codes. Only fast imports are permitted, so that ``--help`` answers at once."""

from __future__ import annotations

import argparse
import math
import os
from importlib.metadata import version
from pathlib import Path

OK, FAILED, USAGE, UNCLEAR, INTERRUPTED, CLOSED = 0, 1, 2, 3, 130, 141
"""Exit codes: success; a check fails, or an error; bad usage or input; undecided; Ctrl-C; broken pipe."""
SCHEMES = ("backward-euler", "midpoint", "bdf2")
FAMILIES = ("one-diagonal", "criss-cross", "shaken", "unstructured", "graded")
MODES = ("frozen", "march")
MINUTES = 60.0
"""How long ``study seeds`` draws new seeds by default."""
TOLERANCE = 1e-12
"""Relative difference that ``study compare`` permits by default."""
AGAIN_TOLERANCE, AGAIN_ABSOLUTE = 1e-5, 1e-9
"""Differences that ``study check --again`` permits by default. With 1e-12 every file differs on another processor,
because numbers near round-off differ and quotients of small numbers have fewer digits."""
CELLS = 20_000
"""Largest number of cells of ``study bound --adapt`` by default."""
RESUMES = ("run", "controls", "seeds", "bound")
RESUMED = "finished results are kept; run the same command again to compute the rest"
STARTS_AGAIN = "no file is half-written; the same command starts from the beginning"


def parser() -> argparse.ArgumentParser:
    """Return the parser of all commands; ``options.command`` has the module and the function of a command."""
    top = argparse.ArgumentParser(
        prog="study",
        description="Verify the claims of Barboteu, Han and Sofonea (2002), and bound the errors of your own problems.",
        epilog=f"Time schemes: {', '.join(SCHEMES)}. Mesh families: {', '.join(FAMILIES)}. A command with --help has "
        "its options; the documentation is in docs/.",
    )
    top.add_argument("--version", action="version", version=f"study {version('signorini-study')}")
    commands = top.add_subparsers(required=True, metavar="COMMAND")

    def add(name: str, module: str, help: str) -> argparse.ArgumentParser:
        command = commands.add_parser(name, help=help, description=help[0].upper() + help[1:] + ".")
        interrupted = RESUMED if name in RESUMES else STARTS_AGAIN
        command.set_defaults(command=(module, f"do_{name}"), interrupted=interrupted)
        return command

    _json(add("cases", "cases", "list the exact solutions"))
    _run(add("run", "run", "measure, judge, write tables and figures; resumes where it was stopped"))
    _check(add("check", "check", "compare data, verdicts and tables on disk with their expected contents"))
    _compare(add("compare", "compare", "show how numbers and verdicts of two result directories differ"))
    _spread(add("controls", "controls", "test that deliberate defects are noticed; exit code 0 if all are"))
    _spread(add("sensitivity", "controls", "find the smallest relative defect of each part that makes a check fail"))
    seeds = add("seeds", "seeds", "estimate the false-alarm rate by judging fresh random meshes")
    seeds.add_argument(
        "--minutes", type=_finite, default=MINUTES, metavar="M", help="how long (default 60; 0: only the table)"
    )
    seeds.add_argument("--seeds", type=int, metavar="N", help="largest number of fresh seeds")
    seeds.add_argument("--seed", type=int, metavar="N", help="measure this seed again; the record is not changed")
    _spread(seeds)
    _rates(add("rates", "rates", "observed orders of any table of errors"))
    _bound(add("bound", "bound", "enclose the error of a computed displacement, exact solution or not"))
    certify = "prove error bounds by certificates, which a stand-alone program checks"
    _certify(add("certify", "certify", certify))
    _export(add("export", "export", "write cases as plain data, to test other people's contact codes"))
    show = add("show", "show", "solve a case on one mesh; draw a storyboard and an animation, and write ParaView files")
    show.add_argument("case", metavar="NAME|FILE.py:NAME", help="a case")
    show.add_argument("--level", type=int, metavar="N", help="cells along a side (default 24, in 3D 9)")
    film = "insist on animation.mp4: refuse if ffmpeg is missing (without this option the film is left out then)"
    show.add_argument("--mp4", action="store_true", help=film)
    _out(show, "shows")
    _out(add("report", "present", "write one HTML page from the data on disk, readable without a network"))
    _out(add("tables", "present", "write the tables again from the data on disk"))
    _figures(add("figures", "present", "draw figures for articles, slides or pages from the data on disk"))
    return top


def _figures(figures: argparse.ArgumentParser) -> None:
    use = "article: columns of 3.5 in, DIR/figures (default); slides: 16:9, 1920 px; web: SVG; DIR/figures/USE"
    figures.add_argument("--for", dest="use", choices=("article", "slides", "web"), default="article", help=use)
    formats = "formats (default: png pdf svg for articles, png pdf for slides, svg png for the web)"
    figures.add_argument("--format", nargs="+", choices=("png", "pdf", "svg", "pgf"), help=formats)
    which = figures.add_mutually_exclusive_group()
    which.add_argument("--case", nargs="+", metavar="NAME", help="only the figures of these cases")
    which.add_argument("--overview", action="store_true", help="only the figures over all cases")
    figures.add_argument("--dpi", type=_finite, metavar="N", help="dots per inch of PNG files")
    style = "Matplotlib style file, replaces entries of the style of the study; figure.figsize sets the column width"
    figures.add_argument("--style", type=Path, metavar="FILE", help=style)
    _spread(figures)


def _rates(rates: argparse.ArgumentParser) -> None:
    orders = "P|NAME=P,..."
    rates.add_argument("file", type=Path, metavar="FILE", help="a table in nearly any form; - is standard input")
    rates.add_argument("--expected", type=_orders, metavar=orders, help="expected order; higher orders fail, too")
    rates.add_argument("--at-least", type=_orders, metavar=orders, help="least order that is accepted")
    rates.add_argument("--tolerance", type=_finite, default=0.15, metavar="T", help="for --expected (default 0.15)")
    rates.add_argument("--columns", metavar="NAME,...", help="columns of errors (default: all that are recognised)")
    rates.add_argument("--in", dest="size", metavar="NAME", help="column of sizes, for example dt")
    rates.add_argument("--dim", type=int, metavar="D", help="dimension, where sizes are counts of cells or unknowns")
    rates.add_argument("--ratio", type=_finite, metavar="R", help="ratio of mesh sizes from row to row")
    rates.add_argument("--values", action="store_true", help="compute the grid convergence index of values")
    rates.add_argument("--junit", type=Path, metavar="FILE", help="also write the verdicts as JUnit XML")
    rates.add_argument("--markdown", type=Path, metavar="FILE", help="also write the verdicts as a Markdown table")
    rates.add_argument("--plot", type=Path, metavar="FILE", help="also draw errors over h as PNG, SVG or PDF")
    _json(rates)


def _run(sweep: argparse.ArgumentParser) -> None:
    size = sweep.add_mutually_exclusive_group()
    quick = "about a minute (default), into results/quick"
    size.add_argument("--quick", dest="plan", action="store_const", const="quick", default="quick", help=quick)
    size.add_argument("--full", dest="plan", action="store_const", const="full", help="all levels, into results")
    sweep.add_argument("--case", action="extend", nargs="+", metavar="NAME|FILE.py:NAME", help="only these cases")
    sweep.add_argument("--levels", nargs="+", type=int, metavar="N", help="cells along a side, increasing")
    sweep.add_argument("--scheme", default="midpoint", help=f"time scheme: {', '.join(SCHEMES)} (default midpoint)")
    sweep.add_argument("--step", type=float, metavar="K", help="time step at every level (default: each case's pace)")
    _jobs(sweep)
    cluster = (
        "measure on the workers of a Dask scheduler, tcp://HOST:PORT; whoever reaches its port can run any code on the "
        "scheduler, on the workers and through their results here: use it only in a network that you trust, or with TLS"
    )
    sweep.add_argument("--cluster", metavar="ADDRESS", help=cluster)
    _undecided(sweep)
    where = "directory (default results/quick, or results with --full)"
    sweep.add_argument("--out", type=Path, metavar="DIR", help=where)


def _check(check: argparse.ArgumentParser) -> None:
    check.add_argument("--junit", type=Path, metavar="FILE", help="also write the verdicts as JUnit XML")
    _undecided(check)
    again = "also measure N rows again, drawn at random, cheap rows more often, and compare; exit 1 if a number differs"
    check.add_argument("--again", type=int, metavar="N", help=again)
    seed = "seed with which --again draws rows; each check prints its seed (default: a fresh seed)"
    check.add_argument("--seed", type=int, metavar="S", help=seed)
    relative = f"numbers a, b of --again are equal if |a - b| <= Y + X max(|a|, |b|) (default {AGAIN_TOLERANCE:g})"
    check.add_argument("--tolerance", type=float, default=AGAIN_TOLERANCE, metavar="X", help=relative)
    absolute = f"(default {AGAIN_ABSOLUTE:g}) for numbers near round-off, which differ between processors"
    check.add_argument("--absolute", type=float, default=AGAIN_ABSOLUTE, metavar="Y", help=absolute)
    _spread(check)


def _compare(differ: argparse.ArgumentParser) -> None:
    differ.add_argument("old", type=Path, metavar="OLD", help="directory of a run, its --out")
    differ.add_argument("new", type=Path, metavar="NEW", help="another one")
    relative = f"numbers a, b are equal if |a - b| <= Y + X max(|a|, |b|) (default {TOLERANCE:g})"
    differ.add_argument("--tolerance", type=float, default=TOLERANCE, metavar="X", help=relative)
    absolute = "(default 0) for numbers near round-off"
    differ.add_argument("--absolute", type=float, default=0.0, metavar="Y", help=absolute)
    _json(differ)


def _bound(bound: argparse.ArgumentParser) -> None:
    bound.add_argument("problem", metavar="NAME|FILE.py:NAME", help="a case, a problem without a solution, or your own")
    _enclosed(bound, levels=(8, 16), shorter=4)
    given = "enclose the error of displacements from files (.npz, or a mesh that meshio reads) instead of computing one"
    bound.add_argument("--displacement", nargs="+", type=Path, metavar="FILE", help=given)
    bound.add_argument("--field", metavar="NAME", help="name of the field in the file (default: recognised)")
    nearest = "if the displacement does not vanish on Γ1, bound the error of the nearest one that does"
    bound.add_argument("--nearest", action="store_true", help=nearest)
    adapt = "refine from the first level until the bound from u_h alone is at most TOL, or P per cent of ‖u‖_V"
    bound.add_argument("--adapt", metavar="TOL|P%%", help=adapt)
    most = f"largest mesh of --adapt (default {CELLS})"
    bound.add_argument("--cells", type=int, default=CELLS, metavar="N", help=most)
    _out(bound, "bounds")


def _certify(certify: argparse.ArgumentParser) -> None:
    certify.add_argument("problem", metavar="NAME|FILE.py:NAME", help="a problem in formulas")
    _enclosed(certify, levels=(4, 8), shorter=2)
    _out(certify, "certificates")


def _enclosed(bound: argparse.ArgumentParser, levels: tuple[int, ...], shorter: int) -> None:
    default = " ".join(map(str, levels))
    increasing = f"increasing (default {default})"
    bound.add_argument("--levels", nargs="+", type=int, default=list(levels), metavar="N", help=increasing)
    bound.add_argument("--family", default="unstructured", help=f"meshes: {', '.join(FAMILIES)} (default unstructured)")
    bound.add_argument("--scheme", default="midpoint", help=f"time scheme: {', '.join(SCHEMES)} (default midpoint)")
    bound.add_argument("--steps", type=int, metavar="N", help="time steps of u_h at every level")
    bound.add_argument("--refine", type=int, default=1, metavar="R", help="refinements of the mesh of ũ (default 1)")
    steps = f"steps of ũ in one of u_h (default {shorter})"
    bound.add_argument("--shorter", type=int, default=shorter, metavar="Q", help=steps)


def _export(export: argparse.ArgumentParser) -> None:
    export.add_argument("case", nargs="+", metavar="NAME|FILE.py:NAME", help="cases with linear laws")
    export.add_argument("--levels", nargs="+", type=int, default=[8, 16, 32], metavar="N", help="default 8 16 32")
    meshes = f"meshes: {', '.join(FAMILIES)} (default: those on which `study run` measures the case)"
    export.add_argument("--family", nargs="+", metavar="NAME", help=meshes)
    export.add_argument("--mode", choices=MODES, default="frozen", help="static problems, or steps in time")
    export.add_argument("--instants", nargs="+", type=_finite, metavar="T", help="for static problems (default: three)")
    export.add_argument("--steps", type=int, metavar="N", help="steps of --mode march (default: the level)")
    export.add_argument("--scale", type=_finite, default=1.0, metavar="S", help="factor of all loads (default 1)")
    slab = "also mesh the foundation, with this number of segments"
    export.add_argument("--foundation", type=int, metavar="SEGMENTS", help=slab)
    _out(export, "tasks", "--to")


def _undecided(command: argparse.ArgumentParser) -> None:
    known = "exit 0 if the undecided rows are exactly those of this table: label, key, case, family, reason"
    command.add_argument("--undecided", type=Path, metavar="FILE", help=known)


def _spread(command: argparse.ArgumentParser) -> None:
    _jobs(command)
    _out(command)


def _jobs(command: argparse.ArgumentParser) -> None:
    command.add_argument("--jobs", type=int, default=os.cpu_count() or 1, help="processes (default: all cores)")


def _out(command: argparse.ArgumentParser, default: str = "results", *also: str) -> None:
    where = f"directory (default {default})"
    command.add_argument("--out", *also, type=Path, default=Path(default), metavar="DIR", help=where)


def _json(command: argparse.ArgumentParser) -> None:
    command.add_argument("--json", action="store_true", help="as JSON")


def _orders(text: str) -> float | dict[str, float]:
    """Return a number for ``2`` and a dict for ``L2=2,H1=1``; commas that follow no ``=2`` belong to a name."""
    orders: dict[str, float] = {}
    name = ""
    for part in text.split(","):
        name += part
        before, _, number = name.rpartition("=")
        try:
            orders[before.strip()] = _finite(number)
            name = ""
        except ValueError:
            name += ","
    if name or ("" in orders and "," in text):
        raise argparse.ArgumentTypeError(f"got '{text}', expected a number such as 2, or names such as L2=2,H1=1")
    return orders if "=" in text else orders[""]


def _finite(text: str) -> float:
    """Return a finite number from text."""
    value = float(text)
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text} is not a finite number")
    return value

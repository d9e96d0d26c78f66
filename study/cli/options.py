"""Defines the commands, their options and exit codes.

The module imports nothing slow, so that ``--help`` answers at once.
"""

from __future__ import annotations

import argparse
import math
import os
from importlib.metadata import version
from pathlib import Path

OK, FAILED, USAGE, UNCLEAR, INTERRUPTED, CLOSED = 0, 1, 2, 3, 130, 141
"""Exit codes: success; a check or a job fails; bad usage or input; undecided; Ctrl-C; broken pipe."""
SCHEMES = ("backward-euler", "midpoint", "bdf2")
FAMILIES = ("one-diagonal", "criss-cross", "shaken", "unstructured", "graded")
MODES = ("frozen", "march")
MINUTES = 60.0
"""Default time in minutes during which ``study seeds`` measures new random meshes."""
TOLERANCE = 1e-12
"""Default relative difference that ``study compare`` permits."""
AGAIN_TOLERANCE, AGAIN_ABSOLUTE = 1e-5, 1e-9
"""Default relative and absolute differences that ``study check --again`` permits. They are larger than 1e-12, because
on another processor numbers near round-off differ, and so do quotients of small numbers."""
CELLS = 20_000
"""Default largest number of cells of ``study bound --adapt``."""
RESUMES = ("run", "controls", "seeds", "bound")
RESUMED = "finished results are kept; run the same command again to compute the rest"
STARTS_AGAIN = "no file is half-written; the same command starts from the beginning"


def parser() -> argparse.ArgumentParser:
    """Return the parser of all commands.

    The parsed options have an attribute ``command``: the module in ``study.cli`` and the name of the function to call.
    """
    top = argparse.ArgumentParser(
        prog="study",
        description="Verify the claims of Barboteu, Han and Sofonea (2002), and bound the errors of your own problems.",
        epilog=f"Time schemes: {', '.join(SCHEMES)}. Mesh families: {', '.join(FAMILIES)}. `study COMMAND --help` "
        "lists the options of a command; the documentation is in docs/.",
    )
    top.add_argument("--version", action="version", version=f"study {version('signorini-study')}")
    commands = top.add_subparsers(required=True, metavar="COMMAND")

    def add(name: str, module: str, help: str) -> argparse.ArgumentParser:
        command = commands.add_parser(name, help=help, description=help[0].upper() + help[1:] + ".")
        interrupted = RESUMED if name in RESUMES else STARTS_AGAIN
        command.set_defaults(command=(module, f"do_{name}"), interrupted=interrupted)
        return command

    _json(add("cases", "cases", "list the exact solutions"))
    _run(add("run", "run", "run the study: measure, judge, write tables and figures; continues if it was stopped"))
    _check(add("check", "check", "compare data, verdicts and tables on disk with their expected contents"))
    _compare(add("compare", "compare", "show in which numbers and verdicts two result directories differ"))
    _spread(add("controls", "controls", "test that deliberate defects are noticed; exit code 0 if all are"))
    _spread(
        add("sensitivity", "controls", "find the smallest defect of each part of the problem that makes a check fail")
    )
    seeds = add("seeds", "seeds", "estimate how often chance makes a check fail, on new random meshes")
    seeds.add_argument(
        "--minutes",
        type=_finite,
        default=MINUTES,
        metavar="M",
        help="time for new seeds (default 60; 0: only write the table again)",
    )
    seeds.add_argument("--seeds", type=int, metavar="N", help="largest number of new seeds")
    seeds.add_argument("--seed", type=int, metavar="N", help="measure this seed again and compare with the record")
    _spread(seeds)
    _rates(add("rates", "rates", "compute the observed orders of any table of errors"))
    _bound(add("bound", "bound", "enclose the error of a computed displacement, without the exact solution"))
    certify = add("certify", "certify", "write proofs of error bounds as files, which a stand-alone program checks")
    certify.add_argument("problem", metavar="NAME|FILE.py:NAME", help="a problem given by formulas")
    _enclosed(certify, levels=(4, 8), shorter=2)
    _out(certify, "certificates")
    _export(add("export", "export", "write cases as data files, to test other contact codes"))
    show = add("show", "show", "solve a case on one mesh, draw images and an animation, and write files for ParaView")
    show.add_argument("case", metavar="NAME|FILE.py:NAME", help="a case")
    show.add_argument("--level", type=int, metavar="N", help="cells along a side (default 24, in 3D 9)")
    film = "require animation.mp4: a missing ffmpeg is an error (without this option the film is then left out)"
    show.add_argument("--mp4", action="store_true", help=film)
    _out(show, "shows")
    _out(add("report", "present", "write one HTML page about the data in a directory"))
    _out(add("tables", "present", "judge the data in a directory again and write the tables"))
    _figures(add("figures", "present", "draw figures for articles, slides or pages from the data in a directory"))
    return top


def _figures(figures: argparse.ArgumentParser) -> None:
    use = "article: 3.5 in wide, into DIR/figures (default); slides: 16:9, 1920 px; web: SVG; both into DIR/figures/USE"
    figures.add_argument("--for", dest="use", choices=("article", "slides", "web"), default="article", help=use)
    formats = "formats (default: png pdf svg for articles, png pdf for slides, svg png for the web)"
    figures.add_argument("--format", nargs="+", choices=("png", "pdf", "svg", "pgf"), help=formats)
    which = figures.add_mutually_exclusive_group()
    which.add_argument("--case", nargs="+", metavar="NAME", help="only the figures of these cases")
    which.add_argument("--overview", action="store_true", help="only the figures that show all cases together")
    which.add_argument("--only", nargs="+", metavar="NAME", help="only these figures, such as zone-hexagon")
    figures.add_argument("--dpi", type=_finite, metavar="N", help="dots per inch of PNG files")
    style = "Matplotlib style file, replaces entries of the style of the study; figure.figsize sets the column width"
    figures.add_argument("--style", type=Path, metavar="FILE", help=style)
    data = "result directory whose data are drawn (default: that of --out, which also receives the figures)"
    figures.add_argument("--data", type=Path, metavar="DIR", help=data)
    _spread(figures)


def _rates(rates: argparse.ArgumentParser) -> None:
    add = rates.add_argument
    orders = "P|NAME=P,..."
    add("file", type=Path, metavar="FILE", help="a table of errors as text, in nearly any form; - reads standard input")
    add("--expected", type=_orders, metavar=orders, help="expected order; lower and higher orders fail")
    add("--at-least", type=_orders, metavar=orders, help="lower limit of the order; higher orders pass")
    add("--tolerance", type=_finite, default=0.15, metavar="T", help="accepted difference of orders (default 0.15)")
    add("--columns", metavar="NAME,...", help="names of the columns of errors (default: found by their names)")
    add("--in", dest="size", metavar="NAME", help="name of the column of mesh sizes or time steps")
    add("--dim", type=int, metavar="D", help="dimension of the mesh, if sizes are numbers of cells or unknowns")
    add("--ratio", type=_finite, metavar="R", help="ratio of the mesh sizes in consecutive rows")
    add("--values", action="store_true", help="the columns are values, not errors: compute the grid convergence index")
    add("--junit", type=Path, metavar="FILE", help="also write the verdicts as JUnit XML")
    add("--markdown", type=Path, metavar="FILE", help="also write the verdicts as a Markdown table")
    add("--plot", type=Path, metavar="FILE", help="also draw errors over h as PNG, SVG or PDF")
    _json(rates)


def _run(sweep: argparse.ArgumentParser) -> None:
    add = sweep.add_argument
    size = sweep.add_mutually_exclusive_group()
    quick = "few levels, a minute, results in results/quick (default)"
    size.add_argument("--quick", dest="plan", action="store_const", const="quick", default="quick", help=quick)
    size.add_argument(
        "--full", dest="plan", action="store_const", const="full", help="all levels, an hour, results in results"
    )
    add(
        "--case",
        action="extend",
        nargs="+",
        metavar="NAME|FILE.py:NAME",
        help="measure only these cases, by name or from your own file",
    )
    add("--levels", nargs="+", type=int, metavar="N", help="meshes: numbers of cells along a side, increasing")
    add("--scheme", default="midpoint", help=f"time scheme: {', '.join(SCHEMES)} (default midpoint)")
    add("--step", type=float, metavar="K", help="time step on all levels (default: chosen for each case)")
    _jobs(sweep)
    cluster = (
        "measure on the workers of the Dask scheduler at tcp://HOST:PORT; anybody who reaches its port can run any "
        "code on the scheduler, the workers and this machine: use it only in a network that you trust, or with TLS"
    )
    add("--cluster", metavar="ADDRESS", help=cluster)
    _undecided(sweep)
    where = "result directory (default results/quick, or results with --full)"
    add("--out", type=Path, metavar="DIR", help=where)


def _check(check: argparse.ArgumentParser) -> None:
    add = check.add_argument
    add("--junit", type=Path, metavar="FILE", help="also write the verdicts as JUnit XML")
    _undecided(check)
    again = "also measure N random rows again, cheap rows more often, and compare; exit code 1 if a number differs"
    add("--again", type=int, metavar="N", help=again)
    seed = "seed with which --again draws rows (default: a new seed, which is printed)"
    add("--seed", type=int, metavar="S", help=seed)
    relative = f"numbers a, b of --again are equal if |a - b| <= Y + X max(|a|, |b|) (default {AGAIN_TOLERANCE:g})"
    add("--tolerance", type=float, default=AGAIN_TOLERANCE, metavar="X", help=relative)
    absolute = f"(default {AGAIN_ABSOLUTE:g}) for numbers near round-off, which differ between processors"
    add("--absolute", type=float, default=AGAIN_ABSOLUTE, metavar="Y", help=absolute)
    _spread(check)


def _compare(differ: argparse.ArgumentParser) -> None:
    add = differ.add_argument
    add("old", type=Path, metavar="OLD", help="result directory of a run")
    add("new", type=Path, metavar="NEW", help="result directory of another run")
    relative = f"numbers a, b are equal if |a - b| <= Y + X max(|a|, |b|) (default {TOLERANCE:g})"
    add("--tolerance", type=float, default=TOLERANCE, metavar="X", help=relative)
    absolute = "(default 0) for numbers near round-off"
    add("--absolute", type=float, default=0.0, metavar="Y", help=absolute)
    _json(differ)


def _bound(bound: argparse.ArgumentParser) -> None:
    add = bound.add_argument
    add("problem", metavar="NAME|FILE.py:NAME", help="a case, a problem of this project, or your own problem")
    _enclosed(bound, levels=(8, 16), shorter=4)
    given = "enclose the errors of displacements in files (.npz, .vtu and others) instead of computing one"
    add("--displacement", nargs="+", type=Path, metavar="FILE", help=given)
    add("--field", metavar="NAME", help="name of the displacement in the file (default: u or displacement)")
    nearest = "if the displacement is not zero on the clamped part, bound the error of the nearest one that is"
    add("--nearest", action="store_true", help=nearest)
    adapt = "refine the first mesh until the error bound is at most TOL, or P per cent of the norm of u"
    add("--adapt", metavar="TOL|P%%", help=adapt)
    most = f"largest number of cells of --adapt (default {CELLS})"
    add("--cells", type=int, default=CELLS, metavar="N", help=most)
    _out(bound, "bounds")


def _enclosed(bound: argparse.ArgumentParser, levels: tuple[int, ...], shorter: int) -> None:
    add = bound.add_argument
    default = " ".join(map(str, levels))
    increasing = f"meshes: numbers of cells along a side, increasing (default {default})"
    add("--levels", nargs="+", type=int, default=list(levels), metavar="N", help=increasing)
    add("--family", default="unstructured", help=f"meshes: {', '.join(FAMILIES)} (default unstructured)")
    add("--scheme", default="midpoint", help=f"time scheme: {', '.join(SCHEMES)} (default midpoint)")
    add("--steps", type=int, metavar="N", help="time steps of the displacement on every level")
    add(
        "--refine",
        type=int,
        default=1,
        metavar="R",
        help="refinements of the mesh for the better displacement ũ of the bound (default 1)",
    )
    steps = f"time steps of ũ in each time step of the displacement (default {shorter})"
    add("--shorter", type=int, default=shorter, metavar="Q", help=steps)


def _export(export: argparse.ArgumentParser) -> None:
    add = export.add_argument
    add("case", nargs="+", metavar="NAME|FILE.py:NAME", help="cases with linear laws")
    add("--levels", nargs="+", type=int, default=[8, 16, 32], metavar="N", help="cells along a side (default 8 16 32)")
    meshes = f"meshes: {', '.join(FAMILIES)} (default: those on which `study run` measures the case)"
    add("--family", nargs="+", metavar="NAME", help=meshes)
    add(
        "--mode",
        choices=MODES,
        default="frozen",
        help="frozen: static problems (default); march: a problem with time steps",
    )
    add("--instants", nargs="+", type=_finite, metavar="T", help="times of the static problems (default: three times)")
    add("--steps", type=int, metavar="N", help="number of time steps of --mode march (default: the level)")
    add("--scale", type=_finite, default=1.0, metavar="S", help="factor of all loads (default 1)")
    slab = "also write a mesh of the foundation, with this number of segments"
    add("--foundation", type=int, metavar="SEGMENTS", help=slab)
    _out(export, "tasks", "--to")


def _undecided(command: argparse.ArgumentParser) -> None:
    known = "exit code 0 if the undecided checks are exactly those in this CSV file (label, key, case, family, reason)"
    command.add_argument("--undecided", type=Path, metavar="FILE", help=known)


def _spread(command: argparse.ArgumentParser) -> None:
    _jobs(command)
    _out(command)


def _jobs(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--jobs", type=int, default=os.cpu_count() or 1, help="number of processes (default: all cores)"
    )


def _out(command: argparse.ArgumentParser, default: str = "results", *also: str) -> None:
    where = f"result directory (default {default})"
    command.add_argument("--out", *also, type=Path, default=Path(default), metavar="DIR", help=where)


def _json(command: argparse.ArgumentParser) -> None:
    command.add_argument("--json", action="store_true", help="print as JSON")


def _orders(text: str) -> float | dict[str, float]:
    """Return the expected orders in a text: a number for ``2``, and a dictionary for ``L2=2,H1=1``.

    Names of columns may contain commas. A comma separates two entries only after a number.
    """
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
    """Return the finite number in a text; argparse prints a message if there is none."""
    value = float(text)
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text} is not a finite number")
    return value

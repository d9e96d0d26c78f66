"""Defines the commands, their options and exit codes.

The module imports nothing slow, so that ``--help`` answers at once.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from difflib import get_close_matches
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

OK = 0
FAILED = 1
BAD_USAGE = 2
UNCLEAR = 3
INTERRUPTED = 130
BROKEN_PIPE = 141
"""Exit codes: success; a check or a job fails; bad usage or input; undecided; Ctrl-C; broken pipe."""
SCHEME_NAMES = ("backward-euler", "midpoint", "bdf2")
FAMILY_NAMES = ("one-diagonal", "criss-cross", "shaken", "unstructured", "graded", "alternating")
COMPARE_TOLERANCE = 1e-12
"""Default relative difference that ``study compare`` permits."""
AGAIN_TOLERANCE = 1e-5
AGAIN_ABSOLUTE = 1e-9
"""Default relative and absolute differences that ``study check --again`` permits. They are larger than 1e-12, because
on another processor numbers near round-off differ, and so do quotients of small numbers."""
SEED_BITS = 62
"""Number of bits of a random seed: so many that seeds do not repeat, and few enough for 64-bit integers."""
MOST_DIGITS = 20
"""Largest number of digits of a whole number."""
MOST_CELLS = 20_000
"""Default largest number of cells of ``study bound --adapt``."""
RESUMES = ("run", "faults", "seeds", "bound")
RESUMED = "finished results are kept; run the same command again to compute the rest"
STARTS_AGAIN = "no file is half-written; the same command starts from the beginning"


class Range(NamedTuple):
    """The permitted values of an option, as numbers and in words.

    Attributes:
        least, most: the smallest and the largest permitted value.
        words: both in words, for messages.
    """

    least: float
    words: str
    most: float = sys.float_info.max


FROM_0 = Range(0, "0 or more")
FROM_1 = Range(1, "1 or more")
FROM_2 = Range(2, "2 or more")
FINITE = Range(0, "a number, 0 or more")
ANY = Range(-sys.float_info.max, "a finite number")
Option = tuple[tuple[str, ...], dict[str, Any]]
"""An option: the arguments of ``ArgumentParser.add_argument``."""


def option(*flags: str, within: Range | None = None, **settings: Any) -> Option:
    """Return an option of a command.

    Parameters:
        flags, settings: the arguments of ``ArgumentParser.add_argument``.
        within: the permitted values; None permits all values.
    """
    if settings.get("action", "extend") == "extend":
        settings["type"] = partial(_read, settings.get("type", str), within)
    return flags, settings


whole = partial(option, type=int, metavar="N")
"""Makes an option whose values are whole numbers."""
path = partial(option, type=Path, metavar="FILE")
"""Makes an option whose values are paths."""


def _read(kind: type, within: Range | None, text: str) -> Any:
    """Return the value in a text; argparse prints a message if the text is empty or the value is not permitted.

    An empty path would be the working directory, and a number of more digits would overflow later.
    """
    if not text.strip():
        raise argparse.ArgumentTypeError("got an empty text, expected a name; leave the option out if there is none")
    if kind is int and len(text) > MOST_DIGITS:
        raise argparse.ArgumentTypeError(f"expected a number of at most {MOST_DIGITS} digits")
    try:
        value = kind(text)
    except ValueError as error:
        numbers = "a whole number" if kind is int else "a number"
        raise argparse.ArgumentTypeError(f"expected {numbers}, got {text!r}") from error
    if within and not within.least <= value <= within.most:
        raise argparse.ArgumentTypeError(f"must be {within.words}, got {text}")
    return value


def out(default: str = "results", *also: str) -> Option:
    """Return the option --out for the result directory.

    Parameters:
        default: the default directory.
        also: other names of the option.
    """
    help = f"result directory (default {default})"
    return path("--out", *also, default=Path(default), metavar="DIR", help=help)


def enclosed(levels: tuple[int, ...], shorter: int) -> list[Option]:
    """Return the options of commands that compute a lower and an upper bound of errors.

    The bounds come from a second displacement ũ, which is more accurate than the one whose error is bounded.

    Parameters:
        levels: default levels.
        shorter: default number of time steps of ũ in each time step of the displacement.
    """
    default = " ".join(map(str, levels))
    increasing = f"meshes: numbers of cells along a side, increasing (default {default})"
    refine = "refinements of the mesh for the better displacement ũ of the bound (default 1)"
    steps = f"time steps of ũ in each time step of the displacement (default {shorter})"
    return [
        whole("--levels", nargs="+", default=list(levels), help=increasing),
        option("--family", default="unstructured", help=f"meshes: {', '.join(FAMILY_NAMES)} (default unstructured)"),
        SCHEME,
        whole("--steps", within=FROM_1, help="time steps of the displacement on every level"),
        whole("--refine", within=Range(0, "0 to 20", 20), default=1, metavar="R", help=refine),
        whole("--shorter", within=FROM_1, default=shorter, metavar="Q", help=steps),
    ]


SCHEME = option("--scheme", default="midpoint", help=f"time scheme: {', '.join(SCHEME_NAMES)} (default midpoint)")
JSON = option("--json", action="store_true", help="print as JSON")
JOBS = option("--jobs", type=int, within=Range(1, "1 to 1024", 1024), default=os.cpu_count() or 1,
             help="number of processes (default: all cores)")  # fmt: skip
SCOPE = (
    " Served: plane polygons with straight sides, also with holes, each side clamped, free, loaded, rolling (a line of "
    "symmetry), or touching a rigid foundation without friction; linear elasticity, and viscoelasticity with small "
    "strains; in static problems also prescribed displacements that are linear on each side; displacements that are "
    "linear or quadratic on triangles (P1, P2). Not served: 3D and axisymmetry, friction, large strains, rollers that "
    "are not parallel to an axis, prescribed displacements in time, quadrilaterals. Instead: give a curved side as the "
    "polygon of the mesh; turn the coordinates; compute again on triangles."
)
"""What ``study bound`` serves, what it does not serve, and what to do instead."""
UNDECIDED_OPTION = path(
    "--undecided",
    help="exit code 0 if the undecided checks are exactly those in this CSV file (label, key, case, family, reason)",
)
CASE = "NAME|FILE.py:NAME"
CLUSTER = (
    "measure on the workers of the Dask scheduler at tcp://HOST:PORT; anybody who reaches its port can run any "
    "code on the scheduler, the workers and this machine: use it only in a network that you trust, or with TLS"
)
FORMATS_HELP = "formats (default: pdf png for articles, png for slides, svg for the web)"
DRAWN = "result directory whose data are drawn (default: that of --out, which also receives the figures)"
STYLE = "Matplotlib style file, replaces entries of the style of the study; figure.figsize sets the column width"
USE = "article: 3.5 in wide, into DIR/figures (default); slides: 16:9, 1920 px; web: SVG; both into DIR/figures/USE"
COMMANDS: dict[str, tuple[str, str, list[Option | list[Option]]]] = {
    "cases": ("cases", "list the exact solutions", [JSON]),
    "run": ("run", "run the study: measure and judge; continues if it was stopped", [
        [
            option("--quick", dest="plan", action="store_const", const="quick", default="quick",
                   help="few levels, less than a minute on two cores, results in results/quick (default)"),
            option("--full", dest="plan", action="store_const", const="full",
                   help="all levels, half an hour, results in results"),
        ],
        option("--case", action="extend", nargs="+", metavar=CASE,
               help="measure only these cases, by name or from your own file"),
        whole("--levels", nargs="+", help="meshes: numbers of cells along a side, increasing"),
        SCHEME,
        option("--step", type=float, metavar="K", help="time step on all levels (default: chosen for each case)"),
        JOBS,
        option("--cluster", metavar="ADDRESS", help=CLUSTER),
        option("--figures", action="store_true", help="also write tables and figures"),
        UNDECIDED_OPTION,
        path("--out", metavar="DIR",
             help="result directory (default results/quick, or results with --full)"),
    ]),
    "check": ("check", "compare data, verdicts and tables on disk with their expected contents", [
        path("--junit", help="also write the verdicts as JUnit XML"),
        UNDECIDED_OPTION,
        whole("--again", within=Range(1, "1 or more rows"),
              help="also measure N random rows again, cheap rows more often, and compare; exit code 1 if a number "
              "differs"),
        whole("--seed", within=FROM_0, metavar="S",
              help="seed with which --again draws rows (default: a new seed, which is printed)"),
        option("--tolerance", type=float, within=FINITE, default=AGAIN_TOLERANCE, metavar="X",
               help="numbers a, b of --again are equal if |a - b| <= Y + X max(|a|, |b|) "
               f"(default {AGAIN_TOLERANCE:g})"),
        option("--absolute", type=float, within=FINITE, default=AGAIN_ABSOLUTE, metavar="Y",
               help=f"(default {AGAIN_ABSOLUTE:g}) for numbers near round-off, which differ between processors"),
        JOBS,
        out(),
    ]),
    "compare": ("main", "show in which numbers and verdicts two result directories differ", [
        path("old", metavar="OLD", help="result directory of a run"),
        path("new", metavar="NEW", help="result directory of another run"),
        option("--tolerance", type=float, within=FINITE, default=COMPARE_TOLERANCE, metavar="X",
               help=f"numbers a, b are equal if |a - b| <= Y + X max(|a|, |b|) (default {COMPARE_TOLERANCE:g})"),
        option("--absolute", type=float, within=FINITE, default=0.0, metavar="Y",
               help="(default 0) for numbers near round-off"),
        JSON,
    ]),
    "faults": ("controls", "measure which checks notice deliberate faults; exit code 0 if all are noticed", [
        option("--case", nargs="+", metavar=CASE, help="cases, also your own (default: all of the quick study)"),
        option("--fault", nargs="+", metavar="NAME", help="names of faults (default: all)"),
        JOBS,
        out(),
    ]),
    "seeds": ("controls", "estimate how often chance makes a check fail, on new random meshes", [
        option("--minutes", type=float, default=60.0, metavar="M",
               within=Range(0, "0 or more (0 prints the record)"),
               help="time for new seeds (default 60; 0: only print the record)"),
        whole("--seeds", within=FROM_1, default=sys.maxsize, help="largest number of new seeds"),
        whole("--seed", within=FROM_0,
              help="measure this seed again and compare with the record"),
        JOBS,
        out(),
    ]),
    # Its options are those of the command convergence-orders.
    "rates": ("main", "compute the observed orders of any table of errors", []),
    "bound": ("bound", "enclose the error of a computed displacement, without the exact solution", [
        option("problem", metavar=CASE, help="a case, a problem of this project, or your own problem"),
        *enclosed((8, 16), shorter=4),
        path("--displacement", nargs="+",
             help="enclose the errors of displacements in files (.npz, .vtu and others) instead of computing one"),
        option("--field", metavar="NAME",
               help="name of the displacement in the file (default: u, displacement, or the only vector field)"),
        whole("--step",
              help="the load step in the file that a static problem describes, counted from 0; -1 is the last"),
        option("--nearest", action="store_true",
               help="replace the values of the displacement at the nodes of clamped and rolling sides, where they "
               "are not the prescribed ones"),
        option("--adapt", metavar="TOL|P%",
               help="refine the first mesh until the error bound is at most TOL, or P per cent of the norm of u"),
        whole("--cells", within=FROM_1, default=MOST_CELLS,
              help=f"largest number of cells of --adapt (default {MOST_CELLS})"),
        out("bounds"),
    ]),
    "certify": ("bound", "write proofs of error bounds as files, which a stand-alone program checks", [
        option("problem", metavar=CASE, help="a problem given by formulas"),
        *enclosed((4, 8), shorter=2),
        out("certificates"),
    ]),
    "export": ("export", "write cases as data files, to test other contact codes", [
        option("case", nargs="+", metavar=CASE, help="cases with linear laws"),
        whole("--levels", nargs="+", within=FROM_2, default=[8, 16, 32],
              help="cells along a side (default 8 16 32)"),
        option("--family", nargs="+", metavar="NAME",
               help=f"meshes: {', '.join(FAMILY_NAMES)} (default: those on which `study run --quick` measures the "
               "case)"),
        option("--mode", choices=("frozen", "march"), default="frozen",
               help="frozen: static problems (default); march: a problem with time steps"),
        option("--instants", nargs="+", type=float, within=ANY, metavar="T",
               help="times of the static problems (default: three times)"),
        whole("--steps", within=FROM_1,
              help="number of time steps of --mode march (default: the level)"),
        option("--scale", type=float, within=Range(1e-100, "1e-100 to 1e100", 1e100), default=1.0, metavar="S",
               help="factor of all loads (default 1)"),
        whole("--foundation", within=FROM_1, metavar="SEGMENTS",
              help="also write a mesh of the foundation, with this number of segments"),
        out("tasks", "--to"),
    ]),
    "show": ("present", "draw a problem as it is stated; of a case also images and a film of its solution, and files "
             "for ParaView", [
        option("case", metavar=CASE, help="a case, or a problem"),
        whole("--level", within=FROM_2, help="cells along a side (default 24, in 3D 9)"),
        option("--mp4", action="store_true",
               help="require animation.mp4: a missing ffmpeg is an error (without this option the film is then left "
               "out)"),
        out("shows"),
    ]),
    "report": ("present", "write one HTML page about the data in a directory", [JOBS, out()]),
    "tables": ("present", "judge the data in a directory again and write the tables", [out()]),
    "figures": ("present", "draw figures for articles, slides or pages from the data in a directory", [
        option("--for", dest="use", choices=("article", "slides", "web"), default="article", help=USE),
        option("--format", nargs="+", choices=("png", "pdf", "svg", "pgf"), help=FORMATS_HELP),
        [
            option("--case", nargs="+", metavar="NAME", help="only the figures of these cases"),
            option("--overview", action="store_true", help="only the figures that show all cases together"),
            option("--only", nargs="+", metavar="NAME", help="only these figures, such as zone-hexagon"),
        ],
        option("--dpi", type=float, within=Range(10, "10 to 2400", 2400), metavar="N",
               help="dots per inch of PNG files"),
        path("--style", help=STYLE),
        path("--data", metavar="DIR", help=DRAWN),
        JOBS,
        out(),
    ]),
}  # fmt: skip
"""Name of a command ↦ its module in ``study.cli``, its help, and its options. Options in a list exclude each other."""


def parser() -> argparse.ArgumentParser:
    """Return the parser of all commands.

    The parsed options have an attribute ``command``: the module in ``study.cli`` and the name of the function to call.
    Their function ``refuse`` ends the program because of words that are no options of the command.
    """
    top = argparse.ArgumentParser(
        prog="study",
        description="Verify the claims of Barboteu, Han and Sofonea (2002), and bound the errors of your own problems.",
        epilog=f"Time schemes: {', '.join(SCHEME_NAMES)}. Mesh families: {', '.join(FAMILY_NAMES)}. "
        "`study COMMAND --help` "
        "lists the options of a command; the documentation is in docs/.",
    )
    top.add_argument("--version", action="version", version=f"study {version('signorini-study')}")
    commands = top.add_subparsers(required=True, metavar="COMMAND")
    for name, (module, help, options) in COMMANDS.items():
        description = help[0].upper() + help[1:] + "." + SCOPE * (name == "bound")
        command = commands.add_parser(name, help=help, description=description)
        interrupted = RESUMED if name in RESUMES else STARTS_AGAIN
        known = ["--help"]
        for one in options:
            group = command.add_mutually_exclusive_group() if isinstance(one, list) else command
            for flags, settings in one if isinstance(one, list) else [one]:
                group.add_argument(*flags, **settings)
                known += flags
        refuse = partial(refuse_unknown, command, known)
        command.set_defaults(command=(module, f"do_{name}"), refuse=refuse, interrupted=interrupted)
    return top


def refuse_unknown(command: argparse.ArgumentParser, known: Sequence[str], words: Sequence[str]) -> None:
    """Print the usage of a command and its unknown words, suggest a similar option, and end the program with 2.

    Parameters:
        command: the parser of the command.
        known: the options that the command has.
        words: the unknown words of the command line. If an option is similar to the first of them, it is suggested.

    Raises:
        SystemExit: always, with the exit code 2.
    """
    near = get_close_matches(words[0], known, n=1, cutoff=0.8)
    command.error(f"unrecognized arguments: {' '.join(words)}{f'; did you mean {near[0]}?' if near else ''}")

"""The command ``convergence-orders``: computes the observed orders of any table of errors, and judges them."""

import argparse
import io
import os
import re
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from .columns import Options, Series, read_series
from .judging import judge, names_of
from .orders import TOLERANCE, OrderError, grid_convergence
from .printing import printable
from .report import as_json, as_junit, as_markdown, as_text, dumps, exit_code, plot, wrapped
from .tables import MAX_BYTES

USAGE = 2
CLOSED = 141
"""Exit codes if the table or an option is not understood, and if nobody reads the output."""
_REAL = r"[ ]*[-+]?[\d.]+(?:[eE][-+]?\d+)?[ ]*"


def main(arguments: Sequence[str] | None = None, name: str = "convergence-orders") -> int:
    """Run the command with the given arguments, by default those of the command line; return the exit code.

    ``name`` is the command as it was typed; it stands in the usage line and in front of every refusal.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # A terminal with another encoding cannot show every name.
            stream.reconfigure(errors="backslashreplace")
    try:
        code = run(_parser(name).parse_args(arguments), name)
        sys.stdout.flush()
    except OSError as error:
        # Python would fail to write the rest of the output at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        if isinstance(error, BrokenPipeError):
            return CLOSED
        print(f"{name}: cannot write the output: {error.strerror}", file=sys.stderr)
        return USAGE
    return code


def _parser(name: str) -> argparse.ArgumentParser:
    """Return the parser of the options."""
    parser = argparse.ArgumentParser(
        prog=name,
        allow_abbrev=False,
        description="Compute the observed orders of a table of errors, and compare them with the orders you expect.",
        epilog="Exit code: 0 all orders hold, 1 an order is wrong, 2 the table is not understood, 3 undecided.",
    )
    add = parser.add_argument
    wish = "P|NAME=P,..."
    add("file", type=_name, metavar="FILE", help="a table of errors as text; - reads standard input")
    add("--expected", type=_orders, metavar=wish, help="expected order; lower and higher orders fail")
    add("--at-least", type=_orders, metavar=wish, help="lower limit of the order; higher orders pass")
    add("--max-error", type=_orders, metavar="E|NAME=E,...", help="largest accepted error on the finest mesh")
    add("--tolerance", type=float, default=TOLERANCE, metavar="T", help="accepted difference of orders (0.15)")
    add("--floor", type=float, default=0.0, metavar="X", help="largest accepted limit of the errors (0)")
    add("--columns", default="", metavar="NAME,...", help="columns of errors (default: found by their names)")
    add("--in", dest="size", metavar="NAME", help="name of the column of mesh sizes or time steps")
    add("--dim", type=int, metavar="D", help="dimension of the mesh, if sizes are numbers of cells or unknowns")
    add("--ratio", type=float, metavar="R", help="ratio of the mesh sizes in consecutive rows")
    add("--values", action="store_true", help="the columns are values, not errors: grid convergence index")
    add("--junit", type=_name, metavar="FILE", help="also write the verdicts as JUnit XML")
    add("--markdown", type=_name, metavar="FILE", help="also write the verdicts as a Markdown table")
    add("--plot", type=_name, metavar="FILE", help="also draw errors over h as PNG, SVG or PDF")
    add("--json", action="store_true", help="print as JSON")
    return parser


def _name(text: str) -> Path:
    """Return the name of a file; an empty one is refused."""
    if not text.strip():
        raise argparse.ArgumentTypeError("got an empty text, expected a name")
    return Path(text)


def _orders(text: str) -> float | dict[str, float]:
    """Return the expected orders in a text: a number for ``2``, and a dictionary for ``L2=2,H1=1``.

    Names of columns may contain commas and the sign =. A comma separates two entries only after a number.
    """
    if re.fullmatch(_REAL, text):
        return float(text)
    pairs = re.findall(f"(.+?)=({_REAL})(?:,|$)", text)
    if not pairs or ",".join(map("=".join, pairs)) != text:
        raise argparse.ArgumentTypeError(f"got '{text}', expected a number such as 2, or names such as L2=2,H1=1")
    return {name.strip(): float(number) for name, number in pairs}


def run(options: argparse.Namespace, name: str) -> int:
    """Read tables of errors, and print the observed orders and the verdicts.

    Parameters:
        options: the options of the command.
        name: the command as it was typed, for messages.

    Returns:
        0 if all orders hold or none is expected, 1 if one fails, 2 for bad input, 3 if one is undecided.
    """
    wishes = {"expected": options.expected, "at_least": options.at_least, "max_error": options.max_error}
    opened = options.file
    try:
        if options.values and any([*wishes.values(), options.junit, options.markdown, options.plot]):
            raise OrderError("with --values the columns have no expected order: leave out all options about verdicts")
        reading = Options(options.dim, options.size, options.ratio, options.columns, signed=options.values)
        tables = read_series(_read(options.file), reading)
        if options.values:
            print(printable(_values(tables, options.json)))
            return 0
        judged = judge(tables, tolerance=options.tolerance, floor=options.floor, **wishes)
        for opened, written in ((options.junit, as_junit), (options.markdown, as_markdown)):
            if opened:
                opened.write_text(written(judged), encoding="utf-8")
        if options.plot:
            opened = options.plot
            plot(judged, opened)
    except OSError as error:
        return _refuse(f"{name}: {opened}: {error.strerror or error}")
    except OrderError as error:
        return _refuse(f"{name}: {options.file}: {error}")
    print(printable(as_json(judged) if options.json else as_text(judged)))
    return exit_code(judged)


def _refuse(reason: str) -> int:
    """Print why there are no verdicts, and return the exit code."""
    print(printable(reason), file=sys.stderr)
    return USAGE


def _values(tables: list[Series], as_json: bool) -> str:
    """Return the order, the extrapolated value and the grid convergence index of each column of values, as text."""
    results = {
        names_of(series, name)[0]: grid_convergence(series.h, values)
        for series in tables
        for name, values in series.errors.items()
    }
    if as_json:
        return dumps([{"name": name} | asdict(result) for name, result in results.items()])
    lines = [f"{name}: {result}" for name, result in results.items()]
    for series in tables:
        lines += ["", *wrapped(series.recognised("values"))]
    return "\n".join(lines)


def _read(file: Path) -> bytes:
    """Return the content of a file or a pipe, or of standard input if the name is ``-``."""
    with open(0 if str(file) == "-" else file, "rb") as stream:
        return stream.read(MAX_BYTES + 1)

"""The command ``convergence-orders``: computes the observed orders of any table of errors, and judges them."""

import argparse
import errno
import io
import json
import math
import os
import re
import sys
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from .columns import Options, Series, read_series
from .judging import judge, names_of
from .orders import OrderError, grid_convergence
from .printing import printable
from .report import as_json, as_junit, as_markdown, as_text, exit_code, finite, plot, recognised
from .tables import MAX_BYTES

USAGE, CLOSED = 2, 141
"""Exit codes if the table or an option is not understood, and if nobody reads the output."""


def main(arguments: Sequence[str] | None = None, name: str = "convergence-orders") -> int:
    """Run the command with the given arguments, by default those of the command line; return the exit code.

    ``name`` is the command as it was typed; it stands in the usage line and in front of every refusal.
    """
    parser = argparse.ArgumentParser(
        prog=name,
        allow_abbrev=False,
        description="Compute the observed orders of a table of errors, and compare them with the orders you expect.",
        epilog="Exit code: 0 all orders hold, 1 an order is wrong, 2 the table is not understood, 3 undecided.",
    )
    for flag, options in ARGUMENTS.items():
        parser.add_argument(flag, **options)  # type: ignore[arg-type]
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # A terminal with another encoding cannot show every name.
            stream.reconfigure(errors="backslashreplace")
    try:
        code = run(parser.parse_args(arguments), name)
        sys.stdout.flush()
    except OSError as error:
        # Python would fail to write the rest of the output at its end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
        if isinstance(error, BrokenPipeError):
            return CLOSED
        full = error.errno == errno.ENOSPC
        reason = f"the disk is full ({error.strerror}); free space there" if full else error.strerror
        print(f"{name.split()[0]}: cannot write the output: {reason}", file=sys.stderr)
        return USAGE
    return code


def _orders(text: str) -> float | dict[str, float]:
    """Return the expected orders in a text: a number for ``2``, and a dictionary for ``L2=2,H1=1``.

    Names of columns may contain commas and the sign =. A comma separates two entries only after a number.
    """
    if re.fullmatch(_NUMBER, text):
        return _finite(text)
    if not re.fullmatch(f"(?:(?!{_NUMBER},).+?={_NUMBER}(?:,(?=.)|$))+", text):
        raise argparse.ArgumentTypeError(f"got '{text}', expected a number such as 2, or names such as L2=2,H1=1")
    return {name.strip(): _finite(number) for name, number in re.findall(f"(.+?)=({_NUMBER})(?:,|$)", text)}


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise argparse.ArgumentTypeError(f"{text} is not a finite number")
    return value


def _name(text: str) -> Path:
    if not text.strip():
        raise argparse.ArgumentTypeError("got an empty text, expected a name")
    return Path(text)


EXPECTED = "P|NAME=P,..."
_NUMBER = r"[ ]*[-+]?[\d.]+(?:[eE][-+]?\d+)?[ ]*"
ARGUMENTS: dict[str, dict[str, object]] = {
    "file": {"type": _name, "metavar": "FILE", "help": "a table of errors as text; - reads standard input"},
    "--expected": {"type": _orders, "metavar": EXPECTED, "help": "expected order; lower and higher orders fail"},
    "--at-least": {"type": _orders, "metavar": EXPECTED, "help": "lower limit of the order; higher orders pass"},
    "--max-error": {"type": _orders, "metavar": "E|NAME=E,...", "help": "largest accepted error on the finest mesh"},
    "--tolerance": {"type": _finite, "default": 0.15, "metavar": "T", "help": "accepted difference of orders (0.15)"},
    "--floor": {"type": _finite, "default": 0.0, "metavar": "X", "help": "largest accepted limit of the errors (0)"},
    "--columns": {"default": "", "metavar": "NAME,...", "help": "columns of errors (default: found by their names)"},
    "--in": {"dest": "size", "metavar": "NAME", "help": "name of the column of mesh sizes or time steps"},
    "--dim": {"type": int, "metavar": "D", "help": "dimension of the mesh, if sizes are numbers of cells or unknowns"},
    "--ratio": {"type": _finite, "metavar": "R", "help": "ratio of the mesh sizes in consecutive rows"},
    "--values": {"action": "store_true", "help": "the columns are values, not errors: grid convergence index"},
    "--junit": {"type": _name, "metavar": "FILE", "help": "also write the verdicts as JUnit XML"},
    "--markdown": {"type": _name, "metavar": "FILE", "help": "also write the verdicts as a Markdown table"},
    "--plot": {"type": _name, "metavar": "FILE", "help": "also draw errors over h as PNG, SVG or PDF"},
    "--json": {"action": "store_true", "help": "print as JSON"},
}
"""Flag ↦ arguments of ``argparse.ArgumentParser.add_argument``."""


def run(options: argparse.Namespace, name: str) -> int:
    """Read tables of errors, and print the observed orders and the verdicts.

    Parameters:
        options: the options of the command.
        name: the command as it was typed, for messages.

    Returns:
        0 if all orders hold or none is expected, 1 if one fails, 2 for bad input, 3 if one is undecided.
    """
    judging = ["expected", "at_least", "max_error", "junit", "markdown", "plot"]
    given = [f"--{name.replace('_', '-')}" for name in judging if getattr(options, name) is not None]
    wishes = {name: getattr(options, name) for name in judging[:3]}
    reading = (options.dim, options.size, options.ratio, options.columns)
    file = ""
    opened = options.file
    try:
        if options.values and given:
            raise OrderError(f"with --values the columns have no expected order: leave out {', '.join(given)}")
        file = f"{options.file}: "
        tables = read_series(_read(options.file), Options(*reading, signed=options.values))
        if options.values:
            print(printable(_values(tables, options.json)))
            return 0
        judged = judge(tables, options.tolerance, options.floor, **wishes)
        file = ""
        for path, write in ((options.junit, as_junit), (options.markdown, as_markdown)):
            if path:
                opened = path
                path.write_text(write(judged), encoding="utf-8")
        if options.plot:
            opened = options.plot
            plot(judged, options.plot)
    except (OrderError, OSError) as error:
        reason = f"{opened}: {error.strerror or error}" if isinstance(error, OSError) else f"{file}{error}"
        print(printable(f"{name}: {reason}"), file=sys.stderr)
        return USAGE
    print(printable(_dumps(as_json(judged)) if options.json else as_text(judged)))
    return exit_code(judged)


def _values(tables: list[Series], as_json: bool) -> str:
    """Return the order, the extrapolated value and the grid convergence index of each column of values, as text."""
    entries = [
        {"name": names_of(series, name)[0]} | asdict(grid_convergence(series.h, values))
        for series in tables
        for name, values in series.errors.items()
    ]
    if as_json:
        return _dumps(finite(entries))
    lines = []
    for entry in entries:
        order = ", order {order:.2f}, extrapolated {extrapolated:.6g}, GCI {index:.2%} on the finest mesh"
        known = math.isfinite(entry["order"])
        lines.append(f"{entry['name']}: {entry['kind']}" + (order.format(**entry) if known else ""))
    for series in tables:
        lines += ["", *(line.replace("errors:", "values:", 1) for line in recognised(series))]
    return "\n".join(lines)


def _dumps(entries: list[dict[str, Any]]) -> str:
    return json.dumps(entries, indent=2, ensure_ascii=False)


def _read(file: Path) -> bytes:
    """Return the content of a file or a pipe, or of standard input if the name is ``-``."""
    if str(file) == "-":
        return sys.stdin.buffer.read(MAX_BYTES + 1)
    with file.open("rb") as stream:
        return stream.read(MAX_BYTES + 1)

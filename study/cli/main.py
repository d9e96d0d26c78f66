"""The ``study`` command: parses options, calls the function of a command, and turns errors into messages.

The commands ``study rates`` and ``study compare``, which need no solver, are here, too.
"""

import importlib
import io
import os
import sys
from argparse import Namespace
from collections.abc import Sequence
from contextlib import redirect_stderr, redirect_stdout
from json import dumps
from typing import Any, TextIO

from convergence_orders.printing import printable
from study.cli.options import BAD_USAGE, BROKEN_PIPE, FAILED, INTERRUPTED, OK, parser


class PrintableStream:
    r"""A text stream that writes into another stream, with control characters escaped as in ``printable``: \u001b.

    Attributes:
        stream: the other stream.
        permitted: control characters that are written as they are, such as the carriage return of progress bars.
    """

    def __init__(self, stream: TextIO, permitted: str = "") -> None:
        self.stream = stream
        self.permitted = permitted

    def write(self, text: str) -> int:
        return self.stream.write(printable(text, self.permitted))

    def __getattr__(self, name: str) -> Any:
        return getattr(self.stream, name)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command and return its exit code.

    The exit codes are 0 for success, 1 if a check fails, 2 for bad usage or input, and 3 if a check is undecided.

    Parameters:
        arguments: the words after ``study``; by default those of the command line.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # An ASCII terminal cannot show a character such as ‖. Then \u2016 is printed, which is also valid in JSON.
            stream.reconfigure(errors="backslashreplace")
    if arguments is None:
        arguments = sys.argv[1:]
        # All figures are files. Matplotlib cannot be imported if this variable names a window system it does not know.
        os.environ.pop("MPLBACKEND", None)
    with (
        redirect_stdout(PrintableStream(sys.stdout)),  # type: ignore[type-var]
        redirect_stderr(PrintableStream(sys.stderr, permitted="\r")),  # type: ignore[type-var]
    ):
        return _run(list(arguments))


def _run(words: list[str]) -> int:
    # The options of ``study rates`` are those of the command convergence-orders, which has its own parser.
    options, unknown = parser().parse_known_args(words[:1] if words[:1] == ["rates"] else words)
    options.words = words[1:]
    if unknown:
        options.refuse(unknown)
    module, name = options.command
    if sys.flags.optimize >= 2 and module not in WITHOUT_PYAMG:
        print(f"study: {STRIPPED}", file=sys.stderr)
        return BAD_USAGE
    try:
        # Only the module of this command is imported, because importing the solvers takes seconds.
        command = getattr(importlib.import_module(f"study.cli.{module}"), name)
        code: int = command(options)
        sys.stdout.flush()
        return code
    except KeyboardInterrupt:
        print(f"study: interrupted; {options.interrupted}", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        _close_output()
        return BROKEN_PIPE
    except ModuleNotFoundError as error:
        if (error.name or "study").partition(".")[0] in ("study", "manufactured"):
            raise
        source = "./convergence_orders" if error.name == "convergence_orders" else "'.[study]'"
        print(f"study: {LACKING.format(error.name, source)}", file=sys.stderr)
        return BAD_USAGE
    except Exception as error:
        code, message = importlib.import_module("study.cli.common").exit_code_and_message(error)
        print(f"study: {message}", file=sys.stderr)
        if isinstance(error, OSError):
            _close_output()
        return code


def do_rates(options: Namespace) -> int:
    """Run the command ``convergence-orders`` with the words behind ``study rates``, and return its exit code."""
    # Imported here, because NumPy takes a tenth of a second.
    from convergence_orders.command import main as command

    return command(options.words, "study rates")


def do_compare(options: Namespace) -> int:
    """Compare two result directories and print the differences.

    Returns:
        0 if they agree within the tolerance, else 1.
    """
    # Imported here, because pandas takes half a second.
    from study.ledger.compare import Tolerance, as_text, compare
    from study.run.store import Store

    tolerance = Tolerance(options.tolerance, options.absolute)
    with Store(options.old).steady(), Store(options.new).steady():
        comparison = compare(options.old, options.new, tolerance)
    print(dumps(comparison.as_json(), indent=2, allow_nan=False) if options.json else as_text(comparison))
    return FAILED if comparison.differs else OK


LACKING = "this command needs {}, which is not installed: python -m pip install {} in a clone of the repository"
WITHOUT_PYAMG = "cases", "main"
"""Modules of the commands that import pyamg neither directly nor indirectly."""
STRIPPED = (
    "python -OO removes docstrings, and pyamg, which this command needs, cannot be imported without them: "
    "run python or python -O"
)


def _close_output() -> None:
    """Redirect standard output to nowhere, because Python would fail to write the rest of the output at its end."""
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 1)

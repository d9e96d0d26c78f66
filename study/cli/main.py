"""The ``study`` command."""

from __future__ import annotations

import importlib
import io
import os
import sys
from collections.abc import Sequence

from study.cli.options import CLOSED, INTERRUPTED, USAGE, parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run a command; return its exit code: 0 no check fails, 1 a check fails, 2 bad usage or input, 3 undecided."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # A terminal in ASCII or cp1252 has no ‖; it is shown as \u2016, also within JSON.
            stream.reconfigure(errors="backslashreplace")
    options = parser().parse_args(arguments)
    module, name = options.command
    if sys.flags.optimize >= 2 and module in WITH_PYAMG:
        print(f"study: {STRIPPED}", file=sys.stderr)
        return USAGE
    try:
        # The import comes late, because the solvers take seconds to import.
        command = getattr(importlib.import_module(f"study.cli.{module}"), name)
        code = int(command(options))
        sys.stdout.flush()
        return code
    except KeyboardInterrupt:
        print(f"study: interrupted; {options.interrupted}", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        _close_output()
        return CLOSED
    except ModuleNotFoundError as error:
        if (error.name or "study").partition(".")[0] in ("study", "manufactured"):
            raise
        extra = "orders" if module == "rates" else "study"
        print(f"study: {LACKING.format(error.name, extra)}", file=sys.stderr)
        return USAGE
    except Exception as error:
        code, message = importlib.import_module("study.cli.refusals").exit_code_and_message(error)
        print(f"study: {message}", file=sys.stderr)
        if isinstance(error, OSError):
            _close_output()
        return int(code)


LACKING = "this command needs {}, which is not installed: python -m pip install '.[{}]' in a clone of the repository"


WITH_PYAMG = (
    "adapt",
    "bound",
    "certify",
    "check",
    "controls",
    "displacement",
    "export",
    "present",
    "run",
    "seeds",
    "show",
)
"""Modules of commands that import pyamg, directly or through others."""
STRIPPED = (
    "python -OO removes docstrings, and pyamg, which this command needs, cannot be imported without them: "
    "run python or python -O"
)


def _close_output() -> None:
    """Discard the rest of the output, because Python would fail to write it at the end."""
    with open(os.devnull, "w") as nowhere:
        os.dup2(nowhere.fileno(), 1)

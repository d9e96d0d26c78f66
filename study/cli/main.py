"""The ``study`` command."""

from __future__ import annotations

import importlib
import io
import sys
from collections.abc import Sequence

from study.cli.arguments import parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns its exit code: 0 all claims hold, 1 one does not, 2 usage."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # A terminal in ASCII or cp1252 has no ‖: it is shown as \u2016, also within JSON.
            stream.reconfigure(errors="backslashreplace")
    options = parser().parse_args(arguments)
    module, name = options.command
    # Not before it is known what is asked for: what solves takes seconds to import.
    refusals = importlib.import_module("study.cli.refusals")
    try:
        return int(getattr(importlib.import_module(f"study.cli.{module}"), name)(options))
    except KeyboardInterrupt:
        print("study: interrupted; finished jobs are kept, the same command does the rest", file=sys.stderr)
        return 130
    except Exception as error:
        code, message = refusals.answer(error)
        print(f"study: {message}", file=sys.stderr)
        return int(code)

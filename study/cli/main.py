"""The ``study`` command."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from concurrent.futures import BrokenExecutor

from manufactured.body import BodyError
from manufactured.case import CaseError
from manufactured.data import LoadError
from manufactured.law import LawError
from manufactured.self_proof import SelfProofError
from manufactured.symbols import FormulaError
from study.bound.discretisation import BoundError
from study.cli import bound, cases, compare, controls, present, rates, run, show
from study.cli.common import FAILED, USAGE
from study.fem.mesh import MeshError
from study.ledger.datafiles import DataError
from study.ledger.errors import UsageError
from study.ledger.files import StoreError
from study.ledger.orders import RatesError
from study.ledger.published import TableError
from study.run.execute import JobsError

COMMANDS = (cases, run, compare, controls, rates, bound, show, present)

OF_CASES = (BodyError, CaseError, FormulaError, LawError, LoadError, SelfProofError)
OF_FILES = (DataError, RatesError, StoreError, TableError)
REFUSALS = (*OF_CASES, *OF_FILES, BoundError, MeshError, UsageError)
"""Errors that say what was given, what was expected and how to mend it: printed without a traceback."""

KILLED = (
    "a worker process was killed, perhaps for want of memory: run the same command again, with fewer --jobs if it does "
    "not help; what is finished is kept"
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command; returns its exit code: 0 all claims hold, 1 one does not, 2 usage."""
    options = parser().parse_args(arguments)
    try:
        return int(options.command(options))
    except REFUSALS as error:
        print(f"study: {error}", file=sys.stderr)
        return USAGE
    except JobsError as error:
        print(f"study: {error}", file=sys.stderr)
        return FAILED
    except BrokenExecutor:
        print(f"study: {KILLED}", file=sys.stderr)
        return FAILED
    except KeyboardInterrupt:
        print("study: interrupted; finished jobs are kept, the same command does the rest", file=sys.stderr)
        return 130


def parser() -> argparse.ArgumentParser:
    """The commands and their options."""
    top = argparse.ArgumentParser(prog="study", description="Verify the claims of Barboteu, Han and Sofonea (2002).")
    commands = top.add_subparsers(required=True, metavar="COMMAND")
    for module in COMMANDS:
        module.add(commands)
    return top

"""Functions that several commands use: exit codes, progress bars, lists of files, messages of errors."""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from concurrent.futures import BrokenExecutor
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import pandas as pd
from tqdm import tqdm

from manufactured.body import BodyError
from manufactured.case import CaseError
from manufactured.data import LoadError
from manufactured.law import LawError
from manufactured.self_proof import SelfProofError
from manufactured.symbols import FormulaError
from study.bound.problem import BoundError
from study.cli.options import BAD_USAGE, FAILED, OK, UNCLEAR
from study.fem.error_norm import NormError
from study.fem.mesh import MeshError
from study.ledger.datafiles import DataError, Key
from study.ledger.files import JobsError, Paths, StoreError, UsageError, disk_full
from study.ledger.quantities import RatesError
from study.ledger.text import folded
from study.ledger.verdict import ROW_KEY, UNDECIDED, Verdicts, exit_code
from study.orders import OrderError

if TYPE_CHECKING:
    # ``study compare``, whose errors get their messages here, must not import pyamg, as plans do.
    from study.run.plan import Job, Jobs

Result = TypeVar("Result")
BAR = "{l_bar}{bar}| {elapsed}<{remaining}"


def known_undecided(file: Path | None) -> set[Key]:
    """Return which checks are listed as undecided in a CSV file.

    Parameters:
        file: the file, with the columns label, key, case, family and reason; None for an empty set.

    Returns:
        Tuples (label of the statement, short name of the check, case, mesh family), which identify the checks.

    Raises:
        UsageError: the file cannot be read, has other columns, or a row does not give the reason why the check is
            undecided.
    """
    if file is None:
        return set()
    try:
        table = pd.read_csv(file, keep_default_na=False, dtype=str)
    except (OSError, ValueError) as error:
        raise UsageError(f"--undecided {file} cannot be read as CSV: {error}") from error
    if list(table.columns) != [*ROW_KEY, "reason"]:
        raise UsageError(f"{file} has the columns {', '.join(table.columns)}, expected {', '.join(ROW_KEY)}, reason")
    if unexplained := [line + 2 for line, reason in enumerate(table.reason) if not reason.strip()]:
        raise UsageError(f"{file}, line {unexplained[0]}: the reason why the row is undecided is missing")
    return set(table[[*ROW_KEY]].itertuples(index=False, name=None))


def code_of(verdicts: Verdicts, file: Path | None) -> int:
    """Return the exit code of a judged run: 1 if a check fails, else 3 if a check is undecided, else 0.

    Parameters:
        verdicts: all checks.
        file: a CSV file with checks that are known to be undecided, or None. With a file, the exit code is 0 if exactly
            these checks are undecided, and 3 otherwise; differences are printed.
    """
    code = exit_code(verdicts)
    known = known_undecided(file)
    if file is None or code == FAILED:
        return code
    found = {verdict.identity for verdict in verdicts if verdict.verdict == UNDECIDED}
    for text, rows in (("undecided but not listed", found - known), ("not undecided but listed", known - found)):
        for row in sorted(rows):
            print(f"this check is {text} in {file}: {', '.join(filter(None, row))}", file=sys.stderr)
    return OK if verdicts and found == known else UNCLEAR


class ProgressBar(tqdm):  # type: ignore[misc]
    """A progress bar for measurements (jobs), which moves by their expected times."""

    monitor_interval = 0  # without tqdm's thread, because a process with threads should not be forked

    def add(self, job: Job) -> None:
        """Move the bar by the expected time of a finished measurement."""
        self.update(round(job.cost))


def progress_bar(total: int, name: str = "") -> ProgressBar:
    """Return a progress bar on standard error, which estimates the remaining time.

    If standard error is not a terminal, the bar is updated less often.

    Parameters:
        total: the number of units at which the bar is full, such as the expected time of all jobs.
        name: the name before the bar.
    """
    pause = 0.5 if sys.stderr.isatty() else 10
    # Without smoothing, the remaining time follows from the mean speed since the start. The speed of the last few
    # measurements varies by a factor of ten.
    return ProgressBar(desc=name, total=total, unit="", bar_format=BAR, mininterval=pause, miniters=1, smoothing=0)


def job_progress(jobs: Jobs, name: str = "") -> ProgressBar:
    """Return a progress bar for measurements, in units of their expected time.

    Parameters:
        jobs: the measurements.
        name: the name before the bar.
    """
    return progress_bar(round(sum(job.cost for job in jobs)), name)


def with_progress(name: str, T: float, compute: Callable[[Callable[[float], object]], Result]) -> Result:
    """Return the result of a computation over time, and show its progress.

    Parameters:
        name: text before the progress bar.
        T: final time.
        compute: the computation. Its argument is a function that it calls with each time that is finished.
    """
    with progress_bar(100, name) as bar:
        return compute(lambda time: bar.update(round(100 * time / T) - bar.n))


def tell_written(paths: Sequence[Path], more: str = "") -> None:
    """Print the names of files that a command has written.

    Three or more files with the same ending in a folder become FOLDER/*.ENDING (NUMBER).

    Parameters:
        paths: the files.
        more: text that is appended to the line.
    """
    kinds: dict[str, Paths] = {}
    for path in paths:
        kinds.setdefault(f"{path.parent}/*{path.suffix}", []).append(path)
    names = (f"{kind} ({len(of)})" if len(of) > 2 else ", ".join(map(str, of)) for kind, of in kinds.items())
    print(folded(f"written: {', '.join(names)}{more}"))


# Errors that end a command: exit code and message, without a traceback.

REFUSALS = (
    BodyError,
    BoundError,
    CaseError,
    DataError,
    FormulaError,
    LawError,
    LoadError,
    MeshError,
    NormError,
    OrderError,
    RatesError,
    SelfProofError,
    StoreError,
    UsageError,
)
"""Errors whose message states the given input, the expected input and the remedy."""

KILLED = (
    "a worker process was killed, perhaps because of too little memory: run the same command again, if necessary with "
    "fewer --jobs; finished results are kept"
)

OUT_OF_MEMORY = (
    "there is not enough memory for this: take coarser levels or meshes, fewer refinements, for example --refine 0, or "
    "a machine with more memory"
)


def exit_code_and_message(error: Exception) -> tuple[int, str]:
    """Return the exit code and the message of an error that ends a command.

    An unexpected error is raised again, so that its traceback is shown.
    """
    message = str(error)
    if isinstance(error, REFUSALS):
        return BAD_USAGE, message
    if isinstance(error, JobsError):
        return FAILED, message
    if isinstance(error, MemoryError):
        return FAILED, message or OUT_OF_MEMORY
    if isinstance(error, BrokenExecutor):
        return FAILED, KILLED
    if full := disk_full(error):
        what = f"cannot write {full.filename}" if full.filename else "cannot write the output"
        return BAD_USAGE, f"{what}: the disk is full ({full.strerror}); free space there and run the command again"
    if isinstance(error, OSError):
        what = f"cannot read or write {error.filename}" if error.filename else "cannot write the output"
        return BAD_USAGE, f"{what}: {error.strerror or error}; make it accessible and run the command again"
    raise error

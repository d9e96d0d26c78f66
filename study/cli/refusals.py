"""Turns errors that end a command into an exit code and a message without a traceback."""

from concurrent.futures import BrokenExecutor

from manufactured.body import BodyError
from manufactured.case import CaseError
from manufactured.data import LoadError
from manufactured.law import LawError
from manufactured.self_proof import SelfProofError
from manufactured.symbols import FormulaError
from study.bound.problem import BoundError
from study.cli.options import FAILED, USAGE
from study.fem.error_norm import NormError
from study.fem.mesh import MeshError
from study.ledger.datafiles import DataError
from study.ledger.files import JobsError, StoreError, UsageError, disk_full
from study.ledger.quantities import RatesError
from study.orders import OrderError

OF_CASES = (BodyError, CaseError, FormulaError, LawError, LoadError, SelfProofError)
OF_FILES = (DataError, OrderError, RatesError, StoreError)
REFUSALS = (*OF_CASES, *OF_FILES, BoundError, MeshError, NormError, UsageError)
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
    if isinstance(error, REFUSALS):
        return USAGE, str(error)
    if isinstance(error, JobsError):
        return FAILED, str(error)
    if isinstance(error, MemoryError):
        return FAILED, str(error) or OUT_OF_MEMORY
    if isinstance(error, BrokenExecutor):
        return FAILED, KILLED
    if full := disk_full(error):
        what = f"cannot write {full.filename}" if full.filename else "cannot write the output"
        return USAGE, f"{what}: the disk is full ({full.strerror}); free space there and run the command again"
    if isinstance(error, OSError):
        what = f"cannot read or write {error.filename}" if error.filename else "cannot write the output"
        return USAGE, f"{what}: {error.strerror or error}; make it accessible and run the command again"
    raise error

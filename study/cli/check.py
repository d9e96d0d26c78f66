"""``study check``: compares data, verdicts, tables and the inputs of the papers with their expected contents."""

import argparse
import secrets
from collections.abc import Sequence
from pathlib import Path

from study.cli.common import code_of, known_undecided, progress_bar
from study.cli.options import FAILED, OK, SEED_BITS
from study.ledger.codes import FOLDER, MARCHES
from study.ledger.compare import Tolerance, as_text, difference
from study.ledger.controls import SEEDS_FILE, SeedRecord
from study.ledger.datafiles import CsvFile, DataError, read_claims
from study.ledger.files import UsageError
from study.ledger.text import folded
from study.ledger.verdict import Verdict
from study.present.outcome import ledger_text, write_junit
from study.present.pages import expected_texts
from study.run.check import compare_again, draw_jobs, expected_seconds, planned_jobs, verify
from study.run.executor import local_pool
from study.run.judgement import claims, claims_file, compare_claims, data_files, verdicts
from study.run.provenance import compare_sums
from study.run.store import Store

IN_PART = (
    "data/provenance.json",
    "data/faults.csv",
    f"data/{SEEDS_FILE}",
    *(f"{folder}/{name}.csv" for folder in (FOLDER, MARCHES) for name in ("classes", "errors")),
)
"""Files in which only some edits are noticed: cells of a wrong kind, and cells from which tables are made. The data
tables of a run also belong to these files if its provenance has no checksums."""


def do_check(options: argparse.Namespace) -> int:
    """Check a result directory.

    Returns:
        0 if everything agrees, 1 if a check fails or a repeated measurement differs, 3 if a check is undecided. A file
        with an unexpected content raises an error, for which the command returns 2.
    """
    known_undecided(options.undecided)
    if options.again is None and options.seed is not None:
        raise UsageError("--seed chooses the rows of --again: give --again N with it")
    with Store(options.out).steady():
        verified = verify(options.out)
        compared = compare_sums(options.out)
        SeedRecord.read(options.out)
        judged = verdicts(options.out)
        if options.junit:
            write_junit(options.junit, judged)
        print(ledger_text(claims(judged)))
        code = code_of(judged, options.undecided)
        if code == FAILED or (options.again is not None and _again(options) == FAILED):
            return FAILED
        # Tables are compared after the data, because a message might advise to write tables from damaged data.
        compared |= as_written(options.out, judged)
    compared |= {options.out / "data" / "cases.csv"}
    inside = len([path for path in compared if options.out in path.parents])
    print(
        folded(f"{verified}; {len(judged)} verdicts and {inside} files agree with the texts that this version writes")
    )
    in_part, unchecked = not_compared(options.out, compared)
    for what, paths in (("checked in part", in_part), ("not checked", unchecked)):
        if paths:
            listed = " ".join(str(path) for path in paths)
            print(folded(f"{what}, {len(paths)} files: {listed}"))
    return code


def _again(options: argparse.Namespace) -> int:
    """Measure a random sample of the rows again; return 0 if all numbers agree, 1 if one differs."""
    seed = secrets.randbits(SEED_BITS) if options.seed is None else options.seed
    every = planned_jobs(options.out)
    jobs = draw_jobs(every, options.again, seed)
    about = f"measured again: {len(jobs)} of {len(every)} measurements, drawn with --seed {seed}"
    print(f"\n{folded(f'{about}, about {expected_seconds(jobs):.0f} s of computing time')}", flush=True)
    with (
        local_pool(min(options.jobs, len(jobs))) as pool,
        progress_bar(round(sum(job.cost for job in jobs))) as bar,
    ):
        tolerance = Tolerance(options.tolerance, options.absolute)
        comparison = compare_again(options.out, jobs, pool, tolerance, bar.add)
    if not comparison.differs:
        print(f"all numbers agree within {options.tolerance:g} relative + {options.absolute:g}")
        return OK
    print(f"numbers differ; old is the value in {options.out}/data, new is measured now\n")
    print(as_text(comparison))
    return FAILED


def as_written(directory: Path, judged: Sequence[Verdict]) -> set[Path]:
    """Compare verdicts, tables, captions, badges and README with the texts that the program would write now.

    Returns:
        The files that were compared.

    Raises:
        DataError: a file differs; the message names the first line, both texts, and the command that mends it.
    """
    compare_claims(directory, judged)
    read_claims(directory)
    expected = expected_texts(directory)
    for file, (text, command) in expected.items():
        if differs := difference(file, text):
            raise DataError(
                f"{differs}: the file or the data from which it is made were changed; if the data are right, "
                f"`{command}` writes the file again"
            )
    return {claims_file(directory), *expected}


def not_compared(directory: Path, compared: set[Path]) -> tuple[list[Path], list[Path]]:
    """Return the files of a result directory that were checked in part, and the files that were not checked.

    Hidden files, stored results of jobs, and result directories inside this one are left out.

    Parameters:
        directory: the result directory.
        compared: the files that were checked completely.
    """
    inside = (path.parent.parent for path in directory.rglob("data/provenance.json"))
    left_out = {directory / "data" / "jobs", *inside} - {directory}
    files = [path for path in sorted(directory.rglob("*")) if path.is_file() and not path.name.startswith(".")]
    rest = [path for path in files if path not in compared and not left_out & {*path.parents}]
    tables = [f"data/{file.name}" for file in data_files() if isinstance(file, CsvFile)]
    in_part = {directory / name for name in (*IN_PART, *tables)}
    return [path for path in rest if path in in_part], [path for path in rest if path not in in_part]

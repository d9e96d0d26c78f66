"""``study check``: whether data, verdicts, tables and the inputs of the article are what they must be."""

from __future__ import annotations

import argparse
import secrets
from collections.abc import Sequence
from pathlib import Path

from study.cli.common import check_jobs, progress_bar
from study.cli.coverage import by_folder, not_compared
from study.cli.exits import FAILED, OK
from study.cli.tolerance import tolerance_from
from study.controls.record_check import compare_record
from study.ledger.compare import as_text
from study.ledger.datafiles import DataError, read_claims, table_text
from study.ledger.differing import NUMBERS, difference
from study.ledger.errors import UsageError
from study.ledger.terminal import folded
from study.ledger.verdict import Verdict, all_pass
from study.present.expected import expected_texts
from study.present.outcome import ledger_text, write_junit
from study.run.again import compare_again, draw_jobs, expected_seconds, planned_jobs
from study.run.execute import Pool
from study.run.judgement import claims, claims_file, verdicts
from study.run.processes import Processes
from study.run.store import Store
from study.run.sums import compare_sums
from study.run.verification import verify

SEED_BITS = 62
"""Bits of a fresh seed: 64-bit integers of other programs hold it."""


def do_check(options: argparse.Namespace) -> int:
    """``study check``: exit 0 all hold and stand as they would be written, 1 a verdict is no pass, 2 they do not."""
    _require_sample(options)
    with Store(options.out).steady():
        verified = verify(options.out)
        found = verdicts(options.out)
        if options.junit:
            write_junit(options.junit, found)
        print(ledger_text(claims(found)))
        if not all_pass(found) or (options.again is not None and _again(options) == FAILED):
            return FAILED
        # Data first: a table that follows from damaged data must not be written again.
        compared = compare_sums(options.out) | compare_record(options.out) | as_written(options.out, found)
    compared |= {options.out / "data" / "cases.csv"}
    inside = len([path for path in compared if options.out in path.parents])
    print(folded(f"{verified}; {len(found)} verdicts and {inside} files stand as they would be written"))
    in_part, unchecked = not_compared(options.out, compared)
    for what, paths in (("checked in part", in_part), ("not checked", unchecked)):
        if paths:
            print(folded(f"{what}, {len(paths)} files: {by_folder(paths)}"))
    return OK


def _require_sample(options: argparse.Namespace) -> None:
    """Refuse options of ``--again`` that make no sense, before time is spent."""
    check_jobs(options.jobs)
    tolerance_from(options)
    if options.again is None:
        if options.seed is not None:
            raise UsageError("--seed chooses the rows of --again: give --again N with it")
        return
    if options.again < 1:
        raise UsageError(f"--again must be 1 or more rows, got {options.again}")
    if options.seed is not None and options.seed < 0:
        raise UsageError(f"--seed must be 0 or more, got {options.seed}")


def _again(options: argparse.Namespace) -> int:
    """Measure a random sample of the rows again: 0 if all numbers agree, 1 if one differs."""
    seed = secrets.randbits(SEED_BITS) if options.seed is None else options.seed
    every = planned_jobs(options.out)
    jobs = draw_jobs(every, options.again, seed)
    about = f"measured again: {len(jobs)} of {len(every)} measurements, drawn with --seed {seed}"
    print(f"\n{folded(f'{about}, about {expected_seconds(jobs):.0f} s of computing time')}", flush=True)
    with (
        Processes(min(options.jobs, len(jobs))) as processes,
        progress_bar(round(sum(job.cost for job in jobs))) as bar,
    ):
        found = compare_again(
            options.out, jobs, Pool.of(processes), tolerance_from(options), lambda cost: bar.update(round(cost))
        )
    if not found.differs:
        print(f"all numbers agree within {options.tolerance:g} relative + {options.absolute:g}")
        return OK
    print(f"numbers differ; old is what stands in {options.out}/data, new is what was measured now\n")
    print(as_text(found))
    return FAILED


def as_written(directory: Path, found: Sequence[Verdict]) -> set[Path]:
    """Compares verdicts, tables, captions, badges and README with what would be written now; returns their files.

    Raises:
        DataError: names the first line that differs, both texts, and the command that mends it.
    """
    path, again = claims_file(directory), f"`study tables --out {directory}` writes it again"
    if not path.is_file():
        raise DataError(f"{path} is missing: {again}")
    _refuse(difference(path, table_text(claims(found)), frozenset(NUMBERS)), again)
    read_claims(directory)
    there = expected_texts(directory)
    for file, (text, command) in there.items():
        _refuse(difference(file, text), f"`{command}` writes it again")
    return {path, *there}


def _refuse(found: str | None, mend: str) -> None:
    if found:
        raise DataError(f"{found}: {mend}")

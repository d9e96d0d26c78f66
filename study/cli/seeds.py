"""``study seeds``: measures how often a check fails by chance on meshes with random vertices.

A *seed* is a number from which a random mesh of every size and body is made. On the meshes of new seeds, all checks are
judged that the study claims to hold there. The results are added to the record of seeds (``study.controls.record``).
"""

import argparse
import secrets
import shutil
import time
from collections.abc import Callable
from pathlib import Path

from tqdm import tqdm

from study.cli.common import progress_bar
from study.cli.options import FAILED, OK, SEED_BITS, UNCLEAR
from study.controls.alarms import tally, text
from study.controls.record import Draw, Record
from study.controls.rules import row_of, rules
from study.controls.seeded import EVERY, LIGHT, WHOLE, claimed, seeded
from study.fem.naming import family_named
from study.ledger.datafiles import AlarmSummary, write_csv
from study.ledger.verdict import FAILS, HOLDS, UNCLAIMED, UNDECIDED, Verdict
from study.run.executor import Pool, Processes, execute
from study.run.judgement import collect, judge
from study.run.plan import Plan
from study.run.store import Store


class TimeIsUpError(Exception):
    """Raised when the time of ``--minutes`` is over; finished measurements are stored."""


def watch(bar: tqdm, end: float) -> Callable[[float], None]:
    """Return a function, called after each measurement, that shows the progress and stops the run when time is over.

    Its argument is the expected computing time of the measurement in µs. It raises TimeIsUpError if the time is over.

    Parameters:
        bar: the progress bar.
        end: when the run must stop, on the clock ``time.monotonic()``.
    """

    def notify(cost: float) -> None:
        bar.update(round(cost))
        if time.monotonic() >= end:
            raise TimeIsUpError

    return notify


def do_seeds(options: argparse.Namespace) -> int:
    """Judge checks on new random meshes as long as time permits, and write the table of false-alarm rates.

    With the option ``--seed``, the command instead measures again on the random meshes with this seed.

    Returns:
        0 if the false-alarm rate is at most the permitted one, 1 if it is larger, 3 if this is undecided. With
        ``--seed``: 0 if all checks hold that the study claims to hold on random meshes, otherwise 1.
    """
    if options.seed is not None:
        # A seed that is too long for the name of a directory raises an error here.
        family_named(f"shaken-{options.seed}")
    Store(options.out).check()
    with Processes(options.jobs) as processes:
        pool = Pool.of(processes)
        if options.seed is not None:
            return _again(options.seed, options.out, pool)
        with Store(options.out).locked():
            most = float("inf") if options.seeds is None else options.seeds
            _fill(options.out, pool, time.monotonic() + 60 * options.minutes, most)
    record = Record.read(options.out)
    if not any(draw.judged >= 0 for draw in record.draws):
        begun = "; the next call continues the seed that was begun" if record.pending() else ""
        print(f"no seed was finished: give more time with --minutes{begun}")
        return UNCLEAR
    table = tally(record)
    written = write_csv(options.out / "data" / "seeds.csv", table)
    print(f"\n{text(table)}\ndata: {written}, {written.parent}/seeds/")
    return {HOLDS: OK, UNDECIDED: UNCLEAR, FAILS: FAILED}[AlarmSummary(table).verdict]


def _fill(directory: Path, pool: Pool, end: float, most: float) -> None:
    """Judge the checks on random meshes with new seeds, and record the results.

    If an earlier call did not finish a seed, this seed comes first.

    Parameters:
        directory, pool: the result directory, and the pool that runs the measurements.
        end: when the run must stop, on the clock ``time.monotonic()``.
        most: largest number of seeds.
    """
    done = 0
    while done < most and time.monotonic() < end:
        done += 1
        record = Record.read(directory)
        draw = record.pending()
        if draw is None:
            draw = Draw(secrets.randbits(SEED_BITS), LIGHT if (len(record.draws) + 1) % EVERY else WHOLE)
            # The seed is recorded before anything is measured, so that a seed with a bad result cannot be left out.
            record = record.drawn(draw.seed, draw.part)
            record.write(directory)
        store, plan = Store(directory / "seeds" / str(draw.seed)), seeded(draw.seed, draw.part)
        try:
            found = judged(plan, store, pool, f"seed {len(record.draws)}, {draw.part}", end)
        except TimeIsUpError:
            return
        known = rules(store.directory, plan, seeded(draw.seed))
        mine = [verdict for verdict in found if row_of(verdict) in known]
        record.judged(draw.seed, mine, known, claimed).write(directory)
        shutil.rmtree(store.directory)


def judged(plan: Plan, store: Store, pool: Pool, name: str, end: float) -> list[Verdict]:
    """Make the measurements of a plan that are not stored, and return the checks about which something is claimed.

    Parameters:
        plan, store, pool: the plan, the directory of its data, and the worker processes.
        name: text before the progress bar.
        end: when the run must stop, on the clock ``time.monotonic()``.

    Raises:
        TimeIsUpError: the time is over before all measurements are finished.
    """
    with progress_bar(round(sum(job.cost for job in plan.jobs)), name) as bar:
        execute(plan.jobs, store, pool, watch(bar, end))
        collect(plan, store)
    return [verdict for verdict in judge(store.directory) if verdict.verdict not in UNCLAIMED]


def _again(seed: int, directory: Path, pool: Pool) -> int:
    """Measure again on the random meshes with one seed; print the checks that should hold there and do not.

    The results are also compared with the record of seeds.

    Returns:
        0 if all checks hold that the study claims to hold on random meshes, otherwise 1.
    """
    store, plan = Store(directory / "seeds" / str(seed)), seeded(seed)
    found = judged(plan, store, pool, f"seed {seed}", float("inf"))
    record, known = Record.read(directory), rules(store.directory, plan, plan)
    shutil.rmtree(store.directory)
    rows = [verdict for verdict in found if row_of(verdict) in known]
    red = [row for row in rows if row.verdict != HOLDS and claimed(row.label)]
    print(
        "\n".join([f"{row.label}, {row.key}, {row.case}: {row.observed:.6g}, expected {row.expected}" for row in red])
    )
    print(f"{len(rows)} checks; {len(red)} of those that a statement claims do not hold")
    if any(draw.seed == seed for draw in record.draws):
        same, other = record.agreement(seed, rows, known)
        print(f"the record has this seed: {same} results are the same, {other} differ")
    else:
        print("the record does not have this seed")
    return FAILED if red else OK

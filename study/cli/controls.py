"""``study faults`` measures which checks notice deliberate faults; ``study seeds`` measures how often chance fails one.

A *seed* is a number from which a random mesh of every size and body is made. On the meshes of new seeds, all checks are
judged that the study claims to hold there. The results are added to the record of seeds (``study.ledger.controls``).
"""

import shutil
import time
from argparse import Namespace
from math import inf
from pathlib import Path
from secrets import randbits

from pandas import DataFrame
from tabulate import tabulate

from manufactured.self_proof import prove
from study.cli.common import job_progress, progress_bar
from study.cli.options import FAILED, OK, SEED_BITS, UNCLEAR
from study.controls.faults import FAULTS
from study.controls.matrix import measure_case
from study.controls.seeded import rules, seeded
from study.fem.naming import absolute, choose, family_named, is_own, name_of, resolve
from study.ledger.controls import FalseAlarms, SeedRecord, in_words, missed, summary
from study.ledger.datafiles import write_csv
from study.ledger.schema import SCHEMA
from study.ledger.text import folded
from study.ledger.verdict import FAILS, HOLDS, UNCLAIMED, UNDECIDED, Verdicts
from study.run.executor import Pool, Processes, execute, local_pool, unfinished
from study.run.fingerprint import of_everything, problem
from study.run.judgement import collect, judge
from study.run.plan import COVER, Job, check_own
from study.run.store import Store


def do_faults(options: Namespace) -> int:
    """Put deliberate faults into the discrete problem, and record which checks fail with each fault in each case.

    The matrix fault × case × check is written to ``data/faults.csv``. Printed are, for each fault, the number of cases
    whose checks notice it, and the faults that are not noticed as the rules of ``missed`` demand.

    Returns:
        1 if a fault is not noticed as these rules demand, else 0; always 0 for a selection of cases.
    """
    store = Store(options.out)
    store.check()
    cases = [absolute(name) for name in options.case or COVER]
    for name in filter(is_own, cases):
        check_own(name)
        prove(resolve(name).solution, f"case {name}")
    names = [choose("fault", name, FAULTS).name for name in options.fault or [fault.name for fault in FAULTS]]
    code = f"{of_everything()} {' '.join(names)}"
    keys = {case: (f"faults__{name_of(case)}", f"{code} {problem(case)}") for case in cases}
    count = f"{len(cases)} cases"
    rows: list[dict[str, object]] = []
    with Processes(options.jobs) as executor, store.locked(), progress_bar(len(cases), count) as bar:
        missing = [case for case in cases if store.load(*keys[case]) is None]
        waiting = {case: executor.submit(measure_case, case, names) for case in missing}
        for case in cases:
            measured = store.cached(*keys[case], lambda case=case: {"rows": waiting[case].result()})  # type: ignore[misc]
            rows += measured["rows"]
            bar.update()
    table = DataFrame(rows, columns=list(SCHEMA["faults.csv"].columns))
    written = write_csv(options.out / "data" / "faults.csv", table)
    heads = {"errors": "noticed by errors", "any_check": "by any check"}
    print(f"\n{tabulate(summary(table).rename(columns=heads), 'keys', showindex=False)}\ndata: {written}")
    lacking = missed(table)
    print(folded(f"{len(names)} faults, {count}; not noticed as the rules demand: {in_words(lacking)}"))
    # A selection of cases need not notice every fault.
    return FAILED if lacking and not options.case else OK


class TimeIsUpError(Exception):
    """Raised when the time of ``--minutes`` is over; finished measurements are stored."""


def do_seeds(options: Namespace) -> int:
    """Judge checks on new random meshes, and count the seeds with a false alarm, a check that does not hold by chance.

    New seeds are measured until the time of ``--minutes`` is over, or their number is that of ``--seeds``. With the
    option ``--seed``, the command instead measures again on the random meshes with this seed.

    Returns:
        0 if the false-alarm rate is at most the permitted one, 1 if it is larger, 3 if this is undecided. With
        ``--seed``: 0 if all checks hold, otherwise 1.
    """
    if options.seed is not None:
        # A seed that is too long for the name of a directory raises an error here.
        family_named(f"shaken-{options.seed}")
    directory = options.out
    store = Store(directory)
    store.check()
    with local_pool(options.jobs) as pool:
        if options.seed is not None:
            return _again(options.seed, directory, pool)
        with store.locked():
            _fill(directory, pool, time.monotonic() + 60 * options.minutes, options.seeds)
    record = SeedRecord.read(directory)
    if not any(row.judged >= 0 for row in record.rows):
        begun = "; the next call continues the seed that was begun" if record.pending() else ""
        print(f"no seed was finished: give more time with --minutes{begun}")
        return UNCLEAR
    alarms = FalseAlarms(record)
    print(f"\n{alarms.text()}\ndata: {record.write(directory)}")
    return {HOLDS: OK, UNDECIDED: UNCLEAR, FAILS: FAILED}[alarms.verdict]


def _fill(directory: Path, pool: Pool, end: float, most: int) -> None:
    """Judge the checks on random meshes with new seeds, and record the results.

    If an earlier call did not finish a seed, this seed comes first.

    Parameters:
        directory, pool: the result directory, and the pool that runs the measurements.
        end: when the run must stop, on the clock ``time.monotonic()``.
        most: largest number of seeds.
    """
    for _ in range(most):
        if time.monotonic() >= end:
            return
        record = SeedRecord.read(directory)
        if record.pending() is None:
            # The seed is recorded before anything is measured, so that a seed with a bad result cannot be left out.
            record = record.drawn(randbits(SEED_BITS))
            record.write(directory)
        seed = record.rows[-1].seed
        try:
            verdicts, hash_of_rules = judged(seed, directory, pool, f"seed {len(record.rows)}", end)
        except TimeIsUpError:
            return
        record.judged(hash_of_rules, len(verdicts), _print_alarms(verdicts)).write(directory)


def judged(seed: int, directory: Path, pool: Pool, name: str, end: float) -> tuple[Verdicts, str]:
    """Measure on the random meshes with one seed, judge the results, and delete the measurements afterwards.

    Measurements of an interrupted call are used.

    Parameters:
        seed, directory, pool: the seed, the result directory and the worker processes.
        name: text before the progress bar.
        end: when the run must stop, on the clock ``time.monotonic()``.

    Returns:
        The checks that something is claimed about, and the hash of their rules (quantities, tolerance windows, levels).

    Raises:
        TimeIsUpError: the time is over before all measurements are finished.
    """
    store = Store(directory / "seeds" / str(seed))
    plan = seeded(seed)

    def notify(job: Job) -> None:
        bar.add(job)
        if time.monotonic() >= end:
            raise TimeIsUpError

    with job_progress(unfinished(plan.jobs, store), name) as bar:
        execute(plan.jobs, store, pool, notify)
        collect(plan, store)
    measured = {job.statement.label for job in plan.jobs}
    claimed = [v for v in judge(store.directory) if v.verdict not in UNCLAIMED and v.label in measured]
    shutil.rmtree(store.directory)
    return claimed, rules(plan, claimed)


def _print_alarms(verdicts: Verdicts) -> int:
    """Print the checks that do not hold, and return their number."""
    alarms = [verdict for verdict in verdicts if verdict.verdict != HOLDS]
    for row in alarms:
        print(f"{row.label}, {row.key}, {row.case}: {row.observed:.6g}, expected {row.expected}")
    return len(alarms)


def _again(seed: int, directory: Path, pool: Pool) -> int:
    """Measure again on the random meshes with one seed; compare the number of false alarms with the record of seeds.

    Returns:
        0 if all checks hold, otherwise 1.
    """
    verdicts, _ = judged(seed, directory, pool, f"seed {seed}", inf)
    alarms = _print_alarms(verdicts)
    print(f"{len(verdicts)} checks; {alarms} do not hold")
    recorded = [row for row in SeedRecord.read(directory).rows if row.seed == seed]
    for row in recorded:
        print(f"the record has {row.judged} checks and {row.alarms} false alarms for this seed")
    if not recorded:
        print("the record does not have this seed")
    return FAILED if alarms else OK

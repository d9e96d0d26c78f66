"""``study check``: compares data, verdicts, tables and the inputs of the papers with their expected contents.

The recorded plan is compared with the plan that its scope gives now, the rows of all tables with the plan, and
``cases.csv`` with the catalogue of cases. Nothing is measured for this. With ``--again N``, a random sample of the rows
is also measured again.
"""

import tempfile
from argparse import Namespace
from pathlib import Path
from secrets import randbits

import numpy as np
from pandas import DataFrame

from study.cli.common import code_of, job_progress, known_undecided
from study.cli.options import FAILED, OK, SEED_BITS
from study.fem.naming import describe
from study.ledger.codes import FOLDER, MARCHES, Codes
from study.ledger.compare import Comparison, Tolerance, as_text, compare, difference
from study.ledger.controls import SEEDS_FILE, SeedRecord
from study.ledger.datafiles import CsvFile, DataError, Key, line, made_by, read_claims, read_csv, table_text, write_csv
from study.ledger.files import Json, Paths, UsageError
from study.ledger.text import folded
from study.ledger.verdict import Verdicts
from study.present.outcome import ledger_text, write_junit
from study.present.pages import expected_texts
from study.run.executor import Notify, Pool, execute, local_pool
from study.run.judgement import (
    PREDICTED,
    claims,
    claims_file,
    compare_claims,
    data_files,
    read_tables,
    stored_rows,
    verdicts,
)
from study.run.plan import Job, Jobs, Plan
from study.run.provenance import commit, compare_sums, read_provenance, recorded_plan
from study.run.store import Store
from study.statements.enclosure import BOUNDS, ENCLOSURES

IN_PART = (
    "data/provenance.json",
    "data/faults.csv",
    f"data/{SEEDS_FILE}",
    *(f"{folder}/{name}.csv" for folder in (FOLDER, MARCHES) for name in ("classes", "errors")),
)
"""Files in which only some edits are noticed: cells of a wrong kind, and cells from which tables are made. The data
tables of a run also belong to these files if its provenance has no checksums."""


def do_check(options: Namespace) -> int:
    """Check a result directory: whether its plan, data, verdicts and the files made from them agree.

    With ``--again``, a random sample of the measurements is also repeated and compared with the data.

    Returns:
        0 if everything agrees, 1 if a check fails or a repeated measurement differs, 3 if a check is undecided. A file
        with an unexpected content raises an error, for which the command returns 2.
    """
    known_undecided(options.undecided)
    directory = options.out
    if options.again is None and options.seed is not None:
        raise UsageError("--seed chooses the rows of --again: give --again N with it")
    with Store(directory).steady():
        verified = verify(directory)
        compared = compare_sums(directory)
        SeedRecord.read(directory)
        judged = verdicts(directory)
        if options.junit:
            write_junit(options.junit, judged)
        print(ledger_text(claims(judged)))
        code = code_of(judged, options.undecided)
        if code == FAILED or (options.again is not None and _again(options) == FAILED):
            return FAILED
        # Tables are compared after the data, because a message might advise to write tables from damaged data.
        compared |= as_written(directory, judged)
    compared |= {directory / "data" / "cases.csv"}
    inside = sum(directory in path.parents for path in compared)
    print(
        folded(f"{verified}; {len(judged)} verdicts and {inside} files agree with the texts that this version writes")
    )
    for what, paths in not_compared(directory, compared).items():
        if paths:
            listed = " ".join(map(str, paths))
            print(folded(f"{what}, {len(paths)} files: {listed}"))
    return code


def _again(options: Namespace) -> int:
    """Measure a random sample of the rows again; return 0 if all numbers agree, 1 if one differs."""
    seed = randbits(SEED_BITS) if options.seed is None else options.seed
    every = planned_jobs(options.out)
    jobs = draw_jobs(every, options.again, seed)
    about = f"measured again: {len(jobs)} of {len(every)} measurements, drawn with --seed {seed}"
    print(f"\n{folded(f'{about}, about {expected_seconds(jobs):.0f} s of computing time')}", flush=True)
    with local_pool(min(options.jobs, len(jobs))) as pool, job_progress(jobs) as bar:
        tolerance = Tolerance(options.tolerance, options.absolute)
        comparison = compare_again(options.out, jobs, pool, tolerance, bar.add)
    if not comparison.differs:
        print(f"all numbers agree within {options.tolerance:g} relative + {options.absolute:g}")
        return OK
    print(f"numbers differ; old is the value in {options.out}/data, new is measured now\n")
    print(as_text(comparison))
    return FAILED


def as_written(directory: Path, judged: Verdicts) -> set[Path]:
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


def not_compared(directory: Path, compared: set[Path]) -> dict[str, Paths]:
    """Return "checked in part" and "not checked" ↦ the files of a result directory of which this is true.

    Hidden files, stored results of jobs, and result directories inside this one are left out.

    Parameters:
        directory: the result directory.
        compared: the files that were checked completely.
    """
    inside = (path.parent.parent for path in directory.rglob("data/provenance.json"))
    left_out = {directory / "data" / "jobs", *inside} - {directory}
    tables = [f"data/{file.name}" for file in data_files() if isinstance(file, CsvFile)]
    in_part = {directory / name for name in (*IN_PART, *tables)}
    rest: dict[str, Paths] = {"checked in part": [], "not checked": []}
    for path in sorted(directory.rglob("*")):
        hidden = path.name.startswith(".") or not path.is_file()
        if not (hidden or path in compared or left_out & {*path.parents}):
            rest["checked in part" if path in in_part else "not checked"].append(path)
    return rest


# Plan, rows and predictions.


def verify(directory: Path) -> str:
    """Compare the data of a run with its plan and with the predictions for its cases.

    Returns:
        A sentence with the numbers of rows, files, planned measurements and cases that were compared.

    Raises:
        UsageError: the directory has no data, or the file of a user's case no longer exists.
        StoreError, DataError: data are of another format, missing, damaged or edited; the message names file, line and
            column, the value and the expected value.
    """
    record = read_provenance(directory)
    again = f"make them again with `{made_by(directory)}`; finished measurements are kept"
    plan = recorded_plan(record, directory)
    planned = _recorded_keys(directory, record, plan, again)
    tables = read_tables(directory)
    for file, table in tables.items():
        _refuse_unplanned(directory, file, table, planned, again)
    # Predicted orders come from the catalogue, or from the file of a user's case.
    path = directory / "data" / "cases.csv"
    read_csv(directory, path.name, PREDICTED)
    cases = DataFrame(map(describe, plan.scope.resolved()))
    if differs := difference(path, table_text(cases)):
        raise DataError(f"{differs} from the catalogue or from the file of the case: {again}")
    for folder in (FOLDER, MARCHES):
        Codes.read(directory, folder)
    rows = sum(map(len, tables.values()))
    return (
        f"measured with the catalogue of commit {record.get('commit') or 'unknown'}: "
        f"{rows} rows in {len(tables)} files belong to the {len(planned)} planned measurements; "
        f"the predictions of {len(cases)} cases agree with the definitions of the cases"
    )


def _recorded_keys(directory: Path, record: Json, plan: Plan, again: str) -> set[Key]:
    """Return the keys of all measurements in the recorded plan of a run.

    Raises:
        DataError: the plan is empty, repeats a key, or differs from the plan that the same commit makes of the recorded
            scope.
    """
    recorded = record["planned"]
    where = f"{directory}/data/provenance.json"
    if not recorded or len({*recorded}) < len(recorded):
        raise DataError(f"{where} has an empty plan, or plans a measurement twice: {again}")
    # A newer program may plan more. What an older one has measured stands.
    differing = set(recorded) ^ set(plan.keys())
    if differing and record.get("commit") == commit()["commit"]:
        first = min(differing)
        plans = "plans" if first in recorded else "does not plan"
        raise DataError(f"{where} {plans} {' '.join(first)}, which disagrees with its scope: {again}")
    return set(recorded)


def _refuse_unplanned(directory: Path, file: CsvFile, table: DataFrame, planned: set[Key], again: str) -> None:
    """Raise DataError if a table has a row that is not in the plan of the run.

    Rows that are in the plan but not in the table are no error here. The first check of the ledger reports them.
    """
    # The plan lists each error bound once. The values of a bound over time, in another file, have the same key.
    name = BOUNDS.name if file == ENCLOSURES else file.name
    for row, (_, *key) in enumerate(file.keys(table)):
        if (name, *key) not in planned:
            raise DataError(
                f"{directory}/data/{file.name}, line {line(row)}: {' '.join(key)} is not among the {len(planned)} "
                f"measurements of the plan: {again}"
            )


# A sample of the rows is measured again.


def planned_jobs(directory: Path) -> tuple[Job, ...]:
    """Return all jobs, that is measurements, whose rows are in the tables of a result directory.

    Jobs for pictures are left out. On other processors, the cells of unstructured meshes of symmetric bodies may be
    numbered differently, so that pictures differ.

    Raises:
        UsageError: there are no data, or the file of a user's case no longer exists.
    """
    record = read_provenance(directory)
    planned = set(record["planned"])
    return tuple(job for job in recorded_plan(record, directory).jobs if job.identity in planned)


def draw_jobs(jobs: Jobs, count: int, seed: int) -> list[Job]:
    """Return a random sample of jobs without repetition.

    A job is drawn with a probability proportional to 1 / cost. So the expected time of one draw is the harmonic mean of
    all costs, about 0.4 s for the full study, even if some jobs take very long.

    Parameters:
        jobs: all jobs of the plan.
        count: size of the sample; if there are fewer jobs, all are returned.
        seed: seed of the random generator, 0 or more; the same seed gives the same sample.
    """
    weights = 1 / np.array([job.cost for job in jobs])
    size = min(count, len(jobs))
    drawn = np.random.default_rng(seed).choice(len(jobs), size, replace=False, p=weights / weights.sum())
    return [jobs[i] for i in drawn]


def expected_seconds(jobs: Jobs) -> float:
    """Return the expected computing time of jobs in seconds."""
    return sum(job.cost for job in jobs) / 1e6


def compare_again(directory: Path, jobs: Jobs, pool: Pool, tolerance: Tolerance, notify: Notify) -> Comparison:
    """Run jobs again and compare the new measurements with the rows on disk.

    Only measured columns are compared, not columns that are derived from them.

    Parameters:
        directory: the result directory.
        jobs: the jobs that are run again.
        pool: runs the jobs.
        tolerance: the permitted differences.
        notify: called with each finished job.

    Returns:
        The differences; ``old`` means the rows in ``directory``, ``new`` the rows that were measured now.

    Raises:
        UsageError: a measurement needs more memory than is available.
        JobsError: a measurement failed.
        DataError: a data file is missing or damaged.
    """
    with tempfile.TemporaryDirectory() as temporary:
        old = Path(temporary) / "old"
        new = Path(temporary) / "new"
        store = Store(new)
        execute(jobs, store, pool, notify)
        for file, measured in stored_rows(jobs, store).items():
            assert isinstance(file, CsvFile), file.name
            table = DataFrame(measured, columns=file.columns)
            write_csv(new / "data" / file.name, table)
            # From the file on disk, only the rows that were measured again are compared, without derived columns.
            wanted = table[[*file.key]].drop_duplicates()
            committed = file.read(directory).merge(wanted, on=[*file.key])
            write_csv(old / "data" / file.name, committed[file.columns])
        return compare(old, new, tolerance)

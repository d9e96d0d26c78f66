"""What a second process is worth: the same run with one and with two, `make bench-parallel`.

    python -m benchmarks.parallel [ARGUMENTS OF study run ...]

Both runs start from an empty directory under ``build/`` and have to write the same CSV files to the byte.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from time import perf_counter

import pandas as pd

from benchmarks.report import RESULTS, ROOT, single_thread, write

STUDY = [sys.executable, "-c", "import sys; from study.cli.main import main; sys.exit(main())", "run"]
GOAL = 1.7
"""What the seconds with one process should be over those with two, at least."""
Files = Mapping[str, bytes]


def run(directory: Path, jobs: int, arguments: Sequence[str]) -> tuple[float, Files]:
    """Seconds of a run in a fresh directory, and its CSV files."""
    shutil.rmtree(directory, ignore_errors=True)
    command = [*STUDY, *arguments, "--jobs", str(jobs), "--out", str(directory)]
    start = perf_counter()
    code = subprocess.run(command, env=single_thread(os.environ), stdout=subprocess.DEVNULL).returncode
    seconds = perf_counter() - start
    # On coarse levels a verdict may fail; the data are complete once there are verdicts.
    if code not in (0, 1) or not (directory / "data" / "claims.csv").is_file():
        raise SystemExit(f"{' '.join(command[3:])}: not measured, exit code {code}")
    data = directory / "data"
    return seconds, {path.relative_to(data).as_posix(): path.read_bytes() for path in sorted(data.rglob("*.csv"))}


def differing(one: Files, other: Files) -> list[str]:
    """Names of the files that are not the same in both."""
    return [name for name in sorted({*one, *other}) if one.get(name) != other.get(name)]


def table(plan: str, one: tuple[float, Files], two: tuple[float, Files]) -> pd.DataFrame:
    """One row, from the seconds and files with one process and with two."""
    ratio = one[0] / two[0]
    row = {
        "plan": plan,
        "one_job_seconds": one[0],
        "two_jobs_seconds": two[0],
        "ratio": ratio,
        "goal": GOAL,
        "met": "yes" if ratio >= GOAL else "no",
        "csv_files": len({*one[1], *two[1]}),
        "identical": "no" if differing(one[1], two[1]) else "yes",
    }
    return pd.DataFrame([row])


def main(plan: Sequence[str]) -> None:
    """Measure a run with the arguments ``plan`` of `study run`, write the table and show it."""
    build = ROOT / "build"
    one, two = (run(build / f"parallel-{jobs}", jobs, plan) for jobs in (1, 2))
    notes = [
        "`study run` from an empty directory to the last figure, one thread for each process; *ratio*: seconds with "
        "one process over those with two, which should be at least *goal*. *identical*: whether the two wrote the same "
        "CSV files, byte for byte."
    ]
    write(RESULTS, "parallel", table(" ".join(plan), one, two), "Processes", notes)
    print((RESULTS / "parallel.md").read_text(encoding="utf-8"))
    for name in differing(one[1], two[1]):
        print(f"WARNING: {name} depends on the number of processes")


if __name__ == "__main__":
    main(sys.argv[1:] or ["--quick"])

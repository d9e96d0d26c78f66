"""Nothing is lost: a run, or a worker, is killed at a random moment, and the same command does the rest."""

from __future__ import annotations

import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import psutil
import pytest

RUN = ["run", "--case", "full-contact", "advance-recede", "--levels", "2", "4", "8", "--jobs", "2", "--out"]
WITHOUT_FIGURES = """
import sys
from study import cli
cli.draw_figures = lambda *arguments: []
sys.exit(cli.main(sys.argv[1:]))
"""
"""The command but for the figures, which are drawn from the data and would take most of the time."""
KILLS = 3
"""In one directory, one run after the other."""


def started(out: Path) -> subprocess.Popen[bytes]:
    """The command, in a process group of its own."""
    command = [sys.executable, "-c", WITHOUT_FIGURES, *RUN, str(out)]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, start_new_session=True)


def finished(out: Path) -> dict[str, bytes]:
    """Let the command end, and read the data that it wrote."""
    # Levels as coarse as these do not carry every verdict; what matters is that it came to verdicts.
    assert started(out).wait() in (0, 1)
    assert (out / "data" / "claims.csv").exists()
    return {str(path.relative_to(out)): path.read_bytes() for path in out.glob("data/**/*") if path.is_file()}


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, bytes], float]:
    """What an undisturbed run writes, and the seconds it takes."""
    start = time.monotonic()
    files = finished(tmp_path_factory.mktemp("undisturbed"))
    return files, time.monotonic() - start


def gone(process: psutil.Process) -> bool:
    """Whether a process has ended, its parent having noticed or not."""
    return not process.is_running() or process.status() == psutil.STATUS_ZOMBIE


def results(out: Path) -> dict[Path, int]:
    """The files of finished jobs and when they were written."""
    return {path: path.stat().st_mtime_ns for path in out.glob("data/jobs/*.json")}


def kill(out: Path, jobs: int, delay: float, choose: random.Random) -> bool:
    """Start the command and kill something of it some seconds after so many jobs are finished.

    Nothing may be left running. Whether it was still running.
    """
    run = started(out)
    leader = psutil.Process(run.pid)
    while len(results(out)) < jobs and run.poll() is None:
        time.sleep(0.01)
    time.sleep(delay)
    if run.poll() is not None:
        return False
    family = [leader, *leader.children(recursive=True)]
    victim = choose.choice(family[-3:])
    victim.send_signal(signal.SIGKILL)
    if victim is not leader:
        assert run.wait() in (0, 1)
    run.wait()
    deadline = time.monotonic() + 20
    while not all(map(gone, family)):
        assert time.monotonic() < deadline, [process for process in family if not gone(process)]
        time.sleep(0.05)
    return True


@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 8))], ids="seed {}".format
)
def test_kills_at_random_moments_change_no_byte_of_what_the_command_writes_in_the_end(
    seed: int, undisturbed: tuple[dict[str, bytes], float], tmp_path: Path
) -> None:
    files, seconds = undisturbed
    total = sum("jobs" in name for name in files)
    choose = random.Random(seed)
    killed = 0
    for _ in range(KILLS):
        # One kill in three before anything is finished, while the cases prove themselves.
        early = choose.random() < 1 / 3
        jobs = 0 if early else choose.randrange(total)
        killed += kill(tmp_path, jobs, choose.uniform(0, 0.5) * seconds if early else choose.uniform(0, 0.3), choose)
    kept = results(tmp_path)
    assert finished(tmp_path) == files
    assert killed >= KILLS - 1
    assert kept.items() <= results(tmp_path).items(), "what was finished is not done again"

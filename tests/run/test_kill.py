"""Nothing is lost: a run, or a worker, is killed at a random moment, and the same command does the rest."""

from __future__ import annotations

import multiprocessing
import os
import random
import signal
import time
from multiprocessing.process import BaseProcess
from pathlib import Path

import psutil
import pytest

from study.cli import common
from study.cli.main import main
from study.run.plan import Plan

RUN = ["run", "--case", "full-contact", "advance-recede", "--levels", "2", "3", "--jobs", "2", "--out"]


def started(out: Path) -> BaseProcess:
    """The command in a process group of its own, forked so that nothing is imported again."""
    process = multiprocessing.get_context("fork").Process(target=command, args=(out,))
    process.start()
    return process


def command(out: Path) -> None:
    """``study run`` without figures and without the proofs of the cases, which write no results and take long."""
    os.setsid()
    with open(os.devnull, "w") as nowhere:
        for stream in (1, 2):
            os.dup2(nowhere.fileno(), stream)
    common.draw_figures = lambda *arguments, **options: []  # type: ignore[assignment]
    Plan.check = lambda *arguments: None  # type: ignore[method-assign, assignment]
    os._exit(main([*RUN, str(out)]))


def written(out: Path) -> dict[str, bytes]:
    """The data of a command that came to verdicts: levels as coarse as these do not carry every one of them."""
    assert (out / "data" / "claims.csv").exists()
    return {str(path.relative_to(out)): path.read_bytes() for path in out.glob("data/**/*") if path.is_file()}


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """What an undisturbed run writes, here in this process."""
    out: Path = tmp_path_factory.mktemp("undisturbed")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("study.cli.common.draw_figures", lambda *arguments, **options: [])
        patch.setattr("study.run.plan.Plan.check", lambda *arguments: None)
        assert main([*RUN, str(out)]) in (0, 1)
    return written(out)


def gone(process: psutil.Process) -> bool:
    """Whether a process has ended, its parent having noticed or not."""
    return not process.is_running() or process.status() == psutil.STATUS_ZOMBIE


def results(out: Path) -> dict[Path, int]:
    """The files of finished jobs and when they were written."""
    return {path: path.stat().st_mtime_ns for path in out.glob("data/jobs/*.json")}


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3), ids="seed {}".format)
def test_a_killed_worker_and_a_killed_run_change_no_byte_of_what_the_command_writes_in_the_end(
    seed: int, undisturbed: dict[str, bytes], tmp_path: Path
) -> None:
    """Nothing of the run may live on when it is killed, and what was finished is not done again."""
    total, moment = sum("jobs" in name for name in undisturbed), random.Random(seed)
    kept: dict[Path, int] = {}
    for victim in ("worker", "run", "run"):
        run = started(tmp_path)
        # At least one job more than there are: nothing works before that but imports.
        jobs = len(kept) + 1 + moment.randrange(total // 5)
        while len(results(tmp_path)) < jobs and run.exitcode is None:
            time.sleep(0.005)
        time.sleep(moment.uniform(0, 0.05))
        leader = psutil.Process(run.pid)
        workers = [worker for worker in leader.children(recursive=True) if not gone(worker)]
        assert workers, "the run was over before its moment came"
        if victim == "worker":
            workers[0].send_signal(signal.SIGKILL)
            while len(results(tmp_path)) <= jobs and run.exitcode is None:
                time.sleep(0.005)
        leader.send_signal(signal.SIGKILL)
        run.join()
        deadline = time.monotonic() + 20
        while not all(map(gone, workers)):
            assert time.monotonic() < deadline, [worker for worker in workers if not gone(worker)]
            time.sleep(0.05)
        assert kept.items() <= results(tmp_path).items()
        kept = results(tmp_path)
    last = started(tmp_path)
    last.join()
    assert last.exitcode in (0, 1)
    assert written(tmp_path) == undisturbed
    assert kept.items() <= results(tmp_path).items()

"""Jobs on a Dask cluster: the same files as without, and what a cluster has to be."""

from __future__ import annotations

import os
import socket
import sys
from collections.abc import Iterator

import psutil
import pytest
from distributed import LocalCluster

from study.cli.main import main
from study.ledger.files import UsageError
from study.run.executor import connected, execute, identity
from study.run.fingerprint import versions
from study.run.plan import Job
from study.run.store import Store
from study.statements.prop_5_4 import FirstOrder, RateSetting

MINE = """
from dataclasses import replace
from manufactured import named
mine = replace(named("advance-recede"), name="mine", pace=3)
"""


def dask(workers: int, threads: int = 1) -> LocalCluster:
    """A scheduler on the loopback interface with worker processes, which start in another directory than the runs."""
    return LocalCluster(n_workers=workers, threads_per_worker=threads, dashboard_address=None)


@pytest.fixture(scope="module")
def cluster() -> Iterator[str]:
    """The address of a scheduler with two workers."""
    with dask(2) as started:
        yield started.scheduler_address


def test_a_cluster_is_refused_with_the_mend_where_there_is_none(tmp_path, capsys, monkeypatch) -> None:
    def refusal(address: str) -> str:
        assert main(["run", "--case", "full-contact", "--cluster", address, "--out", str(tmp_path / "r")]) == 2
        assert not (tmp_path / "r").exists()
        return capsys.readouterr().err

    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
        assert f"no Dask scheduler answers at {address}" in refusal(address)
    assert "known schemes" in refusal("http://127.0.0.1:8786")
    assert "missing port" in refusal("nonsense")
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert "pip install '.[study,cluster]' in a clone" in refusal("tcp://127.0.0.1:8786")


def test_a_cluster_without_workers_is_refused_with_how_to_start_some(monkeypatch) -> None:
    monkeypatch.setattr("study.run.executor.PATIENCE", 1)
    with dask(0) as empty:
        told = f"has no workers.*dask worker {empty.scheduler_address} "
        with pytest.raises(UsageError, match=told), connected(empty.scheduler_address, []):
            pass


@pytest.mark.slow
def test_workers_with_several_threads_are_refused() -> None:
    told = "runs 2 threads, expected 1; start it with dask worker"
    with dask(1, threads=2) as started, pytest.raises(UsageError, match=told), connected(started.scheduler_address, []):
        pass


@pytest.mark.slow
def test_two_workers_on_loopback_give_the_same_files_as_processes_byte_for_byte(cluster, tmp_path, monkeypatch) -> None:
    (tmp_path / "mine.py").write_text(MINE)
    monkeypatch.chdir(tmp_path)
    # Figures are drawn here from the data in any case.
    monkeypatch.setattr("study.cli.common.draw_figures", lambda *arguments, **options: [])
    run = ["run", "--case", "mine.py:mine", "--levels", "2", "4", "--jobs", "2"]
    codes = {main([*run, "--out", "processes"]), main([*run, "--out", "cluster", "--cluster", cluster])}
    assert len(codes) == 1
    by_processes, by_cluster = (
        {str(path.relative_to(out)): path.read_bytes() for path in out.rglob("*") if path.is_file()}
        for out in (tmp_path / "processes", tmp_path / "cluster")
    )
    assert "data/jobs/rates__mine__criss-cross__midpoint__00004.json" in by_processes
    assert by_cluster == by_processes


@pytest.mark.slow
def test_a_worker_that_would_compute_something_else_is_refused(cluster, monkeypatch) -> None:
    monkeypatch.setattr("study.run.executor.versions", lambda: {**versions(), "numpy": "another"})
    told = r"the worker tcp://127.* would not compute the same: numpy [\d.]+, here another"
    with pytest.raises(UsageError, match=told), connected(cluster, ["full-contact"]):
        pass


def test_a_case_is_known_by_what_its_file_says_now(tmp_path) -> None:
    """A worker serves many runs, and the file may change between two of them."""
    file = tmp_path / "mine.py"
    file.write_text(MINE)
    before = identity([f"{file}:mine"])
    assert identity([f"{file}:mine"]) == before
    file.write_text(MINE.replace("advance-recede", "travelling-patch"))
    after = identity([f"{file}:mine"])
    assert {key for key in before if before[key] != after[key]} == {f"{file}:mine"}


@pytest.mark.slow
def test_a_killed_worker_of_a_cluster_costs_no_job(cluster, tmp_path) -> None:
    settings = [RateSetting("full-contact", "one-diagonal", 16 + i, "midpoint", 16) for i in range(8)]
    jobs = [Job(FirstOrder(), setting) for setting in settings]
    store = Store(tmp_path)
    with connected(cluster, ["full-contact"]) as pool:
        victim = psutil.Process(pool.executor.submit(os.getpid).result())

        def kill_once(cost: float) -> None:
            if cost and victim.is_running():
                victim.kill()

        execute(jobs, store, pool, kill_once)
    assert not victim.is_running()
    assert all(store.load(job.key, job.fingerprint()) for job in jobs)

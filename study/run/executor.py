"""Run the jobs that the store does not hold, on local processes or on any other executor, within the memory.

The limit is simple: every job states how many bytes it takes at most (``study.statements.shared.estimates``), and a job
starts only if its bytes and those of all running jobs are available. A job that needs more than there is ends the run
before it starts. A worker that is killed all the same costs no other job its result.
"""

from __future__ import annotations

import gc
import multiprocessing
import os
import socket
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from threading import Thread
from typing import Any, ParamSpec, TypeVar

import psutil
from threadpoolctl import threadpool_limits

from study.fem.naming import resolve
from study.ledger.files import JobsError, UsageError
from study.run.fingerprint import code_hash, problem, versions
from study.run.plan import Job
from study.run.store import Store
from study.statements.enclosure import resolve_problem

P = ParamSpec("P")
T = TypeVar("T")
Notify = Callable[[float], None]
"""Called with the cost of each finished job."""
GIB = 2.0**30
CROWDED = 1.0 * GIB
"""A worker that holds more memory after a job collects its cyclic garbage: large arrays may be part of it."""


class Processes(Executor):
    """Worker processes on this machine, as many as ``workers``.

    A standard ``ProcessPoolExecutor`` refuses all work once a worker has been killed; this one starts new workers for
    the next job. When this process ends, however it ends, its workers end, too.
    """

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self._pool = self._start()

    def _start(self) -> ProcessPoolExecutor:
        pool = ProcessPoolExecutor(self.workers, initializer=_end_with_parent)
        # The first submission forks all workers: it has to come before this process has threads that hold locks.
        pool.submit(os.getpid)
        return pool

    def submit(self, function: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Submit a call to the workers, to new ones if one of them was killed."""
        try:
            return self._pool.submit(function, *args, **kwargs)
        except BrokenExecutor:
            self._pool.shutdown()
            self._pool = self._start()
            return self._pool.submit(function, *args, **kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = True) -> None:
        """End the workers and drop all calls that have not begun.

        Without ``cancel_futures``, a standard pool of Python before 3.11.4 waits for ever for cancelled calls
        (python/cpython#94440).
        """
        self._pool.shutdown(wait, cancel_futures=cancel_futures)


def _end_with_parent() -> None:
    """In a worker: end as soon as the parent process has ended."""
    parent = multiprocessing.parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    Thread(target=watch, daemon=True).start()


@dataclass(frozen=True)
class Pool:
    """An executor and its limits.

    Attributes:
        executor: runs the jobs.
        workers: how many jobs run at a time, each with one thread.
        each: bytes that one job may take.
        together: bytes that all running jobs may take.
    """

    executor: Executor
    workers: int
    each: float
    together: float

    @classmethod
    def of(cls, processes: Processes) -> Pool:
        """Return the pool of local processes, which share the memory of this machine."""
        memory = available()
        return cls(processes, processes.workers, memory, memory)


def unfinished(jobs: Sequence[Job], store: Store) -> list[Job]:
    """Return the jobs that the store does not hold, most expensive first."""
    missing = [job for job in jobs if store.load(job.key, job.fingerprint()) is None]
    return sorted(missing, key=lambda job: -job.cost)


def refuse_too_large(jobs: Sequence[Job], pool: Pool) -> None:
    """Refuse jobs that need more memory than there is; UsageError names the largest one."""
    if jobs:
        largest = max(jobs, key=lambda job: job.memory)
        require(largest.key, largest.memory, pool.each)


def execute(jobs: Sequence[Job], store: Store, pool: Pool, notify: Notify) -> None:
    """Run the jobs that the store does not hold, most expensive first, and store each result as its job ends.

    When a worker is killed, nobody can tell which of the running jobs was too much for it. These jobs wait until all
    others have ended; then they run one by one, so that a second death names one job.

    Raises:
        UsageError: a job needs more memory than there is; no job has started.
        JobsError: after all other jobs have ended; names each failed job and its error.
        BrokenExecutor: a worker of a standard pool was killed.
    """
    waiting = unfinished(jobs, store)
    refuse_too_large(waiting, pool)
    notify(sum(job.cost for job in jobs) - sum(job.cost for job in waiting))
    running: dict[Future[Mapping[str, Any]], Job] = {}
    suspects: set[str] = set()
    failures: list[str] = []
    try:
        # Some executors run jobs in threads of this process.
        with threadpool_limits(1):
            while waiting or running:
                for job in startable(waiting, running.values(), suspects, pool):
                    waiting.remove(job)
                    running[pool.executor.submit(run_job, job)] = job
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    job = running.pop(future)
                    killed = not future.cancelled() and isinstance(future.exception(), BrokenExecutor)
                    if killed and job.key not in suspects:
                        suspects.add(job.key)
                        waiting.append(job)
                    else:
                        failures += _finish(job, future, store, notify)
    finally:
        for future in running:
            future.cancel()
    if failures:
        raise JobsError("\n".join([f"{len(failures)} job(s) failed, all other results are stored:", *failures]))


def startable(waiting: Sequence[Job], running: Iterable[Job], suspects: set[str], pool: Pool) -> Iterator[Job]:
    """Yield the jobs that may start now: while workers and memory last, and suspects only alone."""
    started = [*running]
    for job in [*waiting]:
        if started:
            if len(started) >= pool.workers:
                return
            if suspects & {job.key, *(other.key for other in started)}:
                continue
            if sum(other.memory for other in started) + job.memory > pool.together:
                continue
        started.append(job)
        yield job


def run_job(job: Job) -> Mapping[str, Any]:
    """In a worker: run a job with one thread, as the processes share the cores already."""
    try:
        with threadpool_limits(1):
            return job.run()
    finally:
        if psutil.Process().memory_info().rss > CROWDED:
            gc.collect()


def _finish(job: Job, future: Future[Mapping[str, Any]], store: Store, notify: Notify) -> list[str]:
    """Store the result of a job that has ended, or return why it has none."""
    if future.cancelled():
        return [f"{job.key}: its cluster is gone; the same command does it"]
    error = future.exception()
    if error is None:
        store.save(job.key, job.fingerprint(), future.result())
    notify(job.cost)
    if isinstance(error, BrokenExecutor):
        return [
            f"{job.key}: its process was killed twice, the second time while no other job was running: is there less "
            f"memory than the {job.memory / GIB:.1f} GiB it needs? The same command tries again"
        ]
    return [f"{job.key}: {type(error).__name__}: {error}"] if error else []


def require(what: str, need: float, room: float) -> None:
    """Refuse, before time is spent, what needs more bytes than there are.

    Raises:
        UsageError: says what is needed, and what there is.
    """
    if need > room:
        raise UsageError(
            f"{what} needs about {need / GIB:.1f} GiB of memory, {room / GIB:.1f} GiB are available; take coarser "
            "levels with --levels (--level of `study show`), free memory, or take a machine with more"
        )


def available(root: Path = Path("/")) -> float:
    """Return how many bytes can be used without swapping: free on the machine and in all its control groups.

    Linux tells the control groups of this process and their limits in /proc and /sys below ``root``; page cache that
    can be dropped counts as free. Other systems have none.
    """
    return min([float(psutil.virtual_memory().available), *_free_in_control_groups(root)])


def _free_in_control_groups(root: Path) -> Iterator[float]:
    """Yield the free bytes of each control group with a limit, from that of this process up to the topmost."""
    mounted = root / "sys/fs/cgroup"
    for line in _read(root / "proc/self/cgroup").splitlines():
        _, controllers, path = line.split(":", 2)
        if controllers == "":
            top, names = mounted, ("memory.max", "memory.current", "inactive_file")
        elif "memory" in controllers.split(","):
            top, names = mounted / "memory", ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file")
        else:
            continue
        group = top / path.lstrip("/")
        for directory in (group, *(parent for parent in group.parents if parent.is_relative_to(top))):
            limit, used = (_read(directory / name).strip() for name in names[:2])
            statistics = _read(directory / "memory.stat").split()
            droppable = dict(zip(statistics[::2], statistics[1::2], strict=True)).get(names[2], "0")
            if limit.isdigit() and used.isdigit():
                yield float(int(limit) - int(used) + int(droppable))


def _read(path: Path) -> str:
    """Return the text of a file; empty if there is none."""
    return path.read_text() if path.is_file() else ""


# Jobs on more than one machine: the workers of a running Dask cluster.
#
# Functions and results are exchanged as pickles. Whoever reaches the port of the scheduler or of a worker can run any
# code there, and a hostile scheduler can run any code in this process. Dask's TLS certificates, or a network in which
# every machine is trusted, are the only protection.

PATIENCE = 10
"""Seconds within which a scheduler has to answer and to have a worker."""
START = "dask worker {address} --nworkers 2 --nthreads 1"


@contextmanager
def connected(address: str, references: Sequence[str]) -> Iterator[Pool]:
    """Yield the workers of the cluster at an address, once each has shown that it would compute the same.

    Args:
        address: of the scheduler, tcp://HOST:PORT.
        references: the cases of the run; FILE.py:NAME has to be the same file at the same path on every machine.

    Raises:
        UsageError: Dask is not installed, nothing answers at the address, there are no workers, one of them runs
            several threads, or has other versions or cases.
    """
    try:
        from distributed import Client
        from distributed.comm import get_address_host_port
    except ImportError as error:
        raise UsageError(
            f"--cluster needs Dask ({error}): python -m pip install '.[study,cluster]' in a clone of the repository"
        ) from error
    try:
        # A client of Dask waits long for an address where nothing listens; a socket is refused at once.
        socket.create_connection(get_address_host_port(address), PATIENCE).close()
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        raise UsageError(
            f"no Dask scheduler answers at {address} ({error}); give what `dask scheduler` prints, such as "
            "tcp://192.168.0.1:8786"
        ) from error
    with client:
        yield _pool(client, address, references)


def _pool(client: Any, address: str, references: Sequence[str]) -> Pool:
    start = START.format(address=address)
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError as error:
        raise UsageError(f"the cluster at {address} has no workers; start some on every machine: {start}") from error
    workers = client.scheduler_info()["workers"]
    for name, worker in workers.items():
        if worker["nthreads"] != 1:
            raise UsageError(f"the worker {name} runs {worker['nthreads']} threads, expected 1; start it with {start}")
    expected = identity(references)
    try:
        answers = client.run(identity, references)
    except Exception as error:
        # A worker with another version of this package, or without it, may raise anything.
        raise UsageError(f"a worker at {address} cannot run this study ({error}); install it there, too") from error
    for name, theirs in answers.items():
        other = [f"{key} {theirs.get(key)}, here {mine}" for key, mine in expected.items() if theirs.get(key) != mine]
        if other:
            raise UsageError(
                f"the worker {name} would not compute the same: {'; '.join(other)}. Give every machine the same "
                "versions, and the files of your cases at the same paths, and start the workers again"
            )
    each = min(float(worker["memory_limit"] or "inf") for worker in workers.values())
    # Workers that join later have not been compared.
    executor = client.get_executor(pure=False, workers=list(workers), allow_other_workers=False)
    return Pool(executor, len(workers), each, float("inf"))


def identity(references: Sequence[str]) -> dict[str, str]:
    """Return what results depend on: versions, the code, and the problems of the cases as this process knows them."""
    for cached in (resolve, resolve_problem, problem):
        cached.cache_clear()
    problems = {reference: _problem(reference) for reference in references}
    return {**versions(), "study": version("signorini-study"), "code": code_hash(), **problems}


def _problem(reference: str) -> str:
    try:
        return problem(reference)
    except UsageError as error:
        return str(error)

"""Do the jobs of a run that are not done yet, with any executor."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import dataclass
from typing import Any

import psutil
from threadpoolctl import threadpool_limits

from study.ledger.errors import JobsError
from study.run.job import Job
from study.run.processes import Processes
from study.run.resources import GIB, available, require
from study.run.store import Store


@dataclass(frozen=True)
class Pool:
    """Where jobs run.

    Attributes:
        executor: runs them.
        workers: how many run at a time, each with one thread.
        each: bytes that one job may take.
        together: bytes that all running jobs may take.
    """

    executor: Executor
    workers: int
    each: float
    together: float

    @classmethod
    def of(cls, processes: Processes) -> Pool:
        """Processes on this machine share its memory."""
        memory = available()
        return cls(processes, processes.workers, memory, memory)


Notify = Callable[[float], None]
"""Called with the cost of each finished job."""
CROWDED = 1.0 * GIB
"""A process that holds more after a job looks for what nobody refers to any longer."""


def unfinished(jobs: Sequence[Job], store: Store) -> list[Job]:
    """The jobs that the store does not hold, most expensive first."""
    missing = [job for job in jobs if store.load(job.key, job.fingerprint()) is None]
    return sorted(missing, key=lambda job: -job.cost)


def refuse_too_large(jobs: Sequence[Job], pool: Pool) -> None:
    """Refuse, before time is spent, what needs more memory than there is.

    Raises:
        UsageError: names the job that needs most, what it needs and what there is.
    """
    largest = max(jobs, key=lambda job: job.memory, default=None)
    if largest is not None:
        require(largest.key, largest.memory, pool.each)


def execute(jobs: Sequence[Job], store: Store, pool: Pool, notify: Notify) -> None:
    """Do the jobs that the store does not hold, most expensive first, keeping each as it ends.

    A job starts when a worker is free and its memory fits beside that of those running. When a worker is killed, no
    one can tell which of the running jobs was too much for it: they wait for the others to end and are then done
    again one by one, so that a second death has one job to its name.

    Raises:
        UsageError: a job needs more memory than there is; nothing is done.
        JobsError: after all others are done; names each failed job and its error.
        BrokenExecutor: the executor does not survive its workers.
    """
    waiting = unfinished(jobs, store)
    refuse_too_large(waiting, pool)
    notify(sum(job.cost for job in jobs) - sum(job.cost for job in waiting))
    running: dict[Future[Mapping[str, Any]], Job] = {}
    ended: list[tuple[Job, Future[Mapping[str, Any]]]] = []
    suspects: set[str] = set()
    failed: list[str] = []

    def keep() -> None:
        while ended:
            failed.extend(_end(*ended.pop(0), store, notify))

    try:
        # Also here, for executors whose workers are threads of this process.
        with threadpool_limits(1):
            while waiting or running:
                for job in admitted(waiting, [*running.values()], suspects, pool):
                    waiting.remove(job)
                    running[pool.executor.submit(work, job)] = job
                # Only now, so that no worker waits for files to be written.
                keep()
                for future in wait(running, return_when=FIRST_COMPLETED).done:
                    job = running.pop(future)
                    killed = not future.cancelled() and isinstance(future.exception(), BrokenExecutor)
                    if killed and job.key not in suspects:
                        suspects.add(job.key)
                        waiting.append(job)
                    else:
                        ended.append((job, future))
    finally:
        for future in running:
            future.cancel()
        keep()
    if failed:
        raise JobsError("\n".join([f"{len(failed)} job(s) failed, the rest is kept:", *failed]))


def _end(job: Job, future: Future[Mapping[str, Any]], store: Store, notify: Notify) -> list[str]:
    """Keep what a job found, or say why it found nothing."""
    if future.cancelled():
        return [f"{job.key}: its cluster is gone; the same command does it"]
    error = future.exception()
    if error is None:
        store.save(job.key, job.fingerprint(), future.result())
    notify(job.cost)
    return [_failure(job, error)] if error else []


def admitted(waiting: Sequence[Job], running: list[Job], suspects: set[str], pool: Pool) -> Iterator[Job]:
    """The jobs that may start beside those running: while workers and memory last, and suspects alone."""
    running = [*running]
    for job in [*waiting]:
        alone = not running
        if not alone and len(running) >= pool.workers:
            return
        if not alone and suspects and ({job.key, *(other.key for other in running)} & suspects):
            continue
        if alone or sum(other.memory for other in running) + job.memory <= pool.together:
            running.append(job)
            yield job


def _failure(job: Job, error: BaseException) -> str:
    if isinstance(error, BrokenExecutor):
        return (
            f"{job.key}: its process was killed twice, the second time with no other job beside it: is there less "
            f"memory than the {job.memory / GIB:.1f} GiB it needs? The same command tries again"
        )
    return f"{job.key}: {type(error).__name__}: {error}"


def work(job: Job) -> Mapping[str, Any]:
    """Run one job with one thread: the processes share the cores already.

    Arrays in circles of references would stay until many small objects have been made, gigabytes after some hours;
    to look for them takes a quarter of a second.
    """
    try:
        with threadpool_limits(1):
            return job.run()
    finally:
        if psutil.Process().memory_info().rss > CROWDED:
            gc.collect()

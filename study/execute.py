"""Do the jobs of a run that are not done yet, with any executor."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from typing import Any

from threadpoolctl import threadpool_limits

from study.jobs import Job
from study.store import Store


class JobsError(RuntimeError):
    """Some jobs raised; the others are finished and kept."""


Notify = Callable[[float], None]
"""Called with the cost of each finished job."""


def execute(jobs: Sequence[Job], store: Store, executor: Executor, notify: Notify) -> None:
    """Do the jobs that the store does not hold, most expensive first, keeping each as it ends.

    Raises:
        JobsError: after all others are done; names each failed job and its error.
    """
    pending: dict[Future[dict[str, Any]], Job] = {}
    for job in sorted(jobs, key=lambda job: -job.cost):
        if store.load(job.key, job.fingerprint()) is None:
            pending[executor.submit(work, job)] = job
        else:
            notify(job.cost)
    failed = []
    try:
        while pending:
            for future in wait(pending, return_when=FIRST_COMPLETED).done:
                job = pending.pop(future)
                error = future.exception()
                if error is None:
                    store.save(job.key, job.fingerprint(), future.result())
                else:
                    failed.append(f"{job.key}: {type(error).__name__}: {error}")
                notify(job.cost)
    finally:
        for future in pending:
            future.cancel()
    if failed:
        raise JobsError("\n".join([f"{len(failed)} job(s) failed, the rest is kept:", *failed]))


def work(job: Job) -> dict[str, Any]:
    """Run one job with one thread: the processes share the cores already."""
    with threadpool_limits(1):
        return job.run()

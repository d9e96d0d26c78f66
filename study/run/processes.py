"""Worker processes for a run on one machine."""

from __future__ import annotations

import gc
import multiprocessing
import os
from collections.abc import Callable
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor
from threading import Thread
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")
COLLECTED = 20_000
"""New objects after which a worker looks for garbage: with Python's hundreds it takes a twentieth of its time."""


class Processes(Executor):
    """A ``ProcessPoolExecutor`` of so many ``workers`` that outlives them, and that they do not outlive.

    When a worker is killed, the standard pool is broken for good: what was submitted raises ``BrokenExecutor``. Here
    the next submission starts new workers. And when this process is killed itself, its workers end instead of waiting
    for work for ever.
    """

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self._pool = self._started()

    def _started(self) -> ProcessPoolExecutor:
        pool = ProcessPoolExecutor(self.workers, initializer=_begin)
        # Where processes are forked, the first submission forks all: now, before a run has threads with locks.
        pool.submit(os.getpid)
        return pool

    def submit(self, function: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Submit to the workers, to new ones if one of them was killed."""
        try:
            return self._pool.submit(function, *args, **kwargs)
        except BrokenExecutor:
            self._pool.shutdown()
            self._pool = self._started()
            return self._pool.submit(function, *args, **kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = True) -> None:
        """End the workers, and drop by default what nobody waits for any longer.

        Before Python 3.11.4 the standard pool waits for ever for futures that were cancelled (python/cpython#94440).
        """
        self._pool.shutdown(wait, cancel_futures=cancel_futures)


def _begin() -> None:
    """In a worker: watch the process that started it, and leave what is imported out of the search for garbage."""
    gc.freeze()
    gc.set_threshold(COLLECTED)
    parent = multiprocessing.parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    Thread(target=watch, daemon=True).start()

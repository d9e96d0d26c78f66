"""Runs jobs, that is measurements, on local processes or on a Dask cluster, within the available memory.

Jobs whose results are stored are not run again. The largest memory of each job is estimated
(``study.statements.shared.estimates``). A job starts only if there is enough memory for it and for all running jobs. If
a job needs more memory than is available, the run is refused before it starts. A worker process may be killed
nevertheless, for example by the system because memory runs out. Then the results of all other jobs are kept.
"""

from __future__ import annotations

import gc
import logging
import os
import re
import socket
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from importlib.metadata import version
from itertools import cycle
from math import inf
from multiprocessing import active_children, parent_process
from pathlib import Path
from signal import SIG_IGN, SIGINT, signal
from threading import Thread
from typing import Any, ParamSpec, TypeVar

import psutil
from threadpoolctl import threadpool_limits

from manufactured.self_proof import Finding, SelfProofError, examine
from study.fem.naming import name_of, raised_at, resolve
from study.ledger.files import JobsError, UsageError
from study.run.fingerprint import ALL_CODE, code_hash, of_solution, problem, versions
from study.run.plan import Job, Jobs, Result
from study.run.store import Store
from study.statements.enclosure import resolve_problem
from study.statements.shared.estimates import bound, require_factorisation

P = ParamSpec("P")
Returned = TypeVar("Returned")
Notify = Callable[[Job], object]
"""Function that shows progress; it is called with each finished job."""
GIB = 2.0**30
SILENCE = 5.0
"""If no job ends within this number of seconds, it is checked whether the executor still works."""
CROWDED = 1.0 * GIB
"""If a worker uses more memory than this after a job, it runs the garbage collector, because large arrays may be kept
alive by reference cycles."""


class Processes(Executor):
    """Worker processes on this machine.

    After a worker was killed, a standard ``ProcessPoolExecutor`` refuses all further work. This class starts new
    workers instead. When the main process ends for any reason, the workers end, too.
    """

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self._pool = self._start()

    def _start(self) -> ProcessPoolExecutor:
        pool = ProcessPoolExecutor(self.workers, initializer=_end_with_parent)
        # The first call forks all workers. Later, this process may have threads with locks, which must not be forked.
        pool.submit(os.getpid)
        return pool

    def submit(self, function: Callable[P, Returned], /, *args: P.args, **kwargs: P.kwargs) -> Future[Returned]:
        """Submit a call to the workers; if a worker was killed, start new ones first."""
        try:
            return self._pool.submit(function, *args, **kwargs)
        except BrokenExecutor:
            self._pool.shutdown()
            self._pool = self._start()
            return self._pool.submit(function, *args, **kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = True) -> None:
        """End the workers and cancel all calls that have not begun.

        Calls are cancelled by default, because a standard pool before Python 3.11.4 may otherwise wait forever
        (python/cpython#94440).
        """
        self._pool.shutdown(wait, cancel_futures=cancel_futures)

    def __exit__(self, kind: type[BaseException] | None, *error: Any) -> None:
        """End the workers. After Ctrl-C they are killed at once, and further Ctrl-C are ignored until they have ended.

        Otherwise the program would wait for all running jobs, although their results are lost.
        """
        if kind is not KeyboardInterrupt:
            return self.shutdown()
        before = signal(SIGINT, SIG_IGN)
        for worker in active_children():
            worker.kill()
        self.shutdown()
        signal(SIGINT, before)
        return None


def _end_with_parent() -> None:
    # Ctrl-C reaches all processes of a terminal. The main process ends the workers.
    signal(SIGINT, SIG_IGN)
    parent = parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    Thread(target=watch, daemon=True).start()


@dataclass(frozen=True)
class Pool:
    """Executors that make measurements (jobs), and the limits on their memory.

    Attributes:
        executors: each runs one job at a time, with one thread. The same executor may occur several times.
        each: memory in bytes that one job may use.
        together: memory in bytes that all running jobs may use together.
        failure: returns why the executors can finish no further job; an empty text if they work.
    """

    executors: Sequence[Executor]
    each: float
    together: float
    failure: Callable[[], str] = str


@contextmanager
def local_pool(workers: int) -> Iterator[Pool]:
    """Start worker processes on this machine, which together may use all its available memory."""
    with ExitStack() as stack:
        executors = [stack.enter_context(Processes(1)) for _ in range(workers)]
        memory = available()
        yield Pool(executors, memory, memory)


def unfinished(jobs: Jobs, store: Store) -> list[Job]:
    """Return the jobs whose results are not stored, the most expensive first."""
    missing = [job for job in jobs if store.load(job.key, job.fingerprint()) is None]
    return sorted(missing, key=lambda job: -job.cost)


def refuse_too_large(jobs: Jobs, pool: Pool) -> None:
    """Raise UsageError if the largest job needs more memory than is available."""
    if jobs:
        largest = max(jobs, key=lambda job: job.memory)
        require(largest.key, largest.memory, pool.each)


def execute(jobs: Jobs, store: Store, pool: Pool, notify: Notify) -> None:
    """Run the jobs whose results are not stored, and store each result when its job ends.

    If a worker is killed, its job may have used too much memory. The job waits until all other jobs have ended, and
    then runs alone. If the worker is killed again, the job is the cause.

    Parameters:
        jobs: the jobs.
        store: contains stored results and receives new ones.
        pool: the executors and their limits.
        notify: called with each job when its result has been stored.

    Raises:
        UsageError: a job needs more memory than is available; no job has started.
        JobsError: some jobs failed. It is raised after all other jobs have ended, and names each failed job and its
            error. Or the executors have failed.
        BrokenExecutor: a worker of an executor other than ``Processes`` was killed.
    """
    waiting = unfinished(jobs, store)
    refuse_too_large(waiting, pool)
    failures: list[str] = []
    # An executor may run jobs in threads of this process, so the limit of one thread per job is set here, too.
    with threadpool_limits(1):
        for job in _run_together(waiting, store, pool, notify, failures):
            if _run_together([job], store, pool, notify, failures):
                failures.append(
                    f"{job.key}: its process was killed twice, the second time while no other job was running: is "
                    f"there less memory than the {job.memory / GIB:.1f} GiB it needs? The same command tries again"
                )
    if failures:
        raise JobsError("\n".join([f"{len(failures)} job(s) failed, all other results are stored:", *failures]))


def _run_together(waiting: list[Job], store: Store, pool: Pool, notify: Notify, failures: list[str]) -> list[Job]:
    """Run jobs, as many at once as memory permits, and store their results.

    Parameters:
        waiting: the jobs, the most expensive first; all are removed from the list.
        store, pool, notify: as for ``execute``.
        failures: receives a message for each job that fails.

    Returns:
        The jobs whose process was killed.
    """
    running: dict[Future[Result], tuple[int, Job]] = {}
    cases: dict[int, str] = {}
    killed = []
    try:
        while waiting or running:
            busy = {number for number, _ in running.values()}
            for number in set(range(len(pool.executors))) - busy:
                occupied = [job for _, job in running.values()]
                job = next_job(waiting, occupied, cases.get(number, ""), pool.together)
                if job is not None:
                    waiting.remove(job)
                    cases[number] = job.case
                    running[pool.executors[number].submit(run_job, job)] = number, job
            ended = wait(running, SILENCE, return_when=FIRST_COMPLETED).done
            if not ended and (failure := pool.failure()):
                running.clear()  # ``cancel`` would wait for the executor
                raise JobsError("\n".join([failure, *failures]))
            for future in ended:
                _, job = running.pop(future)
                if future.cancelled():
                    failures.append(f"{job.key}: its cluster no longer answers; run the same command again")
                elif isinstance(error := future.exception(), BrokenExecutor):
                    killed.append(job)
                elif error:
                    notes = "".join(getattr(error, "__notes__", []))
                    failures.append(f"{job.key}: {type(error).__name__}: {error}{notes}")
                else:
                    store.save(job.key, job.fingerprint(), future.result())
                    notify(job)
    finally:
        for future in running:
            future.cancel()
    return killed


def next_job(waiting: Jobs, running: Jobs, case: str, together: float) -> Job | None:
    """Return the job that an idle worker starts now; None if it must wait.

    Parameters:
        waiting: jobs that have not started, the most expensive first.
        running: the running jobs of all workers.
        case: the case of the last job of the worker. Other jobs of this case are preferred.
        together: memory in bytes that all running jobs may use together.
    """
    room = together - sum(job.memory for job in running)
    fitting = [job for job in waiting if not running or job.memory <= room]
    return max(fitting, key=lambda job: job.case == case, default=None)


def run_job(job: Job) -> Result:
    """Run a job in one thread and return its result; the other cores are used by other worker processes."""
    try:
        with threadpool_limits(1):
            return job.run()
    except Exception as error:
        # The traceback is lost on the way to the main process, but a note is not.
        error.add_note(raised_at(error, Path(job.case.rpartition(":")[0])))
        raise
    finally:
        if psutil.Process().memory_info().rss > CROWDED:
            gc.collect()


def require(what: str, need: float, room: float | None = None) -> None:
    """Raise UsageError if a computation needs more memory than is available.

    Parameters:
        what: the computation in words, for the message.
        need: needed memory in bytes.
        room: available memory in bytes; by default that of this process.
    """
    room = available() if room is None else room
    if need > room:
        raise UsageError(
            f"{what} needs about {need / GIB:.1f} GiB of memory, {room / GIB:.1f} GiB are available; take coarser "
            "levels with --levels (--level of `study show`) or a coarser mesh, fewer refinements with --refine (`study "
            "bound` and `study certify`), free memory, or take a machine with more"
        )


def require_bound(what: str, cells: int, refinements: int) -> None:
    """Raise UsageError if an error bound on a mesh needs more memory than is available, or has too many cells.

    Parameters:
        what: the mesh in words, for the message.
        cells: the number of its cells.
        refinements: how often it is refined for the bound.
    """
    require(what, bound(cells, refinements))
    require_factorisation(cells, refinements)


def available(root: Path = Path("/")) -> float:
    """Return the number of bytes that this process can use without swapping.

    On Linux, control groups may limit the memory of a process, for example in a container. Their limits are read from
    /proc and /sys below ``root``. Page cache that can be dropped counts as free. Other systems have no control groups.
    """
    return min([psutil.virtual_memory().available, *_free_in_control_groups(root)])


def _free_in_control_groups(root: Path) -> Iterator[float]:
    """Yield the free bytes of each control group with a memory limit that contains this process."""
    top = root / "sys/fs/cgroup"
    # The line of the second version of control groups begins with 0 and names no controllers.
    own = re.search(r"^0::/(.*)$", _read(root / "proc/self/cgroup"), re.MULTILINE)
    group = top / own[1] if own else top
    for directory in (group, *(parent for parent in group.parents if parent.is_relative_to(top))):
        limit, used = (_read(directory / name).strip() for name in ("memory.max", "memory.current"))
        droppable = re.search(r"^inactive_file (\d+)$", _read(directory / "memory.stat"), re.MULTILINE)
        if limit.isdigit() and used.isdigit():
            yield int(limit) - int(used) + int(droppable[1] if droppable else 0)


def _read(path: Path) -> str:
    return path.read_text() if path.is_file() else ""


# Self-proofs: before a case is measured, it is tested whether its solution is exact.


def prove(jobs: Iterable[Job], cases: Iterable[str], store: Store, pool: Pool) -> list[str]:
    """Test the solutions of the cases that occur in jobs, unless their proofs are stored.

    Parameters:
        jobs: the jobs.
        cases: the cases whose solutions must be exact: names in the catalogue, or FILE.py:NAME.
        store, pool: contains the stored proofs, and runs the tests.

    Returns:
        The cases whose solutions were tested now. ``save_proofs`` stores their proofs when the result directory is
        locked.

    Raises:
        SelfProofError: a solution violates an equation or a contact condition.
    """
    measured = {job.case for job in jobs}
    needed = [case for case in cases if case in measured and store.load(*_proof(case)) is None]
    futures = [executor.submit(violations, case) for executor, case in zip(cycle(pool.executors), needed, strict=False)]
    for case, future in zip(needed, futures, strict=True):
        if violated := future.result():
            raise SelfProofError(f"case {resolve(case).name}", violated)
    return needed


def violations(case: str) -> list[Finding]:
    """Return the equations and contact conditions that the exact solution of a case violates, in one thread.

    Parameters:
        case: the name of the case in the catalogue, or FILE.py:NAME.
    """
    with threadpool_limits(1):
        return [finding for finding in examine(resolve(case).solution) if not finding.passes]


def save_proofs(cases: Iterable[str], store: Store) -> None:
    """Store that the solutions of some cases violate no equation, so that later runs need not test them again."""
    for case in cases:
        store.save(*_proof(case), {"violated": []})


def _proof(case: str) -> tuple[str, str]:
    """Return the name, without ending, of the file with the self-proof of a case, and the cache key of the proof."""
    return f"proof__{name_of(case)}", of_solution(case)


# Functions that run jobs on several machines: on the workers of a Dask cluster.

CLUSTER_PATIENCE = 10
"""Seconds within which the scheduler of a cluster must answer and have a worker."""
LOST = "no longer answers; finished results are stored, and the same command with a running cluster continues"


@contextmanager
def connected(address: str, references: Sequence[str]) -> Iterator[Pool]:
    """Connect to a Dask cluster and yield a pool of its workers, if each of them would compute the same results.

    Functions and results are exchanged as pickles. Anybody who can reach the port of the scheduler or of a worker can
    run any code there, and a hostile scheduler can run any code in this process. The only protection is Dask's TLS
    certificates, or a network in which every machine is trusted.

    Parameters:
        address: address of the Dask scheduler, tcp://HOST:PORT.
        references: the cases of the run. The file of a case FILE.py:NAME must exist at the same path on every machine.

    Raises:
        UsageError: Dask is not installed, nothing answers at the address, there are no workers, or a worker has several
            threads, other versions or other cases.
        JobsError: the scheduler no longer answers.
    """
    try:
        from distributed import Client
        from distributed.comm import get_address_host_port
    except ImportError as error:
        raise UsageError(
            f"--cluster needs Dask ({error}): python -m pip install '.[study,cluster]' in a clone of the repository"
        ) from error
    try:
        # A socket is opened first. If nothing listens at the address, this fails at once, but a client of Dask would
        # wait for a long time.
        socket.create_connection(get_address_host_port(address), CLUSTER_PATIENCE).close()
        client = Client(address, timeout=CLUSTER_PATIENCE, set_as_default=False)
    except (OSError, ValueError) as error:
        raise UsageError(
            f"no Dask scheduler answers at {address} ({error}); give what `dask scheduler` prints, such as "
            "tcp://192.168.0.1:8786"
        ) from error
    # Dask prints tracebacks when connections are lost. This program says it in a sentence.
    logging.disable()
    try:
        yield _pool(client, address, references)
    except Exception as error:
        # When the scheduler is lost, any call of the client may raise any exception.
        if client.status == "running":
            raise
        raise JobsError(f"the Dask scheduler at {address} {LOST}") from error
    finally:
        client.close(timeout=1)
        logging.disable(0)


def _pool(client: Any, address: str, references: Sequence[str]) -> Pool:
    start = f"dask worker {address} --nworkers 2 --nthreads 1"
    try:
        client.wait_for_workers(1, timeout=CLUSTER_PATIENCE)
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
        # A worker without this package, or with another version, may raise any exception.
        raise UsageError(
            f"a worker at {address} cannot run this study ({error}); install it there, too, with the files of your "
            "cases at the same paths"
        ) from error
    for name, theirs in answers.items():
        other = [f"{key} {theirs.get(key)}, here {mine}" for key, mine in expected.items() if theirs.get(key) != mine]
        if other:
            raise UsageError(
                f"the worker {name} would not compute the same: {'; '.join(other)}. Give every machine the same "
                "versions, and the files of your cases at the same paths, and start the workers again. A case with "
                "functions or classes of your own cannot be compared: run it without --cluster"
            )
    each = min(worker["memory_limit"] or inf for worker in workers.values())
    # Workers that join the cluster later are not used, because it was not checked that they compute the same.
    executor = client.get_executor(pure=False, workers=list(workers), allow_other_workers=False)

    def failure() -> str:
        try:
            present = client.sync(client.scheduler.identity, callback_timeout=CLUSTER_PATIENCE)["workers"]
        except (OSError, RuntimeError, TimeoutError):
            return f"the Dask scheduler at {address} {LOST}"
        return "" if workers.keys() & present.keys() else f"the last worker of the cluster at {address} {LOST}"

    return Pool([executor] * len(workers), each, inf, failure)


def identity(references: Sequence[str]) -> dict[str, str]:
    """Return everything on which results depend: versions of libraries, and hashes of the code and of the cases.

    It is called in this process and in each worker of a cluster, and the answers are compared.

    Parameters:
        references: names of cases, or FILE.py:NAME.
    """
    for cached in (resolve, resolve_problem, problem):
        cached.cache_clear()
    problems = {reference: problem(reference) for reference in references}
    return {**versions(), "study": version("signorini-study"), "code": code_hash(ALL_CODE), **problems}

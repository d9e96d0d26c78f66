"""Jobs on more than one machine: the workers of a running Dask cluster.

Functions and results are exchanged as pickles. Whoever reaches the port of the scheduler or of a worker can run any
code there, and a hostile scheduler can run any code in this process. Dask's TLS certificates, or a network in which
every machine is trusted, are the only protection.
"""

from __future__ import annotations

import socket
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.metadata import version
from typing import Any

from study.fem.naming import resolve
from study.ledger.files import UsageError
from study.run.executor import Pool
from study.run.fingerprint import code_hash, problem, versions
from study.statements.enclosure import resolve_problem

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

"""Stores the results of finished jobs on disk, and locks a result directory while a command works on it.

A job is one measurement of a run. Each job has one small file, which is written completely or not at all. It contains
the version of the format, the name of the job, the cache key of its result, the result and its checksum. If a run is
killed, the results of finished jobs remain, and the same command runs only the other jobs. If a file is damaged or its
cache key differs, the file is ignored and the job runs again.
"""

import os
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from hashlib import sha256
from json import dumps, loads
from pathlib import Path
from typing import Any

import psutil
from filelock import FileLock, Timeout

from study.ledger.files import Json, StoreError, unwritable, write_text

STORE_FORMAT = 2
"""Version of the format of data files. It changes if this program can no longer read older files."""
LARGEST_PROCESS = 2**31 - 1
"""Operating systems number processes with 32-bit integers."""
WRITTEN = ("data", "tables", "figures", "article", "report.html")
"""The files and folders that ``study run`` and the commands for its data write into a result directory."""
OF_A_PROBLEM = (
    "data/jobs/*.json",
    "levels.csv",
    "trajectory-*.npz",
    "adapted-*.npz",
    "adaptive.*",
    "enclosure.*",
    "certificate-*.json.gz",
)
"""Patterns of the files that ``study bound`` and ``study certify`` write for one problem."""


@dataclass(frozen=True)
class Store:
    """A result directory DIR with the data of a run.

    The data are in DIR/data, and the results of single measurements in DIR/data/jobs.

    Attributes:
        directory: DIR.
        written: files and folders in DIR that are written; "." if the whole directory belongs to one command.
    """

    directory: Path
    written: tuple[str, ...] = WRITTEN

    @property
    def data(self) -> Path:
        """The folder with the data files of the run, DIR/data."""
        return self.directory / "data"

    @property
    def lock(self) -> Path:
        """The file that is locked while a command works on the directory."""
        return self.data / ".lock"

    @property
    def marks(self) -> tuple[Path, ...]:
        """Files that show that a command of the study has written into the directory before; one of them is enough."""
        return self.lock, self.data / "provenance.json"

    def path(self, key: str) -> Path:
        """Return the path of the file with the result of a job."""
        return self.data / "jobs" / f"{key}.json"

    def refuse_foreign(self) -> None:
        """Raise StoreError if the directory has files of other programs that might be overwritten."""
        if any(mark.exists() for mark in self.marks):
            return
        for place in self.written:
            written = self.directory / place
            paths = sorted((written, *written.rglob("*")))
            foreign = next((path for path in paths if path.is_file() and not path.name.startswith(".")), None)
            if foreign:
                raise StoreError(
                    f"{foreign} was not written by a study, and might be overwritten: give another directory with "
                    "--out, such as --out build/study"
                )

    def check(self) -> None:
        """Check, before anything is computed, that the directory can be written and has no data of another format.

        Raises:
            StoreError: names the directory or the file, and the remedy.
        """
        self.refuse_foreign()
        probe = self.data / ".writable"
        write_text(probe, "")
        probe.unlink(missing_ok=True)
        provenance = self.data / "provenance.json"
        if provenance.exists():
            require_format(provenance, self.read(provenance))

    @contextmanager
    def locked(self) -> Iterator[None]:
        """Lock the directory against other runs, and remove temporary files of killed runs.

        The operating system releases the lock when this process ends for any reason.

        Raises:
            StoreError: another run works on the directory, or it cannot be written.
        """
        self.refuse_foreign()
        try:
            self.lock.parent.mkdir(parents=True, exist_ok=True)
            # A singleton can be locked twice by one process, as for ``study compare DIR DIR``.
            lock = FileLock(self.lock, timeout=0, is_singleton=True).acquire()
        except Timeout as error:
            raise StoreError(
                f"another run works on {self.directory}: wait until it ends, or give another directory with --out"
            ) from error
        except OSError as error:
            raise unwritable(self.lock, error) from error
        with lock:
            # The name of a temporary file contains the number of its process. If no such process exists, it was killed.
            for part in [part for depth in ("", "*/", "data/*/") for part in self.directory.glob(f"{depth}.*.part")]:
                owner = part.name.split(".")[-2]
                if part.is_file() and owner.isdecimal() and not _is_running(int(owner)):
                    part.unlink(missing_ok=True)
            yield

    def steady(self) -> AbstractContextManager[None]:
        """Return a context within which no other command changes the data of a finished run.

        If the data do not exist, or this user may not write them, they are not locked.

        Raises:
            StoreError: another run works on the directory, or its data can be written but its lock cannot.
        """
        changes = any(os.access(path, os.W_OK) for path in (self.data, self.lock))
        return self.locked() if changes else nullcontext()

    def begin(self, problem: str) -> None:
        """Remove the results of another problem, so that the directory has the results of one problem.

        Parameters:
            problem: a hash of the data of the problem, which is stored for later calls.
        """
        path = self.data / "problem.txt"
        if path.is_file() and path.read_text(encoding="utf-8") != problem:
            for file in [file for pattern in OF_A_PROBLEM for file in self.directory.glob(pattern)]:
                file.unlink()
            print(
                f"study: removed from {self.directory}: results of other data or of Python functions", file=sys.stderr
            )
        write_text(path, problem)

    def save(self, key: str, fingerprint: str, result: Mapping[str, Any]) -> None:
        """Write the result of a finished job into its file.

        Parameters:
            key: name of the job and of the file.
            fingerprint: cache key of the result.
            result: numbers, texts, lists and dictionaries.
        """
        write_text(self.path(key), dumps(_entry(key, fingerprint, result)) + "\n")

    def load(self, key: str, fingerprint: str) -> Json | None:
        """Return the stored result of a job; None if its file is missing or damaged, or has another cache key.

        Raises:
            StoreError: the file has another format, or cannot be read.
        """
        path = self.path(key)
        content = self.read(path)
        if content is None:
            return None
        require_format(path, content)
        result = content.get("result")
        return result if isinstance(result, dict) and content == _entry(key, fingerprint, result) else None

    def cached(self, key: str, fingerprint: str, compute: Callable[[], Json], *files: Path) -> Json:
        """Return the stored result of a job; if it is missing, compute and store it.

        Parameters:
            key, fingerprint: name of the job, and cache key of its result.
            compute: function that returns the result and writes the files.
            files: files that belong to the result. If one is missing, everything is computed again.
        """
        stored = self.load(key, fingerprint) if all(file.is_file() for file in files) else None
        if stored is None:
            # If the next result is interrupted, its files must not be taken for those of an earlier result.
            self.path(key).unlink(missing_ok=True)
            stored = compute()
            self.save(key, fingerprint, stored)
        return stored

    @staticmethod
    def read(path: Path) -> Json | None:
        """Return the JSON object in a file; None if the file is missing or damaged.

        Raises:
            StoreError: the file cannot be read.
        """
        try:
            content = loads(path.read_text(encoding="utf-8"))
        # These errors mean that there is no file, or that it is not JSON or has too many digits or nested brackets.
        except (ValueError, RecursionError, FileNotFoundError, IsADirectoryError, NotADirectoryError):
            return None
        except OSError as error:
            raise StoreError(
                f"cannot read {path}: {error.strerror or error}; make it readable, remove it, or give another "
                "directory with --out"
            ) from error
        return content if isinstance(content, dict) else None


def _is_running(process: int) -> bool:
    return process <= LARGEST_PROCESS and psutil.pid_exists(process)


def _entry(key: str, fingerprint: str, result: Mapping[str, Any]) -> Json:
    """Return the content of the file of a result; its checksum is the same before writing and after reading."""
    checksum = sha256(dumps(result).encode()).hexdigest()
    return dict(format=STORE_FORMAT, key=key, fingerprint=fingerprint, sha256=checksum, result=result)


def require_format(path: Path, content: Json | None) -> None:
    """Raise StoreError if a data file has another version of the format than this program reads."""
    stored = None if content is None else content.get("format")
    if stored != STORE_FORMAT:
        raise StoreError(
            f"{path} holds data of format {stored}, this version reads format {STORE_FORMAT}; "
            "use another directory with --out, or remove this one and run again"
        )

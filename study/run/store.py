"""Finished work on disk: one small file per job, each written whole or not at all.

A job file holds the format number, the job's key, the fingerprint of what it computes, its
result and a checksum of that. A run that is killed keeps every finished job; the same command then
does the rest. What is truncated, altered, or another job's is not believed but computed again.
"""

from __future__ import annotations

import errno
import hashlib
import json
import os
import sys
from collections.abc import Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import psutil

from study.ledger.files import StoreError, unwritable, write_text

if sys.platform != "win32":
    import fcntl

FORMAT = 2
"""Changes whenever older data files can no longer be read as they were meant."""


WRITTEN = ("data", "tables", "figures", "article", "report.html")
"""What a run and the commands that start from it write in their directory."""


@dataclass(frozen=True)
class Store:
    """The data directory of a run, DIR/data, with its jobs in DIR/data/jobs.

    Attributes:
        directory: DIR.
        written: files and folders in it that are written; "." where the whole directory is one command's own.
    """

    directory: Path
    written: tuple[str, ...] = WRITTEN

    @property
    def data(self) -> Path:
        return self.directory / "data"

    @property
    def lock(self) -> Path:
        """The file that is locked while a command works on the directory."""
        return self.data / ".lock"

    @property
    def marks(self) -> tuple[Path, ...]:
        """Files of which one is there where the study has written before."""
        return self.lock, self.data / "provenance.json"

    def path(self, key: str) -> Path:
        return self.data / "jobs" / f"{key}.json"

    def refuse_foreign(self) -> None:
        """Refuse a directory with files of others where this writes: the study's have one of the ``marks``.

        Raises:
            StoreError: names the first foreign file.
        """
        if any(mark.exists() for mark in self.marks):
            return
        for place in self.written:
            found = self.directory / place
            files = [found] if found.is_file() else sorted(path for path in found.rglob("*") if path.is_file())
            foreign = next((path for path in files if not path.name.startswith(".")), None)
            if foreign:
                raise StoreError(
                    f"{foreign} was not written by a study, and might be overwritten: give a directory of its own with "
                    "--out, such as --out build/study"
                )

    def check(self) -> None:
        """Refuse, before anything is computed, a directory that cannot be written or is of another format.

        Raises:
            StoreError: names the directory or the file, and the mend.
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
        """Keep every other run out of the directory, and remove what a killed one left half-written.

        The system releases the lock when this process ends, however it ends, and its child processes do not inherit
        it. Windows has no such locks: two runs on one directory are not noticed there.

        Raises:
            StoreError: another run works on the directory, or it cannot be written.
        """
        self.refuse_foreign()
        try:
            self.lock.parent.mkdir(parents=True, exist_ok=True)
            file = self.lock.open("a")
        except OSError as error:
            raise unwritable(self.lock, error) from error
        with file:
            self._hold(file)
            self._sweep()
            yield

    def _hold(self, file: IO[str]) -> None:
        if sys.platform == "win32":
            return
        try:
            fcntl.lockf(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # A store that removes its lock may have done so since this one opened it: then it holds nothing.
            if not os.path.samestat(os.fstat(file.fileno()), os.stat(self.lock)):
                raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN))
        except OSError as error:
            raise StoreError(
                f"another run works on {self.directory}: wait until it ends, or give another directory with "
                f"--out ({self.lock}: {error.strerror})"
            ) from error

    def steady(self) -> AbstractContextManager[None]:
        """``locked`` for commands that start from the data of a finished run.

        Data that this user may not write, or that are not there, are not locked: his command leaves them as they are.

        Raises:
            StoreError: another run works on the directory, or its data can be written and its lock cannot.
        """
        changes = any(os.access(path, os.W_OK) for path in (self.data, self.lock))
        return self.locked() if changes else nullcontext()

    def _sweep(self) -> None:
        """Remove the temporary files of processes that are gone."""
        for part in [part for depth in ("", "*/", "data/*/") for part in self.directory.glob(f"{depth}.*.part")]:
            owner = part.name.split(".")[-2]
            if owner.isdigit() and not psutil.pid_exists(int(owner)):
                part.unlink(missing_ok=True)

    def save(self, key: str, fingerprint: str, result: Mapping[str, Any]) -> None:
        """Keep the result of a finished job."""
        content = {
            "format": FORMAT,
            "key": key,
            "fingerprint": fingerprint,
            "sha256": _checksum(result),
            "result": result,
        }
        write_text(self.path(key), json.dumps(content, indent=None) + "\n")

    def load(self, key: str, fingerprint: str) -> dict[str, Any] | None:
        """The result of a job, or None if it must be computed: absent, damaged, or of another problem.

        Raises:
            StoreError: the file was written in another format, or may not be read.
        """
        path = self.path(key)
        content = self.read(path)
        if content is None:
            return None
        require_format(path, content)
        result = content.get("result")
        expected = key, fingerprint, _checksum(result)
        if (content.get("key"), content.get("fingerprint"), content.get("sha256")) != expected:
            return None
        return result if isinstance(result, dict) else None

    @staticmethod
    def read(path: Path) -> dict[str, Any] | None:
        """The JSON object in a file; None if there is none, or it is damaged.

        Raises:
            StoreError: the file may not be read.
        """
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
        # No JSON or no UTF-8, numbers of too many digits, brackets nested too deeply; no file.
        except (ValueError, RecursionError, FileNotFoundError, IsADirectoryError, NotADirectoryError):
            return None
        except OSError as error:
            raise StoreError(
                f"cannot read {path}: {error.strerror or error}; make it readable, remove it, or give another "
                "directory with --out"
            ) from error
        return content if isinstance(content, dict) else None


def _checksum(result: object) -> str:
    """SHA-256 of a result as it is written; reading and writing it again gives the same digits."""
    return hashlib.sha256(json.dumps(result).encode()).hexdigest()


def require_format(path: Path, content: dict[str, Any] | None) -> None:
    """Refuse data of another version.

    Raises:
        StoreError: names the file and both format numbers.
    """
    found = None if content is None else content.get("format")
    if found != FORMAT:
        raise StoreError(
            f"{path} holds data of format {found}, this version reads format {FORMAT}; "
            "use another directory with --out, or remove this one and run again"
        )

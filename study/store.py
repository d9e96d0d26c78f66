"""Finished work on disk: one small file per job, each written whole or not at all.

A job file holds the format number, the job's key, the fingerprint of what it computes and its
result. A run that is killed keeps every finished job; the same command then does the rest.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

FORMAT = 1
"""Changes whenever older data files can no longer be read as they were meant."""


class StoreError(ValueError):
    """A data directory cannot be used."""


def write_whole(path: Path, write: Callable[[Path], object]) -> Path:
    """Let ``write`` fill a temporary file beside ``path`` and move it there once it is complete.

    Readers see the old content or the new, never a part.

    Raises:
        StoreError: the directory cannot be written.
    """
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write(part)
        os.replace(part, path)
    except OSError as error:
        raise StoreError(
            f"cannot write {path}: {error.strerror or error}; give a directory you may write with --out"
        ) from error
    finally:
        # The cause of a failure may be that its directory does not exist.
        with suppress(OSError):
            part.unlink()
    return path


def write_text(path: Path, text: str) -> Path:
    """``write_whole`` for text, in UTF-8 with Unix line ends on every system."""
    return write_whole(path, lambda part: part.write_text(text, encoding="utf-8", newline="\n"))


@dataclass(frozen=True)
class Store:
    """The data directory of a run.

    Attributes:
        directory: DIR; jobs live in DIR/data/jobs.
    """

    directory: Path

    @property
    def data(self) -> Path:
        return self.directory / "data"

    def path(self, key: str) -> Path:
        return self.data / "jobs" / f"{key}.json"

    def check(self) -> None:
        """Refuse, before anything is computed, a directory that cannot be written or is of another format.

        Raises:
            StoreError: names the directory or the file, and the mend.
        """
        probe = self.data / ".writable"
        write_text(probe, "")
        probe.unlink()
        provenance = self.data / "provenance.json"
        if provenance.exists():
            require_format(provenance, self.read(provenance))

    def save(self, key: str, fingerprint: str, result: dict[str, Any]) -> None:
        """Keep the result of a finished job."""
        content = {"format": FORMAT, "key": key, "fingerprint": fingerprint, "result": result}
        write_text(self.path(key), json.dumps(content, indent=None) + "\n")

    def load(self, key: str, fingerprint: str) -> dict[str, Any] | None:
        """The result of a job, or None if it must be computed: absent, damaged, or of another problem.

        Raises:
            StoreError: the file was written in another format.
        """
        path = self.path(key)
        if not path.exists():
            return None
        content = self.read(path)
        if content is None:
            return None
        require_format(path, content)
        if content.get("key") != key or content.get("fingerprint") != fingerprint:
            return None
        result = content.get("result")
        return result if isinstance(result, dict) else None

    @staticmethod
    def read(path: Path) -> dict[str, Any] | None:
        """The JSON object in a file; None if it is damaged."""
        try:
            content = json.loads(path.read_text(encoding="utf-8"))
        except (json.JSONDecodeError, UnicodeDecodeError, IsADirectoryError):
            return None
        return content if isinstance(content, dict) else None


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

"""Files that are written whole or not at all."""

from __future__ import annotations

import gzip
import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path


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
        raise unwritable(path, error) from error
    finally:
        # The cause of a failure may be that its directory does not exist.
        with suppress(OSError):
            part.unlink()
    return path


def unwritable(path: Path, error: OSError) -> StoreError:
    return StoreError(f"cannot write {path}: {error.strerror or error}; give a directory you may write with --out")


def write_packed(path: Path, text: str) -> Path:
    """``write_whole`` for text that gzip packs: equal texts are equal files."""
    return write_whole(path, lambda part: part.write_bytes(gzip.compress(text.encode(), 9, mtime=0)))


def write_text(path: Path, text: str) -> Path:
    """``write_whole`` for text, in UTF-8 with Unix line ends on every system."""
    return write_whole(path, lambda part: part.write_text(text, encoding="utf-8", newline="\n"))

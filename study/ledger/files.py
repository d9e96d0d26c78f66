"""Files that are written whole or not at all, and the errors of commands that name the remedy."""

from __future__ import annotations

import errno
import gzip
import os
import shutil
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

FULL = (errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC))
"""Error numbers of a full disk and of a quota that is used up; Windows has no number for quotas."""

BLOCK = 4096
"""A disk with fewer free bytes is full: file systems allocate blocks of this size."""


class UsageError(ValueError):
    """A command cannot use what it was given; says what was expected and how to mend it."""


class JobsError(RuntimeError):
    """Some jobs failed; the results of all other jobs are stored."""


class StoreError(ValueError):
    """A data directory cannot be used."""


def write_whole(path: Path, write: Callable[[Path], object]) -> Path:
    """Let ``write`` fill a temporary file in the same folder, rename it to ``path`` when complete, return the path.

    Readers see the old content or the new, never a part.

    Raises:
        StoreError: the directory cannot be written.
    """
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write(part)
        os.replace(part, path)
    except Exception as error:
        cause = disk_full(error) or _no_room(path) or error
        if not isinstance(cause, OSError):
            raise
        raise unwritable(path, cause) from error
    finally:
        # The directory may not exist, which may be why writing failed.
        with suppress(OSError):
            part.unlink()
    return path


def disk_full(error: BaseException | None) -> OSError | None:
    """Returns the error among an error and its causes that says that the disk or the user's quota is full, or None."""
    seen: set[int] = set()
    while error is not None and id(error) not in seen:
        if isinstance(error, OSError) and error.errno in FULL:
            return error
        seen.add(id(error))
        error = error.__cause__ or error.__context__
    return None


def _no_room(path: Path) -> OSError | None:
    """Return ENOSPC if the disk is full now: programs such as ffmpeg do not say why they failed."""
    with suppress(OSError):
        if shutil.disk_usage(path.parent).free < BLOCK:
            return OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    return None


def unwritable(path: Path, error: OSError) -> StoreError:
    """Return the error for a file that cannot be written, with the reason and the remedy."""
    if error.errno in FULL:
        return StoreError(
            f"cannot write {path}: the disk is full ({error.strerror}); free space there, or give a directory on "
            "another disk with --out"
        )
    return StoreError(f"cannot write {path}: {error.strerror or error}; give a directory you may write with --out")


def write_packed(path: Path, text: str) -> Path:
    """Write text compressed by gzip, whole or not at all; equal texts give equal files."""
    return write_whole(path, lambda part: part.write_bytes(gzip.compress(text.encode(), 9, mtime=0)))


def write_text(path: Path, text: str) -> Path:
    """Write text whole or not at all, in UTF-8 with Unix line ends on every system."""
    return write_whole(path, lambda part: part.write_text(text, encoding="utf-8", newline="\n"))

"""Writes files completely or not at all, and defines the errors that end a command with a message."""

import errno
import gzip
import os
import shutil
import sys
from collections.abc import Callable
from contextlib import suppress
from errno import EACCES, ELOOP, ENOSPC
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, TextIO

Paths = list[Path]
Json = dict[str, Any]
"""An object for a JSON file: name ↦ number, text, array, list or further object."""

FULL = (ENOSPC, getattr(errno, "EDQUOT", ENOSPC))
"""Error numbers of a full disk and of an exhausted quota. Windows has no error number for quotas."""

DISK_BLOCK = 4096
"""A disk with fewer free bytes is regarded as full, because file systems allocate blocks of this size."""


class UsageError(ValueError):
    """Raised if a command cannot use its input; the message says what was expected and how to mend it."""


class JobsError(RuntimeError):
    """Raised if some measurements of a run failed; the results of all others are stored."""


class StoreError(ValueError):
    """Raised if a result directory or a file in it cannot be read or written."""


def write_whole(path: Path, write: Callable[[Path], object]) -> Path:
    """Write a file completely or not at all, and return its path.

    A temporary file in the same folder is written and then renamed, so that other programs see the old or the new
    content, never a part of it. A symbolic link remains, and the file to which it leads is written. A device, a pipe
    and the standard output receive the content themselves.

    Parameters:
        path: the file.
        write: function that writes the content to the path it is given.

    Raises:
        StoreError: the file cannot be written, for example because the disk is full.
    """
    file = Path(os.path.realpath(path))
    part = file.with_name(f".{file.name}.{os.getpid()}.part")
    try:
        if _receives_bytes(path):
            _send(path, write)
            return path
        path.parent.mkdir(parents=True, exist_ok=True)
        if file.is_symlink():
            raise OSError(ELOOP, os.strerror(ELOOP))
        if file.is_file() and not os.access(file, os.W_OK):
            raise OSError(EACCES, os.strerror(EACCES))
        write(part)
        os.replace(part, file)
    except Exception as error:
        cause = disk_full(error) or _no_room(path) or error
        if not isinstance(cause, OSError):
            raise
        raise unwritable(path, cause) from error
    finally:
        # The temporary file may not exist: it was renamed, or its directory could not be made.
        with suppress(OSError):
            part.unlink()
    return path


def _receives_bytes(path: Path) -> bool:
    """Return whether a path leads to a device, a pipe, a socket or the standard output of this program."""
    if not path.exists():
        return False
    return not (path.is_file() or path.is_dir()) or _output(path) is not None


def _output(path: Path) -> TextIO | None:
    """Return the standard output or the standard error to which a path leads; None if it leads to neither."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):
            if os.path.samestat(os.fstat(stream.fileno()), os.stat(path)):
                return stream
    return None


def _send(path: Path, write: Callable[[Path], object]) -> None:
    """Write the content to a temporary file, as pipes cannot be written at any place, and send it to a path."""
    with TemporaryDirectory() as directory:
        file = Path(directory) / "content"
        write(file)
        content = file.read_bytes()
    if stream := _output(path):
        stream.flush()
        stream.buffer.write(content)
        stream.flush()
    else:
        path.write_bytes(content)


def disk_full(error: BaseException | None) -> OSError | None:
    """Return the error "disk full" or "quota exceeded" from an error and its causes; None if neither is there."""
    seen: set[int] = set()
    while error is not None and id(error) not in seen:
        if isinstance(error, OSError) and error.errno in FULL:
            return error
        seen.add(id(error))
        error = error.__cause__ or error.__context__
    return None


def _no_room(path: Path) -> OSError | None:
    """Return an error if the disk is full, otherwise None.

    Some programs, such as ffmpeg, fail without giving this reason.
    """
    with suppress(OSError):
        if shutil.disk_usage(path.parent).free < DISK_BLOCK:
            return OSError(ENOSPC, os.strerror(ENOSPC))
    return None


def unwritable(path: Path, error: OSError) -> StoreError:
    """Return the StoreError for a file that cannot be written; its message gives the reason and the remedy."""
    if error.errno in FULL:
        return StoreError(
            f"cannot write {path}: the disk is full ({error.strerror}); free space there, or give a directory on "
            "another disk with --out"
        )
    broken = [place for place in path.parents if place.is_symlink() and not place.exists()]
    if broken:
        return StoreError(
            f"cannot write {path}: {broken[0]} is a symbolic link to {os.readlink(broken[0])}, which does not exist; "
            "make what it leads to, or give another directory with --out"
        )
    return StoreError(f"cannot write {path}: {error.strerror or error}; give a directory you may write with --out")


def write_packed(path: Path, text: str) -> Path:
    """Write text compressed by gzip, completely or not at all, and return the path.

    No time is stored in the file, so that equal texts give equal files.
    """
    return write_whole(path, lambda part: part.write_bytes(gzip.compress(text.encode(), 9, mtime=0)))


def write_text(path: Path, text: str) -> Path:
    """Write text in UTF-8 with Unix line ends, completely or not at all, and return the path."""
    return write_whole(path, lambda part: part.write_text(text, encoding="utf-8", newline="\n"))

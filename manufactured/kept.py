"""Text that takes long to make, kept in the cache directory of the user.

A file is named by the hash of what its text was made from and begins with the hash of the text: one that was cut off is
made again. Files are written aside and renamed, so that many processes may write the same one. Where nothing can be
written nothing is kept. It is the user's own directory, not one of results, because the text may be code that is run.
"""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path

CACHE = "SIGNORINI_CACHE"
"""The environment variable with the directory; without it the usual one, and nothing is kept if it is empty."""


def directory() -> Path | None:
    """Where text is kept, None for nowhere."""
    named = os.environ.get(CACHE)
    if named is not None:
        return Path(named) if named else None
    base = os.environ.get("XDG_CACHE_HOME") or os.environ.get("LOCALAPPDATA")
    try:
        return (Path(base) if base else Path.home() / ".cache") / "signorini-study"
    except RuntimeError:  # nobody is at home
        return None


def kept(made_from: str, make: Callable[[], str]) -> str:
    """The text that ``make`` gives, from an earlier time if it was made from the same then."""
    place = directory()
    if place is None:
        return make()
    path = place / _hash(made_from)
    found = _read(path)
    if found is None:
        found = make()
        _write(path, found)
    return found


def _hash(text: str) -> str:
    return sha256(text.encode()).hexdigest()[:32]


def _read(path: Path) -> str | None:
    """The text of a file that is whole."""
    try:
        seal, _, text = path.read_text(encoding="utf-8").partition("\n")
    except (OSError, UnicodeDecodeError):
        return None
    return text if seal == _hash(text) else None


def _write(path: Path, text: str) -> None:
    """Keep a text, or do nothing where that is impossible."""
    aside = None
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        handle, aside = tempfile.mkstemp(dir=path.parent, prefix=".")
        with open(handle, "w", encoding="utf-8") as file:
            file.write(f"{_hash(text)}\n{text}")
        os.replace(aside, path)
    except OSError:
        if aside is not None:
            Path(aside).unlink(missing_ok=True)

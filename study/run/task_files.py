"""Tasks on disk: files of the format ``contact-task`` (docs/reference/tasks.md) and their sums."""

from __future__ import annotations

import hashlib
import json
import lzma
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from study.ledger.files import StoreError, write_text, write_whole
from study.run.store import Store

SUMS = "SHA256SUMS"

DIGITS = 13
"""Decimal digits kept of the largest number of an array, and of its others as many decimal places."""
FINER = {"reference": 14}
"""Digits of that from which distances are measured that may be zero: rounding grows like 1/h in them."""


@dataclass(frozen=True)
class TaskStore(Store):
    """A directory of tasks, which nothing but tasks and their sums is left in: people copy it."""

    written: tuple[str, ...] = (".",)

    @property
    def lock(self) -> Path:
        return self.directory / ".lock"

    @property
    def marks(self) -> tuple[Path, ...]:
        return self.lock, self.directory / SUMS

    @contextmanager
    def locked(self) -> Iterator[None]:
        """``Store.locked``; the lock is removed at the end."""
        with super().locked():
            try:
                yield
            finally:
                # Windows removes no file that is open.
                with suppress(PermissionError):
                    self.lock.unlink(missing_ok=True)


def write_task(directory: Path, data: dict[str, Any]) -> Path:
    """NAME.json.xz, the same bytes for the same data, and its line in SHA256SUMS; both whole or not at all.

    Raises:
        StoreError: the directory cannot be written.
        StoreError: SHA256SUMS has a line that is none.
    """
    scale = "" if data["scale"] == 1 else f"-times-{data['scale']:g}"
    path = directory / f"{data['case']}-{data['family']}-{data['mode']}-{data['level']}{scale}.json.xz"
    packed = lzma.compress(json.dumps(plain(data), separators=(",", ":")).encode())
    sums = _sums(directory / SUMS) | {path.name: hashlib.sha256(packed).hexdigest()}
    write_whole(path, lambda part: part.write_bytes(packed))
    write_text(directory / SUMS, "".join(f"{sums[name]}  {name}\n" for name in sorted(sums)))
    return path


def _sums(path: Path) -> dict[str, str]:
    """The sums by the name of their file, as ``sha256sum`` writes them."""
    sums = {}
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines() if path.exists() else [], 1):
        parts = line.split()
        if len(parts) != 2:
            raise StoreError(f"{path}, line {number}: stands {line!r}, expected a sum and a file; remove the line")
        sums[parts[1]] = parts[0]
    return sums


def plain(value: Any, digits: int = DIGITS) -> Any:
    """The same of lists and numbers, floats of an array rounded: an error of 10^−digits of the largest."""
    if isinstance(value, dict):
        return {key: plain(one, FINER.get(key, DIGITS)) for key, one in value.items()}
    if isinstance(value, list):
        return [plain(one, digits) for one in value]
    if not isinstance(value, np.ndarray):
        return value
    largest = abs(value).max(initial=0.0)
    if value.dtype.kind == "f" and 0 < largest < np.inf:
        return np.round(value, digits - int(np.ceil(np.log10(largest)))).tolist()
    return value.tolist()

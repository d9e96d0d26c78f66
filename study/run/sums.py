"""Checksums of the data files that a run writes, kept in its ``provenance.json``: an edit that no relation shows."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from pathlib import Path

from study.ledger.datafiles import DataError, made_by
from study.run.provenance import read_provenance

SUMS = "sha256"
"""The entry of ``provenance.json``: name of a file in ``data`` ↦ SHA-256 of its text."""


def text_sum(path: Path) -> str:
    """Returns the SHA-256 of a text file with Unix line ends, which git may have changed."""
    return hashlib.sha256(path.read_bytes().replace(b"\r\n", b"\n")).hexdigest()


def sums_of(data: Path, paths: Iterable[Path]) -> dict[str, str]:
    """Returns the checksums of some files in a data directory, by their names relative to it."""
    return {path.relative_to(data).as_posix(): text_sum(path) for path in sorted(paths)}


def compare_sums(directory: Path) -> set[Path]:
    """Compares the data files of a run with the checksums in its provenance; returns the files that have one.

    Raises:
        DataError: a file is missing or was changed after the run.
    """
    data = directory / "data"
    recorded: dict[str, str] = read_provenance(directory).get(SUMS, {})
    for name, expected in recorded.items():
        path = data / name
        if not path.is_file() or text_sum(path) != expected:
            what = "was changed after the run that wrote it" if path.is_file() else "is missing"
            raise DataError(f"{path} {what}: restore it, or make it again with `{made_by(directory)}`")
    return {data / name for name in recorded}

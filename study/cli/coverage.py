"""Which files of a result directory ``study check`` compares with something, and which it does not."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from study.ledger.codes import FOLDER, MARCHES
from study.ledger.datafiles import CsvFile
from study.run.collect import data_files

IN_PART = (
    "data/provenance.json",
    "data/controls.csv",
    "data/sensitivity.csv",
    *(f"{folder}/{name}.csv" for folder in (FOLDER, MARCHES) for name in ("classes", "errors")),
)
"""Files of which relations between columns, or the tables made from them, show some edits and not all. The tables of a
run whose provenance has no checksums are among them."""


def files_of(directory: Path) -> Iterator[Path]:
    """The files of a result directory, without hidden files, finished jobs and result directories inside it."""
    inside = (path.parent.parent for path in directory.rglob("data/provenance.json"))
    left_out = {directory / "data" / "jobs", *inside} - {directory}
    for path in sorted(directory.rglob("*")):
        if path.is_file() and not path.name.startswith(".") and not left_out & {*path.parents}:
            yield path


def not_compared(directory: Path, compared: set[Path]) -> tuple[list[Path], list[Path]]:
    """Returns the files that are checked in part, and those that are not checked at all.

    Both are found by looking at what is there, so that a file of a new kind is named without further ado.
    """
    rest = [path for path in files_of(directory) if path not in compared]
    tables = [f"data/{file.name}" for file in data_files() if isinstance(file, CsvFile)]
    in_part = {directory / name for name in (*IN_PART, *tables)}
    return [path for path in rest if path in in_part], [path for path in rest if path not in in_part]


def by_folder(paths: list[Path]) -> str:
    """The names of files, the files of one folder behind its path."""
    folders = dict.fromkeys(path.parent for path in paths)
    names = {folder: " ".join(path.name for path in paths if path.parent == folder) for folder in folders}
    return "; ".join(f"{folder}/: {of}" for folder, of in names.items())

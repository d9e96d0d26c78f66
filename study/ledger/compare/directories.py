"""What differs between two result directories, file by file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from study.ledger.compare.closeness import Cell, Tolerance
from study.ledger.compare.differences import TableDifference, compare_tables
from study.ledger.compare.matching import TABLES, kind_of
from study.ledger.compare.picture_files import compare_pictures, read_picture
from study.ledger.compare.reading import COMMANDS, read_bytes, read_table
from study.ledger.datafiles import DataError

IDENTICAL, WITHIN, DIFFERS, LEFT_OUT = "identical", "within", "differs", "left out"
"""Equal to the byte; nothing beyond the tolerance; something; in one directory only, and not by ``study run``."""


@dataclass(frozen=True)
class FileDifference:
    """What differs in one file.

    Attributes:
        name: rates.csv, pictures/corner.json, …
        state: IDENTICAL, WITHIN, DIFFERS or LEFT_OUT.
        only: OLD or NEW if the other directory has no such file, else "".
        command: that writes it, if it is not ``study run``.
        found: what differs in it, if it was read.
    """

    name: str
    state: str
    only: str = ""
    command: str = ""
    found: TableDifference | None = None


@dataclass(frozen=True)
class Comparison:
    """What differs between two result directories."""

    old: Path
    new: Path
    tolerance: Tolerance
    files: tuple[FileDifference, ...]

    @property
    def differs(self) -> bool:
        return any(file.state == DIFFERS for file in self.files)

    @property
    def verdicts(self) -> tuple[Cell, ...]:
        """Every verdict that changed."""
        return tuple(cell for file in self.files if file.found for cell in file.found.verdicts)

    def count(self, state: str) -> int:
        return sum(file.state == state for file in self.files)


def compare(old: Path, new: Path, tolerance: Tolerance) -> Comparison:
    """What differs between the tables and pictures of two result directories.

    Raises:
        DataError: a directory holds no data, or a file is not what ``study run`` writes; names it.
    """
    names = [*dict.fromkeys((*_names(old), *_names(new)))]
    # Tables in the order in which a run makes them, others after them.
    order = {name: place for place, name in enumerate(TABLES)}
    names.sort(key=lambda name: (name.startswith("pictures/"), order.get(name, len(order)), name))
    return Comparison(old, new, tolerance, tuple(_file(old, new, name, tolerance) for name in names))


def _names(directory: Path) -> Iterator[str]:
    """Tables and pictures below DIR/data.

    Raises:
        DataError: there are none.
    """
    data = directory / "data"
    names = [path.relative_to(data).as_posix() for glob in ("*.csv", "pictures/*.json") for path in data.glob(glob)]
    if not names:
        what = f"has no {data.name}/*.csv" if directory.is_dir() else "is not a directory"
        raise DataError(
            f"{directory} {what}, expected a directory of results: give the one that follows --out in `study run`, or "
            f"make it with `study run --out {directory}`"
        )
    yield from names


def _file(old: Path, new: Path, name: str, tolerance: Tolerance) -> FileDifference:
    paths = [directory / "data" / name for directory in (old, new)]
    there = [path.exists() for path in paths]
    if not all(there):
        state = LEFT_OUT if name in COMMANDS else DIFFERS
        return FileDifference(name, state, "OLD" if there[0] else "NEW", COMMANDS.get(name, ""))
    contents = [read_bytes(path) for path in paths]
    if contents[0] == contents[1]:
        return FileDifference(name, IDENTICAL)
    if name.endswith(".csv"):
        first, second = (read_table(*file) for file in zip(paths, contents, strict=True))
        found = compare_tables(kind_of(name, first, second), first, second, tolerance)
    else:
        before, after = (read_picture(*file) for file in zip(paths, contents, strict=True))
        found = compare_pictures(before, after, tolerance)
    return FileDifference(name, DIFFERS if found.differs else WITHIN, found=found)

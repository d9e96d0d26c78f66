"""Differences between two result directories (``study compare``), and between a file and its expected text."""

import csv
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass
from itertools import zip_longest
from json import loads
from math import inf, isclose, isnan
from os.path import commonprefix
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np
import pandas as pd
from pandas import DataFrame, Series

from study.ledger.datafiles import DataError, made_by, read_table, read_uncompressed
from study.ledger.files import Json
from study.ledger.pictures import Packed
from study.ledger.schema import SCHEMA, TEXT_COLUMNS, Table

IDENTICAL = "identical"
WITHIN_TOLERANCE = "within"
DIFFERS = "differs"
LEFT_OUT = "left out"
"""States of a file in two directories. IDENTICAL: the bytes are equal. WITHIN_TOLERANCE: numbers differ within the
tolerance.
DIFFERS: there are larger differences. LEFT_OUT: only one directory has the file, and ``study run`` does not write
it."""
PROSE = ["statement", "quantity", "expected", "summary", "reason", "what", "regularity", "law", "equation"]
"""Columns with text for readers, which are not compared."""
MAGNITUDES = ("displacement_gap", "stress_gap", "displacement_bound", "stress_bound")
"""Columns of ``equivalence.csv`` of which only the order of magnitude is compared: the numbers depend on where an
iteration stops."""
SAME_MAGNITUDE = 0.99
"""Relative tolerance for these columns: a factor of 100. With two tolerances of the solver they differed by at most
this factor."""
CELL_COLUMNS = ["row", "column", "old", "new", "file", "relative"]
WHOLE = r"-?\d+"
"""Matches whole numbers, such as levels."""


@dataclass(frozen=True)
class Tolerance:
    """The tolerance with which numbers are compared.

    Numbers a and b count as equal if |a − b| ≤ absolute + relative · max(|a|, |b|).
    """

    relative: float = 1e-12
    absolute: float = 0.0


@dataclass(frozen=True)
class Comparison:
    """The differences between two result directories.

    Attributes:
        tolerance: the tolerance for numbers.
        states: name of each file in the folders ``data`` ↦ IDENTICAL, WITHIN_TOLERANCE, DIFFERS, or LEFT_OUT for a file
            that only one directory has and that ``study run`` does not write.
        cells: the cells that differ by more than the tolerance, with the columns ``file``, ``row``, ``column``,
            ``old``, ``new`` and ``relative``, the relative difference |a − b| / max(|a|, |b|) of old value a and new
            value b. A cell that only one directory has is empty in the other one.
    """

    tolerance: Tolerance
    states: dict[str, str]
    cells: DataFrame

    @property
    def counts(self) -> dict[str, int]:
        """State (identical, within, differs, left out) ↦ number of files in this state, perhaps 0."""
        count = Counter(self.states.values())
        return {state: count[state] for state in (IDENTICAL, WITHIN_TOLERANCE, DIFFERS, LEFT_OUT)}

    @property
    def differs(self) -> bool:
        """Whether a file differs by more than the tolerance, or is missing although ``study run`` writes it."""
        return DIFFERS in self.states.values()

    @property
    def verdicts(self) -> DataFrame:
        """The rows of ``cells`` with changed verdicts."""
        return self.cells[self.cells.column == "verdict"]

    def as_json(self) -> Json:
        """Return the comparison as a dictionary that can be written as JSON."""
        cells, verdicts = (table.astype(object).where(table.notna(), None) for table in (self.cells, self.verdicts))
        return dict(
            differs=self.differs,
            counts=self.counts,
            tolerance=asdict(self.tolerance),
            verdicts=verdicts.to_dict("records"),
            states=self.states,
            differences=cells.to_dict("records"),
        )


def compare(old: Path, new: Path, tolerance: Tolerance) -> Comparison:
    """Compare two result directories and return the differences.

    Parameters:
        old, new: the directories. Files that are in one of them only are differences.
        tolerance: the differences of numbers that are accepted.

    Raises:
        DataError: a directory has no data, or a file is damaged.
    """
    old_files = _files(old)
    new_files = _files(new)
    states: dict[str, str] = {}
    tables = [DataFrame(columns=CELL_COLUMNS)]
    for name in sorted(old_files | new_files, key=lambda name: ("/" in name, name)):
        if name not in old_files or name not in new_files:
            states[name] = LEFT_OUT if name in SCHEMA and SCHEMA[name].command else DIFFERS
            continue
        old_content = _content(old, old_files[name])
        new_content = _content(new, new_files[name])
        # Two truncated files may be equal. They have no line end at their end, and reading them raises an error.
        if old_content == new_content and old_content.endswith(b"\n"):
            states[name] = IDENTICAL
            continue
        cells = _changed(_cells(old, name, old_content), _cells(new, name, new_content), name, tolerance)
        states[name] = DIFFERS if len(cells) else WITHIN_TOLERANCE
        tables.append(cells)
    return Comparison(tolerance, states, pd.concat(tables))


def _files(directory: Path) -> dict[str, Path]:
    """Return name in the folder ``data``, without ``.gz`` ↦ path, for all tables and pictures of a run."""
    data = directory / "data"
    paths = [*data.glob("*.csv"), *data.glob("pictures/*.json.gz")]
    if not paths:
        raise DataError(f"{directory} has no data/*.csv, expected the directory that follows --out in `study run`")
    return {path.relative_to(data).as_posix().removesuffix(".gz"): path for path in paths}


def _content(directory: Path, path: Path) -> bytes:
    """Return the uncompressed content of a data file; raise DataError if it cannot be read or is damaged."""
    try:
        return read_uncompressed(path)
    except OSError as error:
        raise DataError(f"cannot read {path}: {error.strerror}; make it readable") from error
    except ValueError as error:
        raise DataError(f"{path} is damaged ({error}): make it again with `{made_by(directory)}`") from error


def _cells(directory: Path, name: str, content: bytes) -> Series:
    """Return the cells of a data file as texts, with their rows and columns as index.

    A row is named by its key, with a number if the key is repeated. In a picture, rows are the places in the file.
    """
    if not name.endswith(".csv"):
        try:
            return Series({(place, "value"): str(value) for place, value in _places(loads(content), "")})
        # The file is not JSON in UTF-8, has too many nested brackets, or its packed numbers are damaged.
        except (ValueError, RecursionError, KeyError, TypeError) as error:
            again = f"make it again with `{made_by(directory)}`"
            raise DataError(f"{directory}/data/{name}.gz is not a picture ({error}): {again}") from error
    known = SCHEMA.get(name, Table((), {}))
    # Times in ``enclosures.csv`` may differ by rounding, so these rows are numbered.
    key = [*known.key, *(column for column in known.within if column in TEXT_COLUMNS)]
    table = read_table(directory / "data" / name, key, made_by(directory)).astype(object).fillna("").astype(str)
    names = Series([", ".join(filter(None, cells)) or "row" for cells in table[key].to_numpy()], dtype=str)
    number = names.groupby(names).cumcount() + 1
    rows = table.set_index(names.where(number == 1, names + ", no. " + number.astype(str)))
    return rows.drop(columns=PROSE, errors="ignore").stack()


def _places(value: Any, place: str) -> Iterator[tuple[str, Any]]:
    """Yield all numbers and words in nested JSON data, each with its place, such as ``.frames[3].gap[2]``."""
    if isinstance(value, dict) and value.keys() == {"unit", "shape", "changes"}:
        value = Packed.read(value).values.tolist()
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _places(item, f"{place}.{key}")
    elif isinstance(value, list):
        for number, item in enumerate(value):
            yield from _places(item, f"{place}[{number}]")
    else:
        yield place, value


def _changed(old: Series, new: Series, name: str, tolerance: Tolerance) -> DataFrame:
    """Return the cells that differ, among numbers by more than the tolerance; it does not apply to whole numbers."""
    both = pd.concat([old, new], axis=1, keys=["old", "new"]).rename_axis(["row", "column"]).fillna("")
    both = both[both.old != both.new].reset_index()
    a, b = (pd.to_numeric(both[side], errors="coerce") for side in ("old", "new"))
    larger = np.maximum(abs(a), abs(b))
    difference = abs(a - b)
    loose = both.column.isin(MAGNITUDES) & (name == "equivalence.csv")
    relative = np.where(loose, max(tolerance.relative, SAME_MAGNITUDE), tolerance.relative)
    whole = both.old.str.fullmatch(WHOLE) & both.new.str.fullmatch(WHOLE)
    # An infinite number is equal to no other one: its difference is infinite or no number.
    equal = np.where(whole, difference == 0, (difference <= tolerance.absolute + relative * larger) & (larger < inf))
    return both.assign(file=name, relative=difference / larger)[~equal]


SHOWN_VERDICTS = 20
SHOWN_CELLS = 3
"""Largest numbers of changed verdicts, and of differing cells in a column of a file, that are printed."""


def as_text(comparison: Comparison) -> str:
    """Return a comparison of two result directories as text of 80 columns.

    The text has the changed verdicts, the differences in each file, the largest first, and a summary.
    """
    cells = comparison.cells
    tolerance = comparison.tolerance
    changed = comparison.verdicts
    lines = [f"verdicts: {len(changed) or 'none'} changed", *_listed(changed, SHOWN_VERDICTS), ""]
    for name, state in comparison.states.items():
        if state != IDENTICAL:
            lines.append(f"{name}: {state}")
        for column, differing in cells[cells.file == name].groupby("column", sort=False):
            lines.append(f"  {column}: {len(differing)} beyond tolerance")
            lines += _listed(differing.sort_values("relative", ascending=False, kind="stable"), SHOWN_CELLS)
    identical, within, differ, left_out = comparison.counts.values()
    size = f"{tolerance.relative:g} relative + {tolerance.absolute:g}"
    files = f"{len(comparison.states)} files: {identical} identical, {within} within {size}"
    lines += ["", f"{files}, {differ} differ, {left_out} left out"]
    wrapped = (fill(line, 80, subsequent_indent=" " * 8, break_on_hyphens=False) for line in lines)
    return "\n".join(wrapped).replace("\u00a0", " ")


def _listed(cells: DataFrame, most: int) -> Iterator[str]:
    for cell in cells.head(most).itertuples():
        size = "" if isnan(cell.relative) else f", relative {cell.relative:.1e}"
        # The spaces are non-breaking, so that lines are not wrapped at the arrow.
        yield f"    {cell.row}: {cell.old or 'nothing'}\u00a0→\u00a0{cell.new or 'nothing'}{size}"
    if len(cells) > most:
        yield f"    and {len(cells) - most} more"


ROUNDED_RTOL = 1e-6
"""Relative difference up to which numbers in some columns count as equal. Iterations stop at slightly different values
on different machines."""
SHOWN_TEXT = 60
"""Largest number of characters of a differing text that a message shows."""


def difference(path: Path, expected: str, close: frozenset[str] = frozenset()) -> str | None:
    """Return a message about the first difference between a file and its expected text; None if there is none.

    Parameters:
        path: the file.
        expected: the text that it should contain.
        close: columns of a CSV file whose numbers may differ by rounding.

    Returns:
        A message with line, column, the text in the file and the expected text.
    """
    lines = path.read_text(encoding="utf-8", errors="replace").split("\n")
    wanted_lines = expected.split("\n")
    head = next(csv.reader(wanted_lines)) if path.suffix == ".csv" else []
    for number, pair in enumerate(zip_longest(lines, wanted_lines), start=1):
        rows = (next(csv.reader([line]), []) for line in pair)
        cells = zip_longest(head, *rows) if head and None not in pair else [("", *pair)]
        for name, text, wanted in cells:
            if text != wanted and not (name in close and _near(text, wanted)):
                column = f", column {name}" if name else ""
                return f"{path}, line {number}{column}: found {_shown(text, wanted)}, expected {_shown(wanted, text)}"
    return None


def _near(a: str | None, b: str | None) -> bool:
    with suppress(ValueError):
        return isclose(float(a or "nan"), float(b or "nan"), rel_tol=ROUNDED_RTOL, abs_tol=1e-12)
    return False


def _shown(text: str | None, other: str | None) -> str:
    """Return a text in quotation marks, cut to the part around its first difference from another; None is "nothing"."""
    if text is None:
        return "nothing"
    same = len(commonprefix([text, other or ""]))  # noqa: RUF071 – texts, not paths
    start = max(0, same - SHOWN_TEXT // 2) if len(text) > SHOWN_TEXT else 0
    end = start + SHOWN_TEXT
    return f"{'…' * (start > 0)}{text[start:end]!r}{'…' * (end < len(text))}"

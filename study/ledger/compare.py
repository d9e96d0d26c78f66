"""Differences between two result directories (``study compare``), and between a file and its expected text."""

import csv
import json
import math
import textwrap
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from study.ledger.datafiles import LEDGER, TEXT, DataError, line, made_by, read_csv, read_uncompressed
from study.ledger.pictures import Packed
from study.ledger.verdict import ROW_KEY

IDENTICAL, WITHIN, DIFFERS, LEFT_OUT = "identical", "within", "differs", "left out"
"""States of a file in two directories. IDENTICAL: the bytes are equal. WITHIN: numbers differ within the tolerance.
DIFFERS: there are larger differences. LEFT_OUT: only one directory has the file, and ``study run`` does not write
it."""
PROSE = {"statement", "quantity", "expected", "summary", "reason", "what", "regularity", "law"}
"""Columns with text for readers. A change of such a text is listed, but does not count as a difference of results."""
LATER = ["key", "family", "window_low", "window_high"]
"""Columns that earlier versions of the program did not write. If only one directory has them, results do not differ."""
KEYS = {
    "rates.csv": ("claim", "case", "family", "scheme", "level"),
    "equivalence.csv": ("case", "form", "level", "family"),
    "stresses.csv": ("case", "family", "level"),
    "recomputed.csv": ("case", "family", "scheme", "level"),
    "contact.csv": ("case", "family", "level"),
    "statements.csv": ("label", "case", "family", "level", "quantity"),
    "bounds.csv": ("trajectory", "case", "family", "scheme", "level"),
    "enclosures.csv": ("trajectory", "case", "family", "scheme", "level"),
    "claims.csv": ("label", "case", "quantity"),
    "cases.csv": ("case",),
    "faults.csv": ("fault", "size", "case"),
    "seeds.csv": ("seed",),
}
"""File ↦ the columns that identify a row. In ``enclosures.csv`` and in the files of ``NUMBERS`` several rows may have
the same key; such rows are compared in their order."""
MAGNITUDES = {"equivalence.csv": ("displacement_gap", "stress_gap", "displacement_bound", "stress_bound")}
"""File ↦ columns of which only the order of magnitude is compared: the numbers depend on where an iteration stops."""
SAME_MAGNITUDE = 100.0
"""Numbers of which only the order of magnitude is compared count as equal up to this factor. With two tolerances of the
solver they differed by at most this factor."""
NUMBERS = {"claims.csv": ("observed", "low", "high"), "seeds.csv": ("judged", "alarms")}
"""File ↦ columns of numbers by which a row is found in the other table if the text in its key was changed."""
OF_CONTROLS = "faults.csv", "seeds.csv"
"""Files that other commands than ``study run`` write, so that a result directory may lack them."""
MOST = 2000
"""Largest number of differing cells of a text column that are listed."""


@dataclass(frozen=True)
class Tolerance:
    """The tolerance with which numbers are compared.

    Numbers a and b count as equal if |a − b| ≤ absolute + relative · max(|a|, |b|).
    """

    relative: float = 1e-12
    absolute: float = 0.0

    def equates(self, a: NDArray[Any], b: NDArray[Any]) -> NDArray[Any]:
        """Return for each pair of numbers whether they are equal within the tolerance, as an array of booleans.

        NaN equals NaN, and an infinite number equals itself.
        """
        with np.errstate(all="ignore"):
            near = abs(a - b) <= self.absolute + self.relative * np.maximum(abs(a), abs(b))
        return (a == b) | (np.isnan(a) & np.isnan(b)) | (near & np.isfinite(a) & np.isfinite(b))


@dataclass(frozen=True)
class Difference:
    """The differences in one column of a table, or the rows or columns that only one of two files has.

    Attributes:
        what: name of the column, place in a picture, or a text such as "rows only in OLD".
        compared: number of cells that both files have; 0 for rows or columns that only one file has.
        differing: number of cells that differ.
        beyond: number of differences that count: numbers that differ by more than the tolerance, and texts that differ,
            except in the columns PROSE.
        cells: differing cells as dictionaries with the keys ``row``, ``old``, ``new`` and ``relative``. For text they
            are the first MOST cells, with ``relative`` None. For numbers there is only the cell with the largest
            relative difference |a − b| / max(|a|, |b|); ``relative`` is None if a or b is not finite.
    """

    what: str
    compared: int
    differing: int
    beyond: int
    cells: list[dict[str, Any]]


@dataclass(frozen=True)
class FileDifference:
    """The differences between two versions of one file.

    Attributes:
        name: name of the file in the folder ``data``.
        state: IDENTICAL, WITHIN (the tolerance), DIFFERS or LEFT_OUT (only one directory has the file, because ``study
            run`` does not write it).
        only: OLD or NEW if only this directory has the file.
        differences: the differences. Differences that count come first, larger ones before smaller ones.
    """

    name: str
    state: str
    only: str = ""
    differences: tuple[Difference, ...] = ()


@dataclass(frozen=True)
class Comparison:
    """The differences between two result directories.

    Attributes:
        old, new: the directories.
        tolerance: the tolerance for numbers.
        files: the differences in each file.
    """

    old: Path
    new: Path
    tolerance: Tolerance
    files: tuple[FileDifference, ...]

    @property
    def verdicts(self) -> list[dict[str, Any]]:
        """The checks in all files whose verdict is not the same in the two directories."""
        return [cell for file in self.files for d in file.differences if d.what == "verdict" for cell in d.cells]

    @property
    def states(self) -> dict[str, int]:
        """The number of files in each state: identical, within the tolerance, different, left out."""
        states = [file.state for file in self.files]
        return {state: states.count(state) for state in (IDENTICAL, WITHIN, DIFFERS, LEFT_OUT)}

    @property
    def differs(self) -> bool:
        return self.states[DIFFERS] > 0


def compare(old: Path, new: Path, tolerance: Tolerance) -> Comparison:
    """Compare two result directories and return the differences.

    Raises:
        DataError: a directory has no data, or a file is damaged.
    """
    names: set[str] = set()
    for directory in (old, new):
        data = directory / "data"
        paths = *data.glob("*.csv"), *data.glob("pictures/*.json"), *data.glob("pictures/*.json.gz")
        found = {path.relative_to(data).as_posix().removesuffix(".gz") for path in paths}
        if not found:
            raise DataError(f"{directory} has no data/*.csv, expected the directory that follows --out in `study run`")
        names |= found
    ordered = sorted(names, key=lambda name: ("/" in name, name))
    return Comparison(old, new, tolerance, tuple(_file(name, (old, new), tolerance) for name in ordered))


def _file(name: str, directories: Sequence[Path], tolerance: Tolerance) -> FileDifference:
    # Earlier versions did not compress pictures.
    stored = [f"{name}.gz" if (directory / "data" / f"{name}.gz").exists() else name for directory in directories]
    for directory, stored_name, other in zip(directories, stored, ("NEW", "OLD"), strict=True):
        if not (directory / "data" / stored_name).exists():
            return FileDifference(name, LEFT_OUT if name in OF_CONTROLS else DIFFERS, other)
    first, second = map(_content, stored, directories)
    # Two truncated files may be equal. They have no line end at their end, and reading them below raises an error.
    if first == second and first.endswith(b"\n"):
        return FileDifference(name, IDENTICAL)
    csv = name.endswith(".csv")
    read: list[Any] = _tables(name, directories) if csv else [*map(_picture, stored, directories)]
    old, new, *found = read
    for side, mine, other in (("OLD", old, new), ("NEW", new, old)):
        single = pd.Index([*mine]).difference([*other], sort=False)
        found.append(_words(f"{'columns' if csv else 'places'} only in {side}", single.difference(LATER, sort=False)))
        found.append(_words(f"columns that earlier data lack, in {side}", single.intersection(LATER), counts=False))
    rough = MAGNITUDES.get(name, ())
    found += [_column(c, old[c], new[c], tolerance, c in rough) for c in old if c in new and not old[c].equals(new[c])]
    told = sorted((d for d in found if d.differing), key=lambda d: (not d.beyond, -(d.cells[0]["relative"] or np.inf)))
    return FileDifference(name, DIFFERS if any(d.beyond for d in told) else WITHIN, "", tuple(told))


def _tables(name: str, directories: Sequence[Path]) -> list[Any]:
    """Read a table from two directories, and compare which rows it has there.

    A column with a number in it is read as numbers in both tables.

    Returns:
        A list. The first two entries are the tables, with only the rows that both have. Further entries are
        differences: rows that only one table has, and rows whose key was changed but whose numbers are the same.
    """
    key, numbers = KEYS.get(name, ()), NUMBERS.get(name, ())
    tables = [read_csv(directory, name, (*key, *numbers)) for directory in directories]
    columns = tables[0].columns.intersection(tables[1].columns)
    for column in columns:
        values = [pd.to_numeric(table[column], errors="coerce").astype(float) for table in tables]
        words = column in TEXT or all(value.isna().all() for value in values)
        for directory, table, value in zip(directories, tables, values, strict=True):
            wrong = table[column][value.isna() & table[column].notna() & (table[column].astype(str) != "nan")]
            if not words and len(wrong):
                stands, place = wrong.iloc[0], line(int(wrong.index[0]))
                raise _refusal(directory, name, f"has {stands!r} as {column}, expected a number, in line {place}")
            table[column] = table[column].astype(object).where(table[column].notna(), "").map(str) if words else value
    if keyed := name == "claims.csv" and {*ROW_KEY} <= {*columns}:
        key, numbers = ROW_KEY, ()
    for directory, table in zip(directories, tables, strict=True):
        if key and (keyed or name not in (*NUMBERS, "enclosures.csv")) and (twice := table.duplicated([*key])).any():
            raise _refusal(directory, name, f"has the row {_rows(table[twice], key)[0]} twice")
    old, new = (table.set_axis(_rows(table, key)) for table in tables)
    found = []
    if numbers:
        loose = [column for column in (*key, *numbers) if column not in PROSE]
        lost = [mine.loc[mine.index.difference(other.index, sort=False)] for mine, other in ((old, new), (new, old))]
        names = pd.concat([pd.Series(rows.index, _rows(rows, loose)) for rows in lost], axis=1, join="inner")
        new = new.rename(index=dict(zip(names[1], names[0], strict=True)))
        found = [_words("rows with other names but the same numbers", names[0], counts=False)]
    both = old.index.intersection(new.index, sort=False)
    for side, mine in (("OLD", old), ("NEW", new)):
        found.append(_words(f"rows only in {side}", mine.index.difference(both, sort=False)))
    return [old.loc[both], new.loc[both], *found]


def _refusal(directory: Path, name: str, what: str) -> DataError:
    return DataError(f"{directory / 'data' / name} {what}: make it again with `{made_by(directory)}`")


def _rows(table: pd.DataFrame, key: Sequence[str]) -> pd.Index:
    """Return a name for each row of a table; the same row of another version of the table has the same name.

    A name consists of the cells of the key, numbers with nine digits. Equal names are numbered.
    """
    cells = [[v if isinstance(v, str) else f"{v + 0.0:.9g}" for v in table[column]] for column in key]
    joined = [", ".join(filter(None, row)) for row in zip(*cells, strict=True)] if key else ["row"] * len(table)
    names = pd.Series(joined, dtype=str)
    number = names.groupby(names).cumcount() + 1
    return pd.Index(names.where(number == 1, names + ", no. " + number.astype(str)))


def _content(name: str, directory: Path) -> bytes:
    """Return the content of a data file, uncompressed.

    Raises:
        DataError: the file cannot be read or is damaged.
    """
    try:
        return read_uncompressed(directory / "data" / name)
    except OSError as error:
        raise DataError(f"cannot read {error.filename}: {error.strerror}; make it readable") from error
    except ValueError as error:
        raise _refusal(directory, name, f"is damaged ({error})") from error


def _picture(name: str, directory: Path) -> dict[str, pd.Series]:
    try:
        return dict(_places(json.loads(_content(name, directory)), ""))
    # The file is not JSON in UTF-8, has too many nested brackets, or its packed numbers are damaged.
    except (ValueError, RecursionError, KeyError, TypeError) as error:
        raise _refusal(directory, name, f"is not a picture ({error})") from error


def _places(value: Any, place: str) -> Iterator[tuple[str, pd.Series]]:
    """Yield all arrays of numbers or words in nested JSON data, each with its place in the data.

    Parameters:
        value: lists, dictionaries, numbers and words.
        place: the place of ``value`` in the file, such as ``.frames[3]``.

    Yields:
        Place and shape as text, and the values.
    """
    packed = isinstance(value, dict) and value.keys() == {"unit", "shape", "changes"}
    array = np.atleast_1d(Packed.read(value).values if packed else np.array(value, dtype=object))
    if any(isinstance(item, list | dict) for item in array.flat):
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _places(item, f"{place}[{key}]" if isinstance(key, int) else f"{place}.{key}")
    else:
        index = pd.MultiIndex.from_product(map(range, array.shape))
        yield f"{place} {array.shape}", pd.Series(array.ravel(), index).infer_objects()


def _words(what: str, rows: Any, old: Any = "", new: Any = "", compared: int = 0, counts: bool = True) -> Difference:
    cells = pd.DataFrame({"row": [*map(str, rows)], "old": old, "new": new, "relative": None}, dtype=object)
    return Difference(what, compared, len(cells), len(cells) * counts, cells[:MOST].to_dict("records"))


def _column(what: str, old: pd.Series, new: pd.Series, tolerance: Tolerance, rough: bool = False) -> Difference:
    """Return the differences in a column of two tables.

    The tolerance does not apply to texts, nor to whole numbers such as levels.

    Parameters:
        what: name of the column.
        old, new: the cells of the column in both tables, in the same order of rows.
        tolerance: the tolerance for numbers.
        rough: whether only the orders of magnitude of numbers are compared.
    """
    a, b = old.to_numpy(), new.to_numpy()
    if object in (a.dtype, b.dtype):
        a, b = a.astype(str), b.astype(str)
        return _words(what, old.index[a != b], a[a != b], b[a != b], len(a), what not in PROSE)
    a, b = a.astype(float), b.astype(float)
    changed, both = ~Tolerance(0).equates(a, b), np.append(a, b)
    beyond = changed if np.all((both == np.round(both)) | np.isnan(both)) else ~tolerance.equates(a, b)
    if rough:
        small, large = np.minimum(abs(a), abs(b)), np.maximum(abs(a), abs(b))
        beyond &= ~((a * b > 0) & (large <= (1 + 1e-9) * SAME_MAGNITUDE * small))
    with np.errstate(all="ignore"):
        relative = np.nan_to_num(abs(a - b) / np.maximum(abs(a), abs(b)), nan=np.inf, posinf=np.inf)
    i = int(np.argmax(np.where(beyond if beyond.any() else changed, relative, -1)))
    largest = float(relative[i]) if relative[i] < np.inf else None
    cell = {"row": str(old.index[i]), "old": f"{a[i]:.15g}", "new": f"{b[i]:.15g}", "relative": largest}
    return Difference(what, len(a), int(changed.sum()), int(beyond.sum()), [cell])


SHOWN_VERDICTS, SHOWN_ROWS, SHOWN_PLACES = 20, 5, 3
"""Largest numbers of changed verdicts, of rows in only one directory, and of differences in a picture in the report."""


def as_json(found: Comparison) -> dict[str, Any]:
    """Return a comparison of two result directories as a dictionary that can be written as JSON."""
    head = {"differs": found.differs, "states": found.states, "verdicts": found.verdicts}
    return {**head, **asdict(found), "old": str(found.old), "new": str(found.new)}


def as_text(found: Comparison) -> str:
    """Return a comparison of two result directories as text of 80 columns.

    The text has the changed verdicts, a block for each file, and a summary.
    """
    lines = [f"verdicts: {len(found.verdicts) or 'none'} changed", *_listed(found.verdicts, SHOWN_VERDICTS), ""]
    same = [file for file in found.files if file.state == IDENTICAL and "/" in file.name]
    for file in found.files:
        if file not in same:
            lines.append(f"{file.name}: {file.state}" + f", only in {file.only}" * bool(file.only))
        for difference in file.differences[: SHOWN_PLACES if "/" in file.name else None]:
            text = f"{difference.what}: {difference.differing}"
            if difference.compared:
                text += f" of {difference.compared} differ, {difference.beyond} beyond tolerance"
            largest = difference.cells[0]["relative"]
            lines.append(f"  {text}" if largest is None else f"  {text}; largest {largest:.1e}")
            lines += _listed(difference.cells, 1 if difference.compared else SHOWN_ROWS)
    lines += [f"pictures/: {len(same)} {IDENTICAL}"] if same else []
    count, size = found.states, f"{found.tolerance.relative:g} relative + {found.tolerance.absolute:g}"
    told = f"{count[IDENTICAL]} identical, {count[WITHIN]} within {size}, {count[DIFFERS]} differ"
    lines += ["", f"{len(found.files)} files: {told}, {count[LEFT_OUT]} left out"]
    wrapped = (textwrap.fill(line, 80, subsequent_indent=" " * 8, break_on_hyphens=False) for line in lines)
    return "\n".join(wrapped).replace("\u00a0", " ")


def _listed(cells: list[dict[str, Any]], most: int) -> Iterator[str]:
    for cell in cells[:most]:
        # The spaces are non-breaking, so that lines are not wrapped at the arrow.
        change = f": {cell['old'] or 'nothing'}\u00a0→\u00a0{cell['new'] or 'nothing'}"
        yield f"    {cell['row']}" + change * (cell["old"] != cell["new"])
    if len(cells) > most > 1:
        yield f"    and {len(cells) - most} more"


ROUNDED = {name for name in LEDGER if name not in TEXT} - {"expected", "family"}
"""Columns of ``claims.csv`` whose last digits depend on the machine."""
ROUNDED_RTOL = 1e-6
"""Relative difference up to which numbers in these columns count as equal. Iterations stop at slightly different values
on different machines."""
SHOWN_TEXT = 60
"""Largest number of characters of a differing line that a message shows."""


def difference(path: Path, expected: str, close: frozenset[str] = frozenset()) -> str | None:
    """Return a message about the first difference between a file and its expected text; None if there is none.

    Parameters:
        path: the file.
        expected: the text that it should contain.
        close: columns of a CSV file whose numbers may differ by rounding.

    Returns:
        A message with line, column, the text in the file and the expected text.
    """
    text = path.read_text(encoding="utf-8", errors="replace")
    if text == expected:
        return None
    pairs = zip_longest(text.split("\n"), expected.split("\n"))
    head = next(csv.reader([expected.partition("\n")[0]])) if path.suffix == ".csv" else []
    for number, (old, new) in enumerate(pairs, start=1):
        if old != new and (said := _in_line(old, new, head, close)):
            return f"{path}, line {number}{said}"
    return None


def _in_line(old: str | None, new: str | None, head: list[str], close: frozenset[str]) -> str:
    """Return in words how two lines differ; an empty text if they only differ by rounding.

    Parameters:
        old, new: the line in the file and the expected line; None if there is no such line.
        head: names of the columns; empty if the file is not a table.
        close: columns whose numbers may differ by rounding.
    """
    if old is None or new is None:
        return f": found {_shown(old)}, expected {_shown(new)}"
    if not head:
        return f": found {_shown(old, new)}, expected {_shown(new, old)}"
    cells = zip_longest(head, *(next(csv.reader([text]), []) for text in (old, new)))
    for name, a, b in cells:
        if name in close:
            with suppress(ValueError):
                if math.isclose(float(a or "nan"), float(b or "nan"), rel_tol=ROUNDED_RTOL, abs_tol=1e-12):
                    continue
        if a != b:
            return f", column {name}: found {_shown(a, b)}, expected {_shown(b, a)}"
    return ""


def _shown(text: str | None, other: str | None = None) -> str:
    """Return a text in quotation marks for a message, or "nothing" for None.

    A long text is cut to the part around its first difference from the other text.
    """
    if text is None:
        return "nothing"
    place = next((i for i, (a, b) in enumerate(zip(text, other or "", strict=False)) if a != b), 0)
    start = max(0, place - SHOWN_TEXT // 2) if len(text) > SHOWN_TEXT else 0
    part = text[start : start + SHOWN_TEXT]
    return f"{'…' * (start > 0)}{part!r}{'…' * (start + SHOWN_TEXT < len(text))}"

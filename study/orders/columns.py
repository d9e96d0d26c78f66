"""Decides which column of a table has the mesh sizes, which columns have errors, and which columns are left out."""

import math
import re
from collections import Counter
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from .cells import ALONG_SIDES, SIZES, WHOLE, is_missing, role, to_number
from .reading import RawTable, read_tables
from .sequences import SAME_SIZE, Array, OrderError, consecutive_orders

_COUNTED = re.compile(r"(?i)(?:\w+ )?(?:newton|cg|gmres|grid|mesh)")
"""Matches names of whole numbers, such as iterations. A column with such a name has errors if no number is whole."""
GROWING = "growing"
"""Role of a column of whole numbers that do not fall as the mesh gets finer."""


@dataclass(frozen=True)
class Options:
    """The options with which a user describes the columns of a table of errors.

    Attributes:
        dim: dimension of the meshes. It is needed if mesh sizes are given as numbers of all cells or unknowns.
        size: name of the column of mesh sizes.
        ratio: ratio of the mesh sizes in consecutive rows, for tables without a column of sizes.
        columns: names of the columns of errors; by default they are recognised.
        signed: whether numbers may be negative.
    """

    dim: int | None = None
    size: str | None = None
    ratio: float | None = None
    columns: tuple[str, ...] = ()
    signed: bool = False

    def __post_init__(self) -> None:
        if self.dim is not None and not 1 <= self.dim <= 3:
            raise OrderError(f"--dim must be 1, 2 or 3, got {self.dim}")
        if self.ratio is not None and not (math.isfinite(self.ratio) and self.ratio > 0 and self.ratio != 1):
            raise OrderError(f"--ratio must be positive and not 1, got {self.ratio:g}")


@dataclass(frozen=True)
class Series:
    """The mesh sizes and errors of one table, and how the table was read.

    Attributes:
        h: mesh sizes, (levels,).
        errors: name of a column ↦ errors, (levels,).
        size: how the mesh sizes were determined, in words.
        ignored: name of a column that was left out ↦ its role, such as ``order`` or ``other``.
        caption: text above the table.
        form: the form of the table in words, such as ``CSV``.
        label: text that distinguishes several tables. It is ``degree 2``, for example, if a column divides a table into
            cases; otherwise, it is the caption.
    """

    h: list[float]
    errors: dict[str, list[float]]
    size: str
    ignored: dict[str, str]
    caption: str
    form: str
    label: str

    @property
    def recognised(self) -> str:
        """One line about how the table was read: its form, the mesh sizes, the errors and the ignored columns."""
        ignored = f"; ignored: {', '.join(self.ignored)}" if self.ignored else ""
        growing = ",".join(name for name, kind in self.ignored.items() if kind == GROWING)
        if growing:
            ignored += (
                f" (the whole numbers of {growing} do not fall as h falls, so they are taken as numbers of cells, "
                f"iterations or seconds; --columns '{growing}' judges them as errors)"
            )
        return f"read as {self.form}; size: {self.size}; errors: {', '.join(self.errors)}{ignored}"


def read_series(data: bytes | str, options: Options) -> list[Series]:
    """Return the mesh sizes and errors of all tables in a text. Tables without errors are left out.

    Parameters:
        data: the text, or the content of a file.
        options: the user's description of the columns.

    Raises:
        OrderError: there is no table, no mesh size or no errors; the column of mesh sizes is ambiguous; or a cell is
            not a positive number.
    """
    raw = read_tables(data)
    names = list(dict.fromkeys(name for table in raw for name in _distinct(table.names)))
    options = replace(options, columns=_join_names(options.columns, names))
    if unknown := [name for name in options.columns if name not in names]:
        raise OrderError(f"there is no column {', '.join(unknown)}; there are {', '.join(filter(None, names))}")
    tables = [part for table in raw for part in _split_by_case(Columns(table, options))]
    usable = [table for table in tables if table.errors]
    if not usable:
        seen = ", ".join(f"{name} ({kind})" for table in tables[:1] for name, kind in table.roles.items() if name)
        raise OrderError(f"no column of errors among {seen}: name one with --columns")
    found = [table.series() for table in usable]
    if len({series.label for series in found}) < len(found):
        captions = [series.caption.rstrip(": ") for series in found]
        distinct = len(set(captions)) == len(captions)
        labels = captions if distinct else [f"table {k}" for k in range(1, len(found) + 1)]
        found = [replace(series, label=series.label or label) for series, label in zip(found, labels, strict=True)]
    return found


class Columns:
    """The columns of one table, with their meaning.

    Attributes:
        table, options: the table as text, and the user's description of the columns.
        names: names of the columns; repeated names are numbered.
        cells, values, roles: name of a column ↦ its cells as text; its numbers, None for other text; its role.
        numbers: name of a column ↦ its numbers as an array, (rows,), NaN for other text.
        size: name of the column of mesh sizes; None if there is none.
        filled, errors: names of the columns with at least one number, and of the columns of errors.
    """

    def __init__(self, table: RawTable, options: Options) -> None:
        self.table, self.options = table, options
        self.names = _distinct(table.names)
        self.cells = {name: [row[k] for row in table.rows] for k, name in enumerate(self.names)}
        self.values = {name: [to_number(cell) for cell in column] for name, column in self.cells.items()}
        self.numbers = {name: np.array(column, dtype=float) for name, column in self.values.items()}
        self.roles = {name: role(original) for name, original in zip(self.names, table.names, strict=True)}
        for name, original in zip(self.names, table.names, strict=True):
            self.roles[name] = self._role_by_numbers(name, original)
        self.size = self._size_column()
        self.roles |= {name: GROWING for name in self.names if self.roles[name] == "unknown" and self._grows(name)}
        # A column whose name says that it has errors is not left out if all of them are missing.
        self.filled = [
            name
            for name, values in self.values.items()
            if any(
                value is not None and (self.roles[name] == "error" or not is_missing(cell, value))
                for cell, value in zip(self.cells[name], values, strict=True)
            )
        ]
        recognised = [name for name in self.filled if self.roles[name] in ("error", "unknown") and name != self.size]
        self.errors = [name for name in self.names if name in options.columns] if options.columns else recognised

    def _role_by_numbers(self, name: str, original: str) -> str:
        """Return the role of a column, guessed from its name and corrected by its numbers.

        For example, a column of the numbers 1, 2, 3, … only counts rows, so it has no errors.

        Parameters:
            name, original: the name of the column, with a number if the name is repeated, and the name in the table.
        """
        kind, numbers = self.roles[name], self.values[name]
        if kind in ("other", "unknown") and all(ALONG_SIDES.fullmatch(cell.strip()) for cell in self.cells[name]):
            return "count"
        if re.fullmatch(r".+ N", original, re.IGNORECASE) and numbers == self.values[self.names[0]]:
            return "count" if name == self.names[0] else "other"
        if kind == "count" and numbers in _indices(len(numbers)):
            sizes = [other for other in self.names if other != name and self.roles[other] in ("size", "count", "total")]
            return "other" if sizes else kind
        if kind == "order" and re.fullmatch(r"(?i)[pqr]", original.strip(" $")):
            # Orders are missing on the coarsest mesh or nearly equal, and degrees are whole. An error of the pressure p
            # is none of these.
            found, missing = self.numbers[name], np.isnan(self.numbers[name])
            if missing.any() or not (found % 1).any():
                return "unknown" if missing.sum() > 1 and found[0] % 1 > 0 else kind
            return "unknown" if found.max() > 2 * found.min() or found.max() < 0.5 else kind
        if kind == "other" and _COUNTED.fullmatch(original) and (self.numbers[name] % 1 > 0).all():
            return "unknown"
        return kind

    def _grows(self, name: str) -> bool:
        """Return whether a column has whole numbers that do not fall as the mesh gets finer, and that are not all 0.

        Numbers of cells and unknowns, iterations and seconds grow in this way, whatever their name and its language.
        Only numbers without decimal point and exponent count, so that a growing error such as 2.0e+3 is judged.
        """
        values = self.numbers[name]
        if len(values) < 2 or not values.any() or not all(WHOLE.fullmatch(cell.strip()) for cell in self.cells[name]):
            return False
        if self.size is not None:
            sizes, kind = self.numbers[self.size], self.roles[self.size]
            counts = kind in ("count", "total") or (kind not in SIZES and (sizes > 1).all())
            values = values[np.argsort(sizes if counts else -sizes, kind="stable")]
        return bool((np.diff(values) >= 0).all())

    def _size_column(self) -> str | None:
        """Return the name of the column of mesh sizes; None if there is none."""
        if self.options.ratio is not None:
            return None
        wanted = self.options.size
        if wanted is not None:
            same = [name for name in self.names if name == wanted] or [
                name for name in self.names if name.lower() == wanted.lower()
            ]
            if same or ("" in self.names and wanted.lower() in ("h", "n")):
                return same[0] if same else ""
            raise OrderError(f"--in {wanted}: there is no such column; there are {', '.join(filter(None, self.names))}")
        for kind in SIZES:
            found = [name for name in self.names if self.roles[name] == kind and len(set(self.values[name])) > 1]
            # Orders refer to the largest cell of a mesh.
            found.sort(key=lambda name: "min" in name.lower())
            if kind == "size" and len({name.lower() for name in found}) < len(found):
                raise OrderError(f"the sizes may be {' or '.join(found)}: choose one, for example --in {found[0]}")
            if found:
                return found[0]
        if self.names[0] == "" and self.roles[""] == "other" and self.values[""] not in _indices(len(self.values[""])):
            raise OrderError(
                f"the sizes {self.cells[''][0]}, … have no name: give --in n if they count cells per side, "
                "--in h if they are lengths"
            )
        return None

    def series(self) -> Series:
        """Return the mesh sizes and errors of the table, and how it was read.

        Raises:
            OrderError: mesh sizes are unknown or ambiguous, or a cell is not a positive number.
        """
        errors = {name: self._checked(name) for name in self.errors if name != self.size}
        self._refuse_joined_series()
        h, words = self._sizes(errors)
        left = [name for name in self.names if name not in errors and name != self.size]
        ignored = {name or "(no name)": self.roles[name] if name in self.filled else "text" for name in left}
        self._check_sizes(h)
        return Series(h, errors, words, ignored, self.table.caption, self.table.form, self.table.label)

    def _refuse_joined_series(self) -> None:
        """Refuse rows that may belong to several series of meshes.

        A series ends where the printed orders begin again, where sizes or levels jump back, where the word in a column
        changes, and, without a column of sizes, at a blank line or a rule.

        Raises:
            OrderError: a series ends before the last row.
        """
        cells, rows = self.cells, range(1, len(self.table.rows))
        ends: dict[int, str] = {}
        for name in self.names:
            missing = [is_missing(cell, value) for cell, value in zip(cells[name], self.values[name], strict=True)]
            if self.roles[name] == "order" and missing[0]:
                ends |= {k: f"{name} begins again" for k in rows if missing[k] and not missing[k - 1]}
            words = [cell for cell, value in zip(cells[name], self.values[name], strict=True) if value is None]
            spanned = bool(words) and cells[name][0] == words[0] and len(set(words)) > 1
            if spanned and (len(words) < len(cells[name]) or len(set(words)) < len(words)):
                ends |= {k: f"{name} changes" for k in rows if cells[name][k] not in ("", cells[name][k - 1])}
            if self.roles[name] in ("level", *SIZES) or name == self.size:
                ends |= {k: f"{name} jumps back" for k in _jumps_back(self.numbers[name])}
        gaps = np.diff(self.table.lines)
        if self.size is None and gaps.size and gaps.min() < gaps.max():
            ends |= {int(k) + 1: "a blank line or a rule is above it" for k in np.flatnonzero(gaps > gaps.min())}
        if ends:
            k, reason = next(iter(ends.items()))
            raise OrderError(
                f"line {self.table.lines[k]} may begin another series ({reason}): judge each series in a table of its "
                "own, or sort the rows by size if they are one series"
            )

    def _sizes(self, errors: dict[str, list[float]]) -> tuple[list[float], str]:
        """Return the mesh sizes, and in words how they were determined.

        They come from the ratio that the user gives, from a column, or from orders that are printed in the table.
        """
        rows, ratio = len(self.table.rows), self.options.ratio
        levels = [name for name in self.names if self.roles[name] == "level"]
        if ratio is not None:
            if levels and rows > 1 and (np.diff(self.numbers[levels[0]]) < 0).all():
                return _from_ratio(ratio, rows)[::-1], f"ratio {ratio:g}, finest mesh first as column {levels[0]} says"
            return _from_ratio(ratio, rows), f"ratio {ratio:g}"
        if self.size is not None:
            return self._converted(self.size)
        if levels:
            raise OrderError(
                f"the only size is the level in column {levels[0]}: give --ratio 2 if each level halves the mesh size"
            )
        for ratio in (2.0, math.sqrt(2), 1.5, 3.0, 4.0, 10.0):
            if self._agrees_with_printed_orders(_from_ratio(ratio, rows), errors):
                return _from_ratio(ratio, rows), f"ratio {ratio:g}, which follows from the printed orders"
        raise OrderError(
            f"no column is a mesh size; seen: {', '.join(filter(None, self.names))}. Give --ratio 2 if each mesh is "
            "twice as fine as the one above, or --in NAME for the column of sizes"
        )

    def _converted(self, name: str) -> tuple[list[float], str]:
        """Return the mesh sizes that follow from a column, and in words how they were determined.

        A column of numbers of cells or unknowns is converted to mesh sizes.

        Parameters:
            name: name of the column.
        """
        kind, label, dim = self.roles[name], name or "n", self.options.dim
        if not name:
            kind = "size" if str(self.options.size).lower() == "h" else "count"
        elif kind not in SIZES and all(value and value > 1 and (dim or value % 1 == 0) for value in self.values[name]):
            # In a column with an unknown name, numbers > 1 are taken as numbers of cells if they are whole, or if the
            # user gives the dimension of the meshes.
            kind = "count"
        found = self.numbers[name].tolist()
        if kind not in ("count", "total"):
            return found, f"{'Δt' if kind == 'step' else 'h'} from column {label}"
        if any(value <= 0 for value in found):
            return [math.nan if value <= 0 else 1 / value for value in found], label
        growth = [max(b / a, a / b) for a, b in pairwise(found)]
        if dim is None and (kind == "total" or (growth and min(growth) >= 3.5)):
            raise OrderError(
                f"column {label} is a count: h = 1/{label} if it counts cells along one side (--dim 1), "
                f"h = {label}^(-1/2) if it counts all cells or unknowns in the plane (--dim 2), {label}^(-1/3) in "
                "space (--dim 3); give --dim"
            )
        power = dim or 1
        words = f"h = 1/{label}" if power == 1 else f"h = {label}^(-1/{power})"
        return [value ** (-1 / power) for value in found], f"{words} from column {label}"

    def _agrees_with_printed_orders(self, h: list[float], errors: dict[str, list[float]]) -> bool:
        """Return whether the orders in the table follow from its errors and these mesh sizes."""
        differences = []
        for error, order in pairwise(self.names):
            if error not in errors or self.roles[order] != "order":
                continue
            printed = self.numbers[order][1:]
            used = np.isfinite(printed) & (np.abs(printed) > 0.3)
            difference = np.abs(consecutive_orders(h, errors[error]) - printed) - 0.01 * np.abs(printed)
            differences += difference[used].tolist()
        return bool(differences) and max(differences) < 0.02

    def _check_sizes(self, h: list[float]) -> None:
        for k, value in enumerate(h):
            line, cell = self.table.lines[k], self.cells[self.size][k] if self.size is not None else f"{value:g}"
            if not (math.isfinite(value) and value > 0):
                raise OrderError(f"line {line}: {self.size} = {cell}, but sizes must be positive and finite")
        order = np.argsort(h)
        for i, j in pairwise(order):
            if h[j] - h[i] <= SAME_SIZE * h[i]:
                first, second = sorted((i, j))
                cell, lines = self.cells[self.size or ""][second], self.table.lines
                raise OrderError(
                    f"line {lines[second]}: {self.size or 'n'} = {cell} is already in line {lines[first]}, "
                    "expected another size on every mesh: remove one of the rows"
                )

    def _checked(self, name: str) -> list[float]:
        """Return the numbers in a column of errors; NaN for a cell with the text nan.

        Raises:
            OrderError: a cell is empty, negative or no number, or the column has logarithms of errors.
        """
        if re.match(_LOGARITHM, name) and not self.options.signed:
            raise OrderError(f"column {name} holds logarithms: give the mesh sizes and the errors themselves")
        found = []
        for cell, value, line in zip(self.cells[name], self.values[name], self.table.lines, strict=True):
            if value is None or is_missing(cell, value):
                what = f"is '{cell}', not a number" if cell.strip() else "is missing"
                others = ",".join(other for other in self.errors if other != name)
                advice = f", or leave the column out: --columns '{others}'" if 0 < len(others) < 80 else ""
                raise OrderError(
                    f"line {line}: the entry of {name} {what}: write a number there, or delete the line{advice}"
                )
            if value < 0 and not self.options.signed:
                raise OrderError(f"line {line}: {name} = {cell}, but errors must not be negative: give absolute values")
            found.append(value)
        return found


_LOGARITHM = re.compile(r"(?i)[\W_]*(?:log|ln)(?:[\W_]*(?:2|10|e))?(?:[\W_]|$)")


def _jumps_back(sizes: Array) -> list[int]:
    """Return the rows at which sizes begin again, if this divides them into series of two rows or more."""
    steps = np.diff(sizes)
    direction = np.sign(np.median(np.sign(steps)))
    starts = (np.flatnonzero(steps * direction < 0) + 1).tolist()
    lengths = np.diff([0, *starts, len(sizes)])
    return starts if min(lengths) > 1 else []


def _distinct(names: list[str]) -> list[str]:
    """Return distinct names of columns: the number of the column is added to a repeated name."""
    counts = Counter(names)
    return [name if counts[name] == 1 else f"{name} ({k + 1})" for k, name in enumerate(names)]


def _join_names(parts: tuple[str, ...], names: list[str]) -> tuple[str, ...]:
    """Return the names of columns in a list that was split at commas; names that contain a comma are joined again.

    Parameters:
        parts: the parts of the list between commas.
        names: the names of all columns of the table.
    """
    joined, start, known = [], 0, set(names)
    while start < len(parts):
        lengths = range(min(len(parts) - start, 8), 0, -1)
        length = next((k for k in lengths if ",".join(parts[start : start + k]) in known), 1)
        joined.append(",".join(parts[start : start + length]))
        start += length
    return tuple(joined)


def _indices(length: int) -> list[list[float | None]]:
    """Return the lists 0, 1, 2, … and 1, 2, 3, … of the given length."""
    return [[float(k) for k in range(start, start + length)] for start in (0, 1)]


def _from_ratio(ratio: float, rows: int) -> list[float]:
    return [max(ratio, 1 / ratio) ** -k for k in range(rows)]


def _split_by_case(columns: Columns) -> list[Columns]:
    """Divide a table into one table for each case, if the mesh sizes in the whole table are repeated.

    A case is a value of some column, such as the degree of the elements, for which all mesh sizes differ. If there is
    no such column, the table itself is returned in a list.
    """
    table, size, rows = columns.table, columns.size, range(len(columns.table.rows))
    numbers = columns.values.get(size or "", [])
    if size is None or len(set(numbers)) == len(numbers):
        return [columns]
    for name in columns.names:
        cells = columns.cells[name]
        if cells[0] and "" in cells:
            # The name of a case may only stand in its first row, as with \multirow in LaTeX. It is copied to the rest.
            cells = [next(cell for cell in reversed(cells[: k + 1]) if cell) for k in rows]
        groups = {cell: [k for k in rows if cells[k] == cell] for cell in dict.fromkeys(cells)}
        whole = all(value is None or value % 1 == 0 for value in map(to_number, cells))
        candidate = columns.roles[name] in (*SIZES, "level", "other") or whole
        if name == size or columns.roles[name] == "error" or not candidate or not 1 < len(groups) < len(cells):
            continue
        if all(len(group) > 1 and len({numbers[k] for k in group}) == len(group) for group in groups.values()):
            parts = []
            for cell, group in groups.items():
                label, lines = f"{name} {cell}".strip(), [table.lines[k] for k in group]
                parts.append(replace(table, rows=[table.rows[k] for k in group], lines=lines, label=label))
            return [Columns(part, columns.options) for part in parts]
    return [columns]

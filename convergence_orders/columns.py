"""Decides which column of a table has the mesh sizes, which columns have errors, and which rows are one series.

A table is read only if all three are certain. Otherwise, the message says what was understood and which option decides.
"""

import copy
import math
import re
from collections import Counter
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from .cells import (
    ALONG_SIDES,
    MISSING,
    SIZES,
    UNITS,
    WHOLE,
    kind_of,
    number_and_unit,
    role,
    to_number,
    uses_decimal_commas,
)  # fmt: skip
from .orders import SAME_SIZE, STALLED, Array, OrderError, consecutive_orders
from .tables import Table, read_tables

GROWING = "growing"
"""Role of a column of whole numbers that do not fall as the mesh gets finer."""
_STATUS = re.compile(r"(?i)pass(?:ed)?|fail(?:ed)?|ok|true|false|yes|no|converged|done|x|✓|✗|")
_FRACTIONAL = re.compile(r"(?i)(?:\w+ )?(?:newton|cg|gmres|grid|mesh)")
"""Matches names of whole numbers, such as iterations. A column with such a name has errors if no number is whole."""
_LOGARITHM = re.compile(r"(?i)[\W_]*(?:log|ln)(?:[\W_]*(?:2|10|e))?(?:[\W_]|$)")
RATIOS = (2.0, math.sqrt(2), 1.5, 3.0, 4.0, 10.0)
"""Ratios of mesh sizes that may follow from printed orders."""


@dataclass(frozen=True)
class Options:
    """The options with which a user describes the columns of a table of errors.

    Attributes:
        dim: dimension of the meshes. It is needed if mesh sizes are given as numbers of all cells or unknowns.
        size: name of the column of mesh sizes.
        ratio: ratio of the mesh sizes in consecutive rows, for tables without a column of sizes.
        columns: names of the columns of errors, separated by commas; by default they are recognised.
        signed: whether numbers may be negative.
    """

    dim: int | None = None
    size: str | None = None
    ratio: float | None = None
    columns: str = ""
    signed: bool = False

    def __post_init__(self) -> None:
        if self.dim is not None and not 1 <= self.dim <= 3:
            raise OrderError(f"--dim must be 1, 2 or 3, got {self.dim}")
        if self.ratio is not None and not (0 < self.ratio < math.inf and self.ratio != 1):
            raise OrderError(f"--ratio must be positive and not 1, got {self.ratio:g}")


@dataclass(frozen=True)
class Series:
    """The mesh sizes and errors of one series of meshes, and how its table was read.

    Attributes:
        h: mesh sizes, (levels,).
        errors: name of a column ↦ errors, (levels,).
        size: how the mesh sizes were determined, in words.
        ignored: name of a column that was left out ↦ its role, such as ``order`` or ``other``.
        caption: text above the table.
        form: the form of the table in words, such as ``CSV``.
        label: text that distinguishes several series, for example ``degree 2``.
        remarks: name of a column ↦ what contradicts its computed orders.
    """

    h: list[float]
    errors: dict[str, list[float]]
    size: str
    ignored: dict[str, str]
    caption: str
    form: str
    label: str = ""
    remarks: dict[str, str] = field(default_factory=dict)

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
    """Return the mesh sizes and errors of all series in a text. Tables without errors are left out.

    Parameters:
        data: the text, or the content of a file.
        options: the user's description of the columns.

    Raises:
        OrderError: there is no table, no mesh size or no errors; the mesh sizes or the series are ambiguous; or a cell
            is not a positive number.
    """
    return series_of(read_tables(data), options)


@np.errstate(all="ignore")
def series_of(tables: list[Table], options: Options) -> list[Series]:
    """Return the mesh sizes and errors of all series in tables, as ``read_series`` does."""
    every = [Columns(table, options) for table in tables]
    usable = [one for one in every if one.errors]
    if not usable:
        seen = ", ".join(f"{column.name} ({column.role})" for column in every[0].columns if column.name)
        raise OrderError(f"no column of errors among {seen}: name one with --columns")
    confirmed = {one.size.name: dim for one in usable if one.size and (dim := one.confirmed_dim())}
    found = []
    for one in usable:
        one.confirmed = confirmed.get(one.size.name) if one.size else None
        found += one.series()
    if len({series.label for series in found}) < len(found):
        captions = [series.caption.rstrip(": ") for series in found]
        if len(set(captions)) < len(captions):
            captions = [f"series {k} {series.label}".strip() for k, series in enumerate(found, start=1)]
        found = [replace(series, label=label) for series, label in zip(found, captions, strict=True)]
    return found


@dataclass(eq=False)
class Column:
    """A column of a table.

    Attributes:
        name, cells: its name, and its cells as text.
        numbers: its numbers; NaN for text and for missing numbers.
        missing, text: whether each cell has no number, or a text.
        role: what the column contains.
    """

    name: str
    cells: list[str]
    numbers: Array
    missing: Any
    text: Any
    role: str

    def part(self, rows: list[int]) -> "Column":
        """Return the column in some of the rows."""
        cells = [self.cells[k] for k in rows]
        return Column(self.name, cells, self.numbers[rows], self.missing[rows], self.text[rows], self.role)

    @property
    def repeats(self) -> bool:
        """Whether neighbours are equal, but not all."""
        return 1 < len(set(self.cells)) < len(self.cells) and any(one == other for one, other in pairwise(self.cells))


def column_of(name: str, cells: list[str], comma: bool) -> Column:
    """Return a column with its numbers and its role, which follows from its name and is corrected by its numbers.

    Words behind the numbers of a column are units if they are the same or known; otherwise, the column is text.
    """
    kind = role(re.sub(r" \(\d+\)$", "", name))
    missing = np.array([kind_of(cell) == MISSING for cell in cells])
    words = {number_and_unit(cell)[1] for cell, absent in zip(cells, missing, strict=True) if not absent}
    failed = any(re.match("(?i)fail|div|not|no$", word) for word in words)
    unit = (len(words) == 1 and words <= UNITS) or (kind in ("error", *SIZES) and not failed)
    values = [number_and_unit(cell)[0] if unit else to_number(cell) for cell in cells]
    if comma:
        commas = [to_number(cell, decimal_comma=True) if re.search("[.,]", cell) else None for cell in cells]
        values = [value if other is None else other for value, other in zip(values, commas, strict=True)]
    text = np.array([value is None for value in values])
    numbers = np.array(values, dtype=float)
    return Column(name, cells, numbers, missing, text, _role(name, kind, cells, numbers, missing, text))


def _role(name: str, kind: str, cells: list[str], numbers: Array, missing: Any, text: Any) -> str:
    filled = np.flatnonzero(~missing)
    if all(ALONG_SIDES.fullmatch(cell.strip()) for cell in cells):
        return kind if kind in SIZES else "count"
    if not filled.size:
        return kind if kind == "error" else "empty"
    if text[filled].all() or (kind in ("unknown", "other", "degree") and text[filled[0]]):
        return "text"
    whole = not text.any() and not (numbers[filled] % 1).any()
    if kind == "unknown" and whole and role(name.split()[-1]) == "count":
        return "count"
    if re.fullmatch(r"(?i)\W*[pqr]\W*", name) and kind in ("order", "degree"):
        # Orders are missing on the coarsest mesh or nearly equal, and degrees are whole. An error of the pressure p is
        # none of these.
        if filled[0]:
            return "order"
        if whole:
            return "degree"
        # Comparisons with NaN are false.
        return "order" if 0.5 <= numbers.max() <= 2 * numbers.min() else "unknown"
    return "unknown" if kind == "other" and _FRACTIONAL.fullmatch(name) and (numbers % 1 > 0).all() else kind


class Columns:
    """The columns of one table, or of one series of rows in a table.

    Attributes:
        table, options: the table as text, and the user's description of the columns.
        form: the form of the table in words.
        columns, lines: the columns, and the line number of each row.
        size_name, error_names: name of the column of mesh sizes, None if there is none, and of the columns of errors.
        confirmed: dimension of the meshes that printed orders in another table of the same text confirm.
    """

    def __init__(self, table: Table, options: Options) -> None:
        self.table, self.options, self.lines = table, options, table.lines
        self.confirmed: int | None = None
        names = list(table.names)
        for k, name in enumerate(names):
            # Columns of orders need no name. Their first cell is missing.
            if (
                not name
                and k
                and kind_of(table.rows[0][k]) == MISSING
                and any(row[k].strip(" -") for row in table.rows)
            ):
                names[k] = "order of " + names[k - 1].removeprefix("order of ")
        every = [cell for row in table.rows for cell in row]
        comma = uses_decimal_commas(every)
        if comma is None:
            cell = next(cell for cell in every if "," in cell)
            one, other = cell.replace(",", "."), cell.replace(",", "")
            raise OrderError(f"'{cell}' may be {one} or {other}: write it without a comma")
        self.form = table.form + (", decimal commas" if comma else "")
        self.columns = []
        for k, (name, cells) in enumerate(zip(names, zip(*table.rows, strict=True), strict=True)):
            full_name = name if names.count(name) == 1 else f"{name} ({k + 1})"
            if name or any(map(str.strip, cells)):
                self.columns.append(column_of(full_name, list(cells), comma))
        self._leave_out_indices()
        self.size_name = self._size_name()
        self.error_names = self._error_names()

    @property
    def size(self) -> Column | None:
        return next((column for column in self.columns if column.name == self.size_name), None)

    @property
    def errors(self) -> list[Column]:
        return [column for column in self.columns if column.name in self.error_names]

    def _leave_out_indices(self) -> None:
        """Take numbers 0, 1, 2, … or 1, 2, 3, … for no sizes, if there are others."""
        sizes = [column for column in self.columns if column.role in ("size", "count", "total")]
        for column in sizes:
            steps = np.diff(column.numbers)
            if column.role == "count" and len(sizes) > 1 and column.numbers[0] in (0, 1) and (steps == 1).all():
                column.role = "other"

    def _size_name(self) -> str | None:
        """Return the name of the column of mesh sizes; None if there is none."""
        names, wanted = [column.name for column in self.columns], self.options.size
        if self.options.ratio is not None:
            return None
        if wanted is not None:
            same = [name for name in names if name == wanted] or [
                name for name in names if name.lower() == wanted.lower()
            ]
            if not same and not ("" in names and wanted.lower() in ("h", "n")):
                raise OrderError(f"--in {wanted}: there is no such column; there are {', '.join(filter(None, names))}")
            return same[0] if same else ""
        varied = [one for one in self.columns if one.role in SIZES and len(set(one.numbers)) > 1]
        # A size that stays the same from row to row tells series apart, if there is another one.
        moving = [one for one in varied if not one.repeats] or varied
        for kind in SIZES:
            # Orders refer to the largest cell of a mesh.
            found = sorted([one.name for one in moving if one.role == kind], key=lambda name: "min" in name.lower())
            if kind == "size" and len({name.lower() for name in found}) < len(found):
                raise OrderError(f"the sizes may be {' or '.join(found)}: choose one, for example --in {found[0]}")
            if found:
                return found[0]
        return "" if self.table.form.startswith("size: error pairs") else None

    def _error_names(self) -> list[str]:
        """Return the names of the columns of errors, and correct the roles of columns beside them."""
        found: list[Column] = []
        for column in self.columns:
            if column.role not in ("unknown", "error", "other") or column.name == self.size_name:
                continue
            if column.role != "error" and self._tells_apart(column):
                column.role = "degree"
            elif column.role == "unknown" and found and _follows(column, found[-1]):
                column.role = "order"
            elif column.role == "unknown" and self._grows(column):
                column.role = GROWING
            elif column.role != "other":
                found.append(column)
        # All first entries are missing in a table of orders.
        if len(self.lines) > 2 and all(column.missing[0] for column in found):
            found = []
        return self._wanted() or [column.name for column in found]

    def _wanted(self) -> list[str]:
        """Return the columns that the user names as columns of errors; names may contain commas."""
        rest, wanted = self.options.columns, []
        names = sorted(filter(None, (column.name for column in self.columns)), key=len, reverse=True)
        while rest:
            name = next((name for name in names if f"{rest},".startswith(f"{name},")), None)
            if name is None:
                raise OrderError(f"there is no column {rest.partition(',')[0]}; there are {', '.join(sorted(names))}")
            wanted.append(name)
            rest = rest[len(name) + 1 :]
        return wanted

    def _tells_apart(self, column: Column) -> bool:
        """Return whether sizes are repeated, but not within the rows with the same whole number in a column."""
        if self.size is None or column.text.any() or (column.numbers % 1).any():
            return False
        sizes = self.size.numbers.tolist()
        pairs = set(zip(column.cells, sizes, strict=True))
        return len(set(sizes)) < len(sizes) == len(pairs) and min(Counter(column.cells).values()) > 1

    def _grows(self, column: Column) -> bool:
        """Return whether a column has whole numbers that do not fall as the mesh gets finer, and that are not all 0.

        Numbers of cells and unknowns, iterations and seconds grow in this way, whatever their name and its language.
        Only numbers without decimal point and exponent count, so that a growing error such as 2.0e+3 is judged.
        """
        values = column.numbers
        if len(values) < 2 or not values.any() or not all(WHOLE.fullmatch(cell.strip()) for cell in column.cells):
            return False
        if self.size is not None:
            sizes = self.size.numbers
            counts = self.size.role in ("count", "total") or (sizes > 1).all()
            values = values[np.argsort(sizes if counts else -sizes, kind="stable")]
        return bool((np.diff(values) >= 0).all())

    # Series of rows.

    def series(self) -> list[Series]:
        """Return the series of the table.

        A series ends where the word or the degree in a column changes, where printed orders begin again, where sizes
        jump back, and at a blank line or a rule.

        Raises:
            OrderError: mesh sizes are unknown or ambiguous, or a cell is not a positive number.
        """
        for column in self.errors:
            self._check(column)
        labels = self._labels()
        keys = list(zip(*labels.values(), strict=True)) if labels else [()] * len(self.lines)
        found = []
        for key in dict.fromkeys(keys):
            rows = [k for k, other in enumerate(keys) if other == key]
            starts = self._starts(rows)
            label = " ".join(f"{name} {value}".strip() for name, value in zip(labels, key, strict=True))
            for number, (first, stop) in enumerate(pairwise([0, *starts, len(rows)]), start=1):
                part = self._part(rows[first:stop])
                found.append(part.one_series(f"{label} series {number}".strip() if starts else label))
        return found

    def _part(self, rows: list[int]) -> "Columns":
        part = copy.copy(self)
        part.columns = [column.part(rows) for column in self.columns]
        part.lines = [self.lines[k] for k in rows]
        return part

    def one_series(self, label: str) -> Series:
        """Return the only series of the rows, with the given label."""
        h, words = self._sizes()
        if self.size is None:
            self._refuse_two_series()
        errors = {column.name: column.numbers.tolist() for column in self.errors}
        left = {
            column.name or "(no name)": column.role
            for column in self.columns
            if column.name not in (*errors, self.size_name)
        }
        remarks = {column.name: remark for column in self.errors if (remark := self._contradiction(h, column))}
        return Series(h, errors, words, left, self.table.caption, self.form, label, remarks)

    def _refuse_two_series(self) -> None:
        """Refuse rows without sizes if errors that stagnate or grow fall again, or fall much more once.

        Raises:
            OrderError: the rows may belong to several series.
        """
        for column in self.errors:
            orders = consecutive_orders(_from_ratio(2, len(self.lines)), column.numbers)
            for before, order, after, line in zip(orders, orders[1:], orders[2:], self.lines[2:], strict=False):
                if (before <= STALLED < after) or order > max(before, after) + 1:
                    raise OrderError(
                        f"line {line} may begin another series, {column.name} does not fall there as above and below: "
                        "give a column with the mesh sizes or the name of the series"
                    )

    def _labels(self) -> dict[str, list[str]]:
        """Return the columns whose entries tell several series apart; an entry may span the rows below it."""
        labels: dict[str, list[str]] = {}
        names = [column.name for column in self.columns]
        for column in self.columns[: names.index(self.error_names[0])]:
            cells = column.cells
            if column.name != self.size_name and cells[0] and "" in cells:
                cells = [next(cell for cell in cells[k::-1] if cell) for k in range(len(cells))]
                labels |= {column.name: cells} if len(set(cells)) > 1 else {}
        for column in self.columns:
            steady = column.role in ("count", "total") and min(Counter(column.cells).values()) > 1
            steady = steady or (self.size is None and not column.text[0] and column.role != "order")
            words = column.role in ("text", "degree") and 1 < len(set(column.cells)) < len(column.cells)
            if column.name in (self.size_name, *self.error_names, *labels) or "" in column.cells:
                continue
            if (words or (steady and column.repeats)) and not all(map(_STATUS.fullmatch, column.cells)):
                labels[column.name] = column.cells
        return labels

    def _starts(self, rows: list[int]) -> list[int]:
        """Return the places in ``rows`` at which another series begins."""
        breaks = [j for j in range(1, len(rows)) if rows[j] in self.table.breaks]
        # A rule below every row of a table means nothing.
        starts = set(breaks if len(breaks) < len(rows) - 1 else [])
        for column in self.columns:
            missing = column.missing[rows]
            if column.role == "order" and missing[0]:
                starts |= set((np.flatnonzero(missing[1:] & ~missing[:-1]) + 1).tolist())
            if column.role in ("level", *SIZES) or column.name == self.size_name:
                starts |= set(_jumps_back(column.numbers[rows]))
        return sorted(starts)

    # Mesh sizes.

    def _sizes(self) -> tuple[list[float], str]:
        """Return the mesh sizes of a series, and in words how they were determined.

        They come from the ratio that the user gives, from a column, or from orders that are printed in the table.
        """
        ratio, count = self.options.ratio, len(self.lines)
        levels = [column for column in self.columns if column.role == "level"]
        if ratio is not None:
            for column in self.columns:
                steps = np.abs(np.diff(np.log(column.numbers))) if column.role in ("size", "step") else np.array([])
                if steps.size and np.ptp(steps) < 0.1 < abs(steps[0] - abs(math.log(ratio))):
                    raise OrderError(f"--ratio {ratio:g}, but the sizes in column {column.name} have another ratio")
            if levels and count > 1 and (np.diff(levels[0].numbers) < 0).all():
                words = f"ratio {ratio:g}, finest mesh first as column {levels[0].name} says"
                return _from_ratio(ratio, count)[::-1], words
            return _from_ratio(ratio, count), f"ratio {ratio:g}"
        if self.size is not None:
            h, words = self._converted(self.size)
            self._check_sizes(h)
            return h, words
        for ratio in RATIOS:
            if self._agrees(_from_ratio(ratio, count)):
                return _from_ratio(ratio, count), f"ratio {ratio:g}, which follows from the printed orders"
        for column in self.columns:
            if column.role == "degree":
                raise OrderError(f"column {column.name} has degrees: {DEGREES}")
        names = ", ".join(column.name for column in self.columns if column.name)
        seen = f"no column is a mesh size; seen: {names}. Give"
        if levels:
            seen = f"the only size is the level in column {levels[0].name}: give"
        raise OrderError(
            f"{seen} --ratio 2 if each mesh is twice as fine as the one above, or --in NAME for the column of sizes"
        )

    def _converted(self, column: Column) -> tuple[list[float], str]:
        """Return the mesh sizes that follow from a column, and in words how they were determined."""
        kind, name, sizes = column.role, column.name or "n", column.numbers
        dim, wanted = self.options.dim, self.options.size
        whole = bool((sizes > 1).all() and (dim or not (sizes % 1).any()))
        if kind == "degree":
            raise OrderError(f"--in {name}: {DEGREES}")
        if not column.name:
            kind = "size" if str(wanted).lower() == "h" or not (whole or wanted) else "count"
        elif whole and (dim or kind not in SIZES):
            kind = "count"
        if kind not in ("count", "total"):
            falling = [error.name for error in self.errors if (np.diff(error.numbers) < 0).all()]
            if whole and wanted is None and falling and len(sizes) > 1 and (np.diff(sizes) > 0).all():
                raise OrderError(
                    f"the errors {falling[0]} fall as {name} grows: give --dim 1 if {name} counts cells along a side, "
                    f"or --in {name} if its numbers are lengths"
                )
            return sizes.tolist(), f"{'Δt' if kind == 'step' else 'h'} from column {name}"
        if not (sizes > 0).all():
            return np.where(sizes > 0, sizes, math.nan).tolist(), name
        steps = np.abs(np.diff(np.log(sizes)))
        certain = dim or self.confirmed_dim() or self.confirmed
        if certain is None and (kind == "total" or (steps.size and steps.min() >= math.log(3.5))):
            raise OrderError(
                f"column {name} is a count: h = 1/{name} if it counts cells along one side (--dim 1), "
                f"h = {name}^(-1/2) if it counts all cells or unknowns in the plane (--dim 2), {name}^(-1/3) in space "
                "(--dim 3); give --dim"
            )
        power = certain or 1
        words = f"h = 1/{name}" if power == 1 else f"h = {name}^(-1/{power})"
        confirmed = ", which the printed orders confirm" if not dim and certain else ""
        return (sizes ** (-1 / power)).tolist(), f"{words} from column {name}{confirmed}"

    def confirmed_dim(self) -> int | None:
        """Return the dimension with which the printed orders follow from numbers of cells; None if it is uncertain."""
        if self.size is None or self.size.role not in ("count", "total"):
            return None
        agreeing = [dim for dim in (1, 2, 3) if self._agrees(self.size.numbers ** (-1 / dim))]
        return agreeing[0] if len(agreeing) == 1 else None

    def _agrees(self, h: Array | list[float]) -> bool:
        """Return whether the orders that are printed beside the errors follow from these mesh sizes."""
        differences = [self._difference(h, column)[0] for column in self.errors]
        return max((one for one in differences if one < math.inf), default=1) < 0.02

    def _difference(self, h: Array | list[float], errors: Column) -> tuple[float, str]:
        """Return the largest difference of printed and computed orders, and the printed orders as text.

        One per cent of an order is no difference. Of several columns of orders, the best is taken. The difference is
        infinite if there are no printed orders.
        """
        best = (math.inf, "")
        computed = consecutive_orders(h, errors.numbers)
        for column in self.columns[self.columns.index(errors) + 1 :]:
            if column.name in self.error_names:
                break
            printed = column.numbers[1:]
            used = np.isfinite(printed) & np.isfinite(computed) & (np.abs(printed) > 0.3)
            if column.role == "order" and used.any():
                difference = np.abs(computed - printed) - 0.01 * np.abs(printed)
                best = min(best, (float(difference[used].max()), ", ".join(f"{p:g}" for p in printed[used])))
        return best

    def _contradiction(self, h: list[float], errors: Column) -> str:
        """Return a remark if the orders that are printed in the table are not the computed ones."""
        difference, printed = self._difference(h, errors)
        if not 0.1 < difference < math.inf:
            return ""
        computed = ", ".join(f"{order:.2f}" for order in consecutive_orders(h, errors.numbers))
        return f"the printed orders {printed} are not the computed ones {computed}"

    def _check_sizes(self, h: list[float]) -> None:
        name = self.size_name or "n"
        cells = self.size.cells if self.size else []
        for value, cell, line in zip(h, cells, self.lines, strict=True):
            if not 0 < value < math.inf:
                raise OrderError(f"line {line}: {name} = {cell}, but sizes must be positive and finite")
        for i, j in pairwise(np.argsort(h)):
            if h[j] - h[i] <= SAME_SIZE * h[i]:
                first, second = sorted((i, j))
                raise OrderError(
                    f"line {self.lines[second]}: {name} = {cells[second]} is already in line {self.lines[first]}, "
                    "expected another size on every mesh: remove one of the rows"
                )

    def _check(self, column: Column) -> None:
        """Raise an error if a cell of a column of errors is empty, negative or no number, or if it has logarithms."""
        name, signed = column.name, self.options.signed
        if _LOGARITHM.match(name) and not signed:
            raise OrderError(f"column {name} holds logarithms: give the mesh sizes and the errors themselves")
        bad = np.flatnonzero(column.missing | column.text | ((column.numbers < 0) & (not signed)))
        if not bad.size:
            return
        place = f"line {self.lines[bad[0]]}"
        cell = column.cells[bad[0]]
        if column.numbers[bad[0]] < 0:
            raise OrderError(f"{place}: {name} = {cell}, but errors must not be negative: give absolute values")
        others = ",".join(other for other in self.error_names if other != name)
        what = f"is '{cell}', not a number" if cell.strip() else "is missing"
        advice = f", or leave the column out: --columns '{others}'" if 0 < len(others) < 80 else ""
        raise OrderError(f"{place}: the entry of {name} {what}: write a number there, or delete the line{advice}")


DEGREES = (
    "errors against the degree (p-refinement) fall exponentially and have no order in h; give errors on several meshes "
    "for one degree"
)


def _follows(column: Column, errors: Column) -> bool:
    """Return whether a column has the orders, or the quotients, of the errors in the column before it."""
    if len(errors.cells) < 3 or column.missing[0]:
        return bool(column.missing[0] and not column.text.any() and len(errors.cells) > 2)
    quotients = errors.numbers[:-1] / errors.numbers[1:]
    return any(np.allclose(column.numbers[1:], other, rtol=0.01) for other in (quotients, np.log2(quotients)))


def _from_ratio(ratio: float, rows: int) -> list[float]:
    return [max(ratio, 1 / ratio) ** -k for k in range(rows)]


def _jumps_back(sizes: Array) -> list[int]:
    """Return the rows at which sizes begin again, if this gives several series of two rows or more."""
    steps = np.sign(np.diff(sizes))
    starts = (np.flatnonzero(steps * np.sign(np.median(steps) if steps.size else 0) < 0) + 1).tolist()
    runs = np.diff([0, *starts, len(sizes)])
    return starts if (runs > 1).sum() > 1 else []

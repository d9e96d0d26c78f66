"""Decides which column of a table has the mesh sizes, which columns have errors, and which rows are one series.

A table is read only if all three are certain. Otherwise, the message says what was understood and which option decides.
"""

import math
import re
from collections import Counter
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

import numpy as np

from .cells import SIZES, is_missing, kind_of, role, to_number, uses_decimal_commas, without_words
from .orders import SAME_SIZE, STALLED, Array, OrderError, consecutive_orders
from .tables import Table, read_tables

GROWING = "growing"
"""Role of a column of whole numbers that do not fall as the mesh gets finer."""
_WHOLE = re.compile(r"\d+(?:\.0)?|\d{1,3}(?:[ ,'’\u00a0\u202f]\d{3})+")
"""Matches a whole number, also as pandas writes it in a table of floats: 512, 512.0, 1 024, 1,024."""
_SIDES = re.compile(r"\D*(\d+)(?:\s*(?:[x×]|\\times)\s*\1)+\D*")
"""Matches the cells along the sides of a mesh, such as ``$8 \\times 8$``."""
_STATUS = re.compile(r"(?i)pass(?:ed)?|fail(?:ed)?|ok|true|false|yes|no|converged|done|x|✓|✗")
_LOGARITHM = re.compile(r"(?i)[\W_]*(?:log|ln)(?:[\W_]*(?:2|10|e))?(?:[\W_]|$)")
RATIOS = (2.0, math.sqrt(2), 1.5, 3.0, 4.0, 10.0)
"""Ratios of mesh sizes that may follow from printed orders."""
DEGREES = (
    "errors against the degree (p-refinement) fall exponentially and have no order in h; give errors on several meshes "
    "for one degree"
)


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
        if self.dim not in (None, 1, 2, 3):
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


@dataclass(eq=False)
class Column:
    """A column of a table.

    Attributes:
        name, cells: its name, and its cells as text.
        numbers: its numbers; NaN for text and for missing numbers.
        role: what the column contains.
    """

    name: str
    cells: list[str]
    numbers: Array
    role: str

    @property
    def starts_missing(self) -> bool:
        """Whether the first cell is missing, as in a column of orders."""
        return is_missing(self.cells[0])

    @property
    def whole(self) -> bool:
        """Whether all cells are whole numbers."""
        return all(_WHOLE.fullmatch(cell.strip()) for cell in self.cells)


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
        seen = ", ".join(f"{column.name} ({column.role})" for column in every[0].columns)
        raise OrderError(f"no column of errors among {seen}: name one with --columns")
    confirmed = {one.size.name: dim for one in usable if one.size and (dim := one.confirmed_dim())}
    series = [part for one in usable for part in one.series(confirmed)]
    if len({one.label for one in series}) == len(series):
        return series
    captions = [one.caption.rstrip(": ") for one in series]
    if len(set(captions)) < len(captions):
        captions = [f"series {k} {one.label}".strip() for k, one in enumerate(series, start=1)]
    return [replace(one, label=label) for one, label in zip(series, captions, strict=True)]


def columns_of(table: Table) -> tuple[list[Column], bool]:
    """Return the columns of a table, and whether its numbers have decimal commas.

    Raises:
        OrderError: a comma may be a decimal comma or separate thousands.
    """
    names = list(table.names)
    cells = [list(column) for column in zip(*table.rows, strict=True)]
    every = [cell for column in cells for cell in column]
    comma = uses_decimal_commas(every)
    if comma is None:
        cell = next(cell for cell in every if "," in cell)
        one, other = cell.replace(",", "."), cell.replace(",", "")
        raise OrderError(f"'{cell}' may be {one} or {other}: write it without a comma")
    columns = []
    for k, column in enumerate(cells):
        # Columns of orders need no name. Their first cell is missing.
        if k and not names[k] and is_missing(column[0]) and not all(map(is_missing, column)):
            names[k] = "order of " + names[k - 1].removeprefix("order of ")
        full_name = names[k] if names.count(names[k]) == 1 else f"{names[k]} ({k + 1})"
        if names[k]:
            columns.append(_column(names[k], full_name, column, comma))
    return columns, comma


def _column(name: str, full_name: str, cells: list[str], comma: bool) -> Column:
    """Return a column with its numbers and its role, which follows from its name and is corrected by its numbers.

    Words behind the numbers of a column of errors or sizes are units or remarks.
    """
    kind = role(name)
    clean = [without_words(cell) for cell in cells] if kind in ("error", *SIZES) else cells
    values = [to_number(cell, comma) for cell in clean]
    numbers = np.array(values, dtype=float)
    filled = [k for k, cell in enumerate(cells) if not is_missing(cell)]
    if not filled:
        kind = kind if kind == "error" else "empty"
    elif all(map(_SIDES.fullmatch, cells)):
        kind = kind if kind in SIZES else "count"
    elif values[filled[0]] is None and (kind in ("unknown", "other", "degree") or values.count(None) == len(filled)):
        kind = "text"
    elif re.fullmatch(r"(?i)\W*[pqr]\W*", name) and kind in ("order", "degree"):
        # Orders are missing on the coarsest mesh or nearly equal, and degrees are whole. An error of the pressure p is
        # none of these. Comparisons with NaN are false.
        kind = "order" if filled[0] or 0.5 <= numbers.max() <= 2 * numbers.min() else "unknown"
        kind = "degree" if not filled[0] and not (numbers[filled] % 1).any() else kind
    elif kind == "other" and re.fullmatch("(?i)cg|gmres|mesh|grid", name) and (numbers % 1 > 0).all():
        # Iterations are whole, so that a column named after an element or a mesh may have errors.
        kind = "unknown"
    return Column(full_name, cells, numbers, kind)


class Columns:
    """The columns of one table.

    Attributes:
        table, options: the table as text, and the user's description of the columns.
        columns: the columns that have a name.
        form: the form of the table in words.
        size, errors: the column of mesh sizes, None if there is none, and the columns of errors.
    """

    def __init__(self, table: Table, options: Options) -> None:
        self.table, self.options = table, options
        self.columns, comma = columns_of(table)
        self.form = table.form + (", decimal commas" if comma else "")
        self.size = self._size()
        self.errors = self._errors()

    def _size(self) -> Column | None:
        """Return the column of mesh sizes; None if there is none."""
        wanted = self.options.size
        if self.options.ratio is not None:
            return None
        if wanted is not None:
            for same in (str, str.lower):
                for column in self.columns:
                    if same(column.name) == same(wanted):
                        return column
            names = ", ".join(column.name for column in self.columns)
            raise OrderError(f"--in {wanted}: there is no such column; there are {names}")
        sizes = [column for column in self.columns if column.role in SIZES and len(set(column.numbers)) > 1]
        # Numbers that stay the same from row to row tell series apart, and numbers 0, 1, 2, … count the rows.
        for fits in (_changes, lambda column: not _counts(column)):
            sizes = [column for column in sizes if fits(column)] or sizes
        # Orders refer to the largest cell of a mesh.
        sizes.sort(key=lambda column: (SIZES.index(column.role), "min" in column.name.lower()))
        return sizes[0] if sizes else None

    def _errors(self) -> list[Column]:
        """Return the columns of errors, and correct the roles of columns beside them."""
        found: list[Column] = []
        for column in self.columns:
            if column is self.size or column.role not in ("unknown", "error", "other"):
                continue
            if column.role != "error" and self._tells_apart(column):
                column.role = "degree"
            elif column.role == "unknown" and found and _follows(column, found[-1]):
                column.role = "order"
            elif column.role == "unknown" and self._grows(column):
                column.role = GROWING
            elif column.role != "other":
                found.append(column)
        if self.options.columns:
            return self._wanted()
        # All first entries are missing in a table of orders.
        is_orders = len(self.table.rows) > 2 and all(column.starts_missing for column in found)
        return [] if is_orders else found

    def _wanted(self) -> list[Column]:
        """Return the columns that the user names as columns of errors; names may contain commas."""
        known = {column.name: column for column in self.columns}
        name = "|".join(map(re.escape, sorted(known, key=len, reverse=True)))
        if not re.fullmatch(f"(?:(?:{name})(?:,(?=.)|$))+", self.options.columns):
            raise OrderError(f"--columns {self.options.columns}: expected some of the columns {', '.join(known)}")
        return [known[found] for found in re.findall(f"({name})(?:,|$)", self.options.columns)]

    def _tells_apart(self, column: Column) -> bool:
        """Return whether sizes are repeated, but not within the rows with the same whole number in a column."""
        if self.size is None or not column.whole:
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
        if self.size is not None:
            sizes = self.size.numbers
            counts = self.size.role in ("count", "total") or sizes.min() > 1
            values = values[np.argsort(sizes if counts else -sizes, kind="stable")]
        return len(values) > 1 and column.whole and bool(values.any() and (np.diff(values) >= 0).all())

    # Series of rows.

    def series(self, confirmed: dict[str, int]) -> list[Series]:
        """Return the series of the table.

        A series ends where the word or the degree in a column changes, where printed orders begin again, where sizes
        jump back, and at a blank line or a rule.

        Parameters:
            confirmed: name of a column of sizes ↦ dimension that printed orders in any table of the text confirm.

        Raises:
            OrderError: mesh sizes are unknown or ambiguous, or a cell is not a positive number.
        """
        for column in self.errors:
            self._check(column)
        labels = self._labels()
        keys = list(zip(*labels.values(), strict=True)) if labels else [()] * len(self.table.rows)
        found = []
        for key in dict.fromkeys(keys):
            rows = [k for k, other in enumerate(keys) if other == key]
            label = " ".join(f"{name} {value}" for name, value in zip(labels, key, strict=True))
            starts = self._starts(rows)
            for number, (first, stop) in enumerate(pairwise([0, *starts, len(rows)]), start=1):
                part = self._part(rows[first:stop])
                found.append(part._series(f"{label} series {number}".strip() if starts else label, confirmed))
        return found

    def _part(self, rows: list[int]) -> "Columns":
        """Return some of the rows, with the same columns of sizes and errors."""
        part = object.__new__(Columns)
        lines = [self.table.lines[k] for k in rows]
        part.table, part.options, part.form = replace(self.table, lines=lines), self.options, self.form
        parts = {
            column: replace(column, cells=[column.cells[k] for k in rows], numbers=column.numbers[rows])
            for column in self.columns
        }
        part.columns, part.errors = list(parts.values()), [parts[column] for column in self.errors]
        part.size = parts[self.size] if self.size else None
        return part

    def _series(self, label: str, confirmed: dict[str, int]) -> Series:
        """Return the only series of the rows, with the given label."""
        h, words = self._sizes(confirmed)
        if self.size is None:
            self._refuse_two_series()
        used = [self.size, *self.errors]
        left = {column.name: column.role for column in self.columns if column not in used}
        errors = {column.name: column.numbers.tolist() for column in self.errors}
        remarks = {column.name: remark for column in self.errors if (remark := self._contradiction(h, column))}
        return Series(h, errors, words, left, self.table.caption, self.form, label, remarks)

    def _refuse_two_series(self) -> None:
        """Refuse rows without sizes if errors that stagnate or grow fall again, or fall much more once.

        Raises:
            OrderError: the rows may belong to several series.
        """
        for column in self.errors:
            orders = consecutive_orders(_from_ratio(2, len(column.cells)), column.numbers)
            for before, order, after, line in zip(orders, orders[1:], orders[2:], self.table.lines[2:], strict=False):
                if before <= STALLED < after or order > max(before, after) + 1:
                    raise OrderError(
                        f"line {line} may begin another series, {column.name} does not fall there as above and below: "
                        "give a column with the mesh sizes or the name of the series"
                    )

    def _labels(self) -> dict[str, list[str]]:
        """Return the columns whose entries tell several series apart; an entry may span the empty cells below it."""
        labels: dict[str, list[str]] = {}
        for k, column in enumerate(self.columns):
            cells = column.cells
            if column in (self.size, *self.errors) or all(map(_STATUS.fullmatch, cells)):
                continue
            spanned = k == 0 and cells[0] and "" in cells
            if spanned:
                cells = [next(cell for cell in cells[k::-1] if cell) for k in range(len(cells))]
            words = column.role in ("text", "degree") and len(set(cells)) < len(cells)
            # Without a column of sizes, any numbers that stay the same may be those of a series.
            steady = _repeats(cells) and column.role != "order"
            steady = steady and (self.size is None or (column.role in SIZES and min(Counter(cells).values()) > 1))
            if len(set(cells)) > 1 and "" not in cells and (words or steady or spanned):
                labels[column.name] = cells
        return labels

    def _starts(self, rows: list[int]) -> list[int]:
        """Return the places in ``rows`` at which another series begins."""
        breaks = [j for j in range(1, len(rows)) if rows[j] in self.table.breaks]
        # A rule below every row of a table means nothing.
        starts = set(breaks if len(breaks) < len(rows) - 1 else [])
        for column in self.columns:
            missing = [is_missing(column.cells[k]) for k in rows]
            if column.role == "order" and missing[0]:
                starts |= {j for j in range(1, len(rows)) if missing[j] and not missing[j - 1]}
            if column.role in ("level", *SIZES) or column is self.size:
                starts |= set(_jumps_back(column.numbers[rows]))
        return sorted(starts)

    # Mesh sizes.

    def _sizes(self, confirmed: dict[str, int]) -> tuple[list[float], str]:
        """Return the mesh sizes of a series, and in words how they were determined.

        They come from the ratio that the user gives, from a column, or from orders that are printed in the table.
        """
        if self.size is not None:
            h, words = self._converted(self.size, confirmed)
            self._check_sizes(h, self.size)
            return h, words
        ratio, count = self.options.ratio, len(self.table.lines)
        levels = next((column for column in self.columns if column.role == "level"), None)
        if ratio is not None:
            for column in self.columns:
                steps = np.abs(np.diff(np.log(column.numbers)))
                if column.role in ("size", "step") and (np.abs(steps - abs(math.log(ratio))) > 0.1).any():
                    raise OrderError(f"--ratio {ratio:g}, but the sizes in column {column.name} have another ratio")
            finest_first = levels is not None and count > 1 and (np.diff(levels.numbers) < 0).all()
            words = ", finest mesh first as the levels say" if finest_first else ""
            return _from_ratio(ratio, count)[:: -1 if finest_first else 1], f"ratio {ratio:g}{words}"
        for printed in RATIOS:
            if self._agrees(_from_ratio(printed, count)):
                return _from_ratio(printed, count), f"ratio {printed:g}, which follows from the printed orders"
        for column in self.columns:
            if column.role == "degree":
                raise OrderError(f"column {column.name} has degrees: {DEGREES}")
        names = ", ".join(column.name for column in self.columns)
        raise OrderError(
            f"no column is a mesh size; seen: {names}. Give --ratio 2 if each mesh is twice as fine as the one above, "
            "or --in NAME for the column of sizes"
        )

    def _converted(self, column: Column, confirmed: dict[str, int]) -> tuple[list[float], str]:
        """Return the mesh sizes that follow from a column, and in words how they were determined."""
        kind, name, sizes, dim = column.role, column.name, column.numbers, self.options.dim
        whole = sizes.min() > 1 and (dim or not (sizes % 1).any())
        if kind == "degree":
            raise OrderError(f"--in {name}: {DEGREES}")
        if whole and (dim or kind not in SIZES):
            kind = "count"
        if kind not in ("count", "total"):
            growing = len(sizes) > 1 and (np.diff(sizes) > 0).all()
            falling = [error.name for error in self.errors if (np.diff(error.numbers) < 0).all()]
            if whole and growing and falling and self.options.size is None:
                raise OrderError(
                    f"the errors {falling[0]} fall as {name} grows: give --dim 1 if {name} counts cells along a side, "
                    f"or --in {name} if its numbers are lengths"
                )
            return sizes.tolist(), f"{'Δt' if kind == 'step' else 'h'} from column {name}"
        steps = np.abs(np.diff(np.log(sizes)))
        certain = dim or confirmed.get(name)
        if certain is None and (kind == "total" or (steps.size and steps.min() >= math.log(3.5))):
            raise OrderError(
                f"column {name} is a count: h = 1/{name} if it counts cells along one side (--dim 1), "
                f"h = {name}^(-1/2) if it counts all cells or unknowns in the plane (--dim 2), {name}^(-1/3) in space "
                "(--dim 3); give --dim"
            )
        power = certain or 1
        words = f"h = 1/{name}" if power == 1 else f"h = {name}^(-1/{power})"
        confirmation = ", which the printed orders confirm" if certain and not dim else ""
        return (sizes ** (-1 / power)).tolist(), f"{words} from column {name}{confirmation}"

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
            if column in self.errors:
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

    def _check_sizes(self, h: list[float], column: Column) -> None:
        places = [
            f"line {line}: {column.name} = {cell}" for line, cell in zip(self.table.lines, column.cells, strict=True)
        ]
        for place, value, number in zip(places, h, column.numbers, strict=True):
            if not (0 < value < math.inf and number > 0):
                raise OrderError(f"{place}, but sizes must be positive and finite")
        for i, j in pairwise(np.argsort(h, kind="stable")):
            if h[j] - h[i] <= SAME_SIZE * h[i]:
                raise OrderError(f"{places[j]} is the size in line {self.table.lines[i]}: remove one of the rows")

    def _check(self, column: Column) -> None:
        """Raise an error if a cell of a column of errors is empty, negative or no number, or if it has logarithms."""
        name, signed = column.name, self.options.signed
        if _LOGARITHM.match(name) and not signed:
            raise OrderError(f"column {name} holds logarithms: give the mesh sizes and the errors themselves")
        for cell, number, line in zip(column.cells, column.numbers, self.table.lines, strict=True):
            no_number = math.isnan(number) and kind_of(cell) != "9"
            if no_number or (number < 0 and not signed):
                raise OrderError(
                    f"line {line}: {name} is '{cell}', expected a number that is not negative: write a number there, "
                    "delete the line, or name the columns of errors with --columns"
                )


def _repeats(cells: list[Any]) -> bool:
    """Return whether neighbours are equal, but not all."""
    return len(set(cells)) > 1 and any(one == other for one, other in pairwise(cells))


def _changes(column: Column) -> bool:
    return not _repeats(column.cells)


def _counts(column: Column) -> bool:
    """Return whether a column of whole numbers only counts the rows."""
    return bool(column.role == "count" and column.numbers[0] in (0, 1) and (np.diff(column.numbers) == 1).all())


def _follows(column: Column, errors: Column) -> bool:
    """Return whether a column has the orders, or the quotients, of the errors in the column before it."""
    if len(errors.cells) < 3:
        return False
    quotients = errors.numbers[:-1] / errors.numbers[1:]
    return column.starts_missing or any(
        np.allclose(column.numbers[1:], other, rtol=0.01) for other in (quotients, np.log2(quotients))
    )


def _from_ratio(ratio: float, rows: int) -> list[float]:
    return [max(ratio, 1 / ratio) ** -k for k in range(rows)]


def _jumps_back(sizes: Array) -> list[int]:
    """Return the rows at which sizes begin again, if this gives several series of two rows or more."""
    steps = np.sign(np.diff(sizes))
    starts = (np.flatnonzero(steps * np.median(steps) < 0) + 1).tolist() if steps.size else []
    runs = np.diff([0, *starts, len(sizes)])
    return starts if (runs > 1).sum() > 1 else []

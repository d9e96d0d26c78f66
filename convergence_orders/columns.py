"""Decides which column of a table has the mesh sizes, which columns have errors, and which rows are one series.

A table is read only if all three are certain. Otherwise, the message says what was understood and which option decides.
"""

import math
import re
from collections import Counter
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from .cells import SIZES, is_missing, kind_of, role, to_number, uses_decimal_commas, without_words
from .orders import Array, OrderError, consecutive_orders
from .tables import NORM_BARS, Cells, Table, read_tables, shorten

Rows = NDArray[np.intp]
"""Indices of the rows of a series."""
_WHOLE = re.compile(r"\s*(?:\d{1,10}(?:\.0)?|\d{1,3}(?:[ ,'’\u00a0\u202f]\d{3})+)\s*")
"""Matches a whole number, also as pandas writes it in a table of floats: 512, 512.0, 1 024, 1,024."""
_SIDES = re.compile(r"\D*(\d+)(?:\s*(?:[x×]|\\times)\s*\1)+\D*")
"""Matches the cells along the sides of a mesh, such as ``$8 \\times 8$``."""
_LOGARITHM = re.compile(r"(?i)[\W_]*(?:log|ln)(?:[\W_]*(?:2|10|e))?(?:[\W_]|$)")
_ORDER_WORDS = re.compile(r"(?i)e?oc|orders?|rates?|roc|ooc|slope|of|[^\w|]+")
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
        remarks: name of a column ↦ a remark if the orders that the table prints for it are not the computed ones,
            otherwise an empty text.
    """

    h: list[float]
    errors: dict[str, list[float]]
    size: str
    ignored: dict[str, str]
    caption: str
    form: str
    label: str
    remarks: dict[str, str]

    def recognised(self, what: str) -> str:
        """Return one line about how the table was read: its form, the mesh sizes, the columns and the ignored ones.

        Parameters:
            what: what the columns have, ``errors`` or ``values``.
        """
        line = f"read as {self.form}; size: {self.size}; {what}: {', '.join(self.errors)}"
        ignored = [f"{name} (quotients)" if kind == "quotient" else name for name, kind in self.ignored.items()]
        if ignored:
            line += f"; ignored: {', '.join(ignored)}"
        return line


class Column:
    """A column of a table.

    Attributes:
        name, cells: its name, and its cells as text.
        numbers: its numbers; NaN for text and for missing numbers.
        role: what the column contains. It follows from its name and is corrected by its cells.
        printed: the columns with orders that the table has for this column of errors.
    """

    def __init__(self, name: str, cells: Cells, comma: bool) -> None:
        self.name = name
        self.cells = cells
        self.role = role(name)
        self.printed: list[Column] = []
        # Words behind the numbers of a column of errors or sizes are units or remarks.
        clean = map(without_words, cells) if self.role in ("error", *SIZES) else cells
        self.numbers = np.array([to_number(cell, comma) for cell in clean], dtype=float)
        contents = "".join(map(kind_of, cells))
        if not contents.strip("-"):
            if self.role != "error":
                self.role = "empty"
        elif all(map(_SIDES.fullmatch, cells)):
            if self.role not in SIZES:
                self.role = "count"
        elif "9" not in contents or (contents[0] == "a" and self.role in ("unknown", "other", "degree")):
            self.role = "text"
        elif self.role == "degree" and not self.whole:
            # A column p may have errors of the pressure.
            self.role = "unknown"

    @property
    def starts_missing(self) -> bool:
        """Whether the first cell is missing, as in a column of orders."""
        return is_missing(self.cells[0])

    @property
    def whole(self) -> bool:
        """Whether all cells are whole numbers."""
        return all(map(_WHOLE.fullmatch, self.cells))

    @property
    def steps(self) -> set[float]:
        """The differences of consecutive numbers."""
        return {*np.diff(self.numbers).tolist()}


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
    confirmed: dict[str, int] = {}
    readings = [Reading(table, options, confirmed) for table in tables]
    usable = [reading for reading in readings if reading.errors]
    if not usable:
        seen = ", ".join(f"{column.name} ({column.role})" for column in readings[0].columns)
        raise OrderError(f"no column of errors among {seen}: name one with --columns")
    series = [part for reading in usable for part in reading.series()]
    every_label = (
        [part.label for part in series],
        [part.caption.rstrip(": ") for part in series],
        [f"series {k} {part.label}".strip() for k, part in enumerate(series, start=1)],
    )
    labels = next(labels for labels in every_label if len(set(labels)) == len(labels))
    return [replace(part, label=label) for part, label in zip(series, labels, strict=True)]


def columns_of(table: Table, comma: bool) -> list[Column]:
    """Return the columns of a table that have a name.

    Parameters:
        table: the table.
        comma: whether its numbers have decimal commas.
    """
    names = [name.translate(NORM_BARS) for name in table.names]
    columns = []
    for k, cells in enumerate(table.columns):
        if k and not names[k] and is_missing(cells[0]) and not all(map(is_missing, cells)):
            # Columns of orders need no name. Their first cell is missing.
            owner = names[k - 1].removeprefix("order of ")
            names[k] = f"order of {owner}"
        if not k and cells[0] and (kind_of(cells[0]) == "a" or role(names[0]) in ("degree", "other")):
            # The name of a series may span the empty cells below it.
            cells = [next(filter(None, cells[j::-1])) for j in range(len(cells))]
        if names[k]:
            column = Column(names[k], cells, comma)
            if names.count(names[k]) > 1:
                column.name += f" ({k + 1})"
            columns.append(column)
    return columns


class Reading:
    """The columns of one table: which one has the mesh sizes, and which ones have errors.

    Attributes:
        table, options: the table as text, and the user's description of the columns.
        columns, names: the columns that have a name, and their names in words.
        form: the form of the table in words.
        size, errors: the column of mesh sizes, None if there is none, and the columns of errors.
        confirmed: name of a column of numbers N of cells or unknowns ↦ the dimension d, if it is only one, for which
            the mesh sizes N^(−1/d) give the orders that a table prints. All tables of a text share these dimensions.
    """

    def __init__(self, table: Table, options: Options, confirmed: dict[str, int]) -> None:
        self.table = table
        self.options = options
        self.confirmed = confirmed
        comma = uses_decimal_commas([*chain(*table.columns)])
        self.columns = columns_of(table, comma)
        self.names = ", ".join(column.name for column in self.columns)
        self.form = table.form + (", decimal commas" if comma else "")
        self.size = self._size()
        self.errors = self._errors()
        if self.size and self.size.role in ("count", "total"):
            agreeing = [dim for dim in (1, 2, 3) if self._agrees(self.size.numbers ** (-1 / dim), slice(None))]
            if len(agreeing) == 1:
                confirmed[self.size.name] = agreeing[0]

    def _size(self) -> Column | None:
        """Return the column of mesh sizes; None if there is none."""
        if self.options.ratio is not None:
            return None
        if wanted := self.options.size:
            equal = [column for column in self.columns if column.name.lower() == wanted.lower()]
            if not equal:
                raise OrderError(f"--in {wanted}: there is no such column; there are {self.names}")
            return min(equal, key=lambda column: column.name != wanted)
        sizes = [column for column in self.columns if column.role in SIZES]
        # Numbers that stay the same from row to row tell series apart, numbers 0, 1, 2, … count rows, and orders refer
        # to the largest cell of a mesh.
        return min(
            sizes,
            key=lambda column: (
                0 in column.steps,
                column.role == "count" and column.steps == {1} and column.numbers[0] < 2,
                SIZES.index(column.role),
                "min" in column.name.lower(),
            ),
            default=None,
        )

    def _errors(self) -> list[Column]:
        """Return the columns of errors, and correct the roles of columns beside them."""
        errors: list[Column] = []
        for column in self.columns:
            if column is self.size or column.role not in ("unknown", "error", "order", "quotient"):
                continue
            if errors and column.role != "error":
                _correct(column, errors)
            if column.role in ("unknown", "error"):
                errors.append(column)
            elif column.role == "order" and errors:
                stem = _stem(column.name)
                owner = next((error for error in errors if stem and stem in _stem(error.name)), errors[-1])
                owner.printed.append(column)
        if self.options.columns:
            return self._wanted()
        for column in errors:
            if column.role == "unknown" and column.whole and column.numbers.any():
                raise OrderError(
                    f"column {column.name} has whole numbers: numbers of cells, iterations or seconds, or errors? Name "
                    "the columns of errors with --columns (columns= in Python)"
                )
        # All first entries are missing in a table of orders.
        is_orders = len(self.table.places) > 2 and all(column.starts_missing for column in errors)
        return [] if is_orders else errors

    def _wanted(self) -> list[Column]:
        """Return the columns that the user names as columns of errors; names may contain commas."""
        text = f",{self.options.columns},"
        wanted = [column for column in self.columns if f",{column.name}," in text]
        if sum(len(column.name) + 1 for column in wanted) != len(text) - 1:
            raise OrderError(f"--columns {self.options.columns}: expected some of the columns {self.names}")
        return wanted

    # Series of rows.

    def series(self) -> list[Series]:
        """Return the series of the table.

        A series ends where the word or the degree in a column changes, where printed orders begin again, where sizes
        jump back, and at a blank line or a rule.

        Raises:
            OrderError: mesh sizes are unknown or ambiguous, or a cell is not a positive number.
        """
        for column in filter(None, [*self.errors, self.size]):
            self._check(column)
        labels = [column for column in self.columns if self._is_label(column)]
        cases: dict[str, list[int]] = {}
        for k in range(len(self.table.places)):
            label = " ".join(f"{column.name} {column.cells[k]}" for column in labels)
            cases.setdefault(label, []).append(k)
        ignored = {column.name: column.role for column in self.columns if column not in (self.size, *self.errors)}
        series = []
        for label, rows in cases.items():
            parts = self._parts(np.array(rows))
            for number, part in enumerate(parts, start=1):
                h, words = self._sizes(part)
                series.append(
                    Series(
                        h=h.tolist(),
                        errors={column.name: column.numbers[part].tolist() for column in self.errors},
                        size=words,
                        ignored=ignored,
                        caption=self.table.caption,
                        form=self.form,
                        label=f"{label} series {number}".strip() if len(parts) > 1 else label,
                        remarks={column.name: _contradiction(h, part, column) for column in self.errors},
                    )
                )
        return series

    def _is_label(self, column: Column) -> bool:
        """Return whether the entries of a column tell several series apart.

        They are words, degrees, or numbers that stay the same. Numbers count if there are no sizes, or if sizes are
        repeated.
        """
        times = Counter(column.cells)
        if column in (self.size, *self.errors) or "" in times or not 1 < len(times) < len(column.cells):
            return False
        if column.role in ("text", "degree"):
            return True
        if column.role == "order" or 0 not in column.steps:
            return False
        return self.size is None or (len({*self.size.cells}) < len(self.size.cells) and min(times.values()) > 1)

    def _parts(self, rows: Rows) -> list[Rows]:
        """Return the parts into which rows with the same label are divided."""
        begins = np.isin(rows[1:], self.table.breaks)
        # A rule below every row of a table means nothing.
        begins &= not begins.all()
        for column in self.columns:
            numbers = column.numbers[rows]
            missing = np.isnan(numbers)
            if column.role in ("order", "quotient") and missing[0]:
                begins |= missing[1:] & ~missing[:-1]
            if column.role in ("level", *SIZES) or column is self.size:
                begins |= _jumps_back(numbers)
        return np.split(rows, np.flatnonzero(begins) + 1)

    # Mesh sizes.

    def _sizes(self, rows: Rows) -> tuple[Array, str]:
        """Return the mesh sizes of a series, and in words how they were determined.

        They come from the ratio that the user gives, from a column, or from orders that are printed in the table.
        """
        ratio = self.options.ratio
        levels = np.arange(len(rows), dtype=float)
        for column in self.columns:
            if column.role == "degree" and (column is self.size or (column.steps == {1} and not self.options.size)):
                raise OrderError(f"column {column.name} has degrees: {DEGREES}")
            if ratio and column.role in ("size", "step"):
                raise OrderError(f"--ratio {ratio:g}, but column {column.name} has sizes: leave out --ratio")
            if column.role == "level":
                levels = column.numbers[rows]
                if ratio and (np.abs(np.diff(levels)) != 1).any():
                    raise OrderError(f"--ratio {ratio:g}, but the levels in column {column.name} are not consecutive")
        if self.size:
            return self._converted(self.size, rows)
        finer = ratio or 2.0
        h = max(finer, 1 / finer) ** -levels
        # A column with another name and without orders may be one of sizes.
        named = all(column.role == "error" or column.printed or not column.numbers.any() for column in self.errors)
        if named and self._agrees(h, rows):
            return h, f"ratio {finer:g}, which follows from the printed orders"
        if not ratio:
            raise OrderError(
                f"no column is a mesh size; seen: {self.names}. Give --ratio 2 if each mesh is twice as fine as the "
                "one above, or --in NAME for the column of sizes"
            )
        for column in self.errors:
            orders = consecutive_orders(h, column.numbers[rows])
            if (np.diff(orders) > 1).any():
                raise OrderError(
                    f"the orders of {column.name} rise by more than 1 from row to row, where another series may begin: "
                    "give a column with the mesh sizes or the name of the series"
                )
        return h, f"ratio {ratio:g}"

    def _converted(self, column: Column, rows: Rows) -> tuple[Array, str]:
        """Return the mesh sizes that follow from a column, and in words how they were determined."""
        kind = column.role
        name = column.name
        sizes = column.numbers[rows]
        dim = self.options.dim
        whole = sizes.min() > 1 and (dim or not (sizes % 1).any())
        if kind not in ("count", "total") and not (whole and (dim or kind not in SIZES)):
            steps = np.diff(sizes)
            falling = [error.name for error in self.errors if (np.diff(error.numbers[rows]) * steps < 0).all()]
            if whole and len(steps) and falling and self.options.size is None:
                raise OrderError(
                    f"the errors {falling[0]} fall as {name} grows: give --dim 1 if {name} counts cells along a side, "
                    f"or --in {name} if its numbers are lengths"
                )
            return sizes, f"{'Δt' if kind == 'step' else 'h'} from column {name}"
        power = dim or self.confirmed.get(name)
        if power is None and (kind == "total" or np.abs(np.diff(np.log(sizes))).min(initial=9) >= math.log(3.5)):
            raise OrderError(
                f"column {name} is a count: give --dim D (dim=D in Python) for h = {name}^(-1/D), where D is 1 if it "
                "counts cells along one side, and 2 or 3 if it counts all cells or unknowns in the plane or in space"
            )
        formula = f"{name}^(-1/{power})" if power in (2, 3) else f"1/{name}"
        confirmation = "" if dim or power is None else ", which the printed orders confirm"
        return sizes ** (-1 / (power or 1)), f"h = {formula} from column {name}{confirmation}"

    def _agrees(self, h: Array, rows: Rows | slice) -> bool:
        """Return whether the orders that are printed beside the errors follow from these mesh sizes."""
        differences = [_difference(h, rows, column) for column in self.errors]
        return max((difference for difference in differences if difference >= 0), default=1) < 0.03

    def _check(self, column: Column) -> None:
        """Raise an error if a cell of a column of errors or sizes cannot be used, or if the column has logarithms."""
        is_size = column is self.size
        signed = self.options.signed and not is_size
        if _LOGARITHM.match(column.name) and not signed:
            raise OrderError(f"column {column.name} holds logarithms: give the mesh sizes and the errors themselves")
        for cell, number, place in zip(column.cells, column.numbers, self.table.places, strict=True):
            usable = 0 < number < math.inf if is_size else signed or not number < 0
            if not usable or (math.isnan(number) and kind_of(cell) != "9"):
                wanted = "a positive number" if is_size else "a number that is not negative"
                raise OrderError(
                    f"{place}: {column.name} is '{shorten(cell)}', expected {wanted}: write a number there, delete the "
                    "line, or name the columns of errors with --columns"
                )


def _correct(column: Column, errors: list[Column]) -> None:
    """Correct the role of a column that stands behind columns of errors and may have their quotients or orders.

    Quotients may equal the orders of other errors. So a column behind several columns of errors keeps the role of its
    name if it is called orders.
    """
    last = errors[-1].numbers
    quotients = last[:-1] / last[1:]
    below = column.numbers[1:]
    above = column.numbers[:-1]
    certain = len(errors) == 1 or column.role != "order" or column.name.startswith("order of")
    if certain and (_equal(below, quotients) or _equal(above, quotients)):
        column.role = "quotient"
    elif len(column.cells) > 2 and (column.starts_missing or _equal(below, np.log2(quotients))):
        column.role = "order"


def _stem(name: str) -> str:
    """Return the name of a column of errors, or of the orders that belong to it, without words such as order."""
    return _ORDER_WORDS.sub("", name).lower()


def _equal(numbers: Array, expected: Array) -> bool:
    """Return whether two numbers or more are finite, and all of these are equal up to rounding."""
    used = np.isfinite(numbers * expected)
    return bool(used.sum() > 1 and np.allclose(numbers[used], expected[used], rtol=0.01))


def _difference(h: Array, rows: Rows | slice, errors: Column) -> float:
    """Return the largest difference of the orders that are printed for a column of errors and the computed ones.

    Of several columns of orders, the best is taken. The difference is NaN if there are no printed orders.
    """
    computed = consecutive_orders(h, errors.numbers[rows])
    differences = [np.abs(computed - column.numbers[rows][1:]) for column in errors.printed]
    return min((float(np.nanmax(d)) for d in differences if np.isfinite(d).any()), default=math.nan)


def _contradiction(h: Array, rows: Rows, errors: Column) -> str:
    """Return a remark if the orders that are printed in the table are not the computed ones."""
    if not _difference(h, rows, errors) > 0.1:
        return ""
    printed = ", ".join(f"{order:g}" for order in errors.printed[0].numbers[rows][1:])
    computed = ", ".join(f"{order:.2f}" for order in consecutive_orders(h, errors.numbers[rows]))
    return f"; the printed orders {printed} are not the computed ones {computed}"


def _jumps_back(sizes: Array) -> NDArray[np.bool_]:
    """Return whether sizes begin again below each row, if this gives several series of two rows or more."""
    steps = np.sign(np.diff(sizes))
    back = steps * np.median(steps) < 0 if steps.size else steps > 0
    runs = np.diff([-1, *np.flatnonzero(back), len(back)])
    return back & bool((runs > 1).sum() > 1)

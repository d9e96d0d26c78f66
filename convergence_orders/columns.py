"""Decides which column of a table has the mesh sizes, which columns have errors, and which rows are one series.

A table is read only if all three are certain. Otherwise, the message says what was understood and which option decides.
"""

import math
import re
from collections import Counter
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from .cells import SIZES, is_missing, kind_of, role, to_number, uses_decimal_commas, without_words
from .orders import SAME_SIZE, STALLED, Array, OrderError, consecutive_orders
from .tables import Table, read_tables, shorten

Rows = NDArray[np.intp]
"""Indices of the rows of a series."""
_WHOLE = re.compile(r"\d+(?:\.0)?|\d{1,3}(?:[ ,'’\u00a0\u202f]\d{3})+")
"""Matches a whole number, also as pandas writes it in a table of floats: 512, 512.0, 1 024, 1,024."""
_SIDES = re.compile(r"\D*(\d+)(?:\s*(?:[x×]|\\times)\s*\1)+\D*")
"""Matches the cells along the sides of a mesh, such as ``$8 \\times 8$``."""
_STATUS = re.compile(r"(?i)pass(?:ed)?|fail(?:ed)?|ok|true|false|yes|no|converged|done|x|✓|✗")
_LOGARITHM = re.compile(r"(?i)[\W_]*(?:log|ln)(?:[\W_]*(?:2|10|e))?(?:[\W_]|$)")
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

    @property
    def repeats(self) -> bool:
        """Whether neighbours are equal, but not all."""
        return len(set(self.cells)) > 1 and any(one == other for one, other in pairwise(self.cells))

    @property
    def counts_rows(self) -> bool:
        """Whether the numbers are 0, 1, 2, … or 1, 2, 3, …"""
        return self.role == "count" and self.numbers[0] in (0, 1) and bool((np.diff(self.numbers) == 1).all())


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
    captions = [one.caption.rstrip(": ") for one in series]
    numbered = [f"series {k} {one.label}".strip() for k, one in enumerate(series, start=1)]
    labels = next(names for names in ([one.label for one in series], captions, numbered) if _differ(names))
    return [replace(one, label=label) for one, label in zip(series, labels, strict=True)]


def _differ(names: list[str]) -> bool:
    return len(set(names)) == len(names)


def columns_of(table: Table) -> tuple[list[Column], bool]:
    """Return the columns of a table, and whether its numbers have decimal commas.

    Raises:
        OrderError: a comma may be a decimal comma or separate thousands.
    """
    every = [cell for row in table.rows for cell in row]
    comma = uses_decimal_commas(every)
    if comma is None:
        cell = next(cell for cell in every if "," in cell)
        one, other = cell.replace(",", "."), cell.replace(",", "")
        raise OrderError(f"'{cell}' may be {one} or {other}: write it without a comma")
    names = list(table.names)
    columns = []
    for k, cells in enumerate(map(list, zip(*table.rows, strict=True))):
        if k and not names[k] and is_missing(cells[0]) and not all(map(is_missing, cells)):
            # Columns of orders need no name. Their first cell is missing.
            names[k] = "order of " + names[k - 1].removeprefix("order of ")
        if not k and cells[0] and (kind_of(cells[0]) == "a" or role(names[0]) in ("degree", "other")):
            # The name of a series may span the empty cells below it.
            cells = [next(filter(None, cells[j::-1])) for j in range(len(cells))]
        if names[k]:
            full_name = names[k] if names.count(names[k]) == 1 else f"{names[k]} ({k + 1})"
            columns.append(_column(names[k], full_name, cells, comma))
    return columns, comma


def _column(name: str, full_name: str, cells: list[str], comma: bool) -> Column:
    """Return a column with its numbers and its role, which follows from its name and is corrected by its numbers.

    Words behind the numbers of a column of errors or sizes are units or remarks.
    """
    kind = role(name)
    clean = [without_words(cell) for cell in cells] if kind in ("error", *SIZES) else cells
    numbers = np.array([to_number(cell, comma) for cell in clean], dtype=float)
    column = Column(full_name, cells, numbers, kind)
    filled = [cell for cell in cells if not is_missing(cell)]
    words = [kind_of(cell) == "a" for cell in filled]
    if not filled:
        column.role = kind if kind == "error" else "empty"
    elif all(map(_SIDES.fullmatch, cells)):
        column.role = kind if kind in SIZES else "count"
    elif all(words) or (words[0] and kind in ("unknown", "other", "degree")):
        column.role = "text"
    elif kind in ("order", "degree") and re.fullmatch(r"(?i)\W*[pqr]\W*", name):
        # An error of the pressure p is neither an order nor a degree.
        column.role = "degree" if column.whole else "unknown"
    elif kind == "other" and re.fullmatch("(?i)cg|gmres|mesh|grid", name) and (numbers % 1 > 0).all():
        # Iterations are whole, so that a column named after an element or a mesh may have errors.
        column.role = "unknown"
    return column


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
            known = {column.name.lower(): column for column in self.columns}
            known |= {column.name: column for column in self.columns}
            if found := known.get(wanted, known.get(wanted.lower())):
                return found
            names = ", ".join(column.name for column in self.columns)
            raise OrderError(f"--in {wanted}: there is no such column; there are {names}")
        sizes = [column for column in self.columns if column.role in SIZES and len(set(column.numbers)) > 1]
        # Numbers that stay the same from row to row tell series apart, and orders refer to the largest cell of a mesh.
        return min(
            sizes,
            key=lambda one: (one.repeats, one.counts_rows, SIZES.index(one.role), "min" in one.name.lower()),
            default=None,
        )

    def _errors(self) -> list[Column]:
        """Return the columns of errors, and correct the roles of columns beside them."""
        found: list[Column] = []
        for column in self.columns:
            if column is self.size or column.role not in ("unknown", "error", "other"):
                continue
            if column.role == "unknown" and found and _follows(column, found[-1]):
                column.role = "order"
            elif column.role != "other":
                found.append(column)
        if self.options.columns:
            return self._wanted()
        for column in found:
            if column.role == "unknown" and column.whole and column.numbers.any():
                raise OrderError(
                    f"column {column.name} has whole numbers: numbers of cells, iterations or seconds, or errors? Name "
                    "the columns of errors with --columns (columns= in Python)"
                )
        # All first entries are missing in a table of orders.
        is_orders = len(self.table.rows) > 2 and all(column.starts_missing for column in found)
        return [] if is_orders else found

    def _wanted(self) -> list[Column]:
        """Return the columns that the user names as columns of errors; names may contain commas."""
        known = {column.name: column for column in self.columns}
        name = "|".join(map(re.escape, sorted(known, key=len, reverse=True)))
        found = re.findall(f"(?:^|(?<=,))({name})(?=,|$)", self.options.columns)
        if ",".join(found) != self.options.columns:
            raise OrderError(f"--columns {self.options.columns}: expected some of the columns {', '.join(known)}")
        return [known[one] for one in found]

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
        for column in [*self.errors, *([self.size] if self.size else [])]:
            self._check(column)
        labels = self._labels()
        cases: dict[str, list[int]] = {}
        for k in range(len(self.table.rows)):
            cases.setdefault(" ".join(f"{name} {cells[k]}" for name, cells in labels.items()), []).append(k)
        found = []
        for label, rows in cases.items():
            starts = self._starts(rows)
            for number, (first, stop) in enumerate(pairwise([0, *starts, len(rows)]), start=1):
                name = f"{label} series {number}".strip() if starts else label
                found.append(self._series(np.array(rows[first:stop]), name, confirmed))
        return found

    def _series(self, rows: Rows, label: str, confirmed: dict[str, int]) -> Series:
        """Return the series in the given rows, with the given label."""
        h, words = self._sizes(rows, confirmed)
        used = [self.size, *self.errors]
        left = {column.name: column.role for column in self.columns if column not in used}
        errors = {column.name: column.numbers[rows].tolist() for column in self.errors}
        remarks = {column.name: remark for column in self.errors if (remark := self._contradiction(h, rows, column))}
        return Series(h.tolist(), errors, words, left, self.table.caption, self.form, label, remarks)

    def _labels(self) -> dict[str, list[str]]:
        """Return the columns whose entries tell several series apart: words, degrees, and numbers that stay the same.

        Numbers count if there are no sizes, or if sizes are repeated.
        """
        labels: dict[str, list[str]] = {}
        repeated = self.size is None or len(set(self.size.cells)) < len(self.size.cells)
        for column in self.columns:
            times = Counter(column.cells)
            telling = 1 < len(times) < len(column.cells) and "" not in times and not all(map(_STATUS.fullmatch, times))
            steady = repeated and column.repeats and column.role != "order"
            if column in (self.size, *self.errors) or not telling:
                continue
            if column.role in ("text", "degree") or (steady and (self.size is None or min(times.values()) > 1)):
                labels[column.name] = column.cells
        return labels

    def _starts(self, rows: list[int]) -> list[int]:
        """Return the places in ``rows`` at which another series begins."""
        starts = {j for j in range(1, len(rows)) if rows[j] in self.table.breaks}
        if len(starts) == len(rows) - 1:
            # A rule below every row of a table means nothing.
            starts = set()
        for column in self.columns:
            missing = [is_missing(column.cells[k]) for k in rows]
            if column.role == "order" and missing[0]:
                starts |= {j for j in range(1, len(rows)) if missing[j] and not missing[j - 1]}
            if column.role in ("level", *SIZES) or column is self.size:
                starts |= set(_jumps_back(column.numbers[rows]))
        return sorted(starts)

    # Mesh sizes.

    def _sizes(self, rows: Rows, confirmed: dict[str, int]) -> tuple[Array, str]:
        """Return the mesh sizes of a series, and in words how they were determined.

        They come from the ratio that the user gives, from a column, or from orders that are printed in the table.
        """
        if self.size is not None:
            h, words = self._converted(self.size, rows, confirmed)
            self._refuse_repeated(h, rows, self.size)
            return h, words
        ratio, levels = self.options.ratio, np.arange(len(rows), dtype=float)
        for column in self.columns:
            if ratio is not None and column.role in ("size", "step"):
                raise OrderError(f"--ratio {ratio:g}, but column {column.name} has sizes: leave out --ratio")
            if column.role == "level":
                levels = column.numbers[rows]
                if ratio is not None and set(np.diff(levels)) not in (set(), {1.0}, {-1.0}):
                    raise OrderError(f"--ratio {ratio:g}, but the levels in column {column.name} are not consecutive")
        h = np.power(max(ratio, 1 / ratio) if ratio else 2.0, -levels)
        self._refuse_two_series(h, rows)
        if ratio is not None:
            return h, f"ratio {ratio:g}"
        if self._agrees(h, rows):
            return h, "ratio 2, which follows from the printed orders"
        for column in self.columns:
            if column.role == "degree":
                raise OrderError(f"column {column.name} has degrees: {DEGREES}")
        names = ", ".join(column.name for column in self.columns)
        raise OrderError(
            f"no column is a mesh size; seen: {names}. Give --ratio 2 if each mesh is twice as fine as the one above, "
            "or --in NAME for the column of sizes"
        )

    def _converted(self, column: Column, rows: Rows, confirmed: dict[str, int]) -> tuple[Array, str]:
        """Return the mesh sizes that follow from a column, and in words how they were determined."""
        kind, name, sizes, dim = column.role, column.name, column.numbers[rows], self.options.dim
        if kind == "degree":
            raise OrderError(f"--in {name}: {DEGREES}")
        whole = sizes.min() > 1 and (dim or not (sizes % 1).any())
        if kind not in ("count", "total") and not (whole and (dim or kind not in SIZES)):
            falling = [error.name for error in self.errors if (np.diff(error.numbers[rows]) < 0).all()]
            if whole and len(sizes) > 1 and (np.diff(sizes) > 0).all() and falling and self.options.size is None:
                raise OrderError(
                    f"the errors {falling[0]} fall as {name} grows: give --dim 1 if {name} counts cells along a side, "
                    f"or --in {name} if its numbers are lengths"
                )
            return sizes, f"{'Δt' if kind == 'step' else 'h'} from column {name}"
        power = dim or confirmed.get(name, 0)
        if not power and (kind == "total" or np.abs(np.diff(np.log(sizes))).min(initial=9) >= math.log(3.5)):
            raise OrderError(
                f"column {name} is a count: h = 1/{name} if it counts cells along one side (--dim 1), "
                f"h = {name}^(-1/2) if it counts all cells or unknowns in the plane (--dim 2), {name}^(-1/3) in space "
                "(--dim 3); give --dim"
            )
        words = f"h = {name}^(-1/{power})" if power > 1 else f"h = 1/{name}"
        confirmation = ", which the printed orders confirm" if power and not dim else ""
        return sizes ** (-1 / (power or 1)), f"{words} from column {name}{confirmation}"

    def confirmed_dim(self) -> int | None:
        """Return the dimension with which the printed orders follow from numbers of cells; None if it is uncertain."""
        if self.size is None or self.size.role not in ("count", "total"):
            return None
        rows = np.arange(len(self.table.rows))
        agreeing = [dim for dim in (1, 2, 3) if self._agrees(self.size.numbers ** (-1 / dim), rows)]
        return agreeing[0] if len(agreeing) == 1 else None

    def _agrees(self, h: Array, rows: Rows) -> bool:
        """Return whether the orders that are printed beside the errors follow from these mesh sizes."""
        differences = [self._difference(h, rows, column)[0] for column in self.errors]
        return max((one for one in differences if one < math.inf), default=1) < 0.02

    def _difference(self, h: Array, rows: Rows, errors: Column) -> tuple[float, str]:
        """Return the largest difference of printed and computed orders, and the printed orders as text.

        One per cent of an order is no difference. Of several columns of orders, the best is taken. The difference is
        infinite if there are no printed orders.
        """
        best = (math.inf, "")
        computed = consecutive_orders(h, errors.numbers[rows])
        for column in self.columns[self.columns.index(errors) + 1 :]:
            if column in self.errors:
                break
            printed = column.numbers[rows][1:]
            used = np.isfinite(printed) & np.isfinite(computed) & (np.abs(printed) > 0.3)
            if column.role == "order" and used.any():
                difference = np.abs(computed - printed) - 0.01 * np.abs(printed)
                best = min(best, (float(difference[used].max()), ", ".join(f"{p:g}" for p in printed[used])))
        return best

    def _contradiction(self, h: Array, rows: Rows, errors: Column) -> str:
        """Return a remark if the orders that are printed in the table are not the computed ones."""
        difference, printed = self._difference(h, rows, errors)
        if not 0.1 < difference < math.inf:
            return ""
        computed = ", ".join(f"{order:.2f}" for order in consecutive_orders(h, errors.numbers[rows]))
        return f"the printed orders {printed} are not the computed ones {computed}"

    def _refuse_two_series(self, h: Array, rows: Rows) -> None:
        """Refuse rows without sizes if errors that stagnate or grow fall again, or fall much more once.

        Raises:
            OrderError: the rows may belong to several series.
        """
        for column in self.errors:
            orders = consecutive_orders(h, column.numbers[rows])
            for k, (before, order, after) in enumerate(zip(orders, orders[1:], orders[2:], strict=False), start=2):
                if before <= STALLED < after or order > max(before, after) + 1:
                    raise OrderError(
                        f"{self.table.places[rows[k]]} may begin another series, {column.name} does not fall there "
                        "as above and below: give a column with the mesh sizes or the name of the series"
                    )

    def _refuse_repeated(self, h: Array, rows: Rows, column: Column) -> None:
        """Raise an error if two rows have the same mesh size."""
        for i, j in pairwise(np.argsort(h, kind="stable")):
            if h[j] - h[i] <= SAME_SIZE * h[i]:
                first, second = (self.table.places[rows[k]] for k in (i, j))
                cell = column.cells[rows[j]]
                raise OrderError(f"{second}: {column.name} = {cell} is the size in {first}: remove one of the rows")

    def _check(self, column: Column) -> None:
        """Raise an error if a cell of a column of errors or sizes cannot be used, or if the column has logarithms."""
        name, signed = column.name, self.options.signed and column is not self.size
        if _LOGARITHM.match(name) and not signed:
            raise OrderError(f"column {name} holds logarithms: give the mesh sizes and the errors themselves")
        wanted = "a positive number" if column is self.size else "a number that is not negative"
        for cell, number, place in zip(column.cells, column.numbers, self.table.places, strict=True):
            usable = 0 < number < math.inf if column is self.size else signed or not number < 0
            if not usable or (math.isnan(number) and kind_of(cell) != "9"):
                raise OrderError(
                    f"{place}: {name} is '{shorten(cell)}', expected {wanted}: write a number there, delete the line, "
                    "or name the columns of errors with --columns"
                )


def _follows(column: Column, errors: Column) -> bool:
    """Return whether a column has the orders, or the quotients, of the errors in the column before it."""
    if len(errors.cells) < 3:
        return False
    quotients = errors.numbers[:-1] / errors.numbers[1:]
    return column.starts_missing or any(
        np.allclose(column.numbers[1:], other, rtol=0.01) for other in (quotients, np.log2(quotients))
    )


def _jumps_back(sizes: Array) -> list[int]:
    """Return the rows at which sizes begin again, if this gives several series of two rows or more."""
    steps = np.sign(np.diff(sizes))
    starts = (np.flatnonzero(steps * np.median(steps) < 0) + 1).tolist() if steps.size else []
    runs = np.diff([0, *starts, len(sizes)])
    return starts if (runs > 1).sum() > 1 else []

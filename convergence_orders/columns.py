"""Decides which column of a table has the mesh sizes, which columns have errors, and which rows are one series.

A table is read only if all three are certain. Otherwise, the message says what was understood and which option decides.
"""

import math
import re
from collections import Counter
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from .cells import (
    ALONG_SIDES,
    MISSING,
    SIZES,
    UNITS,
    WHOLE,
    is_missing,
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


def series_of(tables: list[Table], options: Options) -> list[Series]:
    """Return the mesh sizes and errors of all series in tables, as ``read_series`` does."""
    columns = [Columns(table, options) for table in tables]
    usable = [one for one in columns if one.errors]
    if not usable:
        seen = ", ".join(f"{name} ({kind})" for name, kind in columns[0].roles.items() if name)
        raise OrderError(f"no column of errors among {seen}: name one with --columns")
    confirmed = {one.size: dim for one in usable if (dim := one.confirmed_dim())}
    for one in usable:
        one.confirmed = confirmed.get(one.size)
    found = [series for one in usable for series in one.series()]
    if len({series.label for series in found}) < len(found):
        captions = [series.caption.rstrip(": ") for series in found]
        distinct = len(set(captions)) == len(captions)
        labels = captions if distinct else [f"series {k}" for k in range(1, len(found) + 1)]
        found = [replace(one, label=label if distinct else f"{label} {one.label}".strip())
                 for one, label in zip(found, labels, strict=True)]  # fmt: skip
    return found


class Columns:
    """The columns of one table, with their meaning.

    Attributes:
        table, options: the table as text, and the user's description of the columns.
        cells, values, numbers: name of a column ↦ its cells; its numbers, None for other text; the same as an array,
            NaN for text.
        roles: name of a column ↦ its role.
        errors: names of the columns of errors.
        printed: name of a column of errors ↦ names of the columns of orders to its right.
        size: name of the column of mesh sizes; None if there is none.
    """

    def __init__(self, table: Table, options: Options) -> None:
        self.table, self.options = table, options
        names = list(table.names)
        for k, name in enumerate(names):
            # Columns of orders need no name. Their first cell is missing.
            if not name and k and kind_of(table.rows[0][k]) == MISSING and any(_filled(row[k]) for row in table.rows):
                names[k] = names[k - 1] if names[k - 1].startswith("order of ") else f"order of {names[k - 1]}"
        counts = Counter(names)
        names = [name if counts[name] == 1 else f"{name} ({k + 1})" for k, name in enumerate(names)]
        columns = dict(zip(names, zip(*table.rows, strict=True), strict=True))
        self.cells = {name: list(cells) for name, cells in columns.items() if name or any(map(_filled, cells))}
        self.confirmed: int | None = None
        self.form = table.form
        self._plain_numbers()
        self.values = {name: list(map(to_number, cells)) for name, cells in self.cells.items()}
        self.numbers = {
            name: np.array([math.nan if value is None else value for value in values])
            for name, values in self.values.items()
        }
        self.roles = {name: role(re.sub(r" \(\d+\)$", "", name)) for name in self.cells}
        wanted = self._wanted()
        for name in self.cells:
            self.roles[name] = self._role_by_numbers(name)
        self.size = self._size_column()
        before = None
        self.printed: dict[str, list[str]] = {}
        for name, kind in self.roles.items():
            if kind in ("unknown", "error") and name != self.size and before and self._follows(name, before):
                self.roles[name] = kind = "order"
            if kind in ("unknown", "other") and self.size not in (None, name) and self._splits(self.cells[name]):
                self.roles[name] = "degree"
            elif kind == "unknown" and name != self.size and self._grows(name):
                self.roles[name] = GROWING
            elif kind == "order" and before:
                self.printed.setdefault(before, []).append(name)
            elif kind in ("unknown", "error") and name != self.size:
                before = name
        errors = [name for name, kind in self.roles.items() if kind in ("error", "unknown") and name != self.size]
        # All first entries are missing in a table of orders.
        missing = [self._missing(name, 0) for name in errors]
        self.errors = wanted or ([] if missing and all(missing) and len(table.rows) > 2 else errors)

    def _wanted(self) -> list[str]:
        """Return the columns that the user names as columns of errors; names may contain commas."""
        rest, known = self.options.columns, sorted(self.cells, key=len, reverse=True)
        wanted = []
        while rest:
            name = next((name for name in known if name and re.match(re.escape(name) + "(?:,|$)", rest)), None)
            if name is None:
                unknown = rest.partition(",")[0]
                raise OrderError(f"there is no column {unknown}; there are {', '.join(filter(None, self.cells))}")
            wanted.append(name)
            rest = rest[len(name) + 1 :]
        return [name for name in self.cells if name in wanted]

    def _plain_numbers(self) -> None:
        """Remove units and decimal commas from the cells.

        Words behind the numbers of a column are units if they are the same or known; otherwise, the column is text.
        """
        every = [cell for cells in self.cells.values() for cell in cells]
        comma = uses_decimal_commas(every)
        if comma is None:
            cell = next(cell for cell in every if "," in cell)
            one, other = cell.replace(",", "."), cell.replace(",", "")
            raise OrderError(f"'{cell}' may be {one} or {other}: write it without a comma")
        self.form += ", decimal commas" if comma else ""
        for name, cells in self.cells.items():
            units = {number_and_unit(cell) for cell in cells if _filled(cell)}
            words = {unit for _, unit in units}
            if len(words) == 1 and (words <= UNITS or role(name) in ("error", *SIZES)) and words != {""}:
                self.cells[name] = [repr(value) if (value := number_and_unit(cell)[0]) else cell for cell in cells]
            if comma:
                numbers = [to_number(cell, decimal_comma=True) if re.search("[.,]", cell) else None for cell in cells]
                self.cells[name] = [
                    cell if value is None or math.isnan(value) else repr(value)
                    for cell, value in zip(cells, numbers, strict=True)
                ]

    def _missing(self, name: str, k: int) -> bool:
        return is_missing(self.cells[name][k], self.values[name][k])

    def _role_by_numbers(self, name: str) -> str:
        """Return the role of a column, which follows from its name and is corrected by its numbers."""
        kind, values, numbers = self.roles[name], self.values[name], self.numbers[name]
        filled = [k for k in range(len(values)) if not self._missing(name, k)]
        whole = len(filled) > 0 and not (numbers[filled] % 1).any()
        if all(ALONG_SIDES.fullmatch(cell.strip()) for cell in self.cells[name]):
            return "count" if kind not in SIZES else kind
        if not filled and kind != "error":
            return "empty"
        if filled and all(values[k] is None for k in filled):
            return "text"
        if kind in ("unknown", "other", "degree") and filled and values[filled[0]] is None:
            return "text"
        sizes = [other for other in self.cells if other != name and self.roles[other] in ("size", "count", "total")]
        if kind == "count" and sizes and numbers.tolist() in ([*range(len(values))], [*range(1, len(values) + 1)]):
            return "other"
        if (
            re.search(r"(?i).+ N$", name)
            and kind == "unknown"
            and whole
            and _same(numbers, self.numbers[next(iter(self.cells))])
        ):
            return "count" if name == next(iter(self.cells)) else "other"
        if re.fullmatch(r"(?i)\W*[pqr]\W*", name) and kind in ("order", "degree"):
            # Orders are missing on the coarsest mesh or nearly equal, and degrees are whole. An error of the pressure p
            # is none of these.
            if filled[:1] != [0]:
                return "order"
            if whole:
                return "degree"
            known = None not in values and len(filled) == len(values)
            return "order" if known and numbers.max() <= 2 * numbers.min() and numbers.max() >= 0.5 else "unknown"
        if kind == "other" and _FRACTIONAL.fullmatch(name) and (numbers % 1 > 0).all():
            return "unknown"
        return kind

    def _follows(self, name: str, before: str) -> bool:
        """Return whether a column has the orders, or the quotients, of the errors in the column before it."""
        rows = len(self.table.rows)
        if rows < 3 or self.roles[name] == "error":
            return False
        if self._missing(name, 0):
            return all(self.values[name][k] is not None for k in range(1, rows))
        with np.errstate(all="ignore"):
            quotients = self.numbers[before][:-1] / self.numbers[before][1:]
            printed = self.numbers[name][1:]
            return any(np.allclose(printed, other, rtol=0.01) for other in (quotients, np.log2(quotients)))

    def _grows(self, name: str) -> bool:
        """Return whether a column has whole numbers that do not fall as the mesh gets finer, and that are not all 0.

        Numbers of cells and unknowns, iterations and seconds grow in this way, whatever their name and its language.
        Only numbers without decimal point and exponent count, so that a growing error such as 2.0e+3 is judged.
        """
        values = self.numbers[name]
        if len(values) < 2 or not values.any() or not all(WHOLE.fullmatch(cell.strip()) for cell in self.cells[name]):
            return False
        if self.size is not None:
            sizes = self.numbers[self.size]
            counts = self.roles[self.size] in ("count", "total") or (sizes > 1).all()
            values = values[np.argsort(sizes if counts else -sizes, kind="stable")]
        return bool((np.diff(values) >= 0).all())

    def _size_column(self) -> str | None:
        """Return the name of the column of mesh sizes; None if there is none."""
        if self.options.ratio is not None:
            return None
        if (wanted := self.options.size) is not None:
            same = [name for name in self.cells if name == wanted or name.lower() == wanted.lower()]
            if not same and not ("" in self.cells and wanted.lower() in ("h", "n")):
                raise OrderError(
                    f"--in {wanted}: there is no such column; there are {', '.join(filter(None, self.cells))}"
                )
            return same[0] if same else ""
        varied = {name for name in self.cells if len(set(self.values[name])) > 1}
        # A size that stays the same from row to row tells series apart, if there is another one.
        steady = {name for name in varied if self.roles[name] in SIZES and not np.diff(self.numbers[name]).all()}
        moving = {name for name in varied - steady if self.roles[name] in SIZES}
        for kind in SIZES:
            names = [name for name in self.cells if self.roles[name] == kind and name in (moving or varied)]
            # Orders refer to the largest cell of a mesh.
            names.sort(key=lambda name: "min" in name.lower())
            if kind == "size" and len({name.lower() for name in names}) < len(names):
                raise OrderError(f"the sizes may be {' or '.join(names)}: choose one, for example --in {names[0]}")
            if names:
                return names[0]
        return "" if self.table.form.startswith("size: error pairs") else None

    # Series of rows.

    def series(self) -> list[Series]:
        """Return the series of the table.

        Raises:
            OrderError: mesh sizes are unknown or ambiguous, or a cell is not a positive number.
        """
        errors = {name: self._checked(name) for name in self.errors if name != self.size}
        groups = self._groups()
        found = []
        for label, rows in groups:
            h, words = self._sizes(rows, errors)
            if self.size is None:
                self._refuse_two_series(rows, errors)
            own = {name: [column[k] for k in rows] for name, column in errors.items()}
            left = {
                name or "(no name)": self.roles[name] for name in self.cells if name not in errors and name != self.size
            }
            remarks = {name: remark for name in own if (remark := self._contradiction(h, own[name], name, rows))}
            found.append(Series(h, own, words, left, self.table.caption, self.form, label, remarks))
        return found

    def _refuse_two_series(self, rows: list[int], errors: dict[str, list[float]]) -> None:
        """Refuse rows without sizes if errors that stagnate or grow fall again, or fall much more once.

        Raises:
            OrderError: the rows may belong to several series.
        """
        for name, column in errors.items():
            orders = consecutive_orders(_from_ratio(2, len(rows)), [column[k] for k in rows])
            for k, (before, order, after) in enumerate(zip(orders, orders[1:], orders[2:], strict=False), start=2):
                if (before <= STALLED < after) or order > max(before, after) + 1:
                    raise OrderError(
                        f"line {self.table.lines[rows[k]]} may begin another series, {name} does not fall there "
                        "as above and below: give a column with the mesh sizes or the name of the series"
                    )

    def _groups(self) -> list[tuple[str, list[int]]]:
        """Return label and rows of each series.

        A series ends where the word or the degree in a column changes, where printed orders begin again, where sizes
        jump back, and at a blank line or a rule.
        """
        labels = self._labels()
        every = range(len(self.table.rows))
        keys = [tuple(cells[k] for cells in labels.values()) for k in every]
        found = []
        for key in dict.fromkeys(keys):
            rows = [k for k in every if keys[k] == key]
            starts = self._starts(rows)
            names = " ".join(f"{name} {value}".strip() for name, value in zip(labels, key, strict=True))
            for number, (first, stop) in enumerate(pairwise([0, *starts, len(rows)]), start=1):
                found.append((f"{names} series {number}".strip() if starts else names, rows[first:stop]))
        return found

    def _labels(self) -> dict[str, list[str]]:
        """Return the columns whose entries tell several series apart; an entry may span the rows below it."""
        labels = {}
        rows = len(self.table.rows)
        first_error = [*self.cells].index(self.errors[0])
        for k, (name, cells) in enumerate(self.cells.items()):
            if name == self.size or name in self.errors or self.roles[name] == "order":
                continue
            spanned = cells[0] and "" in cells and k < first_error
            full = [next(cell for cell in cells[j::-1] if cell or not j) for j in range(rows)] if spanned else cells
            several = 1 < len(set(full)) < rows
            steady = self.roles[name] in ("count", "total") and min(Counter(full).values()) > 1
            steady = steady or (self.size is None and to_number(full[0]) is not None)
            steady = steady and any(one == other for one, other in pairwise(full))
            words = (self.roles[name] in ("text", "degree") or steady) and "" not in full
            words = words and not all(map(_STATUS.fullmatch, full))
            if several and (words or spanned):
                labels[name] = full
        return labels

    def _splits(self, cells: list[str]) -> bool:
        """Return whether the sizes are repeated, but not within the rows with the same whole number in a column."""
        sizes = self.values[self.size or ""]
        if len(set(sizes)) == len(sizes) or any(value is None or value % 1 for value in map(to_number, cells)):
            return False
        pairs = list(zip(cells, sizes, strict=True))
        return len(set(pairs)) == len(pairs) and min(Counter(cells).values()) > 1

    def _starts(self, rows: list[int]) -> list[int]:
        """Return the places in ``rows`` at which another series begins."""
        lines = self.table.breaks
        breaks = [j for j in range(1, len(rows)) if rows[j] in lines]
        # A rule below every row of a table means nothing.
        starts = set(breaks if len(breaks) < len(rows) - 1 else [])
        for name, kind in self.roles.items():
            if kind == "order" and self._missing(name, rows[0]):
                missing = [self._missing(name, k) for k in rows]
                starts |= {j for j in range(1, len(rows)) if missing[j] and not missing[j - 1]}
            if kind in ("level", *SIZES) or name == self.size:
                starts |= set(_jumps_back(self.numbers[name][rows]))
        return sorted(starts)

    # Mesh sizes.

    def _sizes(self, rows: list[int], errors: dict[str, list[float]]) -> tuple[list[float], str]:
        """Return the mesh sizes of a series, and in words how they were determined.

        They come from the ratio that the user gives, from a column, or from orders that are printed in the table.
        """
        ratio, count = self.options.ratio, len(rows)
        levels = [name for name, kind in self.roles.items() if kind == "level"]
        if ratio is not None:
            lengths = [name for name, kind in self.roles.items() if kind in ("size", "step")]
            steps = [np.abs(np.diff(np.log(self.numbers[name][rows]))) for name in lengths]
            if any(step.size and np.ptp(step) < 0.1 < abs(step[0] - abs(math.log(ratio))) for step in steps):
                raise OrderError(f"--ratio {ratio:g}, but the sizes in column {lengths[0]} have another ratio")
            if levels and count > 1 and (np.diff(self.numbers[levels[0]][rows]) < 0).all():
                return _from_ratio(ratio, count)[::-1], f"ratio {ratio:g}, finest mesh first as column {levels[0]} says"
            return _from_ratio(ratio, count), f"ratio {ratio:g}"
        if self.size is not None:
            h, words = self._converted(self.size, rows, errors)
            self._check_sizes(h, rows)
            return h, words
        for ratio in RATIOS:
            if self._agrees(_from_ratio(ratio, count), rows, errors):
                return _from_ratio(ratio, count), f"ratio {ratio:g}, which follows from the printed orders"
        degrees = [name for name, kind in self.roles.items() if kind == "degree"]
        if degrees and len(set(self.values[degrees[0]])) > 1:
            raise OrderError(
                f"column {degrees[0]} has degrees: errors against the degree (p-refinement) fall exponentially and "
                "have no order in h; give errors on several meshes for one degree"
            )
        seen = f"no column is a mesh size; seen: {', '.join(filter(None, self.cells))}. Give"
        if levels:
            seen = f"the only size is the level in column {levels[0]}: give"
        raise OrderError(
            f"{seen} --ratio 2 if each mesh is twice as fine as the one above, or --in NAME for the column of sizes"
        )

    def _converted(self, name: str, rows: list[int], errors: dict[str, list[float]]) -> tuple[list[float], str]:
        """Return the mesh sizes that follow from a column, and in words how they were determined.

        Parameters:
            name, rows: name of the column, and the rows of the series.
            errors: name of a column ↦ errors; they show whether printed orders agree.
        """
        kind, label, dim = self.roles[name], name or "n", self.options.dim
        sizes = self.numbers[name][rows]
        whole = bool((sizes > 1).all() and (dim or not (sizes % 1).any()))
        if kind == "degree":
            raise OrderError(f"--in {name}: errors against the degree (p-refinement) have no order in h")
        if not name:
            kind = "size" if str(self.options.size).lower() == "h" or not (whole or self.options.size) else "count"
        elif whole and (dim or kind not in SIZES):
            kind = "count"
        if kind in ("size", "step") and whole and self.options.size is None and (np.diff(sizes) > 0).all():
            falling = [other for other, column in errors.items() if (np.diff(np.array(column)[rows]) < 0).all()]
            if falling:
                raise OrderError(
                    f"the errors {falling[0]} fall as {name} grows: give --dim 1 if {name} counts cells along a side, "
                    f"or --in {name} if its numbers are lengths"
                )
        if kind not in ("count", "total"):
            return sizes.tolist(), f"{'Δt' if kind == 'step' else 'h'} from column {label}"
        if (sizes <= 0).any() or np.isnan(sizes).any():
            return [math.nan if not value > 0 else 1 / value for value in sizes], label
        steps = np.abs(np.diff(np.log(sizes)))
        certain = dim or self._confirmed_dim(sizes, rows, errors) or self.confirmed
        if certain is None and (kind == "total" or (steps.size and steps.min() >= math.log(3.5))):
            raise OrderError(
                f"column {label} is a count: h = 1/{label} if it counts cells along one side (--dim 1), "
                f"h = {label}^(-1/2) if it counts all cells or unknowns in the plane (--dim 2), {label}^(-1/3) in "
                "space (--dim 3); give --dim"
            )
        power = certain or 1
        words = f"h = 1/{label}" if power == 1 else f"h = {label}^(-1/{power})"
        confirmed = ", which the printed orders confirm" if not dim and certain else ""
        return (sizes ** (-1 / power)).tolist(), f"{words} from column {label}{confirmed}"

    def _confirmed_dim(self, sizes: Array, rows: list[int], errors: dict[str, list[float]]) -> int | None:
        """Return the dimension with which the printed orders follow from numbers of cells; None if it is uncertain."""
        agreeing = [dim for dim in (1, 2, 3) if self._agrees(sizes ** (-1 / dim), rows, errors)]
        return agreeing[0] if len(agreeing) == 1 else None

    def confirmed_dim(self) -> int | None:
        """Return the dimension that printed orders confirm in the whole table; None if they confirm none."""
        if self.size is None or self.roles[self.size] not in ("count", "total"):
            return None
        errors = {name: self.numbers[name].tolist() for name in self.errors}
        with np.errstate(all="ignore"):
            return self._confirmed_dim(self.numbers[self.size], list(range(len(self.table.rows))), errors)

    def _agrees(self, h: Array | list[float], rows: list[int], errors: dict[str, list[float]]) -> bool:
        """Return whether the orders that are printed in a series follow from its errors and these mesh sizes."""
        differences = [self._difference(h, errors[name], name, rows)[0] for name in errors]
        differences = [difference for difference in differences if difference < math.inf]
        return bool(differences) and max(differences) < 0.02

    def _difference(self, h: Array | list[float], errors: list[float], name: str, rows: list[int]) -> tuple[float, str]:
        """Return the largest difference of printed and computed orders, and the printed orders as text.

        One per cent of an order is no difference. Of several columns of orders, the best is taken. The difference is
        infinite if there are no printed orders.
        """
        best = (math.inf, "")
        column = errors if len(errors) == len(rows) else [errors[k] for k in rows]
        computed = consecutive_orders(h, column)
        for other in self.printed.get(name, []):
            printed = self.numbers[other][rows][1:]
            used = np.isfinite(printed) & np.isfinite(computed) & (np.abs(printed) > 0.3)
            difference = np.abs(computed - printed) - 0.01 * np.abs(printed)
            if used.any():
                best = min(best, (float(difference[used].max()), ", ".join(f"{p:g}" for p in printed[used])))
        return best

    def _contradiction(self, h: list[float], errors: list[float], name: str, rows: list[int]) -> str:
        """Return a remark if the orders that are printed in the table are not the computed ones."""
        difference, printed = self._difference(h, errors, name, rows)
        if not 0.1 < difference < math.inf:
            return ""
        computed = ", ".join(f"{order:.2f}" for order in consecutive_orders(h, errors))
        return f"the printed orders {printed} are not the computed ones {computed}"

    def _check_sizes(self, h: list[float], rows: list[int]) -> None:
        name, lines = self.size or "n", self.table.lines
        cells = self.cells[self.size or ""]
        for value, k in zip(h, rows, strict=True):
            if not 0 < value < math.inf:
                raise OrderError(f"line {lines[k]}: {name} = {cells[k]}, but sizes must be positive and finite")
        order = np.argsort(h)
        for i, j in pairwise(order):
            if h[j] - h[i] <= SAME_SIZE * h[i]:
                first, second = (rows[k] for k in sorted((i, j)))
                raise OrderError(
                    f"line {lines[second]}: {name} = {cells[second]} is already in line {lines[first]}, expected "
                    "another size on every mesh: remove one of the rows"
                )

    def _checked(self, name: str) -> list[float]:
        """Return the numbers in a column of errors; NaN for a cell with the text nan.

        Raises:
            OrderError: a cell is empty, negative or no number, or the column has logarithms of errors.
        """
        if _LOGARITHM.match(name) and not self.options.signed:
            raise OrderError(f"column {name} holds logarithms: give the mesh sizes and the errors themselves")
        for k, (cell, value, line) in enumerate(
            zip(self.cells[name], self.values[name], self.table.lines, strict=True)
        ):
            if value is None or self._missing(name, k):
                what = f"is '{cell}', not a number" if cell.strip() else "is missing"
                others = ",".join(other for other in self.errors if other != name)
                advice = f", or leave the column out: --columns '{others}'" if 0 < len(others) < 80 else ""
                raise OrderError(
                    f"line {line}: the entry of {name} {what}: write a number there, or delete the line{advice}"
                )
            if value < 0 and not self.options.signed:
                raise OrderError(f"line {line}: {name} = {cell}, but errors must not be negative: give absolute values")
        return self.numbers[name].tolist()


def _filled(cell: str) -> bool:
    return kind_of(cell) != MISSING


def _same(one: Array, other: Array) -> bool:
    return bool((one == other).all())


def _from_ratio(ratio: float, rows: int) -> list[float]:
    return [max(ratio, 1 / ratio) ** -k for k in range(rows)]


def _jumps_back(sizes: Array) -> list[int]:
    """Return the rows at which sizes begin again, if this gives several series of two rows or more."""
    steps = np.diff(sizes)
    direction = np.sign(np.median(np.sign(steps))) if steps.size else 0
    starts = [int(k) + 1 for k in np.flatnonzero(steps * direction < 0)]
    runs = np.diff([0, *starts, len(sizes)])
    return starts if (runs > 1).sum() > 1 else []

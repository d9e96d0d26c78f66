"""Orders of a published or foreign error table: ``study rates FILE.csv``.

The file has a header with ``h`` (mesh size) or ``n`` (cells per unit length, h = 1/n) and one or more
columns of errors; lines that are empty or start with # are skipped.
"""

from __future__ import annotations

import csv
import math
import textwrap
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from tabulate import tabulate

from study.ledger.orders import Array, fit, orders
from study.ledger.verdict import FAILS, HOLDS, UNDECIDED

CONSECUTIVE, FITTED = 0.15, 0.1
"""How far consecutive orders and the fitted one may lie from the expected order. Without one, an order that is so far
above the fitted order is too good: a single pair of meshes that converges faster than the table as a whole."""
SETTLED = 0.1
"""Orders count as settled from the level on after which all lie this close to the last one."""
EXACT = 1e-6
"""Scatter of three or more orders below which they look computed, not measured."""


class TableError(ValueError):
    """A table of errors cannot be read; the message names the file and the line."""


@dataclass(frozen=True)
class Report:
    """What one column of errors says, coarse to fine.

    Attributes:
        orders: consecutive orders, one fewer than errors.
        order, low, high: least squares over the asymptotic range with its 95 % interval.
        asymptotic_from: h of the first level of the asymptotic range; None if orders never settle.
        too_good: for each order why it looks better than a measured one can, or None.
        verdict: holds, fails or undecided against the expected order; None without one.
    """

    name: str
    h: tuple[float, ...]
    errors: tuple[float, ...]
    orders: tuple[float, ...]
    order: float
    low: float
    high: float
    asymptotic_from: float | None
    too_good: tuple[str | None, ...]
    expected: float | None
    verdict: str | None


def read_table(path: Path) -> tuple[Array, dict[str, Array]]:
    """Mesh sizes and the columns of errors, coarse to fine.

    Raises:
        TableError: no such file, no ``h`` or ``n``, no errors, fewer than two levels, or an entry that
            is missing, not a number, not positive or stands in its column twice; names the lines.
    """
    rows = _read_lines(path)
    (first, head), levels = rows[0], rows[1:]
    names = [name for name in head if name not in ("h", "n")]
    if len(head) - len(names) != 1 or not names or len(set(head)) < len(head):
        raise TableError(
            f"{path}, line {first}: the header is {', '.join(head)}; expected h or n, and one or more columns of errors"
        )
    for number, cells in levels:
        if len(cells) != len(head):
            raise TableError(f"{path}, line {number}: {len(cells)} entries, expected {len(head)} ({', '.join(head)})")
    values = [[_positive(path, number, *entry) for entry in zip(head, cells, strict=True)] for number, cells in levels]
    if len(values) < 2:
        raise TableError(f"{path} has {len(values)} level(s); an order needs two or more")
    columns = dict(zip(head, np.array(values).T, strict=True))
    for name, column in columns.items():
        _refuse_repeated(path, name, column, [number for number, _ in levels])
    h = columns["h"] if "h" in columns else 1 / columns["n"]
    coarse_first = np.argsort(-h)
    return h[coarse_first], {name: columns[name][coarse_first] for name in names}


def _read_lines(path: Path) -> list[tuple[int, list[str]]]:
    """The number and the cells of every line with content."""
    if not path.is_file():
        raise TableError(f"there is no file {path}")
    try:
        lines = path.read_text(encoding="utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise TableError(f"{path} is not text in UTF-8 (byte {error.start}); save it as CSV in UTF-8") from error
    rows = [
        (number, [cell.strip() for cell in next(csv.reader([line]))])
        for number, line in enumerate(lines, start=1)
        if line.strip() and not line.lstrip().startswith("#")
    ]
    if not rows:
        raise TableError(f"{path} is empty; expected a header h,error or n,error and one line per level")
    return rows


def _positive(path: Path, number: int, name: str, cell: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        what = "is missing" if not cell else f"is {cell!r}, not a number"
        raise TableError(f"{path}, line {number}: the entry of {name} {what}") from None
    if not (math.isfinite(value) and value > 0):
        raise TableError(f"{path}, line {number}: {name} = {cell}, but sizes and errors must be positive and finite")
    return value


def _refuse_repeated(path: Path, name: str, values: Array, lines: list[int]) -> None:
    """Two meshes differ in their size, and errors on them in some digit."""
    for i, value in enumerate(values):
        if value in values[:i]:
            before = lines[list(values).index(value)]
            raise TableError(
                f"{path}, line {lines[i]}: {name} = {value:.12g} stands in line {before} already, expected another "
                "value on every mesh: remove the row if it was copied, or give more digits"
            )


def report(name: str, h: Array, errors: Array, expected: float | None = None) -> Report:
    """Orders, fit, asymptotic range and verdict of one column, coarse to fine."""
    found = orders(h, errors)
    unsettled = np.flatnonzero(abs(found - found[-1]) > SETTLED)
    first = int(unsettled[-1]) + 1 if unsettled.size else 0
    # One order alone is no range.
    asymptotic = first if len(found) - first >= 2 else None
    start = asymptotic if asymptotic is not None else max(0, len(h) - 3)
    line = fit(h[start:], errors[start:])
    return Report(
        name=name,
        h=tuple(map(float, h)),
        errors=tuple(map(float, errors)),
        orders=tuple(map(float, found)),
        order=line.order,
        low=line.low,
        high=line.high,
        asymptotic_from=None if asymptotic is None else float(h[asymptotic]),
        too_good=_too_good(found, line.order, expected),
        expected=expected,
        verdict=None if expected is None else _verdict(found, line.order, asymptotic, expected),
    )


def _too_good(found: Array, fitted: float, expected: float | None) -> tuple[str | None, ...]:
    if len(found) >= 3 and np.ptp(found) < EXACT:
        return ("all orders are equal to six digits: computed from a formula rather than measured?",) * len(found)
    usual, of = (fitted, "fitted") if expected is None else (expected, "expected")
    why = f"above the {of} {usual:.3g} by more than {CONSECUTIVE:g}: superconvergence, or the wrong error?"
    return tuple(why if order > usual + CONSECUTIVE else None for order in found)


def _verdict(found: Array, fitted: float, asymptotic: int | None, expected: float) -> str:
    if asymptotic is None:
        return UNDECIDED
    inside = abs(found[asymptotic:] - expected).max() <= CONSECUTIVE and abs(fitted - expected) <= FITTED
    return HOLDS if inside else FAILS


def as_text(found: Report) -> str:
    """The report as lines for a terminal."""
    orders = ["", *(f"{order:.3f}" for order in found.orders)]
    marks = ["", *("too good" if why else "" for why in found.too_good)]
    sizes, errors = ([f"{value:.5g}" for value in values] for values in (found.h, found.errors))
    rows = [("h", "error", "order", ""), *zip(sizes, errors, orders, marks, strict=True)]
    table = tabulate(rows, tablefmt="plain", disable_numparse=True, colalign=("right", "right", "right", "left"))
    interval = f" in [{found.low:.3f}, {found.high:.3f}] (95 %)"
    lines = [
        f"fitted order {found.order:.3f}{interval if math.isfinite(found.low) else ', no interval from two levels'}"
    ]
    if found.asymptotic_from is None:
        lines.append(f"orders have not settled to ± {SETTLED:g}: no asymptotic range yet")
    else:
        lines.append(f"asymptotic from h = {found.asymptotic_from:.5g}")
    lines += [f"too good to be true? {why}" for why in dict.fromkeys(found.too_good) if why]
    if found.verdict:
        lines.append(f"expected {found.expected:g} ± {CONSECUTIVE:g} (fitted ± {FITTED:g}): {found.verdict}")
    return found.name + "\n" + textwrap.indent("\n".join([table, *lines]), "  ")


def as_json(found: Report) -> dict[str, Any]:
    """The report for machines; an interval that does not exist is null."""
    values = asdict(found)
    return values | {end: values[end] if math.isfinite(values[end]) else None for end in ("low", "high")}

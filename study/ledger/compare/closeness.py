"""When two numbers count as equal, and how many of two columns do not."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.float64]
Booleans = NDArray[np.bool_]
Row = dict[str, str]
"""What names a row: column ↦ cell."""


@dataclass(frozen=True)
class Tolerance:
    """Numbers a and b count as equal if |a − b| ≤ absolute + relative · max(|a|, |b|)."""

    relative: float = 1e-12
    absolute: float = 0.0

    def equates(self, a: Numbers, b: Numbers) -> Booleans:
        """Whether finite numbers count as equal; others never do."""
        with np.errstate(all="ignore"):
            limit = self.absolute + self.relative * np.maximum(abs(a), abs(b))
            return np.isfinite(a) & np.isfinite(b) & (abs(a - b) <= limit)


@dataclass(frozen=True)
class Cell:
    """One cell in both tables: its row, its text in each, and |a − b| / max(|a|, |b|).

    ``relative`` is infinite for a number against none or against an infinite one, and None for words.
    """

    row: Row
    old: str
    new: str
    relative: float | None


@dataclass(frozen=True)
class ComparedColumn:
    """Cells of a column that differ.

    Attributes:
        name: of the column.
        cells: how many both tables have.
        differing: how many differ at all.
        beyond: how many differ by more than the tolerance; all that differ, of words and of whole numbers.
        by_absolute: how many count as equal by the absolute tolerance alone.
        largest: the one that differs most, among those beyond the tolerance if there are any; of words the first.
    """

    name: str
    cells: int
    differing: int
    beyond: int
    by_absolute: int
    largest: Cell


def words(name: str, cells: int, changed: list[Cell]) -> ComparedColumn | None:
    """A column of words of which some changed; None if none did."""
    return ComparedColumn(name, cells, len(changed), len(changed), 0, changed[0]) if changed else None


def numbers(
    name: str, a: Numbers, b: Numbers, whole: Booleans, tolerance: Tolerance, cell: Callable[[int, float], Cell]
) -> ComparedColumn | None:
    """What differs between two columns of numbers; None if nothing does, where NaN is NaN and −0 is 0.

    Whole numbers (levels, steps, counts) have no tolerance. ``cell`` makes the cell of a place, given its relative
    difference.
    """
    same = (a == b) | (np.isnan(a) & np.isnan(b))
    if same.all():
        return None
    beyond = ~same & (whole | ~tolerance.equates(a, b))
    by_absolute = ~same & ~beyond & ~Tolerance(tolerance.relative).equates(a, b)
    relative = np.where(same, 0.0, _relative(a, b))
    worst = int(np.argmax(np.where(beyond, relative, -1.0) if beyond.any() else relative))
    differing, far, near = (int(np.count_nonzero(cells)) for cells in (~same, beyond, by_absolute))
    return ComparedColumn(name, len(a), differing, far, near, cell(worst, float(relative[worst])))


def _relative(a: Numbers, b: Numbers) -> Numbers:
    """|a − b| / max(|a|, |b|), infinite unless both are finite."""
    with np.errstate(all="ignore"):
        return np.where(np.isfinite(a) & np.isfinite(b), abs(a - b) / np.maximum(abs(a), abs(b)), math.inf)

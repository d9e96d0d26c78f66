"""What differs between two tables, column by column."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass

import numpy as np

from study.ledger.compare.closeness import Cell, ComparedColumn, Row, Tolerance, numbers, words
from study.ledger.compare.matching import PROSE, Match, TableKind, match
from study.ledger.compare.reading import ReadTable
from study.ledger.datafiles import TEXT

WORDS = TEXT | PROSE | {"key", "defect", "setting", "caught", "claimed"}
"""Columns that hold words even where they look like numbers; another one does if no cell of it is a number."""
WHOLE = re.compile(r"[+-]?\d+|")


@dataclass(frozen=True)
class Rewording:
    """Other words in a column for readers, and in how many rows."""

    column: str
    old: str
    new: str
    rows: int


@dataclass(frozen=True)
class TableDifference:
    """What differs between two tables; rows and columns in one of them only, and what differs in both.

    Attributes:
        rows: how many are in both.
        only_old, only_new: the others.
        columns_old, columns_new: columns of one table only, but for those that data of earlier versions lack.
        later: these.
        columns: those that differ.
        verdicts: every verdict that changed.
        words: what was reworded.
        renamed: old and new names of rows that were found by their numbers alone, as their words were changed.
    """

    rows: int
    only_old: tuple[Row, ...] = ()
    only_new: tuple[Row, ...] = ()
    columns_old: tuple[str, ...] = ()
    columns_new: tuple[str, ...] = ()
    later: tuple[str, ...] = ()
    columns: tuple[ComparedColumn, ...] = ()
    verdicts: tuple[Cell, ...] = ()
    words: tuple[Rewording, ...] = ()
    renamed: tuple[tuple[Row, Row], ...] = ()

    @property
    def differs(self) -> bool:
        """Whether anything differs by more than the tolerance; words for readers do not count."""
        lost = self.only_old or self.only_new or self.columns_old or self.columns_new
        return bool(lost) or any(column.beyond for column in self.columns)


def compare_tables(kind: TableKind, old: ReadTable, new: ReadTable, tolerance: Tolerance) -> TableDifference:
    """What differs between two tables.

    Raises:
        DataError: a row is there twice, or a number is none.
    """
    found = match(kind, old, new)
    shared = [name for name in old.columns if name in new.columns]
    pair = _Pair(kind, old, new, found, tolerance)
    single = [[name for name in a.columns if name not in b.columns] for a, b in ((old, new), (new, old))]
    return TableDifference(
        rows=len(found.both),
        only_old=tuple(kind.row(old, i) for i in found.only_old),
        only_new=tuple(kind.row(new, i) for i in found.only_new),
        columns_old=tuple(name for name in single[0] if name not in kind.later),
        columns_new=tuple(name for name in single[1] if name not in kind.later),
        later=tuple(name for name in (*single[0], *single[1]) if name in kind.later),
        columns=tuple(column for name in shared if name not in PROSE and (column := pair.column(name))),
        verdicts=tuple(pair.cell("verdict", n, None) for n in pair.changed("verdict")) if "verdict" in shared else (),
        words=tuple(reworded for name in shared if name in PROSE for reworded in pair.rewordings(name)),
        renamed=tuple((kind.row(old, i), kind.row(new, j)) for i, j in found.renamed),
    )


@dataclass(frozen=True)
class _Pair:
    """Two tables, and which rows of them are the same."""

    kind: TableKind
    old: ReadTable
    new: ReadTable
    match: Match
    tolerance: Tolerance

    def cell(self, column: str, n: int, relative: float | None) -> Cell:
        """The cell of a column in the n-th of the rows that are in both."""
        i, j = self.match.both[n]
        return Cell(self.kind.row(self.old, i), self.old.columns[column][i], self.new.columns[column][j], relative)

    def changed(self, column: str) -> list[int]:
        """Where the text of a column differs."""
        old, new = self.old.columns[column], self.new.columns[column]
        return [n for n, (i, j) in enumerate(self.match.both) if old[i] != new[j]]

    def rewordings(self, column: str) -> list[Rewording]:
        cells = (self.cell(column, n, None) for n in self.changed(column))
        return [Rewording(column, *texts, rows) for texts, rows in Counter((c.old, c.new) for c in cells).items()]

    def column(self, name: str) -> ComparedColumn | None:
        """What differs in a column of numbers or of words; None if nothing does."""
        if name in WORDS or not (self.old.has_number(name) or self.new.has_number(name)):
            return words(name, len(self.match.both), [self.cell(name, n, None) for n in self.changed(name)])
        rows = np.array(self.match.both, dtype=int).reshape(-1, 2)
        a, b = self.old.numbers(name)[rows[:, 0]], self.new.numbers(name)[rows[:, 1]]
        whole = np.full(len(rows), self._whole(name))
        return numbers(name, a, b, whole, self.tolerance, lambda n, relative: self.cell(name, n, relative))

    def _whole(self, name: str) -> bool:
        """Whether all cells of a column are whole numbers: levels, steps and counts."""
        return all(WHOLE.fullmatch(cell) for table in (self.old, self.new) for cell in table.columns[name])

"""Which row of one table is which row of another."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from study.ledger.compare.closeness import Row
from study.ledger.compare.reading import ReadTable, again
from study.ledger.datafiles import DataError

PROSE = frozenset({"statement", "quantity", "expected", "summary", "reason", "what", "regularity", "law"})
"""Columns for readers: other words in them are told, but nothing was measured or judged otherwise."""


@dataclass(frozen=True)
class TableKind:
    """What identifies the rows of a data file.

    Attributes:
        key: columns whose cells a row shares with no other.
        repeated: rows may share them nevertheless, and are told apart by the order in which they stand.
        numbers: columns by which a row is found again whose words were changed; none where it is not looked for.
        later: columns that data of earlier versions lack: no difference where only one directory has them.
    """

    key: tuple[str, ...]
    repeated: bool = False
    numbers: tuple[str, ...] = ()
    later: tuple[str, ...] = ()

    def row(self, table: ReadTable, i: int) -> Row:
        """What names a row to a reader: its identity and the quantity that stands there."""
        names = [name for name in dict.fromkeys((*self.key, "quantity")) if name in table.columns]
        # Where the columns do not tell rows apart, the line does.
        line = {"line": str(table.lines[i])} if self.repeated and not self.numbers else {}
        return {name: table.columns[name][i] for name in names} | line


LATER = ("key", "family", "window_low", "window_high")
BOUND = ("trajectory", "case", "family", "scheme", "level")
BY_LINE = TableKind((), repeated=True)
"""Of a file that is not known here."""
TABLES: dict[str, tuple[TableKind, ...]] = {
    "rates.csv": (TableKind(("claim", "case", "family", "scheme", "level")),),
    "equivalence.csv": (TableKind(("case", "form", "level", "family")),),
    "stresses.csv": (TableKind(("case", "family", "level")),),
    "statements.csv": (TableKind(("label", "case", "family", "level", "quantity")),),
    "bounds.csv": (TableKind(BOUND),),
    # Times are not exact: a row is the same by its place among the times of one computation.
    "enclosures.csv": (TableKind(BOUND, repeated=True),),
    "claims.csv": (
        TableKind(("label", "key", "case", "family"), later=LATER),
        TableKind(("label", "case", "quantity"), repeated=True, numbers=("observed", "low", "high"), later=LATER),
    ),
    "cases.csv": (TableKind(("case",)),),
    "controls.csv": (TableKind(("defect", "setting")),),
    "seeds.csv": (
        TableKind(("label", "case", "quantity"), repeated=True, numbers=("seeds", "lowest", "highest"), later=LATER),
    ),
}
"""File ↦ what identifies its rows; of several, the first whose columns both directories have."""


def kind_of(name: str, old: ReadTable, new: ReadTable) -> TableKind:
    """What identifies the rows of both tables.

    Raises:
        DataError: one of them lacks a column for it.
    """
    kinds = TABLES.get(name, (BY_LINE,))
    shared = old.columns.keys() & new.columns.keys()
    kind = next((kind for kind in kinds if shared.issuperset(kind.key)), kinds[-1])
    for table in (old, new):
        if lacking := [column for column in (*kind.key, *kind.numbers) if column not in table.columns]:
            raise DataError(f"{table.path} lacks the columns {', '.join(lacking)}: {again(table.path)}")
    return kind


@dataclass(frozen=True)
class Match:
    """Rows by their numbers in the tables; ``renamed`` are those of ``both`` that only their numbers tell."""

    both: list[tuple[int, int]]
    renamed: list[tuple[int, int]]
    only_old: list[int]
    only_new: list[int]


def match(kind: TableKind, old: ReadTable, new: ReadTable) -> Match:
    """The rows of two tables that are the same.

    Raises:
        DataError: two rows of a table have one identity, or a number by which rows are found is none.
    """
    both, only_old, only_new = _pairs(_identified(kind, old), _identified(kind, new))
    renamed: list[tuple[int, int]] = []
    if kind.numbers and only_old and only_new:
        renamed, only_old, only_new = _pairs(_measured(kind, old, only_old), _measured(kind, new, only_new))
    return Match(both + renamed, renamed, only_old, only_new)


Identities = dict[tuple[tuple[str, ...], int], int]
"""(cells, how many rows before have the same) ↦ row."""


def _pairs(old: Identities, new: Identities) -> tuple[list[tuple[int, int]], list[int], list[int]]:
    """Rows in both, only in the first, only in the second."""
    both = [(i, new[identity]) for identity, i in old.items() if identity in new]
    only = [[i for identity, i in mine.items() if identity not in other] for mine, other in ((old, new), (new, old))]
    return both, only[0], only[1]


def _identified(kind: TableKind, table: ReadTable) -> Identities:
    found = _counted((tuple(table.columns[name][i] for name in kind.key), i) for i in range(len(table)))
    for (cells, before), i in found.items():
        if before and not kind.repeated:
            first = table.lines[found[cells, 0]]
            row = ", ".join(f"{name} = {cell}" for name, cell in zip(kind.key, cells, strict=True))
            raise DataError(
                f"{table.path}, line {table.lines[i]}: {row} stands in line {first} already, expected one row: "
                f"{again(table.path)}"
            )
    return found


def _measured(kind: TableKind, table: ReadTable, rows: list[int]) -> Identities:
    """Rows by what of their key is no prose, and by their numbers to nine digits."""
    names = [table.columns[name] for name in kind.key if name not in PROSE]
    numbers = [table.numbers(name) for name in kind.numbers]
    return _counted(
        # 0 is added as −0 and 0 are one number.
        ((*(cells[i] for cells in names), *(f"{values[i] + 0.0:.9g}" for values in numbers)), i)
        for i in rows
    )


def _counted(rows: Iterable[tuple[tuple[str, ...], int]]) -> Identities:
    seen: Counter[tuple[str, ...]] = Counter()
    found: Identities = {}
    for cells, i in rows:
        found[cells, seen[cells]] = i
        seen[cells] += 1
    return found

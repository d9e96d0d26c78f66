"""A comparison as text of 80 columns, verdicts first, and for programs."""

from __future__ import annotations

import math
import textwrap
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from typing import Any

from study.ledger.compare.closeness import Cell, ComparedColumn, Row, Tolerance
from study.ledger.compare.differences import TableDifference
from study.ledger.compare.directories import DIFFERS, IDENTICAL, LEFT_OUT, WITHIN, Comparison, FileDifference

WIDTH = 80
VERDICTS, ROWS = 20, 5
"""How many changed verdicts, and rows of one directory only, are shown one by one."""


def as_text(found: Comparison) -> str:
    """Changed verdicts, a block for every file, and their numbers; at most 80 columns wide."""
    judged = any(file.name == "claims.csv" and not file.only for file in found.files)
    lines = [*_verdicts(found.verdicts)] or (["verdicts: none changed", ""] if judged else [])
    same = [file.name for file in found.files if file.state == IDENTICAL and file.name.startswith("pictures/")]
    for file in found.files:
        if file.name not in same:
            lines += _file(file, found.tolerance)
    if same:
        lines.append(f"pictures/: {len(same)} with identical bytes")
    return "\n".join([*lines, "", _summary(found)])


def as_json(found: Comparison) -> dict[str, Any]:
    """The comparison for programs, with every row and every word that changed.

    A relative difference is null where there is none: of words, and of a number against none or an infinite one.
    """
    states = {state: found.count(state) for state in (IDENTICAL, WITHIN, DIFFERS, LEFT_OUT)}
    content: dict[str, Any] = asdict(found) | {"old": str(found.old), "new": str(found.new)}
    for file in content["files"]:
        if not (table := file["found"]):
            continue
        del table["verdicts"]
        for column in table["columns"]:
            if math.isinf(column["largest"]["relative"] or 0):
                column["largest"]["relative"] = None
    verdicts = [asdict(cell) for cell in found.verdicts]
    return {"differs": found.differs, "states": states, "verdicts": verdicts, **content}


def _summary(found: Comparison) -> str:
    # Both parts of a tolerance stand with every file; the last line is one line.
    size = "tolerance" if found.tolerance.absolute else _size(found.tolerance)
    counts = (
        f"{len(found.files)} files: {found.count(IDENTICAL)} identical to the byte, {found.count(WITHIN)} "
        f"within {size}, {found.count(DIFFERS)} differ"
    )
    return counts + (f", {found.count(LEFT_OUT)} left out" if found.count(LEFT_OUT) else "")


def _verdicts(cells: Sequence[Cell]) -> Iterator[str]:
    if cells:
        yield f"verdicts: {len(cells)} changed"
        for cell in cells[:VERDICTS]:
            yield from _fold(f"{_name(cell.row)}: {cell.old} → {cell.new}", 2)
        yield from _more(len(cells) - VERDICTS)
        yield ""


def _file(file: FileDifference, tolerance: Tolerance) -> Iterator[str]:
    if file.only:
        why = f"; `{file.command}` writes it, not compared" if file.command else ": differs"
        yield from _fold(f"{file.name}: only in {file.only}{why}", 0)
    elif file.found is None:
        yield f"{file.name}: identical bytes"
    else:
        state = DIFFERS if file.state == DIFFERS else f"{WITHIN} {_size(tolerance)}"
        rows = f", {_rows(file.found.rows)} in both" if file.name.endswith(".csv") else ""
        yield f"{file.name}: {state}{rows}"
        yield from _table(file.found)


def _table(table: TableDifference) -> Iterator[str]:
    for side, rows in (("OLD", table.only_old), ("NEW", table.only_new)):
        if rows:
            yield f"  {_rows(len(rows))} only in {side}"
            for row in rows[:ROWS]:
                yield from _fold(_name(row), 4)
            yield from _more(len(rows) - ROWS)
    for side, columns in (("OLD", table.columns_old), ("NEW", table.columns_new)):
        if columns:
            yield from _fold(f"columns only in {side}: {', '.join(columns)}", 2)
    if table.later:
        yield from _fold(f"columns that the older directory lacks: {', '.join(table.later)}", 2)
    for column in table.columns:
        yield from _column(column)
    if table.words:
        reworded = Counter[str]()
        for words in table.words:
            reworded[words.column] += words.rows
        yield from _fold("words changed: " + ", ".join(f"{name} in {_rows(n)}" for name, n in reworded.items()), 2)
    if table.renamed:
        yield f"  {_rows(len(table.renamed))} renamed: found by their numbers alone"


def _column(column: ComparedColumn) -> Iterator[str]:
    """How many cells differ, and the one that does most."""
    line = f"{column.name}: {column.differing} of {column.cells} differ"
    if column.largest.relative is not None:
        line += f", {column.beyond} beyond tolerance"
        line += f", {column.by_absolute} equal by --absolute alone" if column.by_absolute else ""
        line += f"; largest {column.largest.relative:.1e}:"
    yield from _fold(line, 2)
    cell = column.largest
    yield from _fold(f"{_name(cell.row)}: {cell.old or 'nothing'} → {cell.new or 'nothing'}", 4)


def _name(row: Row) -> str:
    """The cells that name a row; the key of a verdict, which its quantity says in words, is left out."""
    cells = [f"line {cell}" if name == "line" else cell for name, cell in row.items() if name != "key" and cell]
    return ", ".join(cells)


def _size(tolerance: Tolerance) -> str:
    return f"{tolerance.relative:g}" + (f" relative + {tolerance.absolute:g}" if tolerance.absolute else "")


def _rows(number: int) -> str:
    return f"{number} row" if number == 1 else f"{number} rows"


def _more(number: int) -> Iterator[str]:
    if number > 0:
        yield f"    and {number} more"


def _fold(text: str, indent: int) -> list[str]:
    first, later = " " * indent, " " * (indent + 4)
    # Old and new value stay on one line.
    held = text.replace(" → ", "\u00a0→\u00a0")
    lines = textwrap.wrap(held, WIDTH, initial_indent=first, subsequent_indent=later, break_on_hyphens=False)
    return [line.replace("\u00a0", " ") for line in lines]

"""A comparison as text of 80 columns, verdicts first, and for programs."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from study.ledger.compare.difference import DIFFERS, IDENTICAL, LEFT_OUT, WITHIN, Comparison

VERDICTS, ROWS, PLACES = 20, 5, 3
"""How many changed verdicts, rows that only one directory has, and differences in a picture are shown."""


def as_json(found: Comparison) -> dict[str, Any]:
    """The comparison for programs."""
    head = {"differs": found.differs, "states": found.states, "verdicts": found.verdicts}
    return {**head, **asdict(found), "old": str(found.old), "new": str(found.new)}


def as_text(found: Comparison) -> str:
    """Changed verdicts, a block for every file, and a line with their numbers."""
    lines = (textwrap.fill(line, 80, subsequent_indent=" " * 8, break_on_hyphens=False) for line in _lines(found))
    return "\n".join(lines).replace("\u00a0", " ")


def _lines(found: Comparison) -> Iterator[str]:
    """Lines of any length."""
    yield f"verdicts: {len(found.verdicts) or 'none'} changed"
    yield from _listed(found.verdicts, VERDICTS)
    yield ""
    same = [file for file in found.files if file.state == IDENTICAL and "/" in file.name]
    for file in found.files:
        if file not in same:
            yield f"{file.name}: {file.state}" + f", only in {file.only}" * bool(file.only)
        for difference in file.differences[: PLACES if "/" in file.name else None]:
            line = f"{difference.what}: {difference.differing}"
            if difference.compared:
                line += f" of {difference.compared} differ, {difference.beyond} beyond tolerance"
            largest = difference.cells[0]["relative"]
            yield f"  {line}" if largest is None else f"  {line}; largest {largest:.1e}"
            yield from _listed(difference.cells, 1 if difference.compared else ROWS)
    if same:
        yield f"pictures/: {len(same)} {IDENTICAL}"
    count, size = found.states, f"{found.tolerance.relative:g} relative + {found.tolerance.absolute:g}"
    told = f"{count[IDENTICAL]} identical, {count[WITHIN]} within {size}, {count[DIFFERS]} differ"
    yield ""
    yield f"{len(found.files)} files: {told}, {count[LEFT_OUT]} left out"


def _listed(cells: list[dict[str, Any]], most: int) -> Iterator[str]:
    for cell in cells[:most]:
        # Spaces at which no line ends.
        change = f": {cell['old'] or 'nothing'}\u00a0→\u00a0{cell['new'] or 'nothing'}"
        yield f"    {cell['row']}" + change * (cell["old"] != cell["new"])
    if len(cells) > most > 1:
        yield f"    and {len(cells) - most} more"

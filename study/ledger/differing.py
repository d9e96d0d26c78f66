"""Where a file differs from the text that would be written now: line, column of a table, and both texts."""

from __future__ import annotations

import csv
import math
from itertools import zip_longest
from pathlib import Path

from study.ledger.datafiles import LEDGER, TEXT

NUMBERS = {name for name in LEDGER if name not in TEXT} - {"expected", "family"}
"""Columns of ``claims.csv`` whose last digits depend on the machine."""
ROOM = 1e-6
"""Relative difference that their numbers may have: some are found by iteration."""
WIDTH = 60
"""Characters that are shown of a text."""


def difference(path: Path, expected: str, close: frozenset[str] = frozenset()) -> str | None:
    """Where the file at a path first differs from a text, in words; None if it does not.

    Args:
        close: columns in which numbers may differ by rounding.
    """
    stands = path.read_text(encoding="utf-8", errors="replace")
    if stands == expected:
        return None
    pairs = zip_longest(stands.split("\n"), expected.split("\n"))
    head = next(csv.reader([expected.partition("\n")[0]])) if path.suffix == ".csv" else []
    for number, (old, new) in enumerate(pairs, start=1):
        if old != new and (said := _in_line(old, new, head, close)):
            return f"{path}, line {number}{said}"
    return None


def _in_line(old: str | None, new: str | None, head: list[str], close: frozenset[str]) -> str:
    """Which column differs, and how; nothing if only last digits do."""
    if old is None or new is None:
        return f": stands {_shown(old)}, would be {_shown(new)}"
    if not head:
        return f": stands {_shown(*_around(old, new))}, would be {_shown(*_around(new, old))}"
    cells = zip_longest(head, *(next(csv.reader([text]), []) for text in (old, new)))
    for name, a, b in cells:
        if a != b and not (name in close and _close(a, b)):
            return f", column {name}: stands {_shown(*_around(a, b))}, would be {_shown(*_around(b, a))}"
    return ""


def _around(text: str | None, other: str | None) -> tuple[str | None, int]:
    """A text, and where it begins to differ from another one."""
    same = next((i for i, (a, b) in enumerate(zip(text or "", other or "", strict=False)) if a != b), 0)
    return text, same


def _shown(text: str | None, place: int = 0) -> str:
    """A text, or the part around a place if it is long; nothing for no line."""
    if text is None:
        return "nothing"
    start = max(0, place - WIDTH // 2) if len(text) > WIDTH else 0
    part = text[start : start + WIDTH]
    return f"{'…' * (start > 0)}{part!r}{'…' * (start + WIDTH < len(text))}"


def _close(a: str | None, b: str | None) -> bool:
    """Whether two texts are numbers that differ by rounding."""
    try:
        return math.isclose(float(a or "nan"), float(b or "nan"), rel_tol=ROOM, abs_tol=1e-12)
    except ValueError:
        return False

"""Which folder or file of the code says how a statement is measured and judged, asked of the code itself."""

from __future__ import annotations

import inspect
from pathlib import Path

from study.statements import STATEMENTS

ROOT = Path(__file__).parents[3]


def sources() -> dict[str, list[str]]:
    """label ↦ the files, from the root of the repository, that judge the rows of that label."""
    found: dict[str, list[str]] = {}
    for statement in STATEMENTS:
        file = Path(inspect.getfile(type(statement))).relative_to(ROOT).as_posix()
        files = found.setdefault(statement.label, [])
        files += [file] if file not in files else []
    return found

"""Where the code and the data of a statement are, asked of the statements themselves."""

from __future__ import annotations

import inspect
from pathlib import Path
from typing import Any

from study.run.completeness import Complete
from study.statements import STATEMENTS
from study.statements.shared.base import Listed

ROOT = Path(__file__).parents[2]


def sources() -> dict[str, dict[str, Any]]:
    """label ↦ ``code``, from the root of the repository, and the ``data`` file with what it is judged by.

    The code is the folder of a statement, or its file where it has no folder of its own.
    """
    complete = Path(inspect.getfile(Complete)).relative_to(ROOT).as_posix()
    found: dict[str, dict[str, Any]] = {Complete.label: {"code": [complete], "data": "provenance.json"}}
    for statement in STATEMENTS:
        file = Path(inspect.getfile(type(statement))).relative_to(ROOT)
        place = file.as_posix() if file.parent.name in ("statements", "shared") else f"{file.parent.as_posix()}/"
        data = "claims.csv" if isinstance(statement, Listed) else statement.file.name
        of = found.setdefault(statement.label, {"code": [], "data": data})
        of["code"] += [place] if place not in of["code"] else []
    return found

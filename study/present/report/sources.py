"""Which file of the code judges a statement, asked of the code itself."""

from __future__ import annotations

import inspect
from pathlib import Path

from study.statements import STATEMENTS
from study.statements.enclosure import claims as bounds
from study.statements.prop_5_4 import claims
from study.statements.thm_4_2 import orders_of_stresses as stresses

ROOT = Path(claims.__file__).parents[3]


def sources() -> dict[str, list[str]]:
    """label ↦ the files, from the root of the repository, that judge the rows of that label."""
    found: dict[str, list[str]] = {}
    judged = [(label, claims.__file__) for label in claims.STATEMENTS]
    judged += [(label, bounds.__file__) for label in bounds.STATEMENTS]
    judged += [(stresses.LABEL, stresses.__file__)]
    judged += [(statement.label, inspect.getfile(type(statement))) for statement in STATEMENTS]
    for label, file in judged:
        found.setdefault(label, []).append(Path(file).relative_to(ROOT).as_posix())
    return found

"""Which folder or file of the code says how a statement is measured and judged, asked of the code itself."""

from __future__ import annotations

import inspect
import sys
from pathlib import Path
from types import ModuleType

from study.ledger.verdict import Named
from study.run.judgement import Complete
from study.statements import STATEMENTS

ROOT = Path(__file__).parents[3]


def sources() -> dict[str, list[str]]:
    """label ↦ the files, from the root of the repository, that judge the rows of that label."""
    judged: tuple[Named, ...] = (Complete(), *STATEMENTS)
    found: dict[str, list[str]] = {}
    for statement in judged:
        file = Path(inspect.getfile(_home(statement))).relative_to(ROOT).as_posix()
        files = found.setdefault(statement.label, [])
        files += [file] if file not in files else []
    return found


def _home(statement: Named) -> ModuleType | type[Named]:
    """The module of the statements that has the object itself, such as a list of slips, or else its class."""
    modules = [module for name, module in sys.modules.items() if name.startswith("study.statements.")]
    return next((m for m in modules if any(value is statement for value in vars(m).values())), type(statement))

"""What a result is known by: a hash of all that it depends on."""

from __future__ import annotations

import hashlib
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any

import numpy as np
import sympy as sp

from manufactured.exact import ExactSolution
from study.fem.naming import family_named
from study.run.versions import versions
from study.statements.enclosure.bound_rows import posed
from study.statements.shared.base import Setting, Statement


def fingerprint(statement: Statement, setting: Setting) -> str:
    """The hash for a statement in a setting: the problem, the mesh family and the setting by value, and versions."""
    settings = {name: value for name, value in vars(setting).items() if name != "case"}
    values = [family_named(setting.family), statement.steps(setting), sorted(settings.items())]
    return _hash([statement.label, versions(), problem(setting.case), *map(by_value, values)])


@cache
def problem(reference: str) -> str:
    """The hash of the exact solution behind a reference, or of the data of a problem whose solution is unknown."""
    behind = posed(reference)
    data = behind.data.body, behind.data.law, behind.data.formulas_of
    return _hash([behind.pace, by_value(behind.case.solution if behind.case else data)])


def by_value(item: object) -> object:
    """Frozen dataclasses as their fields, formulas as text, arrays as lists, all the way down."""
    if isinstance(item, ExactSolution):
        return _of_solution(item)
    if is_dataclass(item) and not isinstance(item, type):
        return _of_fields(item)
    if isinstance(item, tuple | list):
        return [by_value(entry) for entry in item]
    if isinstance(item, np.ndarray):
        return item.tolist()
    if isinstance(item, sp.Basic):
        return sp.srepr(item)
    return repr(item)


def _of_fields(item: Any) -> list[object]:
    return [type(item).__name__, *(by_value(getattr(item, field.name)) for field in fields(item) if field.init)]


# Most jobs share the solution of their case with others, and its formulas are long.
_of_solution = cache(_of_fields)


def _hash(values: list[object]) -> str:
    return hashlib.sha256(repr(values).encode()).hexdigest()[:16]

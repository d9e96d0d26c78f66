"""What a result is known by: a hash of the problem and the setting by value, of versions, and of the code behind it.

The code is that of the modules that the module of ``measure`` imports, directly or through others, and of those with
the types of the exact solution, as syntax trees: comments, docstrings and line breaks do not count. Nobody has to say
that a change of the code changes numbers. Not in it is which kernels a BLAS takes for a processor: last digits may
differ between processors.
"""

from __future__ import annotations

import hashlib
import platform
from collections.abc import Iterable, Iterator
from dataclasses import fields, is_dataclass
from functools import cache
from importlib.metadata import version
from typing import Any

import numpy as np
import sympy as sp

from manufactured.case import Case
from manufactured.data import Data
from manufactured.exact import ExactSolution
from study.fem.naming import family_named
from study.run.code import code_of, code_of_all
from study.statements.enclosure import posed
from study.statements.shared.base import Setting, Statement

PACKAGES = ("numpy", "scipy", "scikit-fem", "pyamg", "clarabel", "sympy")
"""Distributions that compute."""


def fingerprint(statement: Statement, setting: Setting) -> str:
    """The hash for a statement in a setting."""
    settings = {name: value for name, value in vars(setting).items() if name != "case"}
    values = [family_named(setting.family), statement.steps(setting), sorted(settings.items())]
    measure = type(statement).measure.__module__
    code = code_of({measure, *modules_behind(setting.case), *modules_of(values)})
    return _hash([statement.label, versions(), problem(setting.case), *map(by_value, values), code])


@cache
def problem(reference: str) -> str:
    """The hash of the exact solution behind a reference, or of the data of a problem whose solution is unknown."""
    behind = posed(reference)
    return _hash([behind.pace, behind.order, by_value(_problem(reference))])


@cache
def modules_behind(reference: str) -> frozenset[str]:
    """The modules with the types that an exact solution or a problem consists of."""
    return frozenset(modules_of(_problem(reference)))


def _problem(reference: str) -> object:
    behind = posed(reference)
    return _behind(behind.data, behind.case)


def _behind(data: Data, case: Case | None) -> object:
    return (case.solution, case.regularity) if case else (data.body, data.law, data.formulas_of)


def of_problem(data: Data, case: Case | None, setting: Iterable[object], module: str) -> str:
    """The hash for what a module computes in a setting of anybody's problem, or of a case."""
    values, behind = [*setting], _behind(data, case)
    code = code_of({module, *modules_of(behind), *modules_of(values)})
    return _hash([versions(), by_value(behind), by_value(values), code])


def of_everything() -> str:
    """The hash for what depends on any code of the project, also on that which judges."""
    return _hash([versions(), code_of_all()])


@cache
def versions() -> dict[str, str]:
    """Of these packages and of Python, and the architecture."""
    return {"python": platform.python_version(), "machine": platform.machine(), **packages()}


def packages() -> dict[str, str]:
    """Their versions."""
    return {package: version(package) for package in PACKAGES}


def modules_of(item: object) -> Iterator[str]:
    """The modules of the types in a value, all the way down."""
    yield getattr(item, "__module__", None) or type(item).__module__
    parts: Iterable[object] = ()
    if is_dataclass(item) and not isinstance(item, type):
        parts = [getattr(item, field.name) for field in fields(item)]
    elif isinstance(item, tuple | list):
        parts = item
    for part in parts:
        yield from modules_of(part)


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

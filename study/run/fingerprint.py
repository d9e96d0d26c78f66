"""Cache keys of results: hashes of the code that computes, of library versions, of the problem and of its mesh.

The code consists of all modules in ``COMPUTING``, without docstrings, comments and tolerance windows. If the code
changes, every result is computed again. If only texts or windows change, stored results are used. The processor is not
part of the key, although last digits may differ between processors.
"""

from __future__ import annotations

import ast
import hashlib
import platform
from collections.abc import Iterable
from dataclasses import fields, is_dataclass
from functools import cache
from importlib.metadata import version
from pathlib import Path

import numpy as np
import sympy as sp

from manufactured.case import Case
from manufactured.data import Data
from study.statements.enclosure import resolve_problem
from study.statements.shared.base import Setting, Statement

ROOT = Path(__file__).parents[2]
"""The directory with the packages ``manufactured`` and ``study``."""
COMPUTING = (
    "manufactured/**/*.py",
    *(f"study/{package}/**/*.py" for package in ("fem", "solve", "stresses", "bound", "statements")),
    "study/ledger/pictures.py",
)
"""The modules on which results depend. The last one rounds the numbers of pictures."""
COLOURS = "manufactured/colours.py"
"""A module of ``manufactured`` that is never hashed, because results do not depend on it."""
WINDOWS = ("Window", "positive_at_most", "around", "at_least", "at_most", "between")
"""Names of the class and of the functions with which the code makes tolerance windows."""
LIBRARIES = ("numpy", "scipy", "scikit-fem", "pyamg", "clarabel", "sympy")
"""Libraries on which results depend."""


def fingerprint(statement: Statement, setting: Setting) -> str:
    """Return the cache key of one measurement.

    Parameters:
        statement: the statement that is measured.
        setting: the case, mesh family, level and other parameters of the measurement.
    """
    mesh = sorted((name, repr(value)) for name, value in vars(setting).items() if name != "case")
    return _hash([statement.label, type(statement).__name__, problem(setting.case), mesh, statement.steps(setting)])


def of_problem(data: Data, case: Case | None, setting: Iterable[object]) -> str:
    """Return the cache key of a result that was computed for a problem.

    Parameters:
        data: the problem.
        case: the case with the exact solution of the problem; None if the exact solution is unknown.
        setting: everything else on which the result depends: numbers, texts, arrays and dataclasses of these.
    """
    return _hash([_value_of(data, case), by_value(list(setting))])


def of_everything() -> str:
    """Return the cache key of a result that depends on all code, tolerance windows included, except colours."""
    return _hash([], code_hash(("manufactured/**/*.py", "study/**/*.py"), windows=True))


@cache
def problem(reference: str) -> str:
    """Return a text that identifies a problem, for cache keys.

    The name of a problem of this project is returned unchanged. For a problem in a file, a hash of the file and of the
    values in the problem is returned.

    Parameters:
        reference: the name, or FILE.py:NAME.
    """
    file, colon, _ = reference.rpartition(":")
    if not colon:
        return reference
    given = resolve_problem(reference)
    text = without_docstrings(Path(file).read_text(encoding="utf-8"))
    return _hash([given.pace, given.order, _value_of(given.data, given.case), text])


@cache
def code_hash(patterns: tuple[str, ...] = COMPUTING, windows: bool = False) -> str:
    """Return a hash of modules of the project, without docstrings and comments.

    Parameters:
        patterns: patterns of file names, relative to ``ROOT``.
        windows: whether the hash depends on tolerance windows.
    """
    files = sorted({path for pattern in patterns for path in ROOT.glob(pattern)} - {ROOT / COLOURS})
    code = [
        (str(path.relative_to(ROOT)), without_docstrings(path.read_text(encoding="utf-8"), windows)) for path in files
    ]
    return hashlib.sha256(repr(code).encode()).hexdigest()


def without_docstrings(text: str, windows: bool = True) -> str:
    """Return the syntax tree of a module as text, without docstrings and other strings that are statements.

    Parameters:
        text: the source text.
        windows: whether calls that make tolerance windows remain in the tree.
    """
    tree: ast.AST = ast.parse(text) if windows else _WithoutWindows().visit(ast.parse(text))
    for node in ast.walk(tree):
        for block in ("body", "orelse", "finalbody"):
            if isinstance(lines := getattr(node, block, None), list):
                values = [line.value if isinstance(line, ast.Expr) else None for line in lines]
                strings = [isinstance(value, ast.Constant) and isinstance(value.value, str) for value in values]
                setattr(node, block, [line for line, string in zip(lines, strings, strict=True) if not string])
    return ast.dump(tree)


class _WithoutWindows(ast.NodeTransformer):
    """Replaces calls that make tolerance windows by a constant, because windows do not change measured numbers."""

    def visit_Call(self, node: ast.Call) -> ast.AST:
        is_window = isinstance(node.func, ast.Name) and node.func.id in WINDOWS
        return ast.Constant("window") if is_window else self.generic_visit(node)


@cache
def versions() -> dict[str, str]:
    """Return the versions of Python and of ``LIBRARIES``, and the architecture of the processor."""
    return {"python": platform.python_version(), "machine": platform.machine(), **packages()}


def packages() -> dict[str, str]:
    """Return the versions of ``LIBRARIES``, on which results depend."""
    return {package: version(package) for package in LIBRARIES}


def by_value(item: object) -> object:
    """Return a value as nested lists of texts and numbers, for a hash.

    A dataclass becomes a list of its fields, and a formula becomes a text.
    """
    if is_dataclass(item) and not isinstance(item, type):
        return [type(item).__name__, *(by_value(getattr(item, field.name)) for field in fields(item) if field.init)]
    if isinstance(item, tuple | list):
        return [by_value(entry) for entry in item]
    if isinstance(item, np.ndarray):
        return item.tolist()
    return sp.srepr(item) if isinstance(item, sp.Basic) else repr(item)


def _value_of(data: Data, case: Case | None) -> object:
    return by_value((case.solution, case.regularity) if case else (data.body, data.law, data.formulas_of))


def _hash(values: list[object], code: str | None = None) -> str:
    return hashlib.sha256(repr([code or code_hash(), versions(), *values]).encode()).hexdigest()[:16]

"""Cache keys of results: hashes of the code that computes, of library versions, of the problem and of its mesh.

The code of a measurement consists of the modules in ``COMPUTING``, without docstrings, comments and tolerance windows,
but of the statements and of the cases only its own and those that are imported. If this code changes, the measurement
is made again. If only texts, windows, other statements or other cases change, the stored result is used. The processor
is not part of the key, although last digits may differ between processors.
"""

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
from manufactured.catalogue import NAMES, module_of
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
SINGLE = ("manufactured/cases/*.py", "study/statements/*.py")
"""The modules of single cases and statements. A result depends only on its own case, its own statement and imports."""
LISTS = ("manufactured/catalogue.py", "manufactured/colours.py", "manufactured/html.py", "manufactured/body/html.py")
"""Modules that list the cases, name colours or draw pictures in notebooks. No result depends on them."""
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
    own = (type(statement).__module__, *([module_of(setting.case)] if setting.case in NAMES else []))
    values = [statement.label, type(statement).__name__, problem(setting.case), mesh, statement.steps(setting)]
    return _hash(values, measuring_code(own))


def of_problem(data: Data, case: Case | None, setting: Iterable[object]) -> str:
    """Return the cache key of a result that was computed for a problem.

    Parameters:
        data: the problem.
        case: the case with the exact solution of the problem; None if the exact solution is unknown.
        setting: everything else on which the result depends: numbers, texts, arrays and dataclasses of these.
    """
    return _hash([_value_of(data, case), by_value(list(setting))])


def of_data(data: Data) -> str:
    """Return a hash of the data of a problem alone, which distinguishes problems with the same name."""
    return hashlib.sha256(repr(_value_of(data, None)).encode()).hexdigest()[:16]


def of_everything() -> str:
    """Return the cache key of a result that depends on all code of the project, tolerance windows included."""
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
    return _hash_of(_modules(patterns), windows)


@cache
def measuring_code(own: tuple[str, ...]) -> str:
    """Return a hash of the code on which a measurement depends, without docstrings, comments and tolerance windows.

    Parameters:
        own: the names of the modules of its statement and of its case.
    """
    computing, single, lists = (_modules(patterns) for patterns in (COMPUTING, SINGLE, LISTS))
    found: frozenset[str] = frozenset()
    new = computing - single | {file for name in own for file in _files(name)}
    while new := (new & computing) - found - lists:
        found |= new
        new = frozenset(file for module in new for file in _imported(module))
    return _hash_of(found)


@cache
def _modules(patterns: tuple[str, ...]) -> frozenset[str]:
    """Return the files of the project that have one of the patterns, relative to ``ROOT``."""
    return frozenset(path.relative_to(ROOT).as_posix() for pattern in patterns for path in ROOT.glob(pattern))


def _files(name: str) -> tuple[str, str]:
    """Return the files that can hold the module with a dotted name: a single file, or that of a package."""
    path = name.replace(".", "/")
    return f"{path}.py", f"{path}/__init__.py"


@cache
def _imported(module: str) -> frozenset[str]:
    """Return the files that can hold the modules imported by a module; not all of them exist."""
    names = set[str]()
    for node in ast.walk(ast.parse((ROOT / module).read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
        elif isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
    return frozenset(file for name in names for file in _files(name))


def _hash_of(modules: Iterable[str], windows: bool = False) -> str:
    return hashlib.sha256(repr([(module, _code(module, windows)) for module in sorted(modules)]).encode()).hexdigest()


@cache
def _code(module: str, windows: bool) -> str:
    text = without_docstrings((ROOT / module).read_text(encoding="utf-8"), windows)
    return hashlib.sha256(text.encode()).hexdigest()


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

"""Cache keys of results: hashes of the code that computes, of library versions, of the problem and of its mesh.

The code of a measurement is the code of the modules in ``COMPUTING``, without docstrings and comments. Two kinds of
modules are left out: modules of cases, and modules of other statements that the measured statement does not import. If
the code or the value of the case changes, the measurement is made again. If only docstrings, comments, other statements
or other cases change, the stored result is used. The processor is not part of the key, although last digits may differ
between processors.

A case or problem is known by its value: numbers, texts, arrays, formulas, and dataclasses of this project. Functions
and classes of a user have no value, because what they compute may depend on anything, such as other files. A result
that depends on them is stored with a key that no later command knows. Loads and stresses at some points are a part of
the value, because the file of a user may replace functions of this program or of a library.
"""

import ast
import platform
import re
import uuid
from ast import ClassDef, Constant, Expr, FunctionDef, Import, ImportFrom, Module
from collections.abc import Iterable, Set
from dataclasses import fields, is_dataclass, replace
from enum import Enum
from functools import cache
from hashlib import sha256
from importlib.metadata import version
from importlib.util import resolve_name
from pathlib import Path

import numpy as np
from sympy import Basic, preorder_traversal, srepr

from manufactured.body import Kind
from manufactured.case import Case
from manufactured.catalogue import MODULES, NAMES, OTHER_NAMES
from manufactured.data import Data
from study.fem.naming import is_own, resolve
from study.statements.shared.base import Setting, Statement

ROOT = Path(__file__).parents[2]
"""The directory with the packages ``manufactured`` and ``study``."""
COMPUTING = (
    "manufactured/**/*.py",
    *(f"study/{package}/**/*.py" for package in ("fem", "solve", "stresses", "bound", "statements")),
    "study/ledger/pictures.py",
    "study/ledger/text.py",
)
"""The modules on which results depend. The last two round the numbers of pictures and of measurements."""
ALL_CODE = ("manufactured/**/*.py", "study/**/*.py")
"""All modules of the two packages: of the continuous problem, and of the study."""
SINGLE_MODULES = ("study/statements/*.py",)
"""The modules of single statements. A result depends only on its own statement and imports."""
EXCLUDED_MODULES = (
    "manufactured/catalogue.py",
    "manufactured/colours.py",
    *sorted({f"manufactured/cases/{module}.py" for module in MODULES.values()}),
)
"""Modules that list the cases, name colours, or make cases.

No result depends on them, except through the value of its case.
"""
HASHED_TYPES = (bool, int, float, complex, str, type(None), tuple, list, np.ndarray)
"""Types outside this project that are hashed by value, besides numbers of NumPy and formulas of SymPy."""
LONG_NUMBER = re.compile(r"\d+\.\d{10,}(e[-+]\d+)?")
"""A decimal number with many digits, as ``repr`` and SymPy write it."""
PROJECT = ("manufactured", "study")
"""The packages of this project. Their code is part of every cache key."""
LIBRARIES = ("numpy", "scipy", "scikit-fem", "pyamg", "clarabel", "sympy")
"""Libraries on which results depend."""


def fingerprint(statement: Statement, setting: Setting) -> str:
    """Return the cache key of one measurement.

    Parameters:
        statement: the statement that is measured.
        setting: the case, mesh family, level and other parameters of the measurement.
    """
    mesh = by_value(replace(setting, case=""))
    case = _value_of_case(setting.case) if setting.case in (*NAMES, *OTHER_NAMES) else problem(setting.case)
    values = [statement.label, type(statement).__name__, case, mesh, statement.steps(setting)]
    return _hash(values, measuring_code(type(statement).__module__))


def of_problem(data: Data, case: Case | None, setting: Iterable[object]) -> str:
    """Return the cache key of a result that was computed for a problem.

    Parameters:
        data: the problem.
        case: the case with the exact solution of the problem; None if the exact solution is unknown.
        setting: everything else on which the result depends: numbers, texts, arrays and dataclasses of these.
    """
    return _hash([_value_of(data), by_value(case), by_value(list(setting))])


def of_data(data: Data) -> str:
    """Return a hash of the data of a problem alone, which distinguishes problems with the same name."""
    return _digest(_value_of(data))


def of_solution(reference: str) -> str:
    """Return the cache key of a result that depends only on the exact solution of a case.

    Parameters:
        reference: the name of the case, or FILE.py:NAME.
    """
    return _hash([problem(reference)], code_hash(ALL_CODE[:1]))


def of_everything() -> str:
    """Return the cache key of a result that depends on all code of the project."""
    return _hash([], code_hash(ALL_CODE))


@cache
def problem(reference: str) -> str:
    """Return a text that identifies a problem, for cache keys.

    The name of a problem of this project is returned unchanged. For a case in a file, a hash of its value is returned.

    Parameters:
        reference: the name, or FILE.py:NAME.
    """
    if not is_own(reference):
        return reference
    case = resolve(reference)
    return of_problem(Data.of(case.solution), case, ())


@cache
def _value_of_case(name: str) -> str:
    """Return a hash of the name and the value of a case of this project, for cache keys.

    Numbers are rounded to 12 digits, because the last digits of computed numbers differ between processors.
    """
    value = repr(by_value(resolve(name)))
    return _digest([name, LONG_NUMBER.sub(lambda number: f"{float(number[0]):.12g}", value)])


@cache
def code_hash(patterns: tuple[str, ...] = COMPUTING) -> str:
    """Return a hash of modules of the project, without docstrings and comments.

    Parameters:
        patterns: patterns of file names, relative to ``ROOT``.
    """
    return _hash_of(_modules(patterns))


@cache
def measuring_code(statement: str) -> str:
    """Return a hash of the code on which a measurement depends, without docstrings and comments.

    Parameters:
        statement: the name of the module that defines the measured statement, such as "study.statements.prop_5_4".
    """
    return _hash_of(_with_imports(_common(), set(_files(statement))))


@cache
def _common() -> frozenset[str]:
    """Return the modules on which every measurement depends."""
    return _with_imports(frozenset(), _modules(COMPUTING) - _modules(SINGLE_MODULES))


def _with_imports(modules: frozenset[str], new: Set[str]) -> frozenset[str]:
    """Return modules with new modules and everything that these import, if results depend on it."""
    computing = _modules(COMPUTING) - _modules(EXCLUDED_MODULES)
    while new := (new & computing) - modules:
        modules |= new
        new = {file for module in new for file in _parsed(module)[1]}
    return modules


@cache
def _modules(patterns: tuple[str, ...]) -> frozenset[str]:
    """Return the files of the project that have one of the patterns, relative to ``ROOT``."""
    return frozenset(path.relative_to(ROOT).as_posix() for pattern in patterns for path in ROOT.glob(pattern))


def _files(name: str) -> tuple[str, str]:
    """Return the files that can hold the module with a dotted name: a single file, or that of a package."""
    path = name.replace(".", "/")
    return f"{path}.py", f"{path}/__init__.py"


@cache
def _parsed(module: str) -> tuple[str, frozenset[str]]:
    """Return a hash of a module without docstrings, and the files that can hold the modules that it imports.

    Not all of these files exist.
    """
    tree = ast.parse((ROOT / module).read_text(encoding="utf-8"))
    names = set[str]()
    package = ".".join(Path(module).parent.parts)
    for node in ast.walk(tree):
        if isinstance(node, ImportFrom):
            source = resolve_name("." * node.level + (node.module or ""), package)
            names |= {source, *(f"{source}.{alias.name}" for alias in node.names)}
        elif isinstance(node, Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, Module | ClassDef | FunctionDef):
            node.body = [line for line in node.body if not _is_text(line)]
    return _digest(ast.dump(tree)), frozenset(file for name in names for file in _files(name))


def _hash_of(modules: Iterable[str]) -> str:
    return _digest([(module, _parsed(module)[0]) for module in sorted(modules)])


def _is_text(node: ast.stmt) -> bool:
    return isinstance(node, Expr) and isinstance(node.value, Constant) and isinstance(node.value.value, str)


@cache
def versions() -> dict[str, str]:
    """Return the versions of Python and of ``LIBRARIES``, and the architecture of the processor."""
    return {"python": platform.python_version(), "machine": platform.machine(), **packages()}


def packages() -> dict[str, str]:
    """Return the versions of ``LIBRARIES``, on which results depend."""
    return {package: version(package) for package in LIBRARIES}


def by_value(item: object) -> object:
    """Return a value as nested lists of texts, for a hash.

    A dataclass becomes a list of its name and its fields, and an array a list; a number or formula becomes a text. An
    object without a value, such as a user's function, becomes a random identifier that does not occur again.
    """
    if not _has_value(item):
        return uuid.uuid4()
    if is_dataclass(item):
        return [type(item).__name__, *(by_value(getattr(item, field.name)) for field in fields(item) if field.init)]
    if isinstance(item, np.ndarray):
        item = item.tolist()
    if isinstance(item, tuple | list):
        return [by_value(entry) for entry in item]
    return srepr(item) if isinstance(item, Basic) else repr(item)


def _has_value(item: object) -> bool:
    """Return whether ``by_value`` describes everything on which computations with an object may depend."""
    kind = type(item)
    if isinstance(item, Basic):
        # A function in a formula may be implemented by the user. Its class belongs to no package, or to the user's.
        return {_package(type(node)) for node in preorder_traversal(item)} <= {"sympy", *PROJECT}
    if _package(kind) in PROJECT:
        return isinstance(item, Enum) or is_dataclass(kind)
    return kind in HASHED_TYPES or (isinstance(item, np.generic) and _package(kind) == "numpy")


def _package(item: object) -> str:
    """Return the name of the package that defines a class or a function."""
    return str(getattr(item, "__module__", None)).partition(".")[0]


def _value_of(data: Data) -> object:
    """Return the value of the data of a problem; functions and classes of a user have none."""
    known = data.formulas_of and _package(type(data)) in PROJECT
    functions = (data.formulas_of, _sampled(data)) if known else data.functions
    return by_value([type(data).__name__, data.body, data.law, data.lines, data.points, functions])


def _sampled(data: Data) -> list[str]:
    """Return loads and stresses at some points, each in units of its largest value and without last digits."""
    x = data.body.sample(np.random.default_rng(0), 16)
    time = 0.4 * data.body.T
    strain = data.initial(x)
    loads = data.body_force(x)(time), *(data.surface_load(part, x)(time) for part in data.body.of(Kind.LOADED))
    texts = []
    # Loads may be much smaller than stresses, so they have units of their own.
    for values in (*loads, data.law.at(x).stress(strain + 1, strain + 2)):
        largest = float(abs(values).max())
        # Adding 0 turns −0 into 0.
        scaled = np.round(values / (largest or 1.0), 9) + 0.0
        texts += [f"{largest:.9g}", str(scaled.tolist())]
    return texts


def _hash(values: list[object], code: str | None = None) -> str:
    return _digest([code or code_hash(), versions(), *values])


def _digest(value: object) -> str:
    return sha256(repr(value).encode()).hexdigest()[:16]

"""A hash of the code that numbers depend on: syntax trees of modules and of all that they import of this project."""

from __future__ import annotations

import ast
import hashlib
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = ("manufactured", "study")
BY_VALUE = ("manufactured.catalogue", "manufactured.cases", "manufactured.problems", "study.fem.naming")
"""They find objects by name; what they find is hashed by value, with the code of its types."""
NO_NUMBERS = (
    "study.ledger",
    "study.statements.shared.base",
    "study.statements.shared.estimates",
    "study.statements.shared.scope",
)
"""How measurements are chosen, written and judged; what was chosen is hashed by value."""
NUMBERS = ("study.ledger.packing",)
"""What counts nevertheless."""
WINDOWS = ("Window", "above_nothing", "around", "at_least", "at_most", "between")
"""Functions that make tolerance windows in statements, which judge numbers and do not change them."""


def code_of(modules: Iterable[str]) -> str:
    """The hash of the code of some modules and of what they import of the project, directly or through others."""
    found = sorted((name, digest(name)) for name in closure(frozenset(modules)))
    return hashlib.sha256(repr(found).encode()).hexdigest()


@cache
def code_of_all() -> str:
    """The hash of all files of the project with code."""
    files = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
    return hashlib.sha256(b"".join(path.read_bytes() for path in files)).hexdigest()


@cache
def closure(modules: frozenset[str]) -> frozenset[str]:
    """The modules that count, of some and of all that they import."""
    found: set[str] = set()
    waiting = [name for name in modules if counts(name)]
    while waiting:
        name = waiting.pop()
        if name not in found:
            found.add(name)
            waiting += [imported for imported in imports(name) if counts(imported)]
    return frozenset(found)


def counts(module: str) -> bool:
    """Whether numbers depend on the code of a module: one of the project, or a file of a user's case."""
    if module in NUMBERS:
        return True
    if any(module == name or module.startswith(name + ".") for name in (*BY_VALUE, *NO_NUMBERS)):
        return False
    return module.partition(".")[0] in PACKAGES or module.startswith("case_")


def digest(module: str) -> str:
    """The hash of the syntax tree of a module without docstrings."""
    return _read(module)[1]


@cache
def _read(module: str) -> tuple[tuple[str, ...], str]:
    """The modules that a module imports, and its hash."""
    code = ast.parse(source(module).read_text(encoding="utf-8"))
    imported = tuple(dict.fromkeys(map(_module, _imports(code))))
    tree: ast.AST = without_docstrings(code)
    if module.startswith("study.statements."):
        tree = WithoutWindows().visit(tree)
    return imported, hashlib.sha256(ast.dump(tree).encode()).hexdigest()


def without_docstrings(code: ast.Module) -> ast.Module:
    """A tree without strings that stand alone: docstrings, and what is said of a constant below it."""
    for node in ast.walk(code):
        for block in ("body", "orelse", "finalbody"):
            lines = getattr(node, block, None)
            if isinstance(lines, list):
                setattr(node, block, [line for line in lines if not _stands_alone(line)])
    return code


class WithoutWindows(ast.NodeTransformer):
    """Replaces every call that makes a tolerance window, so that a window can be changed without measuring again."""

    def visit_Call(self, node: ast.Call) -> ast.AST:
        if isinstance(node.func, ast.Name) and node.func.id in WINDOWS:
            return ast.Constant("window")
        return self.generic_visit(node)


def _stands_alone(line: ast.AST) -> bool:
    return isinstance(line, ast.Expr) and isinstance(line.value, ast.Constant) and isinstance(line.value.value, str)


def source(module: str) -> Path:
    """The file of a module."""
    if module.startswith("case_"):
        return Path(str(sys.modules[module].__file__))
    path = ROOT.joinpath(*module.split("."))
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


def imports(module: str) -> tuple[str, ...]:
    """The modules of the project that a module imports, anywhere in it."""
    return _read(module)[0]


def _imports(code: ast.Module) -> Iterator[str]:
    """Modules, and names in modules, which may be modules themselves."""
    for node in ast.walk(code):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name.partition(".")[0] in PACKAGES)
        elif isinstance(node, ast.ImportFrom) and node.module and node.module.partition(".")[0] in PACKAGES:
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def _module(imported: str) -> str:
    """The module that is imported, or of which a name is."""
    return imported if source(imported).is_file() else imported.rpartition(".")[0]

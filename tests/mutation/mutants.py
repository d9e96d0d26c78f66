"""The mutants of a file: the same code with one small mistake each.

Comparisons are turned, sums and products swapped, ``and`` and ``or``, ``any`` and ``all``, ``min`` and ``max``; numbers
are one larger, or by a hundredth; signs, negations, absolute values, filters, calls that stand alone, guards and parts
of lists are left out. Texts, annotations and docstrings are left alone, and what only makes the message of an error.
"""

from __future__ import annotations

import ast
from collections import Counter
from collections.abc import Iterator
from copy import copy
from dataclasses import dataclass
from pathlib import Path

SWAPPED: dict[type[ast.AST], type[ast.AST]] = {
    ast.Lt: ast.Gt,
    ast.LtE: ast.GtE,
    ast.Eq: ast.NotEq,
    ast.In: ast.NotIn,
    ast.Is: ast.IsNot,
    ast.Add: ast.Sub,
    ast.Mult: ast.Div,
    ast.BitAnd: ast.BitOr,
    ast.And: ast.Or,
}
SWAPPED |= {other: one for one, other in SWAPPED.items()} | {ast.Pow: ast.Mult}
OPPOSITE = {"min": "max", "any": "all", "minimum": "maximum", "argmin": "argmax"}
OPPOSITE |= {other: one for one, other in OPPOSITE.items()}
LARGER = 1.01
"""A number that is wrong by a hundredth."""
SHOWN = 56
"""Letters of code that are kept of a mutant."""
SPARED = ("annotation", "returns", "decorator_list")
SPARED_FUNCTIONS = ("cost", "memory")
"""How a run is scheduled."""
SPARED_OPTIONS = ("optimize", "sort", "overwrite_a")
"""How something is computed, not what."""


@dataclass(frozen=True)
class Mutant:
    """One mistake.

    Attributes:
        module: where.
        function: in which it is, with its class; empty for the body of the module.
        before, after: the code around it.
        again: how often the same was met before in this function.
    """

    module: str
    function: str
    before: str
    after: str
    again: int


@dataclass(frozen=True)
class Edit:
    """``old``, in a field of ``parent``, at a place if that is a list, becomes ``new``, or is left out."""

    parent: ast.AST
    field: str
    index: int | None
    old: ast.AST
    new: ast.AST | None
    function: str

    def make(self) -> None:
        if self.index is None:
            setattr(self.parent, self.field, self.new)
        elif self.new is None:
            del getattr(self.parent, self.field)[self.index]
        else:
            getattr(self.parent, self.field)[self.index] = self.new

    def undo(self) -> None:
        if self.index is None:
            setattr(self.parent, self.field, self.old)
        elif self.new is None:
            getattr(self.parent, self.field).insert(self.index, self.old)
        else:
            getattr(self.parent, self.field)[self.index] = self.old


def file_of(module: str) -> str:
    """The path of a module relative to the root."""
    return module.replace(".", "/") + ".py"


def mutants(root: Path, module: str) -> list[Mutant]:
    """All mutants of a module."""
    return list(_named(module, _parsed(root, module)))


def mutated(root: Path, mutant: Mutant) -> str:
    """The code of the module with the mistake.

    Raises:
        LookupError: there is no such place any longer.
    """
    tree = _parsed(root, mutant.module)
    for edit, found in zip(list(_edits(tree, "")), _named(mutant.module, tree), strict=True):
        if found == mutant:
            edit.make()
            return ast.unparse(ast.fix_missing_locations(tree))
    raise LookupError(f"{mutant.module} has no {mutant.before!r} in {mutant.function or 'its body'} any longer")


def _parsed(root: Path, module: str) -> ast.Module:
    return ast.parse((root / file_of(module)).read_text(encoding="utf-8"))


def _named(module: str, tree: ast.Module) -> Iterator[Mutant]:
    seen: Counter[tuple[str, str, str]] = Counter()
    for edit in list(_edits(tree, "")):
        shown = edit.old if isinstance(edit.old, ast.stmt) else edit.parent
        shown = edit.old if len(ast.unparse(shown)) > SHOWN else shown
        before = _short(shown)
        edit.make()
        after = _short(shown) if shown is edit.parent else _short(edit.new)
        edit.undo()
        key = edit.function, before, after
        yield Mutant(module, *key, seen[key])
        seen[key] += 1


def _short(node: ast.AST | None) -> str:
    text = "nothing" if node is None else " ".join(ast.unparse(node).split())
    return text if len(text) <= SHOWN else text[: SHOWN - 2] + " …"


def _edits(node: ast.AST, function: str) -> Iterator[Edit]:
    """Of a tree, in the order of its code."""
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        function = f"{function}.{node.name}" if function else node.name
    for field, value in ast.iter_fields(node):
        if field in SPARED:
            continue
        for index, child in enumerate(value) if isinstance(value, list) else [(None, value)]:
            if not isinstance(child, ast.AST) or _is_spared(child):
                continue
            for new in _instead(child):
                yield Edit(node, field, index, child, new, function)
            if index is not None and _may_go(node, field, child, len(value)):
                yield Edit(node, field, index, child, ast.Pass() if isinstance(child, ast.stmt) else None, function)
            yield from _edits(child, function)


def _is_spared(node: ast.AST) -> bool:
    match node:
        case ast.JoinedStr() | ast.Raise() | ast.arguments():
            return True
        case ast.keyword(arg=name):
            return name in SPARED_OPTIONS
        case ast.FunctionDef(name=name):
            return name in SPARED_FUNCTIONS
    return False


def _instead(node: ast.AST) -> Iterator[ast.AST]:
    """What could stand in the place of a node."""
    match node:
        case ast.Compare(ops=[one]) if type(one) in SWAPPED:
            yield _with(node, ops=[SWAPPED[type(one)]()])
        case ast.Compare(left=left, ops=[first, second], comparators=[middle, right]):
            yield ast.Compare(left, [first], [middle])
            yield ast.Compare(middle, [second], [right])
        case ast.BoolOp(op=op) | ast.BinOp(op=op) if type(op) in SWAPPED:
            yield _with(node, op=SWAPPED[type(op)]())
        case ast.UnaryOp(op=ast.Not() | ast.USub() | ast.Invert(), operand=operand):
            yield operand
        case ast.Constant(value=bool(value)):
            yield ast.Constant(not value)
        case ast.Constant(value=int(value)):
            yield ast.Constant(value + 1)
        case ast.Constant(value=float(value)):
            yield ast.Constant(value * LARGER if value else 1 - 1 / LARGER)
        case ast.Call(func=ast.Name(id="abs"), args=[argument]):
            yield argument
        case ast.Name(id=name) if name in OPPOSITE:
            yield _with(node, id=OPPOSITE[name])
        case ast.Attribute(attr=name) if name in OPPOSITE:
            yield _with(node, attr=OPPOSITE[name])


def _may_go(parent: ast.AST, field: str, child: ast.AST, count: int) -> bool:
    """Whether an entry of a list can be left out: a rule among others, a filter, a call that stands alone, a guard."""
    match child:
        case ast.Expr(value=ast.Call() | ast.YieldFrom() | ast.Yield()) | ast.AugAssign():
            return True
        case ast.If(orelse=[]):
            return isinstance(child.body[-1], ast.Raise | ast.Return | ast.Continue)
        case ast.Call() | ast.Starred() if isinstance(parent, ast.Tuple | ast.List):
            return field == "elts" and count > 1
    return field == "ifs"


def _with(node: ast.AST, **changes: object) -> ast.AST:
    new = copy(node)
    for name, value in changes.items():
        setattr(new, name, value)
    return new

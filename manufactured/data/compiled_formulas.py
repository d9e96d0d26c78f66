"""Turns formulas of x1, x2, x3 and t into functions of points and time."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any

import numpy as np
import sympy as sp
from sympy.core.relational import Relational

from manufactured.arguments import checked
from manufactured.compiled import function
from manufactured.factor import x1, x2, x3
from manufactured.symbols import FormulaError, extreme_numbers, t
from manufactured.tensors import Points, Vectors


@dataclass(frozen=True)
@checked(FormulaError)
class Expressions:
    """Formulas of the body force f_0, the tractions f_2 and the initial displacement u_0 in x1, x2 (x3) and t.

    Two instances are equal if their formulas are equal.

    Attributes:
        force: the components of f_0.
        loads: pairs of the number of a part in ``body.parts`` and the components of f_2 on it, sorted by number. On
            other parts there is no load.
        start: the components of u_0.
    """

    force: tuple[sp.Expr, ...]
    loads: tuple[tuple[int, tuple[sp.Expr, ...]], ...]
    start: tuple[sp.Expr, ...]


KNOWN = {str(symbol): symbol for symbol in (x1, x2, x3, t)}
"""The symbols that formulas may contain, by their names."""


def compiled(
    formulas: Sequence[sp.Expr | float], count: int, name: str, symbols: tuple[sp.Symbol, ...]
) -> Callable[..., Vectors]:
    """Return a function that evaluates formulas at points, (d, ...) → (count, ...), and at a time if t is among the
    symbols.

    Args:
        formulas: the formulas.
        count: the number of formulas that is expected.
        name: the name of the quantity, for messages.
        symbols: the symbols that the formulas may contain, in the order of the arguments.

    Raises:
        FormulaError: there are other symbols, a wrong number of formulas, numbers that double precision cannot
            represent, or functions that NumPy does not have.
    """
    expressions = [own_formula(formula) for formula in formulas]
    if len(expressions) != count:
        raise FormulaError(f"{name} has {len(expressions)} components, expected {count}")
    strange = sorted({str(a) for e in expressions for a in e.free_symbols - {*symbols}})
    if strange:
        raise FormulaError(f"{name} has the symbols {', '.join(strange)}; use {', '.join(map(str, symbols))}")
    for expression in expressions:
        _require_numbers(expression, name)
    call = _function(symbols, expressions, name)

    # NumPy can evaluate a Piecewise only if all of its conditions have the same shape, so all arguments get one shape.
    spread = any(expression.has(sp.Piecewise) for expression in expressions)

    def values(x: Points, *time: float) -> Vectors:
        times = [np.full(x.shape[1:], each) for each in time] if spread else time
        return np.array([np.broadcast_to(value, x.shape[1:]) for value in call(*x, *times)])

    return values


PIECES: dict[type, Callable[..., sp.Expr]] = {
    sp.Max: lambda *args: reduce(lambda a, b: sp.Piecewise((a, a > b), (b, True)), args),
    sp.Min: lambda *args: reduce(lambda a, b: sp.Piecewise((a, a < b), (b, True)), args),
    sp.Abs: lambda x: sp.Piecewise((x, x > 0), (-x, True)),
    sp.sign: lambda x: sp.Piecewise((1, x > 0), (-1, x < 0), (0, True)),
    sp.Heaviside: lambda x, at_0: sp.Piecewise((1, x > 0), (0, x < 0), (at_0, True)),
}
"""Functions of SymPy with kinks or jumps, written as Piecewise functions."""


def own_formula(formula: sp.Expr | float) -> sp.Expr:
    """Return a formula of the user with the symbols of this package.

    SymPy distinguishes symbols of the same name by their assumptions, so x1, x2, x3 and t of the user are replaced. A
    condition a < b becomes a − b < 0. Numbers that cancel are then removed by SymPy, and not by rounding.
    """
    expression = sp.sympify(formula)
    expression = expression.subs({a: KNOWN[a.name] for a in expression.free_symbols if a.name in KNOWN})
    logical = sp.Xor, sp.ITE, sp.Implies, sp.Equivalent
    expression = expression.replace(
        lambda part: isinstance(part, logical), lambda part: sp.to_nnf(part, simplify=False)
    )
    return expression.replace(
        lambda part: isinstance(part, Relational) and isinstance(part.lhs, sp.Expr),
        lambda part: part.func(part.lhs - part.rhs, 0),
    )


def gradient(formulas: Sequence[sp.Expr], symbols: Sequence[sp.Symbol]) -> list[sp.Expr]:
    """Return the derivatives of continuous formulas with respect to all symbols; the symbols change fastest.

    Kinks are first written as Piecewise functions, because SymPy's derivative of a Max with three arguments that are
    equal on a set is wrong there.
    """
    pieces = [formula.replace(lambda part: type(part) in PIECES, _as_pieces) for formula in formulas]
    return [sp.diff(formula, symbol) for formula in pieces for symbol in symbols]


def _as_pieces(part: sp.Expr) -> sp.Expr:
    return PIECES[type(part)](*part.args)


def _require_numbers(expression: sp.Expr, name: str) -> None:
    """Raise FormulaError if a formula contains NaN, infinity or a number that double precision cannot represent."""
    if expression.has(sp.nan, sp.zoo, sp.oo) or extreme_numbers(expression):
        raise FormulaError(
            f"{name} is {sp.N(expression, 3)} in SymPy, and has no value in double precision somewhere; write it as a "
            "Piecewise, and use units in which its numbers have moderate size"
        )


def _function(symbols: tuple[sp.Symbol, ...], expressions: Sequence[sp.Expr], name: str) -> Callable[..., Any]:
    """Return a NumPy function that evaluates formulas; raise FormulaError if NumPy does not have their functions."""
    try:
        call = function(symbols, expressions)
        with np.errstate(all="ignore"):
            call(*np.zeros((len(symbols), 2)))  # functions of ``math`` accept one point
    except (NameError, AttributeError, NotImplementedError, TypeError, ValueError) as error:
        formula = ", ".join(map(str, expressions))
        raise FormulaError(
            f"{name} = {formula} cannot be evaluated: {error}; write it with functions that NumPy has, and steps with "
            "Heaviside or pos(x, 0)"
        ) from error
    return call

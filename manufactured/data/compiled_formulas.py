"""Turns formulas of x1, x2, x3 and t into functions of points and time."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import sympy as sp

from manufactured.compiled import function
from manufactured.factor import x1, x2, x3
from manufactured.symbols import FormulaError, pos, t
from manufactured.tensors import Points, Vectors

KNOWN = {str(symbol): symbol for symbol in (x1, x2, x3, t)}
"""The symbols that formulas may contain, by their names."""
SMALLEST, LARGEST = float(np.finfo(float).tiny), float(np.finfo(float).max)


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
    call = function(symbols, expressions)
    _require_values(call, len(symbols), expressions, name)

    # NumPy can evaluate a Piecewise only if all of its conditions have the same shape, so all arguments get one shape.
    spread = any(expression.has(sp.Piecewise) for expression in expressions)

    def values(x: Points, *time: float) -> Vectors:
        times = [np.full(x.shape[1:], each) for each in time] if spread else time
        return np.array([np.broadcast_to(value, x.shape[1:]) for value in call(*x, *times)])

    return values


def own_formula(formula: sp.Expr | float) -> sp.Expr:
    """Return a formula of the user with the symbols of this package, and with steps written with ``pos``.

    SymPy distinguishes symbols of the same name by their assumptions, so x1, x2, x3 and t of the user are replaced.
    Heaviside(x) becomes pos(x, 0), which is 1 for x > 0 and 0 elsewhere.
    """
    expression = sp.sympify(formula)
    expression = expression.subs({a: KNOWN[a.name] for a in expression.free_symbols if a.name in KNOWN})
    expression = expression.replace(sp.sign, lambda x: pos(x, 0) - pos(-x, 0))
    return expression.replace(lambda part: isinstance(part, sp.Heaviside), lambda part: pos(part.args[0], 0))


def _require_numbers(expression: sp.Expr, name: str) -> None:
    """Raise FormulaError if a formula contains a number that double precision cannot represent."""
    for number in expression.atoms(sp.Number):
        if number != 0 and not SMALLEST <= abs(number) <= LARGEST:
            raise FormulaError(
                f"{name} has the number {sp.N(number, 3)}, which double precision cannot represent; use units in which "
                f"numbers lie between {SMALLEST:.3g} and {LARGEST:.3g}"
            )


def _require_values(call: Callable[..., Any], count: int, expressions: Sequence[sp.Expr], name: str) -> None:
    """Evaluate formulas once, and raise FormulaError if they contain functions that NumPy does not have."""
    try:
        with np.errstate(all="ignore"):
            call(*np.zeros((count, 2)))  # functions of ``math`` accept one point
    except (NameError, AttributeError, TypeError) as error:
        formula = ", ".join(map(str, expressions))
        raise FormulaError(
            f"{name} = {formula} cannot be evaluated: {error}; write it with functions that NumPy has, and steps with "
            "Heaviside or pos(x, 0)"
        ) from error

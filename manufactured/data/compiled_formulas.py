"""Formulas of x1, x2, x3 and t as functions of points and time."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import sympy as sp

from manufactured.compiled import function
from manufactured.factor import x1, x2, x3
from manufactured.symbols import FormulaError, t
from manufactured.tensors import Points, Vectors

KNOWN = {str(symbol): symbol for symbol in (x1, x2, x3, t)}
"""The symbols of formulas by name."""


def compiled(
    formulas: Sequence[sp.Expr | float], count: int, name: str, symbols: tuple[sp.Symbol, ...]
) -> Callable[..., Vectors]:
    """(x, …) ↦ the values of some formulas, (count, ...)."""
    expressions = [own_formula(formula) for formula in formulas]
    if len(expressions) != count:
        raise FormulaError(f"{name} has {len(expressions)} components, expected {count}")
    strange = sorted({str(a) for e in expressions for a in e.free_symbols - {*symbols}})
    if strange:
        raise FormulaError(f"{name} has the symbols {', '.join(strange)}; use {', '.join(map(str, symbols))}")
    call = function(symbols, expressions)

    def values(x: Points, *time: float) -> Vectors:
        return np.array([np.broadcast_to(value, x.shape[1:]) for value in call(*x, *time)])

    return values


def own_formula(formula: sp.Expr | float) -> sp.Expr:
    """The formula with the symbols of this package in place of those of the same name: derivatives tell them apart."""
    expression = sp.sympify(formula)
    return expression.subs({a: KNOWN[a.name] for a in expression.free_symbols if a.name in KNOWN})

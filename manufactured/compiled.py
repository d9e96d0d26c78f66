"""NumPy functions made from SymPy expressions and their derivatives.

``Jet`` evaluates a formula of the face coordinates s and of time t, and its derivatives, at many points and times.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from inspect import signature

import numpy as np
import sympy as sp
from sympy.simplify.cse_main import tree_cse

from manufactured.symbols import (
    NOT_REAL,
    FormulaError,
    Index,
    Symbols,
    Values,
    differentiate,
    indices,
    refuse_kinks,
    s,
    t,
)
from manufactured.tensors import Array, Time


def power(x: Array, exponent: float) -> Array:
    """Return the powers x^a.

    For integers a up to 12 products are used, because NumPy's general power takes twenty times as long.
    """
    if exponent == 0.5:
        return np.sqrt(x)
    if exponent != int(exponent) or not 1 <= exponent <= 12:
        return x**exponent
    # Binary exponentiation: each bit after the leading one squares the result, and a bit 1 multiplies it by x.
    found = x
    for bit in bin(int(exponent))[3:]:
        found = found * found * x if bit == "1" else found * found
    return found


def truncated_power(x: Array, exponent: float) -> Array:
    """Return the truncated power x_+^a: x^a where the real part of x is positive, and 0 elsewhere."""
    x = np.asarray(x)
    positive = x.real > 0
    if exponent > 0:
        return power(np.where(positive, x, 0.0), exponent)
    if exponent == 0:
        return positive.astype(float)
    return np.where(positive, np.where(positive, x, 1.0) ** exponent, 0.0)


# A docstring of the formulas would take as long as their compilation. SymPy 1.11 does not have this option.
WITHOUT_DOCSTRING = {"docstring_limit": 0} if "docstring_limit" in signature(sp.lambdify).parameters else {}


def common_subexpressions(expressions: list[sp.Expr]) -> tuple[list[tuple[sp.Symbol, sp.Expr]], list[sp.Expr]]:
    """Return names for subexpressions that occur several times, and the expressions with these names.

    ``sympy.cse`` also orders the terms of sums and finds common parts of products. This takes twice as long, and the
    functions are only a fifth faster.
    """
    return tree_cse(expressions, sp.numbered_symbols(), order="none")  # type: ignore[no-any-return]


def function(arguments: Sequence[sp.Symbol], expressions: Sequence[sp.Expr]) -> Callable[..., list[Array]]:
    """Return a NumPy function that evaluates SymPy expressions and returns the list of their values.

    Common subexpressions are computed once. The value of a constant expression is a number, not an array.

    Args:
        arguments: the symbols, in the order of the arguments of the function.
        expressions: expressions that contain no other symbols.
    """
    modules = [{"pos": truncated_power}, "numpy"]
    return sp.lambdify(  # type: ignore[no-any-return]
        [*arguments], [*map(sp.sympify, expressions)], modules=modules, cse=common_subexpressions, **WITHOUT_DOCSTRING
    )


@lru_cache(maxsize=1024)
def derivatives(
    expression: sp.Expr, arguments: tuple[sp.Symbol, ...], orders: tuple[Index, ...]
) -> Callable[..., list[Array]]:
    """Return a NumPy function that evaluates derivatives of an expression and returns the list of their values.

    Functions are cached, because solutions for different laws have formulas in common.

    Args:
        expression: a formula of the arguments.
        arguments: the symbols with respect to which derivatives are taken.
        orders: the multi-index of each derivative.
    """
    return function(arguments, [differentiate(expression, tuple(arguments), order) for order in orders])


def coefficients_in_t(polynomial: sp.Expr) -> list[sp.Expr]:
    """Return the coefficients of a polynomial of the time t, highest power first."""
    return list(sp.Poly(polynomial, t).all_coeffs())


@dataclass(frozen=True)
class Jet:
    """Evaluates a formula of s and t together with its derivatives in s, the coordinates along a contact face.

    A call with points, (d−1, ...), a time (or times that broadcast with the points) and an order returns the
    derivatives ∂^i with |i| ≤ order as a dict from multi-indices i to arrays, (...).

    Attributes:
        expression: the formula.
        variables: the symbols of the coordinates along the face.
        in_time: the order n of the time derivative ∂_t^n of the formula that is evaluated; 0 for the formula itself.

    Raises:
        FormulaError: the formula has other symbols, numbers that are complex or not finite, or kinks or jumps that are
            not written with ``pos``.
    """

    expression: sp.Expr
    variables: Symbols = (s,)
    in_time: int = 0

    def __post_init__(self) -> None:
        refuse_kinks(self.expression)
        if self.expression.has(*NOT_REAL):
            raise FormulaError(f"{self.expression} has a number that is complex or not finite: use finite real numbers")
        strange = sorted(map(str, self.expression.free_symbols - {*self.variables, t}))
        if strange:
            raise FormulaError(
                f"{self.expression} has {', '.join(strange)}; use the symbols s (s1, s2 in 3D) and t "
                "of ``manufactured``, and numbers for everything else"
            )

    def __call__(self, points: Array, time: Time, order: int = 0) -> Values:
        shape = np.broadcast_shapes(points.shape[1:], np.shape(time))
        keys = indices(len(self.variables), order)
        orders = tuple((*key, self.in_time) for key in keys)
        evaluate = derivatives(self.expression, (*self.variables, t), orders)
        found: Values = {}
        for key, value in zip(keys, evaluate(*points, time), strict=True):
            # A formula need not contain all variables, so its value may have fewer axes than points and times.
            full = isinstance(value, np.ndarray) and value.shape == shape
            found[key] = value if full else np.broadcast_to(value, shape)
        return found

    def rate(self) -> Jet:
        """Return the object that evaluates the time derivative of the formula."""
        return replace(self, in_time=self.in_time + 1)

"""NumPy functions made from SymPy expressions and their derivatives."""

from collections.abc import Callable, Sequence
from functools import lru_cache
from inspect import signature

import numpy as np
import sympy as sp

from manufactured.symbols import Index, differentiate, t
from manufactured.tensors import Array


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


def function(arguments: Sequence[sp.Symbol], expressions: Sequence[sp.Expr]) -> Callable[..., list[Array]]:
    """Return a NumPy function that evaluates expressions and returns the list of their values.

    Common subexpressions are computed once. The value of a constant expression is a number, not an array.

    Args:
        arguments: the symbols, in the order of the arguments of the function.
        expressions: expressions that contain no other symbols.
    """
    modules = [{"pos": truncated_power}, "numpy"]
    return sp.lambdify(  # type: ignore[no-any-return]
        [*arguments], [*map(sp.sympify, expressions)], modules=modules, cse=True, **WITHOUT_DOCSTRING
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

"""The symbols of formulas on a contact face, the truncated power ``pos``, and the multi-indices of derivatives.

Gap and pressure are SymPy formulas of ``s``, the coordinate along a contact face (``s1`` and ``s2`` in 3D), and the
time ``t``. ``compiled`` makes NumPy functions of them and of their derivatives.
"""

from collections.abc import Callable
from functools import lru_cache
from itertools import product

import numpy as np
import sympy as sp

from manufactured.tensors import Array

s, s1, s2, t = sp.symbols("s s1 s2 t", real=True)
"""The symbols of formulas: the coordinate s along a face in 2D, the coordinates s1 and s2 in 3D, and the time t."""

Symbols = tuple[sp.Symbol, ...]
"""The type of the symbols of coordinates, such as the coordinates along a contact face."""

Index = tuple[int, ...]
"""The orders of a derivative along a contact face, one number for each coordinate."""

Values = dict[Index, Array]
"""The type of a function on a contact face with its derivatives along the face, as a dict from multi-indices to values.

The multi-index of zeros gives the function itself.
"""

Function = Callable[..., list[Array]]
"""The type of a NumPy function that ``compiled`` makes of formulas: it returns the list of their values."""

NOT_REAL = (sp.I, sp.nan, sp.oo, -sp.oo, sp.zoo)
"""SymPy objects whose presence in a formula shows that the formula is complex or not finite."""
SMALLEST, LARGEST = float(np.finfo(float).tiny), float(np.finfo(float).max)
"""The range of double precision: absolute values of numbers must lie between these two numbers."""


def extreme_numbers(formula: sp.Expr) -> list[sp.Number]:
    """Return the numbers of a formula that overflow or underflow in double precision; 0 is not one of them.

    Their absolute value is above ``LARGEST`` or below ``SMALLEST``.
    """
    return [
        number for number in formula.atoms(sp.Number) if not number.is_zero and not SMALLEST <= abs(number) <= LARGEST
    ]


class FormulaError(ValueError):
    """Raised if a formula cannot be differentiated or integrated exactly, or has wrong symbols."""


class pos(sp.Function):  # type: ignore[misc]
    """The truncated power x_+^a: x^a where x > 0, and 0 elsewhere; pos(x, 0) is a step from 0 to 1.

    Its derivative with respect to x is a·pos(x, a−1), which holds for x ≠ 0, and everywhere for a > 1.

    >>> pos(s - t, 2).diff(s)
    2*pos(s - t, 1)
    >>> pos(s - t, 2).subs({s: 3, t: 1}), pos(s - t, 2).subs({s: 1, t: 3})
    (4, 0)
    """

    nargs = 2

    def __new__(cls, x: sp.Expr, a: sp.Expr, **options: bool) -> sp.Expr:
        try:
            real = not any(isinstance(value, complex) or np.ma.is_masked(value) for value in (x, a))
            given = [sp.sympify(value, strict=True) for value in (x, a)] if real else []
        except (sp.SympifyError, TypeError):
            given = []
        if not given or any(not isinstance(value, sp.Expr) or value.has(*NOT_REAL) for value in given):
            raise FormulaError(f"pos({x}, {a}): give a formula of SymPy and a number as its exponent, real and finite")
        return super().__new__(cls, *given, **options)

    @classmethod
    def eval(cls, x: sp.Expr, a: sp.Expr) -> sp.Expr | None:
        if x.is_number:
            return x**a if x > 0 else sp.Integer(0)
        return None

    def fdiff(self, argindex: int = 1) -> sp.Expr:
        if argindex != 1:
            raise sp.core.function.ArgumentIndexError(self, argindex)
        x, a = self.args
        return a * pos(x, a - 1)


@lru_cache
def indices(variables: int, order: int) -> tuple[Index, ...]:
    """Return all multi-indices with ``variables`` entries and a sum of at most ``order``, small sums first."""
    every = [i for i in product(range(order + 1), repeat=variables) if sum(i) <= order]
    return tuple(sorted(every, key=lambda i: (sum(i), i)))


@lru_cache(maxsize=4096)
def differentiate(expression: sp.Expr, variables: Symbols, index: Index) -> sp.Expr:
    """Return a derivative of an expression; derivatives of lower order are cached.

    Args:
        expression: the expression.
        variables: the variables.
        index: the order of the derivative with respect to each variable, such as (1, 2) for ∂_1 ∂_2².
    """
    for position, times in enumerate(index):
        if times:
            lower = (*index[:position], times - 1, *index[position + 1 :])
            return _derivative(differentiate(expression, variables, lower), variables[position])
    return expression


@lru_cache(maxsize=4096)
def _derivative(expression: sp.Expr, variable: sp.Symbol) -> sp.Expr:
    # SymPy's own derivative takes eight times as long, because it asks of every partial result whether it is zero.
    if variable not in expression.free_symbols:
        return sp.Integer(0)
    terms = expression.args
    if expression.is_Add:
        return sp.Add(*(_derivative(term, variable) for term in terms))
    if expression.is_Mul:
        return sp.Add(
            *(sp.Mul(*terms[:i], _derivative(term, variable), *terms[i + 1 :]) for i, term in enumerate(terms))
        )
    if expression.is_Pow and expression.exp.is_number:
        return expression.exp * expression.base ** (expression.exp - 1) * _derivative(expression.base, variable)
    has_chain_rule = type(expression)._eval_derivative is sp.Function._eval_derivative
    if has_chain_rule and all(term.is_number for term in terms[1:]):
        return expression.fdiff() * _derivative(terms[0], variable)
    return sp.diff(expression, variable)


KINKED = (sp.Heaviside, sp.DiracDelta, sp.Piecewise, sp.Abs, sp.Min, sp.Max, sp.sign)
"""SymPy functions with kinks or jumps. Formulas must not contain them; kinks and jumps are written with ``pos``."""


def refuse_kinks(*formulas: sp.Expr | None) -> None:
    """Refuse formulas with kinks or jumps that are not written with ``pos``.

    This check comes before other checks, because these understand only ``pos``.

    Raises:
        FormulaError: a kink or jump is written in another way; the message shows how to write it.
    """
    for expression in formulas:
        if expression is not None and expression.has(*KINKED):
            raise FormulaError(
                f"{expression}: write fronts with pos(x, a), so that derivatives are known"
                f"{written_with_pos(expression)}"
            )


def written_with_pos(expression: sp.Expr) -> str:
    """Return advice how to write a Max(x, 0) or |x| of an expression with ``pos``; "" if the expression has none.

    The text is the end of an error message and begins with "; instead of".
    """
    for power in sp.preorder_traversal(expression):
        base, exponent = power.as_base_exp() if isinstance(power, sp.Expr) else (power, 1)
        if isinstance(base, sp.Max) and 0 in base.args and len(base.args) == 2:
            (x,) = set(base.args) - {sp.Integer(0)}
            return f"; instead of {power} write pos({x}, {exponent})"
        if isinstance(power, sp.Abs):
            return f"; instead of {power} write pos({power.args[0]}, 1) + pos({-power.args[0]}, 1)"
    return ""

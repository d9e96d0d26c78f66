"""Finds the exponents of truncated powers in a formula, and the parts of a formula that may not be smooth."""

import math

import sympy as sp

from manufactured.symbols import pos

SMOOTH = (sp.exp, sp.sin, sp.cos, sp.sinh, sp.cosh, sp.tanh, sp.atan, sp.asinh, sp.erf)
"""Functions that are smooth wherever their argument is smooth."""


def order_at(formula: sp.Expr, x: sp.Expr) -> tuple[float, float]:
    """Return how a formula behaves near x = 0, as two exponents (a, k).

    Near x = 0 the formula has the size x^k, and it is smooth there except for the truncated power x_+^a and higher
    ones. Sums, products and powers of ``pos(x, ·)`` and of x are understood.
    """
    if formula in (x, -x):
        return math.inf, 1.0
    if isinstance(formula, pos) and formula.args[0] == x:
        return float(formula.args[1]), float(formula.args[1])
    if isinstance(formula, sp.Pow):
        (rough, zero), exponent = order_at(formula.base, x), formula.exp
        if isinstance(formula.base, pos) and rough == zero and exponent.is_number:
            return rough * float(exponent), zero * float(exponent)
        if is_natural(exponent):
            return rough + (float(exponent) - 1) * zero, zero * float(exponent)
    below = [order_at(part, x) for part in formula.args]
    if isinstance(formula, sp.Mul):
        total = sum(zero for _, zero in below)
        return min(rough + total - zero for rough, zero in below), total
    least = min((rough for rough, _ in below), default=math.inf)
    return least, min(zero for _, zero in below) if isinstance(formula, sp.Add) else 0.0


def must_be_positive(part: sp.Expr) -> sp.Expr | None:
    """Return the expression that must be positive so that a part of a formula is smooth; None if there is none."""
    if isinstance(part, SMOOTH) or (isinstance(part, pos) and part.args[1].is_number):
        return None
    if isinstance(part, sp.log):
        return part.args[0]
    if not isinstance(part, sp.Pow):
        return sp.Integer(0)
    base = part.base
    exponent = part.exp
    if is_natural(exponent) or (isinstance(base, pos) and exponent.is_positive):
        return None
    return base**2 if is_natural(-exponent) else base


def is_natural(exponent: sp.Expr) -> bool:
    """Return whether an exponent is a natural number 0, 1, 2, …."""
    return bool(exponent.is_number and exponent.is_real and exponent >= 0 and float(exponent).is_integer())

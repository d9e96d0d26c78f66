"""NumPy functions made from SymPy expressions and their derivatives."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
import sympy as sp

from manufactured.symbols import Index, differentiate, pos, t
from manufactured.tensors import Array


def _power(x: Array, exponent: float) -> Array:
    # Repeated products: NumPy's general power is some twenty times slower.
    if exponent == 0.5:
        return np.sqrt(x)
    if exponent != int(exponent) or not 1 <= exponent <= 12:
        return x**exponent
    odd, half = int(exponent) % 2, int(exponent) // 2
    if half == 0:
        return x
    square = _power(x * x, half)
    return square * x if odd else square


def _truncated_power(x: Array, exponent: float) -> Array:
    x = np.asarray(x)
    if exponent > 0:
        # Of complex numbers the sign of the real part counts alone, and a maximum would look at the other one, too.
        return _power(np.where(x.real > 0, x, 0.0) if np.iscomplexobj(x) else np.maximum(x, 0.0), exponent)
    positive = x.real > 0
    if exponent == 0:
        return positive.astype(float)
    return np.where(positive, np.where(positive, x, 1.0) ** exponent, 0.0)


def function(arguments: Sequence[sp.Symbol], expressions: Sequence[sp.Expr]) -> Callable[..., list[Array]]:
    """A NumPy function returning the list of expressions, with common subexpressions shared."""
    return _compiled(tuple(arguments), tuple(map(sp.sympify, expressions)), ((0,) * len(arguments),))


def derivatives(
    expression: sp.Expr, arguments: Sequence[sp.Symbol], orders: Sequence[Index]
) -> Callable[..., list[Array]]:
    """A NumPy function returning the list of ∂^i of an expression in its arguments, for the given i."""
    return _compiled(tuple(arguments), (expression,), tuple(orders))


def _compiled(
    arguments: tuple[sp.Symbol, ...], expressions: tuple[sp.Expr, ...], orders: tuple[Index, ...]
) -> Callable[..., list[Array]]:
    """A NumPy function returning every ∂^i of every expression."""
    fronts = _Fronts(arguments)
    outer = [fronts.named(expression) for expression in expressions]
    formulas = [fronts.resolved(differentiate(formula, arguments, order)) for formula in outer for order in orders]
    return sp.lambdify(  # type: ignore[no-any-return]
        arguments, formulas, modules=[{"pos": _truncated_power}, "numpy"], cse=fronts.shared
    )


Steps = list[tuple[sp.Symbol, sp.Expr]]
"""What is computed before a formula, step by step."""


class _Fronts:
    """The arguments of the truncated powers in some formulas, but for added numbers, under names of their own.

    A gap is F(ψ) for a front ψ, and its derivatives F''(ψ) ψ_s ψ_t + F'(ψ) ψ_st, … are short as long as ψ stands for
    itself. Written out in s and t they have hundreds of terms.
    """

    def __init__(self, arguments: tuple[sp.Symbol, ...]) -> None:
        self._arguments = arguments
        self._inner: dict[sp.Expr, sp.Expr] = {}
        self._values: dict[sp.Expr, sp.Symbol] = {}

    def named(self, formula: sp.Expr) -> sp.Expr:
        """The formula of these names, as functions of the arguments."""
        for x in sorted({power.args[0].as_coeff_Add()[1] for power in formula.atoms(pos)}, key=sp.default_sort_key):
            if not x.is_Atom and -x not in self._inner.values() and x not in self._inner.values():
                self._inner[sp.Function(f"front{len(self._inner)}", real=True)(*self._arguments)] = x
        for name, x in self._inner.items():
            formula = formula.replace(lambda part, x=x: part in (x, -x) or part.is_Add, partial(_swapped, x, name))
        return formula

    def resolved(self, formula: sp.Expr) -> sp.Expr:
        """The same with symbols for the names and their derivatives, or with numbers where these are numbers."""
        found: dict[sp.Expr, sp.Expr] = {}
        for part in formula.atoms(sp.Derivative):
            orders = dict(part.variable_count)
            index = tuple(int(orders.get(argument, 0)) for argument in self._arguments)
            value = differentiate(self._inner[part.expr], self._arguments, index)
            found[part] = value if value.is_number else self._symbol(value)
        found |= {name: self._symbol(x) for name, x in self._inner.items() if formula.has(name)}
        return formula.xreplace(found)

    def _symbol(self, value: sp.Expr) -> sp.Symbol:
        return self._values.setdefault(value, sp.Symbol(f"v{len(self._values)}", real=True))

    def shared(self, formulas: Sequence[sp.Expr]) -> tuple[Steps, list[sp.Expr]]:
        """Common subexpressions of formulas and what is left of these, with powers by products and square roots.

        NumPy's general power takes as long as ten products, and derivatives have many powers of one base.
        """
        powers = _Powers()
        values = powers.shared([*self._values], "y")
        powers.steps += zip(self._values.values(), values, strict=True)
        return powers.steps, powers.shared([_in_first_powers(formula) for formula in formulas], "x")


def _swapped(x: sp.Expr, name: sp.Expr, part: sp.Expr) -> sp.Expr:
    """A part of a formula with the name in place of x or of −x, which may be some terms of a sum."""
    for sign in (1, -1):
        terms, mine = set(sp.Add.make_args(part)), set(sp.Add.make_args(sign * x))
        if mine <= terms:
            return sp.Add(*(terms - mine), sign * name)
    return part


def _in_first_powers(formula: sp.Expr) -> sp.Expr:
    """The same with pos(x, n) as pos(x, 1)^n, so that all n have one step in common."""

    def whole(part: sp.Basic) -> bool:
        return isinstance(part, pos) and part.args[1].is_Integer and part.args[1] > 1

    return formula.replace(whole, lambda part: pos(part.args[0], 1) ** part.args[1])


class _Powers:
    """Steps whose powers are made of earlier steps.

    x^{n+f} for a natural n and 0 < f < 1 is x^f x^n, x^n is the square of x^{n/2} or x times it, and x^{−a} is 1/x^a.
    """

    def __init__(self) -> None:
        self.steps: Steps = []
        self._known: dict[sp.Expr, sp.Symbol] = {}
        self._names = sp.numbered_symbols("p", real=True)

    def shared(self, formulas: Sequence[sp.Expr], names: str) -> list[sp.Expr]:
        """What steps more, for what formulas have in common, leave of them."""
        steps, rest = sp.cse(formulas, sp.numbered_symbols(names, real=True), list=False)
        for symbol, expression in steps:
            self.steps.append((symbol, self.without(expression)))
        return [self.without(expression) for expression in rest]

    def without(self, expression: sp.Expr) -> sp.Expr:
        """An expression whose powers but for squares, roots and reciprocals are steps."""
        if not expression.args:
            return expression
        parts = [self.without(part) for part in expression.args]
        if isinstance(expression, sp.Pow) and expression.exp.is_Rational and not expression.base.is_number:
            base, exponent = parts[0], sp.Rational(expression.exp)
            power = self._power(base if base.is_Symbol else self._step(base), abs(exponent))
            return power if exponent > 0 else 1 / power
        return expression.func(*parts)

    def _power(self, base: sp.Symbol, exponent: sp.Rational) -> sp.Expr:
        """x^a for a > 0."""
        whole, part = divmod(exponent, 1)
        if part:
            root = self._step(base**part)
            return root * self._power(base, whole) if whole else root
        half, odd = divmod(int(whole), 2)
        if half == 0:
            return base
        square = self._step(self._power(base, sp.Integer(half)) ** 2)
        return square * base if odd else square

    def _step(self, expression: sp.Expr) -> sp.Symbol:
        """The symbol of an expression, of one step more where it is new."""
        if expression not in self._known:
            symbol = self._known[expression] = next(self._names)
            self.steps.append((symbol, expression))
        return self._known[expression]


def coefficients_in_t(polynomial: sp.Expr) -> list[sp.Expr]:
    """The coefficients of a polynomial of t, highest power first."""
    return list(sp.Poly(polynomial, t).all_coeffs())

"""Formulas of (s, t): the truncated power, and fast derivatives of a SymPy expression.

Cases are written in SymPy with the symbols ``s`` (coordinate along a contact face; ``s1`` and ``s2``
in 3D) and ``t`` (time); every derivative is taken symbolically and evaluated by NumPy.
"""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache, partial
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import sympy as sp

from manufactured.kept import kept
from manufactured.tensors import Array

s, s1, s2, t = sp.symbols("s s1 s2 t", real=True)
"""Coordinate along a face of a polygon; the two coordinates along a face of a polyhedron; time."""

Index = tuple[int, ...]
"""A multi-index of derivatives along the face, one entry per coordinate."""

Values = dict[Index, Array]
"""Derivatives of a function on the face, keyed by multi-index; the key of zeros is the value."""


class FormulaError(ValueError):
    """A formula of a case lies outside the class that can be differentiated or integrated exactly."""


class pos(sp.Function):  # type: ignore[misc]
    """The truncated power x_+^a = x^a where x > 0, and 0 elsewhere; pos(x, 0) is the step.

    Its derivative in x is a·pos(x, a−1), which is right away from x = 0, and everywhere for a > 1.

    >>> pos(s - t, 2).diff(s)
    2*pos(s - t, 1)
    >>> pos(s - t, 2).subs({s: 3, t: 1}), pos(s - t, 2).subs({s: 1, t: 3})
    (4, 0)
    """

    nargs = 2

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

    def code() -> str:
        fronts = _Fronts(arguments)
        outer = [fronts.named(expression) for expression in expressions]
        formulas = [fronts.resolved(differentiate(formula, arguments, order)) for formula in outer for order in orders]
        call = sp.lambdify(arguments, formulas, modules=[{"pos": _truncated_power}, "numpy"], cse=fronts.shared)
        return inspect.getsource(call).replace(call.__name__, NAME, 1)

    names: dict[str, Any] = {**vars(np), "pos": _truncated_power}
    exec(compile(made_once((*arguments, *expressions), orders, code), "<formulas>", "exec"), names)
    return names[NAME]  # type: ignore[no-any-return]


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


def made_once(formulas: Sequence[sp.Expr], others: object, make: Callable[[], str]) -> str:
    """Text that is made from formulas and others, which have a ``repr``, kept from one process to the next (``kept``).

    Of functions that are not SymPy's or ``pos`` the names do not tell what they are: nothing of them is kept.
    """
    functions = {type(part) for formula in formulas for part in formula.atoms(sp.Function)}
    if not all(kind is pos or kind.__module__.startswith("sympy.") for kind in functions):
        return make()
    return kept(repr((_versions(), [*map(_written, formulas)], others)), make)


def coefficients_in_t(polynomial: sp.Expr) -> list[sp.Expr]:
    """The coefficients of a polynomial of t, highest power first."""
    text = made_once([polynomial], "coefficients in t", lambda: sp.srepr(sp.Poly(polynomial, t).all_coeffs()))
    functions = {type(part).__name__: type(part) for part in polynomial.atoms(sp.Function)}
    return list(eval(text, {**vars(sp), **functions}))


_written = lru_cache(maxsize=4096)(sp.srepr)
"""Each formula is asked for many orders of derivatives."""
NAME = "formulas"
"""Of the functions in the code that is kept."""


@cache
def _versions() -> tuple[str, ...]:
    """What the code depends on besides the formulas."""
    return sp.__version__, np.__version__, Path(__file__).read_text(encoding="utf-8")


@lru_cache
def indices(variables: int, order: int) -> tuple[Index, ...]:
    """All multi-indices of ``variables`` entries and total order ≤ ``order``, low orders first."""
    every = [i for i in product(range(order + 1), repeat=variables) if sum(i) <= order]
    return tuple(sorted(every, key=lambda i: (sum(i), i)))


@lru_cache(maxsize=4096)
def differentiate(expression: sp.Expr, variables: tuple[sp.Symbol, ...], index: Index) -> sp.Expr:
    """∂^index of an expression in the given variables, one step from the derivative before it."""
    for position, times in enumerate(index):
        if times:
            lower = (*index[:position], times - 1, *index[position + 1 :])
            return sp.diff(differentiate(expression, variables, lower), variables[position])
    return expression


KINKED = (sp.Heaviside, sp.DiracDelta, sp.Piecewise, sp.Abs, sp.Min, sp.Max, sp.sign)
"""Functions with kinks or jumps, whose derivatives SymPy does not take in the sense that is meant."""


def refuse_kinks(*formulas: sp.Expr | float | None) -> None:
    """Kinks and jumps have to be written with ``pos``; None is no formula.

    Said before anything else about a formula: exponents, symbols and dimensions are looked for where kinks are known.

    Raises:
        FormulaError: they are written in another way; the message says how to write them.
    """
    for expression in map(sp.sympify, formulas):
        if expression is not None and expression.has(*KINKED):
            raise FormulaError(
                f"{expression}: write fronts with pos(x, a), so that derivatives are known"
                f"{written_with_pos(expression)}"
            )


def written_with_pos(expression: sp.Expr) -> str:
    """How the first power of Max(x, 0), or the first |x|, is written with ``pos``; empty where there is none."""
    for power in sp.preorder_traversal(expression):
        base, exponent = power.as_base_exp() if isinstance(power, sp.Expr) else (power, 1)
        if isinstance(base, sp.Max) and 0 in base.args and len(base.args) == 2:
            (x,) = set(base.args) - {sp.Integer(0)}
            return f"; instead of {power} write pos({x}, {exponent})"
        if isinstance(power, sp.Abs):
            return f"; instead of {power} write pos({power.args[0]}, 1) + pos({-power.args[0]}, 1)"
    return ""


BLOCK = 1 << 13
"""Values that are found together: formulas are so long that what they leave half-done of more does not stay in the
cache, and of fewer calls would cost more than arithmetic."""


def in_blocks(points: Array, time: Array | complex, shape: tuple[int, ...]) -> Iterator[tuple[slice, Array | complex]]:
    """Rows of points (d, rows, ...), and the times that belong to them, of about BLOCK of the values (rows, ...) each.

    Nothing where points do not differ from row to row.
    """
    if not shape or points.shape[1:2] != shape[:1]:
        return
    every = np.ndim(time) == len(shape) and np.shape(time)[0] == shape[0]
    step = max(1, BLOCK * shape[0] // math.prod(shape)) if math.prod(shape) else 1
    for first in range(0, shape[0], step):
        rows = slice(first, first + step)
        yield rows, time[rows] if every and isinstance(time, np.ndarray) else time


@dataclass(frozen=True)
class Jet:
    """A formula of (s, t) with its derivatives along the face, evaluated by NumPy.

    ``Jet(expr, (s,))(points, time, order)`` has points (d−1, ...), one time or some that broadcast with them, and
    gives every ∂^i expr with |i| ≤ order as arrays (...); with ``in_time`` n those of ∂_t^n expr.

    Raises:
        FormulaError: other symbols than these, or functions with jumps that are not written with ``pos``.
    """

    expression: sp.Expr
    variables: tuple[sp.Symbol, ...] = (s,)
    in_time: int = 0
    _compiled: dict[int, Callable[..., list[Array]]] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def __post_init__(self) -> None:
        refuse_kinks(self.expression)
        strange = sorted(map(str, self.expression.free_symbols - {*self.variables, t}))
        if strange:
            raise FormulaError(
                f"{self.expression} has {', '.join(strange)}; use the symbols s (s1, s2 in 3D) and t "
                "of ``manufactured``, and numbers for everything else"
            )

    def __call__(self, points: Array, time: Array | complex, order: int = 0) -> Values:
        shape = np.broadcast_shapes(points.shape[1:], np.shape(time))
        blocks = [*in_blocks(points, time, shape)]
        if len(blocks) < 2:
            return self._at(points, time, order)
        found = {key: np.empty(shape, np.result_type(points, time)) for key in indices(len(self.variables), order)}
        for rows, moments in blocks:
            for key, values in self._at(points[:, rows], moments, order).items():
                found[key][rows] = values
        return found

    def _at(self, points: Array, time: Array | complex, order: int) -> Values:
        """The values at so many points and times that what is left half-done at them stays in the cache."""
        keys = indices(len(self.variables), order)
        if order not in self._compiled:
            orders = [(*key, self.in_time) for key in keys]
            self._compiled[order] = derivatives(self.expression, (*self.variables, t), orders)
        values = self._compiled[order](*points, time)
        shape = np.broadcast_shapes(points.shape[1:], np.shape(time))
        return {k: v if np.shape(v) == shape else np.broadcast_to(v, shape) for k, v in zip(keys, values, strict=True)}

    def rate(self) -> Jet:
        """The jet of ∂_t expr."""
        return replace(self, in_time=self.in_time + 1)

"""Random formulas with kinks and jumps, and their exact values, by none of the code under test."""

import operator

import mpmath
import numpy as np
import sympy as sp
from sympy import Rational, sin
from sympy.printing.pycode import MpmathPrinter

from manufactured import pos, t
from manufactured.factor import x1, x2

KINKS = (
    lambda a, b: sp.Max(a, 0),
    lambda a, b: sp.Min(a, 0),
    sp.Max,
    sp.Min,
    lambda a, b: sp.Abs(a),
    lambda a, b: pos(a, 1),
)
JUMPS = (
    lambda a, b: pos(a, 0),
    lambda a, b: sp.sign(a),
    lambda a, b: sp.Heaviside(a),
    lambda a, b: sp.Heaviside(a, 1),
    lambda a, b: sp.Heaviside(a, 0),
)
SMOOTH = (operator.add, operator.mul, lambda a, b: a**2, lambda a, b: sin(a))


class RandomFormula:
    """Makes formulas whose conditions change at multiples of 1/4, many of them on sets of positive measure."""

    def __init__(self, seed):
        self.rng = np.random.default_rng(seed)

    def __call__(self, depth):
        if depth == 0:
            return self._chosen(x1, x2, t, x1 - x2) - Rational(int(self.rng.integers(5)), 4)
        a = self(depth - 1)
        b = self(int(self.rng.integers(depth)))
        if self.rng.random() < 1 / 3:
            otherwise = self._chosen(sp.Integer(0), sp.Integer(1), a + 1)
            branches = (a, self.condition(depth - 1)), (b, self.condition(0)), (otherwise, True)
            try:
                return sp.Piecewise(*branches)
            except AttributeError:  # SymPy cannot nest some conditions with Xor
                return self(depth)
        return self._chosen(*KINKS, *KINKS, *JUMPS, *SMOOTH)(a, b)

    def condition(self, depth):
        relation = self._chosen(sp.Gt, sp.Ge, sp.Lt, sp.Le, sp.Eq, sp.Ne)
        # A kink is compared with 0, because Max(…, 0) and 0 are equal on sets of positive measure.
        single = relation(self._chosen(*KINKS)(self(depth), self(0)), self._chosen(0, 0, Rational(1, 4), x2))
        if self.rng.random() < 1 / 2:
            return single
        other = relation(self(0), 0)
        combine = self._chosen(sp.And, sp.Or, sp.Xor, sp.Nand, lambda a, b: sp.ITE(a, b, self(0) > 0))
        return combine(single, self.condition(depth - 1) if depth else other)

    def _chosen(self, *choices):
        return choices[int(self.rng.integers(len(choices)))]


def exact(formula):
    """Return the function of (x1, x2, t) that gives the value of a formula, by numbers of 300 digits from mpmath.

    Sums and products of binary fractions are exact then, and a sine has an error that no condition notices.
    """
    functions = {"pos": lambda x, a: x**a if x > 0 else 0, "Heaviside": lambda x, at_0: (x > 0) + (x == 0) * at_0}
    printer = MpmathPrinter({"allow_unknown_functions": True, "user_functions": {name: name for name in functions}})
    function = sp.lambdify((x1, x2, t), formula, [functions, {"mpmath": mpmath}], printer)

    def at(point):
        with mpmath.workdps(300):
            return mpmath.mpf(function(*map(mpmath.mpf, point)))

    return at

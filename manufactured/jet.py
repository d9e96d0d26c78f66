"""Evaluates a formula of the face coordinates s and of time t, and its derivatives, at many points and times."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import sympy as sp

from manufactured.compiled import derivatives
from manufactured.symbols import NOT_REAL, FormulaError, Symbols, Values, indices, refuse_kinks, s, t
from manufactured.tensors import Array, Time


@dataclass(frozen=True)
class Jet:
    """Evaluates a formula of (s, t) together with its derivatives along a contact face.

    A call with points, (d−1, ...), a time (or times that broadcast with the points) and an order returns the
    derivatives ∂^i with |i| ≤ order as a dict from multi-indices i to arrays, (...).

    Attributes:
        expression: the formula.
        variables: the symbols of the coordinates along the face.
        in_time: the order n of the time derivative ∂_t^n of the formula that is evaluated; 0 for the formula itself.

    Raises:
        FormulaError: the formula has other symbols, or functions with jumps that are not written with ``pos``.
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

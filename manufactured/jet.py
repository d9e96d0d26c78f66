"""A formula of (s, t) with its derivatives, evaluated at many points and times."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np
import sympy as sp

from manufactured.compiled import derivatives
from manufactured.symbols import FormulaError, Values, indices, refuse_kinks, s, t
from manufactured.tensors import Array

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
        shape = np.broadcast_shapes(points.shape[1:], time.shape) if isinstance(time, np.ndarray) else points.shape[1:]
        blocks = [*in_blocks(points, time, shape)] if math.prod(shape) > BLOCK else []
        if len(blocks) < 2:
            return self._at(points, time, shape, order)
        found = {key: np.empty(shape, np.result_type(points, time)) for key in indices(len(self.variables), order)}
        for rows, moments in blocks:
            here = *points[0, rows].shape[:1], *shape[1:]
            for key, values in self._at(points[:, rows], moments, here, order).items():
                found[key][rows] = values
        return found

    def _at(self, points: Array, time: Array | complex, shape: tuple[int, ...], order: int) -> Values:
        """The values, of some shape, at so many points and times that what is left half-done stays in the cache."""
        keys = indices(len(self.variables), order)
        if order not in self._compiled:
            orders = [(*key, self.in_time) for key in keys]
            self._compiled[order] = derivatives(self.expression, (*self.variables, t), orders)
        values = self._compiled[order](*points, time)
        return {key: _filled(value, shape) for key, value in zip(keys, values, strict=True)}

    def rate(self) -> Jet:
        """The jet of ∂_t expr."""
        return replace(self, in_time=self.in_time + 1)


def _filled(value: Array | float, shape: tuple[int, ...]) -> Array:
    """A value, which may depend on fewer variables, in the shape of all."""
    return value if isinstance(value, np.ndarray) and value.shape == shape else np.broadcast_to(value, shape)

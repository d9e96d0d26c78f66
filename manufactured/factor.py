"""Scalar factors α(x) > 0 of material tensors, by which a material becomes heterogeneous."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp

from manufactured.arguments import checked
from manufactured.compiled import function
from manufactured.symbols import FormulaError, Function, Symbols, pos
from manufactured.tensors import Array, Hyperplane, Points, Vectors

COORDINATES = x1, x2, x3 = sp.symbols("x1 x2 x3", real=True)
"""The Cartesian coordinates, as symbols for formulas."""


@dataclass(frozen=True, eq=False)
@checked(FormulaError)
class Factor:
    """A scalar factor α(x) > 0 of a material tensor, given by a formula of x1, x2, x3.

    Attributes:
        formula: the formula of α. Jumps between layers are written with ``pos(·, 0)``.
        low, high: bounds with 0 < low ≤ α ≤ high on the body. Constants of the material (ellipticity, Lipschitz
            constant) are computed from them; the self-proof of a case checks them.
        steps: planes {x : direction·x = offset} across which α jumps, as pairs (direction, offset).

    Raises:
        FormulaError: the formula has symbols other than the coordinates, or the bounds are not positive.
    """

    formula: sp.Expr
    low: float
    high: float
    steps: tuple[Hyperplane, ...] = ()

    def __post_init__(self) -> None:
        strange = sorted(map(str, self.formula.free_symbols.difference(COORDINATES)))
        if strange:
            raise FormulaError(
                f"the factor {self.formula} has the symbols {', '.join(strange)}; use x1, x2 and x3 of ``manufactured``"
            )
        if not 0 < self.low <= self.high < float("inf"):
            raise FormulaError(f"a factor needs bounds 0 < low ≤ high < ∞, got low = {self.low}, high = {self.high}")

    @cached_property
    def _compiled(self) -> Function:
        return function(COORDINATES, [self.formula, *(sp.diff(self.formula, x) for x in COORDINATES)])

    def _evaluate(self, x: Points) -> list[Array]:
        coordinates = [*x, *[0.0] * (3 - len(x))]
        return [np.broadcast_to(value, x.shape[1:]) for value in self._compiled(*coordinates)]

    def __call__(self, x: Points) -> Array:
        """Return the factor α at points: (d, ...) → (...)."""
        return self._evaluate(x)[0]

    def gradient(self, x: Points) -> Vectors:
        """Return the gradient ∂_j α at points where α does not jump: (d, ...) → (d, ...)."""
        return np.array(self._evaluate(x)[1 : 1 + len(x)])

    def along(self, start: Array, tangents: Array, variables: Symbols) -> sp.Expr:
        """Return the factor α on the line or plane {start + Σ_i s_i t_i} as a formula of the coordinates s_i.

        Args:
            start: a point, (d,).
            tangents: the vectors t_i as columns, (d, d−1).
            variables: the symbols s_i.
        """
        if not self.formula.free_symbols:
            return self.formula
        place = sp.Matrix(start) + sp.Matrix(tangents) * sp.Matrix(variables)
        return self.formula.subs(dict(zip(COORDINATES, [sp.nsimplify(c, rational=True) for c in place], strict=False)))


@checked(FormulaError)
def layers(direction: tuple[float, ...], offset: float, ratio: float) -> Factor:
    """Return the material factor α(x) of a body of two layers, 1 in the first and ``ratio`` in the second layer.

    Args:
        direction: the unit normal of the line or plane between the layers, d numbers.
        offset: the first layer is {x : direction·x < offset}.
        ratio: the positive value of the factor in the second layer.
    """
    beyond = pos(sum(c * x for c, x in zip(direction, COORDINATES, strict=False)) - offset, 0)
    return Factor(1 + (ratio - 1) * beyond, min(1.0, ratio), max(1.0, ratio), ((direction, offset),))


UNIFORM = Factor(sp.Integer(1), 1.0, 1.0)
"""The factor α = 1 of a homogeneous material."""

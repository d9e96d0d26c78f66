"""Integrals of smooth functions against e^{−λ(t−r)}, where no closed form is known."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import sympy as sp

from manufactured.face_strain.convolution import Started
from manufactured.jet import Jet
from manufactured.symbols import FormulaError, Values
from manufactured.tensors import Array

POINTS = 40
"""Number of Gauss points on an interval of contact."""
ACCURACY = 1e-13
"""Largest accepted difference between the rule on an interval and on its halves, relative to the largest integral."""


class Quadrature:
    """∫_a^b e^{−λ(b−r)} ∂_s^i P(s, r) dr for a branch P of p/a that is smooth in r, by Gauss's rule."""

    def __init__(self, branch: sp.Expr, variables: tuple[sp.Symbol, ...], decay: float) -> None:
        self.branch, self.decay, self.jet = branch, decay, Jet(branch, variables)
        x, w = np.polynomial.legendre.leggauss(POINTS)
        self.nodes, self.weights = (1 + x) / 2, w / 2

    def started(self, points: Array, lower: Array, upper: Array, order: int) -> Started:
        """Prepare the integrals from ``lower`` (N,) up to at most ``upper`` (N,), at points (d − 1, N).

        Raises:
            FormulaError: P changes too fast for the rule.
        """
        found = _Started(self, points, lower, order)
        middle, every = (lower + upper) / 2, np.arange(lower.size)
        whole, fading = found.upto(upper, every), np.exp(-self.decay * (upper - middle))
        halves = found.upto(middle, every), _Started(self, points, middle, order).upto(upper, every)
        for index, value in whole.items():
            off = abs(value - fading * halves[0][index] - halves[1][index]).max(initial=0.0)
            if not off <= ACCURACY * max(abs(value).max(initial=0.0), np.finfo(float).tiny):
                raise FormulaError(
                    f"{self.branch}: this part of p/a changes so fast in t that its memory is known to {off:.1g} only, "
                    f"relative to {abs(value).max():.3g}; take a slower motion or a shorter time"
                )
        return found


@dataclass(frozen=True, eq=False)
class _Started:
    rule: Quadrature
    points: Array
    lower: Array
    order: int

    def upto(self, upper: Array, chosen: Array) -> Values:
        """See ``Started.upto``."""
        rule, lower = self.rule, self.lower[chosen][:, None]
        length = upper[:, None] - lower
        left = length * (1 - rule.nodes)
        weights = length * rule.weights * np.exp(-rule.decay * left)
        points = np.repeat(self.points[:, chosen, None], len(rule.nodes), axis=2)
        values = rule.jet(points, lower + length * rule.nodes, self.order)
        return {index: np.einsum("nq,nq->n", value, weights) for index, value in values.items()}

"""Integrals over time of smooth functions times e^{−λ(t−r)} by Gauss's rule, if no closed form is known."""

import math
from copy import copy
from dataclasses import dataclass

import numpy as np
import sympy as sp

from manufactured.face_strain.convolution import Started
from manufactured.jet import Jet
from manufactured.symbols import FormulaError, Values
from manufactured.tensors import Array

POINTS = 40
"""Number of Gauss points on an interval of contact, or on each of its equal pieces."""
PIECES = (1, 4)
"""Numbers of equal pieces of an interval of contact that are tried in turn. A long contact may contain many periods."""
ACCURACY = 1e-13
"""Largest accepted difference between the rule on an interval and on its halves, relative to the largest integral."""
TINY = float(np.finfo(float).tiny)
"""Lower bound of the sizes of integrals, which prevents a division by zero if all integrals are zero."""


class Quadrature:
    """Computes integrals ∫_a^b e^{−λ(b−r)} ∂_s^i P(s, r) dr over time by Gauss's rule, for a smooth part P of p/a."""

    def __init__(self, branch: sp.Expr, variables: tuple[sp.Symbol, ...], decay: float) -> None:
        self.branch, self.decay, self.jet = branch, decay, Jet(branch, variables)
        self.use(PIECES[0])

    def use(self, pieces: int) -> None:
        """Set nodes and weights to Gauss's rule on (0, 1), repeated on the given number of equal pieces."""
        x, w = np.polynomial.legendre.leggauss(POINTS)
        starts = np.arange(pieces)[:, None]
        self.nodes, self.weights = ((starts + (1 + x) / 2) / pieces).ravel(), np.tile(w / (2 * pieces), pieces)

    def started(self, points: Array, lower: Array, upper: Array, order: int) -> Started:
        """Prepare the integrals for given points and starting times; see ``Integral.started``.

        Raises:
            FormulaError: P changes too fast in time for the rule.
        """
        for pieces in PIECES:
            rule = copy(self)
            rule.use(pieces)
            found = _Started(rule, points, lower, order)
            off, size = found.defect(upper)
            if off <= ACCURACY * max(size, TINY):
                return found
        raise FormulaError(
            f"{self.branch}: this part of p/a changes so fast in t that the strain it causes has an error of "
            f"{off:.1g} for a size of {size:.3g}; take a slower motion or a shorter time"
        )


@dataclass(frozen=True, eq=False)
class _Started:
    rule: Quadrature
    points: Array
    lower: Array
    order: int

    def defect(self, upper: Array) -> tuple[float, float]:
        """Return the error of Gauss's rule, estimated from the rule on both halves, and the size of the integral.

        Both numbers belong to the derivative with the largest relative error.
        """
        rule, lower, every = self.rule, self.lower, np.arange(self.lower.size)
        middle = (lower + upper) / 2
        whole, fading = self.upto(upper, every), np.exp(-rule.decay * (upper - middle))
        first, second = self.upto(middle, every), _Started(rule, self.points, middle, self.order).upto(upper, every)
        found = []
        for index, value in whole.items():
            off = abs(value - fading * first[index] - second[index]).max(initial=0.0)
            found.append((float(off), float(abs(value).max(initial=0.0))))
        return max(found, key=lambda pair: math.inf if math.isnan(pair[0]) else pair[0] / max(pair[1], TINY))

    def upto(self, upper: Array, chosen: Array) -> Values:
        """Return the integrals up to the times ``upper``; see ``Started.upto``."""
        rule, lower = self.rule, self.lower[chosen][:, None]
        length = upper[:, None] - lower
        left = length * (1 - rule.nodes)
        weights = length * rule.weights * np.exp(-rule.decay * left)
        points = np.repeat(self.points[:, chosen, None], len(rule.nodes), axis=2)
        values = rule.jet(points, lower + length * rule.nodes, self.order)
        return {index: np.einsum("nq,nq->n", value, weights) for index, value in values.items()}

"""Divides the pressure at a point of a face into intervals of contact, in each of which it is smooth in time.

Integrals over time of smooth functions times e^{−λ(t−r)} are computed by Gauss's rule, if no closed form is known.
"""

from __future__ import annotations

import math
from copy import copy
from dataclasses import dataclass

import numpy as np
import sympy as sp

from manufactured.exponents import SMOOTH
from manufactured.face_strain.convolution import Convolution, Integral, Started
from manufactured.face_strain.fronts import Front, between, front, within
from manufactured.jet import Jet
from manufactured.symbols import FormulaError, Values, pos, t
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


def smooth_branch(term: sp.Expr, variables: tuple[sp.Symbol, ...]) -> tuple[tuple[sp.Expr, ...], sp.Expr]:
    """Return the moving fronts of a term of the pressure, and the formula of the term where there is contact.

    A moving front is given by a formula ψ that is positive where there is contact.

    Raises:
        FormulaError: the exponent of a moving front is not an integer ≥ 2, or the formula between the fronts contains
            functions of t that are not known to be smooth.
    """
    fronts = [p for p in term.atoms(pos) if p.args[0].has(t)]
    for power in fronts:
        # With the exponent 1, the second derivative of the strain along the face would contain a Dirac measure at the
        # front. If ψ depends on time only, there is no such measure.
        lowest = 2 if power.args[0].free_symbols & set(variables) else 0
        if not (power.args[1].is_integer and power.args[1] >= lowest):
            raise FormulaError(
                f"{power}: a moving front of the pressure needs pos(ψ, m) with an integer m ≥ 2; with a smaller m the "
                "strain that the pressure causes has no second derivative along the face"
            )
    smooth = term.subs({p: p.args[0] ** p.args[1] for p in fronts})
    strange = {str(type(f).__name__) for f in smooth.atoms(sp.Function) if f.has(t) and not isinstance(f, SMOOTH)}
    if strange:
        raise FormulaError(
            f"the pressure term {term} has {', '.join(sorted(strange))} of t, so that it is not known to be smooth "
            f"between its fronts; of functions use {', '.join(f.__name__ for f in SMOOTH)}"
        )
    return tuple(sorted({power.args[0] for power in fronts}, key=sp.default_sort_key)), smooth


@dataclass(frozen=True, eq=False)
class PressureTerm:
    """Terms of p/a (pressure divided by viscosity) that have the same moving fronts.

    Attributes:
        moving: the moving fronts.
        integral: computes integrals over time of the formula that holds where there is contact.
    """

    moving: tuple[Front, ...]
    integral: Integral

    @classmethod
    def of(
        cls, fronts: tuple[sp.Expr, ...], branch: sp.Expr, variables: tuple[sp.Symbol, ...], decay: float
    ) -> PressureTerm:
        exact = branch.is_polynomial(t)
        integral = (Convolution if exact else Quadrature)(branch, variables, decay)
        return cls(tuple(front(formula, variables) for formula in fronts), integral)

    def intervals(self, points: Array, T: float) -> tuple[Array, Array]:
        """Return the times at which contact begins and ends at N points, (J, N) each.

        If both times of an interval are equal, there is no contact in this interval.
        """
        passes = [np.empty((0, points.shape[1]))]
        for moving in self.moving:
            passes.append(moving.passes(points, T))
        begin, end = between(np.vstack(passes), T)
        times = within(begin, end)
        inside = np.ones(times.shape, dtype=bool)
        for moving in self.moving:
            inside &= moving.beyond(points, times)
        return np.where(inside, begin, T), np.where(inside, end, T)

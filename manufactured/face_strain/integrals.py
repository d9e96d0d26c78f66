"""Integrals over time of smooth functions times e^{−λ(t−r)}.

For polynomials there is a closed form with the φ-functions of exponential integrators. Other functions are integrated
by Gauss's rule.
"""

import math
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
import sympy as sp

from manufactured.compiled import coefficients_in_t
from manufactured.jet import Jet
from manufactured.symbols import FormulaError, Index, Symbols, Values, t
from manufactured.tensors import Array


class Started(Protocol):
    """The interface of integrals ∫_a^b e^{−λ(b−r)} ∂_s^i P(s, r) dr at N points, as functions of b for a fixed a."""

    def upto(self, upper: Array, chosen: Array) -> Values:
        """Return the integrals up to given times, at some of the points.

        Args:
            upper: the times b, (n,).
            chosen: the indices of the points, (n,).

        Returns:
            A dict from the multi-index i of the derivative to the values, (n,).
        """
        ...


class Convolution:
    """Computes integrals ∫_a^b e^{−λ(b−r)} ∂_s^i P(s, r) dr for a polynomial P of the time r, of degree m.

    With τ = b − a, Taylor's formula at a gives

        ∫_a^b e^{−λ(b−r)} P(r) dr = Σ_{j≤m} ∂_r^j P(a) τ^{j+1} φ_{j+1}(−λτ),    φ_k(z) = Σ_n z^n/(n + k)!.

    Only τ depends on b, so the coefficients of a point are computed once.

    Source of the functions φ_k: M. Hochbruck, A. Ostermann, Exponential integrators, Acta Numer. 19 (2010) 209–286.
    """

    def __init__(self, smooth: sp.Expr, variables: Symbols, decay: float) -> None:
        self.decay = decay
        self.powers = [Jet(coefficient, variables) for coefficient in reversed(coefficients_in_t(smooth))]

    def started(self, points: Array, lower: Array, upper: Array, order: int) -> Started:
        """Prepare the integrals for given points and starting times.

        The derivatives ∂_s^i ∂_r^j P(s, a) are computed for every |i| ≤ order and every j.

        Args:
            points: the coordinates s of the points, (d − 1, N).
            lower: the starting times a, (N,).
            upper: the latest times b for which integrals will be needed, (N,).
            order: the highest order |i| of derivatives along the face.
        """
        values = [jet(points, lower, order) for jet in self.powers]
        factorials = np.array([[math.factorial(j)] for j in range(len(values))], dtype=float)
        coefficients = {}
        for index in values[0]:
            taylor = 1.0 * np.array([value[index] for value in values])  # values of integers have an integer type
            # Repeated synthetic division by r − a turns coefficients of powers of r into those of powers of r − a.
            for first in range(len(taylor)):
                for j in reversed(range(first, len(taylor) - 1)):
                    taylor[j] += lower * taylor[j + 1]
            coefficients[index] = factorials * taylor
        return _Taylor(self.decay, len(values) - 1, lower, coefficients)


@dataclass(frozen=True, eq=False)
class _Taylor:
    """The integrals from starting times a, (N,), with the Taylor coefficients at a, (m + 1, N) for each multi-index."""

    decay: float
    degree: int
    lower: Array
    coefficients: dict[Index, Array]

    def upto(self, upper: Array, chosen: Array) -> Values:
        """Return the integrals up to the times ``upper``; see ``Started.upto``."""
        found = {i: np.empty(upper.shape, np.result_type(upper, value)) for i, value in self.coefficients.items()}
        for first in range(0, len(upper), TOGETHER):
            here = slice(first, first + TOGETHER)
            duration = upper[here] - self.lower[chosen[here]]
            weights = phi(-self.decay * duration, self.degree + 1)
            weights *= duration ** np.arange(1, self.degree + 2)[:, None]
            for index, value in self.coefficients.items():
                found[index][here] = np.einsum("jn,jn->n", np.take(value, chosen[here], axis=1), weights)
        return found


TOGETHER = 1 << 12
"""Number of integrals that are evaluated together, so that the values of all φ_k stay in the processor's cache."""
SMALL = 12.0
"""Up to this |z|, φ_k is computed from φ_K by downward recurrence, which amplifies rounding by |z|^K/K!."""
TERMS = 48
"""Number of terms of the power series of φ_K. The next term |z|^n/(n + K)! is below the rounding of the sum."""


def phi(z: Array, count: int) -> Array:
    """Return the functions φ_1, …, φ_count of exponential integrators at points z, (N,) with Re z ≤ 0, as (count, N).

    The recurrence φ_k = z φ_{k+1} + 1/k! is used. Where |z| is small it runs downwards from the power series of
    φ_count, elsewhere upwards from φ_1 = (e^z − 1)/z.
    """
    found = np.empty((count, *z.shape), dtype=np.result_type(z, float))
    large = abs(z) > SMALL
    near = np.where(large, 0.0, z)
    size, terms, first = float(abs(near).max(initial=0.0)), 1, 1e18 * math.factorial(count)
    while terms < TERMS and size**terms * first >= math.factorial(terms + count):
        terms += 1
    # Horner's rule overwrites one array, because most of the time for a strain with memory is spent here.
    series = found[-1]
    series[:] = 0.0
    for n in reversed(range(terms)):
        series *= near
        series += 1 / math.factorial(n + count)
    for k in range(count - 1, 0, -1):
        found[k - 1] = near * found[k] + 1 / math.factorial(k)
    if large.any():
        far = np.where(large, z, -1.0)
        value = np.expm1(far) / far
        for k in range(1, count + 1):
            found[k - 1] = np.where(large, value, found[k - 1])
            value = (value - 1 / math.factorial(k)) / far
    return found


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

    def __init__(self, branch: sp.Expr, variables: Symbols, decay: float) -> None:
        self.branch, self.decay, self.jet = branch, decay, Jet(branch, variables)

    def started(self, points: Array, lower: Array, upper: Array, order: int) -> Started:
        """Prepare the integrals for given points and starting times; see ``Convolution.started``.

        Raises:
            FormulaError: P changes too fast in time for the rule.
        """
        x, w = np.polynomial.legendre.leggauss(POINTS)
        for pieces in PIECES:
            starts = np.arange(pieces)[:, None]
            nodes, weights = ((starts + (1 + x) / 2) / pieces).ravel(), np.tile(w / (2 * pieces), pieces)
            found = _Gauss(self.jet, self.decay, nodes, weights, points, lower, order)
            off, size = found.defect(upper)
            if off <= ACCURACY * max(size, TINY):
                return found
        raise FormulaError(
            f"{self.branch}: this part of p/a changes so fast in t that the strain it causes has an error of "
            f"{off:.1g} for a size of {size:.3g}; take a slower motion or a shorter time"
        )


@dataclass(frozen=True, eq=False)
class _Gauss:
    """The integrals from starting times a, (N,), by a rule with nodes and weights on (0, 1)."""

    jet: Jet
    decay: float
    nodes: Array
    weights: Array
    points: Array
    lower: Array
    order: int

    def defect(self, upper: Array) -> tuple[float, float]:
        """Return the error of Gauss's rule, estimated from the rule on both halves, and the size of the integral.

        Both numbers belong to the derivative with the largest relative error.
        """
        every = np.arange(self.lower.size)
        middle = (self.lower + upper) / 2
        fading = np.exp(-self.decay * (upper - middle))
        first, second = self.upto(middle, every), replace(self, lower=middle).upto(upper, every)
        found = []
        for index, value in self.upto(upper, every).items():
            off = abs(value - fading * first[index] - second[index]).max(initial=0.0)
            found.append((float(off), float(abs(value).max(initial=0.0))))
        return max(found, key=lambda pair: math.inf if math.isnan(pair[0]) else pair[0] / max(pair[1], TINY))

    def upto(self, upper: Array, chosen: Array) -> Values:
        """Return the integrals up to the times ``upper``; see ``Started.upto``."""
        lower = self.lower[chosen][:, None]
        length = upper[:, None] - lower
        left = length * (1 - self.nodes)
        weights = length * self.weights * np.exp(-self.decay * left)
        points = np.repeat(self.points[:, chosen, None], len(self.nodes), axis=2)
        values = self.jet(points, lower + length * self.nodes, self.order)
        return {index: np.einsum("nq,nq->n", value, weights) for index, value in values.items()}


def integral(branch: sp.Expr, variables: Symbols, decay: float) -> Convolution | Quadrature:
    """Return the object that computes the integrals for a smooth part P of p/a, pressure over viscosity.

    Args:
        branch: the formula of P.
        variables: the coordinates s along the face.
        decay: λ.
    """
    return (Convolution if branch.is_polynomial(t) else Quadrature)(branch, variables, decay)

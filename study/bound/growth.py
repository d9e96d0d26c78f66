"""Growth of the bound y of ‖e‖_V, e = u − ũ, over one time step [a, b] of length k.

Let g_i be the moduli of G against A (``study.bound.problem``), |τ|²_i the part of |τ|²_{A⁻¹} in the i-th direction,
0 ≤ θ ≤ min g_i a modulus, ‖·‖ the norm of A⁻¹, and ρ = ρ_A + ρ_G the residual, with the fractions 1 − w_i and w_i in
each direction, 0 ≤ w_i ≤ 1. Then

    (ρ, ε(e))_Q ≤ ‖ρ_A‖ ‖e‖_V + q + Σ_i (g_i − θ) ‖ε(e)‖²_i,     q = ¼ Σ_i w_i² ‖ρ‖²_i / (g_i − θ),

and the last sum plus θ ‖e‖_V² is at most (Gε(u) − Gε(ũ), ε(e))_Q. So the elasticity damps the error with the rate θ. In
directions in which G is stiff, such as volume changes of a nearly incompressible material, the rest of the elasticity
compensates a part of the residual:

    y(b) ≤ (e^{−2θk} y(a)² + 2 ∫ e^{−2θ(b−t)} (c + q))^{1/2} + ∫ e^{−θ(b−t)} (‖ρ_A‖ + η).

The smallest value over several θ and w is used. Each integral is at most the integral of its kernel times the largest
value of the other factor, which is sharp for steps much longer than 1/θ. By the Cauchy–Schwarz inequality it is also at
most a multiple of the mean value. If the least g_i is m < 0, then θ = 0 and the right side has the factor e^{|m|k}.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from manufactured.tensors import Array

ROUNDS = 4
"""Number of times that the weights w are improved."""
SMALL = 2.0**-20
"""Value of k β for which the weights are nearly 1."""
LAGRANGE = np.array([[16.0, 15.0, 4.0], [15.0, 64.0, 15.0], [4.0, 15.0, 16.0]]) / 120
"""Integrals ∫_0^1 |L_i L_j| of the Lagrange polynomials for the nodes 0, 1/2 and 1."""
LEBESGUE = 1.25
"""The largest value of Σ |L_i| on [0, 1]."""


@dataclass(frozen=True, eq=False)
class Sizes:
    """The terms that drive the error, at one time of a step or as means over it.

    Attributes:
        residual: |ρ|²_i on cells, (directions, cells).
        oscillation: η_T², (cells,).
        contact: c.
        rest: the bound of terms that are not computed for each cell.
    """

    residual: Array
    oscillation: Array
    contact: float
    rest: float

    def joined(self, share: Array) -> float:
        """Return the square root of Σ_T (‖ρ‖_T + η_T)², with a fraction of ρ in every direction, (directions,)."""
        residual = np.sqrt(np.tensordot(share**2, self.residual, axes=1))
        return float(np.linalg.norm(residual + np.sqrt(self.oscillation)))

    def squares(self, inverse: Array) -> float:
        """Return 2 (c + q).

        Args:
            inverse: w_i²/(g_i − θ), (directions,).
        """
        return 2 * self.contact + float(inverse @ self.residual.sum(axis=1)) / 2


@dataclass(frozen=True, eq=False)
class Step:
    """One time step: its length k, the means of the terms, and bounds of the terms at any time of the step.

    Means of η_T and |ρ|_i are mean squares.
    """

    k: float
    mean: Sizes
    largest: Sizes


def grow(y: float, moduli: Array, step: Step) -> tuple[float, float]:
    """Return bounds of ‖e‖_V at the end of a step and at any time of it, from the bound y at its start."""
    m = float(moduli.min())
    growth = float(np.exp(max(-m, 0.0) * step.k))
    bounds = [pair for theta in {0.0, max(m, 0.0)} for pair in _bounds(y, moduli, theta, step)]
    at_b, inside = (growth * min(ends) for ends in zip(*bounds, strict=True))
    return at_b, inside


def _bounds(y: float, moduli: Array, theta: float, step: Step) -> Iterator[tuple[float, float]]:
    """Yield bounds for several weights w_i = g/(g + β), g = g_i − θ, starting from w = 0 and from w close to 1.

    Each iteration computes β from the condition that the bound is stationary, then the weights from β. Any β ≥ 0 gives
    a valid bound. If y = c = 0, the best weights are w = 1, but the iteration from w = 0 does not leave 0.
    """
    k, mean, largest = step.k, step.mean, step.largest
    g = np.maximum(moduli - theta, 0.0)
    single, double = kernel(theta, k), kernel(2 * theta, k)
    decayed = np.exp(-theta * k) * y
    rest = min(k * mean.rest, single * largest.rest)
    for w in (np.zeros(len(g)), g / (g + SMALL / k)):
        for _ in range(ROUNDS):
            inverse = np.divide(w**2, g, out=np.zeros_like(w), where=g > 0)
            square = min(k * mean.squares(inverse), double * largest.squares(inverse))
            linear = min(np.sqrt(double * k) * mean.joined(1 - w), single * largest.joined(1 - w)) + rest
            root = float(np.hypot(decayed, np.sqrt(square)))
            yield root + linear, float(np.hypot(y, np.sqrt(square))) + linear
            taking = 2 * root * g
            w = np.divide(taking, taking + mean.joined(1 - w), out=np.zeros_like(g), where=taking > 0)


def kernel(rate: float, k: float) -> float:
    """Return the integral ∫_a^b e^{−rate (b−t)} dt."""
    return float(-np.expm1(-rate * k) / rate) if rate > 0 else k


def mean_square(*norms: Array) -> Array:
    """Return a bound of the mean of ‖f‖² for a parabola f in time, from ‖f‖ at both ends and in the middle.

    The bound follows from ‖f‖ ≤ Σ |L_i| ‖f_i‖ with the Lagrange polynomials L_i.
    """
    return np.einsum("ij,i...,j...->...", LAGRANGE, np.array(norms), np.array(norms))


def largest_square(*norms: Array) -> Array:
    """Return a bound of ‖f‖² at all times for a parabola f in time, from ‖f‖ at both ends and in the middle."""
    return (LEBESGUE * np.max(norms, axis=0)) ** 2

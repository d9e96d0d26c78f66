"""How much the bound y of the error ‖e‖_V, e = u − ũ, can grow over one time step [a, b] of length k.

The elasticity G is described by moduli g_i relative to the viscosity A, one for each direction i of strain space
(``study.bound.problem``). ‖·‖ is the norm of A⁻¹, and |τ|²_i is the part of |τ|²_{A⁻¹} in the i-th direction. Choose θ
with 0 ≤ θ ≤ min g_i. Split the residual of the law into ρ = ρ_A + ρ_G, with the fractions 1 − w_i and w_i in each
direction, 0 ≤ w_i ≤ 1. Then

    (ρ, ε(e))_Q ≤ ‖ρ_A‖ ‖e‖_V + q + Σ_i (g_i − θ) ‖ε(e)‖²_i,     q = ¼ Σ_i w_i² ‖ρ‖²_i / (g_i − θ),

and the last sum plus θ ‖e‖_V² is at most (Gε(u) − Gε(ũ), ε(e))_Q. So the elasticity damps the error with the rate θ. In
directions in which G is stiff, such as volume changes of a nearly incompressible material, the rest of the elasticity
compensates a part of the residual:

    y(b) ≤ (e^{−2θk} y(a)² + 2 ∫ e^{−2θ(b−t)} (c + q))^{1/2} + ∫ e^{−θ(b−t)} (‖ρ_A‖ + η).

Here c is the contact term and η the dual norm of the loads that are not balanced (``study.bound.terms``). The smallest
value over several θ and w is used. Each integral is at most the integral of its kernel times the largest value of the
other factor, which is sharp for steps much longer than 1/θ. By the Cauchy–Schwarz inequality it is also at most a
multiple of the mean value. If the least g_i is m < 0, then θ = 0 and the right side has the factor e^{|m|k}.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from manufactured.tensors import Array

ROUNDS = 4
"""Number of iterations that improve the weights w_i of the module's docstring."""
SMALL = 2.0**-20
"""Value of k β with which an iteration for the weights g/(g + β) starts, so that the first weights are nearly 1."""
LAGRANGE = np.array([[16.0, 15.0, 4.0], [15.0, 64.0, 15.0], [4.0, 15.0, 16.0]]) / 120
"""Integrals ∫_0^1 |L_i L_j| of the Lagrange polynomials L_i for the nodes 0, 1/2 and 1."""
LEBESGUE = 1.25
"""The largest value of Σ_i |L_i| on [0, 1] for the Lagrange polynomials L_i for the nodes 0, 1/2 and 1."""


@dataclass(frozen=True, eq=False)
class Sizes:
    """The quantities on which the growth of the error bound depends, at one time or as means over a time step.

    Attributes:
        residual: the squared residual |ρ|²_i of the law in every direction i on every cell, (directions, cells).
        oscillation: the square of the oscillation η_T of the loads on every cell, (cells,).
        contact: the contact term c.
        rest: a bound of the sum of all other quantities, which are not divided among the cells.
    """

    residual: Array
    oscillation: Array
    contact: float
    rest: float

    def joined(self, share: Array) -> float:
        """Return (Σ_T (‖ρ_A‖_T + η_T)²)^½, the norm of a part ρ_A of the residual together with the oscillation η.

        Args:
            share: the fraction of the residual ρ that belongs to ρ_A, for every direction, (directions,).
        """
        residual = np.sqrt(np.tensordot(share**2, self.residual, axes=1))
        return float(np.linalg.norm(residual + np.sqrt(self.oscillation)))

    def squares(self, inverse: Array) -> float:
        """Return 2 (c + q), where c is the contact term and q the quadratic term of the residual.

        The docstring of the module defines c and q.

        Args:
            inverse: the factors w_i²/(g_i − θ) in q, (directions,).
        """
        return 2 * self.contact + float(inverse @ self.residual.sum(axis=1)) / 2


@dataclass(frozen=True, eq=False)
class Step:
    """The quantities that drive the error over one time step.

    Attributes:
        k: the length of the step.
        mean: means over the step; for the residual and the oscillation these are mean squares.
        largest: bounds that hold at all times of the step.
    """

    k: float
    mean: Sizes
    largest: Sizes


def grow(y: float, moduli: Array, step: Step) -> tuple[float, float]:
    """Return two bounds of the error ‖u − ũ‖_V: at the end of a time step, and at all times of the step.

    Args:
        y: a bound of the error at the start of the step.
        moduli: the moduli g_i of G relative to A, (directions,).
        step: the residual, the loads and the contact term on the step.
    """
    m = float(moduli.min())
    growth = float(np.exp(max(-m, 0.0) * step.k))
    bounds = [pair for theta in {0.0, max(m, 0.0)} for pair in _bounds(y, moduli, theta, step)]
    at_b, inside = (growth * min(ends) for ends in zip(*bounds, strict=True))
    return at_b, inside


def _bounds(y: float, moduli: Array, theta: float, step: Step) -> Iterator[tuple[float, float]]:
    """Yield pairs of bounds as in ``grow`` for one rate of decay θ and several weights w_i.

    The weights are w_i = g/(g + β) with g = g_i − θ. Every β ≥ 0 gives a valid bound. Each iteration computes β from
    the condition that the bound is stationary, then the weights from β. One iteration starts from w = 0. Another starts
    close to w = 1, because w = 1 is best for y = c = 0, but the first iteration then stays at 0.
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
    """Return ∫_0^k e^{−rate·s} ds, the weight of a constant right-hand side over a step of length k."""
    return float(-np.expm1(-rate * k) / rate) if rate > 0 else k


def mean_square(*norms: Array) -> Array:
    """Return a bound of the mean of ‖f‖² over a time step, for a function f that is a parabola in time.

    The bound follows from ‖f‖ ≤ Σ |L_i| ‖f_i‖ with the Lagrange polynomials L_i.

    Args:
        norms: the norm ‖f‖ at the start, in the middle and at the end of the step.
    """
    return np.einsum("ij,i...,j...->...", LAGRANGE, np.array(norms), np.array(norms))


def largest_square(*norms: Array) -> Array:
    """Return a bound of ‖f‖² at all times of a step, for a function f that is a parabola in time.

    Args:
        norms: the norm ‖f‖ at the start, in the middle and at the end of the step.
    """
    return (LEBESGUE * np.max(norms, axis=0)) ** 2

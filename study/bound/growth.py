"""How the bound y of ‖e‖_V grows over one step [a, b] of length k, from means over the step and largest values in it.

With the moduli g_i of G against A (``study.bound.moduli``), |τ|²_i the part of |τ|²_{A⁻¹} in the i-th direction, a
modulus 0 ≤ θ ≤ min g_i, the norm ‖·‖ of A⁻¹ and the residual ρ = ρ_A + ρ_G in parts (1 − w_i) and w_i of every
direction, 0 ≤ w_i ≤ 1,

    (ρ, ε(e))_Q ≤ ‖ρ_A‖ ‖e‖_V + q + Σ_i (g_i − θ) ‖ε(e)‖²_i,     q = ¼ Σ_i w_i² ‖ρ‖²_i / (g_i − θ),

and the last sum with θ ‖e‖_V² is at most (Gε(u) − Gε(ũ), ε(e))_Q. So the elasticity damps the error by θ, and the
rest of it takes up that part of the residual which is large where G is stiff, as it is in volume for G nearly
incompressible:

    y(b) ≤ (e^{−2θk} y(a)² + 2 ∫ e^{−2θ(b−t)} (c + q))^{1/2} + ∫ e^{−θ(b−t)} (‖ρ_A‖ + η),

and the least of some θ and w counts. Each integral is at most that of its kernel times the largest value, which serves
steps much longer than 1/θ, and at most that of the mean value, by the inequality of Cauchy and Schwarz. If the least
g_i is m < 0, then θ = 0 and the right side has the factor e^{|m|k}.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from manufactured.tensors import Array

ROUNDS = 4
"""Times that the weights w are improved."""
SMALL = 2.0**-20
"""k β of weights that are nearly 1."""


@dataclass(frozen=True, eq=False)
class Sizes:
    """What drives the error, at a time of a step.

    Attributes:
        residual: |ρ|²_i over cells, (directions, cells).
        oscillation: η_T², (cells,).
        contact: c.
        rest: the bound of what is no part of a cell.
    """

    residual: Array
    oscillation: Array
    contact: float
    rest: float

    def joined(self, share: Array) -> float:
        """The root of Σ_T (‖ρ‖_T + η_T)², with a share of ρ in every direction, (directions,)."""
        kept = np.sqrt(np.tensordot(share**2, self.residual, axes=1))
        return float(np.linalg.norm(kept + np.sqrt(self.oscillation)))

    def squares(self, inverse: Array) -> float:
        """2 (c + q), from w_i²/(g_i − θ), (directions,)."""
        return 2 * self.contact + float(inverse @ self.residual.sum(axis=1)) / 2


@dataclass(frozen=True, eq=False)
class Added:
    """What one step adds: its length k, means over it (of η_T and |ρ|_i the mean squares) and bounds at any time."""

    k: float
    mean: Sizes
    largest: Sizes


def grown(y: float, moduli: Array, added: Added) -> tuple[float, float]:
    """Bounds of ‖e‖_V at the end of a step and at any time of it, from the bound y at its start."""
    m = float(moduli.min())
    growth = float(np.exp(max(-m, 0.0) * added.k))
    found = [bounds for theta in {0.0, max(m, 0.0)} for bounds in _bounds(y, moduli, theta, added)]
    at_b, inside = (growth * min(ends) for ends in zip(*found, strict=True))
    return at_b, inside


def kernel(rate: float, k: float) -> float:
    """∫_a^b e^{−rate (b−t)} dt."""
    return float(-np.expm1(-rate * k) / rate) if rate > 0 else k


def _bounds(y: float, moduli: Array, theta: float, added: Added) -> Iterator[tuple[float, float]]:
    """Those for some weights w_i = g/(g + β), g = g_i − θ, from w = 0 and from nearly w = 1.

    β, in turns with the weights, makes the bound stationary; any β ≥ 0 gives one that is valid. From w = 0 it does not
    leave w = 0 where y = c = 0, and towards w = 1, which is best there, it goes slowly.
    """
    k, mean, largest = added.k, added.mean, added.largest
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


LAGRANGE = np.array([[16.0, 15.0, 4.0], [15.0, 64.0, 15.0], [4.0, 15.0, 16.0]]) / 120
"""∫_0^1 |L_i L_j| for Lagrange's polynomials of the nodes 0, 1/2 and 1."""


def mean_square(*norms: Array) -> Array:
    """A bound of the mean of ‖f‖² for a parabola f in time, from ‖f‖ at both ends and in the middle.

    ‖f‖ ≤ Σ |L_i| ‖f_i‖ with Lagrange's polynomials.
    """
    return np.einsum("ij,i...,j...->...", LAGRANGE, np.array(norms), np.array(norms))


LEBESGUE = 1.25
"""The largest Σ |L_i|."""


def largest_square(*norms: Array) -> Array:
    """A bound of ‖f‖² at all times for a parabola f in time, from ‖f‖ at both ends and in the middle."""
    return (LEBESGUE * np.max(norms, axis=0)) ** 2

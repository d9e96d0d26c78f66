"""How the bound y of ‖e‖_V grows over one step of length k, from means over the step.

With the moduli g_i of G against A (``study.bound.moduli``), |τ|²_i the part of |τ|²_{A⁻¹} in the i-th direction, and
the residual ρ = ρ_A + ρ_G in parts (1 − w_i) and w_i of every direction, 0 ≤ w_i ≤ 1,

    (ρ, ε(e))_Q ≤ ‖ρ_A‖_{A⁻¹} ‖e‖_V + ¼ ‖ρ_G‖²_{G⁻¹} + Σ_i g_i ‖ε(e)‖²_i,     ‖ρ_G‖²_{G⁻¹} = Σ_i w_i² ‖ρ‖²_i / g_i,

and the last sum is at most (Gε(u) − Gε(ũ), ε(e))_Q. So either the elasticity damps the error, or it takes up that part
of the residual which is large where G is stiff, as it is in volume for G nearly incompressible:

    y(b) ≤ (e^{−2mk} y(a)² + 2 ∫c)^{1/2} + ∫ e^{−m(b−t)} (r + η)                             (damped)
    y(b) ≤ (y(a)² + 2 ∫c + ½ ∫ ‖ρ_G‖²_{G⁻¹})^{1/2} + ∫ (‖ρ_A‖_{A⁻¹} + η),                      (shared)

the least of which counts. For m < 0 both get the factor e^{|m|k} instead of the damping.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from manufactured.tensors import Array

ROUNDS = 4
"""Times that the weights w are improved."""


@dataclass(frozen=True, eq=False)
class Added:
    """What one step adds.

    Attributes:
        k: the length of the step.
        residual: the mean of |ρ|²_i over cells, (directions, cells).
        oscillation: the mean square of η_T, (cells,).
        contact: ∫ c.
        rest: ∫ of what is no part of a cell.
    """

    k: float
    residual: Array
    oscillation: Array
    contact: float
    rest: float

    def joined(self, share: Array) -> float:
        """The root of the mean of Σ_T (‖ρ‖_T + η_T)², with a share of ρ in every direction, (directions,)."""
        kept = np.sqrt(np.tensordot(share**2, self.residual, axes=1))
        return float(np.linalg.norm(kept + np.sqrt(self.oscillation)))


def grown(y: float, moduli: Array, added: Added) -> tuple[float, float]:
    """Bounds of ‖e‖_V at the end of a step and at any time of it, from the bound y at its start."""
    m = float(moduli.min())
    growth = float(np.exp(max(-m, 0.0) * added.k))
    shared = _shared(y, moduli, added)
    damped = damping(m, added.k) * np.sqrt(added.k) * added.joined(np.ones(len(moduli))) + added.rest
    decayed = np.exp(-max(m, 0.0) * added.k) * y
    at_b = np.hypot(decayed, np.sqrt(2 * added.contact)) + damped
    inside = np.hypot(y, np.sqrt(2 * added.contact)) + damped
    return float(growth * min(at_b, shared)), float(growth * min(inside, shared))


def damping(m: float, k: float) -> float:
    """(∫_a^b e^{−2m(b−t)} dt)^{1/2} for m ≥ 0, and √k for m < 0, where the growth is counted apart."""
    return float(np.sqrt(-np.expm1(-2 * m * k) / (2 * m))) if m > 0 else float(np.sqrt(k))


def _shared(y: float, moduli: Array, added: Added) -> float:
    """The least bound of some weights w_i = g_i/(g_i + β).

    β = ‖ρ_A‖/(2 (…)^{1/2}), in turns with the weights, makes the bound stationary; any β ≥ 0 gives one that is valid.
    """
    g, k, found = np.maximum(moduli, 0.0), added.k, []
    w = np.zeros(len(g))
    totals = added.residual.sum(axis=1)
    for _ in range(ROUNDS):
        taken = float(np.sum(np.divide(w**2 * totals, g, out=np.zeros_like(w), where=g > 0)))
        root = float(np.sqrt(y**2 + 2 * added.contact + k * taken / 2))
        joined = added.joined(1 - w)
        found.append(root + k * joined + added.rest)
        taking = 2 * root * g
        w = np.divide(taking, taking + joined, out=np.zeros_like(g), where=taking > 0)
    return min(found)


LAGRANGE = np.array([[16.0, 15.0, 4.0], [15.0, 64.0, 15.0], [4.0, 15.0, 16.0]]) / 120
"""∫_0^1 |L_i L_j| for Lagrange's polynomials of the nodes 0, 1/2 and 1."""


def mean_square(*norms: Array) -> Array:
    """A bound of the mean of ‖f‖² for a parabola f in time, from ‖f‖ at both ends and in the middle.

    ‖f‖ ≤ Σ |L_i| ‖f_i‖ with Lagrange's polynomials.
    """
    return np.einsum("ij,i...,j...->...", LAGRANGE, np.array(norms), np.array(norms))

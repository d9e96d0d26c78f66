"""The moduli of G against A: g_i and directions v_i with (Gε₁ − Gε₂)·(ε₁ − ε₂) ≥ Σ_i g_i (Av_i·(ε₁ − ε₂))².

The v_i are orthonormal in A, so that A(ε)·ε = Σ_i (Av_i·ε)² and A⁻¹τ·τ = Σ_i (v_i·τ)². For linear G they are the
eigenvectors of A⁻¹G, for others all g_i are the constant m of monotonicity.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh

from manufactured.law import KelvinVoigt, Linear
from manufactured.tensors import Array


class BoundError(ValueError):
    """No bound can be given for the data."""


@dataclass(frozen=True, eq=False)
class Moduli:
    """g, (directions,), ascending, and the v_i as columns, (D, directions)."""

    values: Array
    directions: Array

    def decay(self, k: float) -> float:
        """e^{−mk} for the least modulus m: what a step leaves of an error."""
        return float(np.exp(-self.values.min() * k))

    def weights(self, time: float) -> Array:
        """time/(1 + 2 time g_i) in every direction: what squares of residuals count, (directions,).

        To first order a step adds to y² twice ∫ (c + ¼ Σ_i |ρ|²_i/(g_i + β)), β ~ 1/(2T) (``study.bound.growth``).
        """
        return np.asarray(time / (1 + 2 * time * np.maximum(self.values, 0.0)))

    def compliance(self, time: float) -> Array:
        """Σ_i v_i v_iᵀ with these weights, Mandel (D, D): the norm of residuals whose minimum serves the bound."""
        return (self.directions * self.weights(time)) @ self.directions.T


def moduli(law: KelvinVoigt) -> Moduli:
    """Those of a law.

    Raises:
        BoundError: G has no finite constant of monotonicity.
    """
    A, G = law.A, law.G
    if not np.isfinite(G.monotonicity):
        raise BoundError(
            f"{law.name}: G has the monotonicity constant {G.monotonicity}; the bound needs a finite "
            "one, −L_G if nothing better is known"
        )
    if isinstance(G, Linear):
        values, directions = eigh(G.matrix, A.matrix)
        if G.factor is A.factor:
            return Moduli(values, directions)
        damped, grows = G.factor.low / A.factor.high, G.factor.high / A.factor.low
        return Moduli(values * np.where(values >= 0, damped, grows), directions)
    m = G.monotonicity / (A.lipschitz if G.monotonicity >= 0 else A.ellipticity)
    _, directions = eigh(A.matrix, A.matrix)
    return Moduli(np.full(len(directions), m), directions)

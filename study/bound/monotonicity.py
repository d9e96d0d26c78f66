"""The constant m of monotonicity of G with respect to A, on which the growth of the bound in time rests."""

from __future__ import annotations

import numpy as np

from manufactured.law import KelvinVoigt, Linear
from study.bound.refusal import BoundError


def monotonicity(law: KelvinVoigt) -> float:
    """m with (G ε₁ − G ε₂)·(ε₁ − ε₂) ≥ m A(ε₁ − ε₂)·(ε₁ − ε₂).

    For a linear G the least eigenvalue of A⁻¹G; else from G's own constant and the bounds of A.

    Raises:
        BoundError: that constant is not finite.
    """
    A, G = law.A, law.G
    if not np.isfinite(G.monotonicity):
        raise BoundError(
            f"{law.name}: G has the monotonicity constant {G.monotonicity}; the bound needs a finite "
            "one, −L_G if nothing better is known"
        )
    if isinstance(G, Linear):
        least = float(np.linalg.eigvals(np.linalg.solve(A.matrix, G.matrix)).real.min())
        return least if G.factor is A.factor else least * G.factor.low / A.factor.high
    return G.monotonicity / (A.lipschitz if G.monotonicity >= 0 else A.ellipticity)

"""One sparse factorisation of a symmetric positive definite matrix, for many right-hand sides."""

from __future__ import annotations

import scipy.sparse as sps
from scipy.sparse.linalg import splu

from manufactured.tensors import Array


class Factor:
    """S⁻¹ by SuperLU in its symmetric mode: diagonal pivots, minimum degree on the pattern of S + Sᵀ."""

    def __init__(self, S: sps.csc_array) -> None:
        self._lu = splu(
            sps.csc_matrix(S), permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
        )

    def __call__(self, b: Array) -> Array:
        """S⁻¹ b, (n,) or (n, columns)."""
        return self._lu.solve(b)

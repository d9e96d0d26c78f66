"""The matrix of a time step, and the optimality conditions, for tests of the contact solvers."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sps

from manufactured import named
from manufactured.tensors import Array
from study.fem.space import Space, form


def step_matrix(name: str, space: Space) -> sps.csc_array:
    """Return 20 A + G, the matrix of a step of length 1/20 with the law of a case."""
    law = named(name).solution.law
    return sps.csc_array(20 * form(space, law.A) + form(space, law.G))


def require_optimal(S, N, b: Array, solution: tuple[Array, Array], rest: float, exact: float | None = None) -> None:
    """Require S u + Nᵀλ = b up to ``rest``, and N u ≤ 0, λ ≥ 0 and λ·N u = 0 up to ``exact``, in relative terms.

    For a positive definite S these conditions have one solution (u, λ), if the rows of N are linearly independent.
    """
    (u, multipliers), exact = solution, rest if exact is None else exact
    # If all unknowns are held at their bounds, u is zero up to rounding, so its size is not taken from u alone.
    size, force = max(abs(u).max(), abs(b).max() / abs(S).max()), abs(multipliers).max(initial=0.0)
    assert np.linalg.norm(S @ u + N.T @ multipliers - b) <= rest * np.linalg.norm(b)
    assert (N @ u).max(initial=0.0) <= exact * size
    assert multipliers.min(initial=0.0) >= 0
    assert abs(multipliers * (N @ u)).max(initial=0.0) <= exact * size * force

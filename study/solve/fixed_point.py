"""Fixed-point iteration u = g(v) for a contraction g, with Anderson acceleration.

The next v is the image of the combination of the last inputs for which the residual f(v) = g(v) − v would be smallest
if g were affine (D. G. Anderson, Iterative procedures for nonlinear integral equations, J. ACM 12 (1965) 547–560).

Two inputs and their images give a lower bound of the contraction number ρ of g. The distance from u to the fixed point
is at most ρ/(1 − ρ) ‖u − v‖. The largest quotient so far is used as ρ; for ρ > 1/2 the residual itself is compared with
the tolerance. Both are estimates, so a caller that needs a bound has to measure the remaining error.

Vectors w are stored with their duals M w, (2, n). Sums and multiples of pairs are pairs, so that each image needs only
one product with M.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence

import numpy as np

from manufactured.tensors import Array

SEEN = 3
"""Least number of images before an iteration may stop: they give two quotients."""
MEMORY = 3
"""Number of differences of residuals that determine an input."""
CUTOFF = 1e-12
"""Eigenvalues of a Gram matrix below this value, relative to the largest, count as zero."""
TINY = 1e-300
"""Replaces zero in denominators."""


class FixedPointError(RuntimeError):
    """Raised if the iteration did not converge."""


def fixed_point(
    image: Callable[[Array], Array], v: Array, dual: Callable[[Array], Array], tolerance: float, most: int
) -> tuple[Array, int]:
    """Return u = image(v) at an estimated distance of tolerance · ‖u‖ from the fixed point, and the number of images.

    Args:
        image: a contraction.
        v: the first input.
        dual: w ↦ M w with the matrix of the norm, ‖w‖² = w·M w.
        tolerance: relative tolerance.
        most: largest number of images.

    Raises:
        FixedPointError: the iteration did not converge, or values are not finite.
    """

    def with_dual(w: Array) -> Array:
        return np.stack([w, dual(w)])

    u = image(v)
    residual, contraction = with_dual(u - v), 0.0
    if _finite(_norm(residual), 1) == 0:
        return u, 1
    whole = with_dual(u)
    memory: deque[tuple[Array, Array]] = deque(maxlen=MEMORY)
    for taken in range(2, most + 1):
        step = _accelerated(residual, memory)
        v = v + step[0]
        u = image(v)
        before, residual = residual, with_dual(u - v)
        change = residual - before
        # u = v + f(v) is the image of v, so step + change is the difference of the last two images.
        moved = step + change
        whole += moved
        left = _finite(_norm(residual), taken)
        contraction = max(contraction, _norm(moved) / max(_norm(step), TINY))
        if left == 0 or (taken >= SEEN and left <= tolerance * _per_residual(contraction) * _norm(whole)):
            return u, taken
        memory.append((change, moved))
    raise FixedPointError(f"the iteration did not settle in {most} steps")


def _norm(w: Array) -> float:
    """Return the norm ‖w‖ of a vector with its dual, (2, n)."""
    return float(np.sqrt(max(w[0] @ w[1], 0.0)))


def _finite(size: float, taken: int) -> float:
    if not np.isfinite(size):
        raise FixedPointError(f"the iteration did not settle: image {taken} is not finite")
    return size


def _per_residual(contraction: float) -> float:
    """Return the factor by which a residual may exceed the required error.

    The factor is at least 1: quotients of round-off are arbitrary, and a residual of the size of the tolerance is
    enough.
    """
    return max(1.0, (1 - contraction) / max(contraction, TINY))


def _accelerated(residual: Array, memory: Sequence[tuple[Array, Array]]) -> Array:
    """Return residual − Σ γ_i Δu_i with the least ‖residual − Σ γ_i Δf_i‖; ``memory`` has pairs (Δf_i, Δu_i)."""
    if not memory:
        return residual
    changes, of_images = (np.array(parts) for parts in zip(*memory, strict=True))
    gram = changes[:, 0] @ changes[:, 1].T
    # The differences of a contraction become much smaller from step to step, so the system is scaled.
    sizes = np.sqrt(np.maximum(gram.diagonal(), TINY))
    slopes = changes[:, 1] @ residual[0] / sizes
    gamma = np.linalg.lstsq(gram / np.outer(sizes, sizes), slopes, rcond=CUTOFF)[0] / sizes
    return np.asarray(residual - np.tensordot(gamma, of_images, axes=1))

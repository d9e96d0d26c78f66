"""Fixed-point iteration u = g(v) for a contraction g, with Anderson acceleration.

The next input is the image where g, were it affine between the last inputs, would have the least residual f(v) = g(v) −
v (D. G. Anderson, Iterative procedures for nonlinear integral equations, J. ACM 12 (1965) 547–560).

Two inputs and their images bound the contraction number ρ of g from below. With ρ, the fixed point is no further from u
than ρ/(1 − ρ) ‖u − v‖; the largest quotient seen stands for ρ, and for ρ > 1/2 the residual itself is compared with the
tolerance. Both are estimates: whoever needs a bound has to measure the error that is left.

Vectors w travel with their duals M w, (2, n): sums and multiples of pairs are pairs, so that an image takes one product
with M.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence

import numpy as np

from manufactured.tensors import Array

SEEN = 3
"""Images before an iteration may stop: two quotients."""
MEMORY = 3
"""Differences of residuals that an input is made of."""
CUTOFF = 1e-12
"""Eigenvalues of a Gram matrix that are smaller, relative to the largest, count as zero."""
TINY = 1e-300
"""Stands for zero in denominators."""


class FixedPointError(RuntimeError):
    """The iteration did not settle."""


def fixed_point(
    image: Callable[[Array], Array], v: Array, dual: Callable[[Array], Array], tolerance: float, most: int
) -> tuple[Array, int]:
    """u = image(v) at an estimated distance of tolerance · ‖u‖ from the fixed point, and how many images were taken.

    Args:
        image: a contraction.
        v: where to start.
        dual: w ↦ M w with the matrix of the norm, ‖w‖² = w·M w.
        tolerance: relative.
        most: images to be taken before it is given up.

    Raises:
        FixedPointError: it did not settle, or came to values that are not finite.
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
        # From u = v + f(v): how far images are from one another.
        moved = step + change
        whole += moved
        left = _finite(_norm(residual), taken)
        contraction = max(contraction, _norm(moved) / max(_norm(step), TINY))
        if left == 0 or (taken >= SEEN and left <= tolerance * _per_residual(contraction) * _norm(whole)):
            return u, taken
        memory.append((change, moved))
    raise FixedPointError(f"the iteration did not settle in {most} steps")


def _norm(w: Array) -> float:
    """‖w‖ of a vector with its dual, (2, n)."""
    return float(np.sqrt(max(w[0] @ w[1], 0.0)))


def _finite(size: float, taken: int) -> float:
    if not np.isfinite(size):
        raise FixedPointError(f"the iteration did not settle: image {taken} is not finite")
    return size


def _per_residual(contraction: float) -> float:
    """How many times as large as the error that is asked for a residual may be.

    Quotients of what rounding leaves may be anything: a residual of the size of the tolerance is enough.
    """
    return max(1.0, (1 - contraction) / max(contraction, TINY))


def _accelerated(residual: Array, memory: Sequence[tuple[Array, Array]]) -> Array:
    """The step residual − Σ γ_i Δu_i with ‖residual − Σ γ_i Δf_i‖ least; the memory holds Δf_i and Δu_i."""
    if not memory:
        return residual
    changes, of_images = (np.array(parts) for parts in zip(*memory, strict=True))
    gram = changes[:, 0] @ changes[:, 1].T
    # Each step of a contraction is much smaller than the one before: the system is scaled.
    sizes = np.sqrt(np.maximum(gram.diagonal(), TINY))
    slopes = changes[:, 1] @ residual[0] / sizes
    gamma = np.linalg.lstsq(gram / np.outer(sizes, sizes), slopes, rcond=CUTOFF)[0] / sizes
    return np.asarray(residual - np.tensordot(gamma, of_images, axes=1))

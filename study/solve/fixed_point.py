"""Fixed-point iteration u = g(v) for a contraction g, with Anderson acceleration.

The next input is the image where g, were it affine between the last inputs, would have the least residual f(v) = g(v) −
v (D. G. Anderson, Iterative procedures for nonlinear integral equations, J. ACM 12 (1965) 547–560).

Two inputs and their images bound the contraction number ρ of g from below. With ρ, the fixed point is no further from u
than ρ/(1 − ρ) ‖u − v‖; the largest quotient seen stands for ρ, and for ρ > 1/2 the residual itself is compared with the
tolerance. Both are estimates: whoever needs a bound has to measure the error that is left.
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

    def norm(w: Array) -> float:
        return float(np.sqrt(w @ dual(w)))

    u = image(v)
    residual, contraction = u - v, 0.0
    if _finite(norm(residual), 1) == 0:
        return u, 1
    memory: deque[tuple[Array, Array, Array]] = deque(maxlen=MEMORY)
    for taken in range(2, most + 1):
        old_v, old_u, old_residual = v, u, residual
        v = _accelerated(u, residual, memory)
        u = image(v)
        residual = u - v
        left = _finite(norm(residual), taken)
        contraction = max(contraction, norm(u - old_u) / max(norm(v - old_v), TINY))
        if left == 0 or (taken >= SEEN and left <= tolerance * _per_residual(contraction) * norm(u)):
            return u, taken
        change = residual - old_residual
        memory.append((change, dual(change), u - old_u))
    raise FixedPointError(f"the iteration did not settle in {most} steps")


def _finite(size: float, taken: int) -> float:
    if not np.isfinite(size):
        raise FixedPointError(f"the iteration did not settle: image {taken} is not finite")
    return size


def _per_residual(contraction: float) -> float:
    """How many times as large as the error that is asked for a residual may be.

    Quotients of what rounding leaves may be anything: a residual of the size of the tolerance is enough.
    """
    return max(1.0, (1 - contraction) / max(contraction, TINY))


def _accelerated(u: Array, residual: Array, memory: Sequence[tuple[Array, Array, Array]]) -> Array:
    """u − Σ γ_i Δu_i with ‖residual − Σ γ_i Δf_i‖ least; the memory holds Δf_i, M Δf_i and Δu_i."""
    if not memory:
        return u
    changes, duals, of_images = (np.array(parts) for parts in zip(*memory, strict=True))
    gram = changes @ duals.T
    # Each step of a contraction is much smaller than the one before: the system is scaled.
    sizes = np.sqrt(np.maximum(gram.diagonal(), TINY))
    gamma = np.linalg.lstsq(gram / np.outer(sizes, sizes), duals @ residual / sizes, rcond=CUTOFF)[0] / sizes
    return np.asarray(u - gamma @ of_images)

"""Fixed-point iteration u = g(v) for a contraction g, with Anderson acceleration.

**Acceleration.** The next input v is the image of a combination of the last inputs. The combination is chosen so that
the residual f(v) = g(v) − v would be smallest if g were affine (D. G. Anderson, Iterative procedures for nonlinear
integral equations, J. ACM 12 (1965) 547–560).

**When to stop.** For a contraction number ρ of g, the distance from u to the fixed point is at most ρ/(1 − ρ) ‖u − v‖.
Two inputs and their images give a lower bound of ρ; the largest of these bounds so far is used as ρ. For ρ > 1/2 the
residual itself is compared with the tolerance. These are estimates: a caller that needs a guaranteed accuracy has to
measure the remaining error.

**Norm.** The norm is ‖w‖² = w·M w. Every vector w is stored together with M w, as an array (2, n). Sums and multiples
of such pairs are pairs, so each image needs one product with M only.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence

import numpy as np

from manufactured.tensors import Array

SEEN = 3
"""Least number of images before the iteration may stop; they give two estimates of ρ."""
MEMORY = 3
"""Number of previous differences that the acceleration combines."""
CUTOFF = 1e-12
"""Eigenvalues of a Gram matrix below this value, relative to the largest, count as zero."""
TINY = 1e-300
"""Replaces zero in denominators."""


class FixedPointError(RuntimeError):
    """Raised if the fixed-point iteration did not converge."""


def fixed_point(
    image: Callable[[Array], Array], v: Array, dual: Callable[[Array], Array], tolerance: float, most: int
) -> tuple[Array, int]:
    """Return the fixed point of a contraction, and the number of evaluations.

    Args:
        image: the contraction g, (n,) → (n,).
        v: the first input, (n,).
        dual: the function w ↦ M w with the matrix of the norm, ‖w‖² = w·M w.
        tolerance: the estimated distance from the fixed point, relative to ‖u‖, at which the iteration stops.
        most: largest number of evaluations of g.

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
        # The residual may exceed the tolerance by (1 − ρ)/ρ, but is not required to be smaller than the tolerance:
        # quotients of round-off are arbitrary.
        excess = max(1.0, (1 - contraction) / max(contraction, TINY))
        if left == 0 or (taken >= SEEN and left <= tolerance * excess * _norm(whole)):
            return u, taken
        memory.append((change, moved))
    raise FixedPointError(f"the fixed-point iteration did not converge in {most} steps")


def _norm(w: Array) -> float:
    """Return the norm ‖w‖ of a vector with its dual, (2, n)."""
    return float(np.sqrt(max(w[0] @ w[1], 0.0)))


def _finite(size: float, taken: int) -> float:
    if not np.isfinite(size):
        raise FixedPointError(f"the fixed-point iteration did not converge: image {taken} is not finite")
    return size


def _accelerated(residual: Array, memory: Sequence[tuple[Array, Array]]) -> Array:
    """Return the accelerated step, residual − Σ γ_i Δu_i, where the γ_i minimise ‖residual − Σ γ_i Δf_i‖.

    Args:
        residual: the last residual with its dual, (2, n).
        memory: pairs of the differences Δf_i of residuals and Δu_i of images, with their duals, (2, n) each.
    """
    if not memory:
        return residual
    changes, of_images = (np.array(parts) for parts in zip(*memory, strict=True))
    gram = changes[:, 0] @ changes[:, 1].T
    # The differences of a contraction become much smaller from step to step, so the system is scaled.
    sizes = np.sqrt(np.maximum(gram.diagonal(), TINY))
    slopes = changes[:, 1] @ residual[0] / sizes
    gamma = np.linalg.lstsq(gram / np.outer(sizes, sizes), slopes, rcond=CUTOFF)[0] / sizes
    return np.asarray(residual - np.tensordot(gamma, of_images, axes=1))

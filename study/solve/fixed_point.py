"""Fixed-point iteration u = g(v) for a contraction g, with Anderson acceleration.

**Acceleration.** Every evaluation of g maps an iterate v, here called input, to its image g(v). The next input is a
linear combination of the last images. Its factors are chosen so that the residual f(v) = g(v) − v would be smallest if
g were affine (D. G. Anderson, Iterative procedures for nonlinear integral equations, J. ACM 12 (1965) 547–560).

**When to stop.** For a contraction number ρ of g, the distance from u to the fixed point is at most ρ/(1 − ρ) ‖u − v‖.
Two inputs and their images give a lower bound of ρ; the largest of these bounds so far is used as ρ. For ρ > 1/2 the
residual itself is compared with the tolerance. These are estimates: a caller that needs a guaranteed accuracy has to
measure the remaining error.

**Norm.** The norm is ‖w‖² = w·M w. Every vector w is stored together with M w, as an array (2, n). Sums and multiples
of such pairs are pairs, so each image needs one product with M only.
"""

from collections import deque
from collections.abc import Callable, Sequence

import numpy as np

from manufactured.tensors import Array

SEEN = 3
"""The iteration may stop only after this number of evaluations, which give two estimates of the contraction number."""
MEMORY = 3
"""Number of previous steps that Anderson acceleration combines."""
CUTOFF = 1e-12
"""In least squares, eigenvalues of the Gram matrix count as zero below this fraction of the largest one."""
TINY = 1e-300
"""Replaces zero in denominators."""


class FixedPointError(RuntimeError):
    """Raised if the fixed-point iteration did not converge."""


def fixed_point(
    image: Callable[[Array], Array], v: Array, dual: Callable[[Array], Array], tolerance: float, most: int
) -> tuple[Array, int]:
    """Return the fixed point of a contraction, and the number of evaluations of the contraction.

    Args:
        image: the contraction g, (n,) → (n,).
        v: the first input, (n,).
        dual: the function w ↦ M w with the matrix of the norm, ‖w‖² = w·M w.
        tolerance: the iteration stops at this estimated distance from the fixed point, relative to the norm of the
            result.
        most: the largest number of evaluations of g.

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
        # The image of an input v is v plus its residual. So the image changes by the step of the input plus the change
        # of the residual.
        moved = step + change
        whole += moved
        left = _finite(_norm(residual), taken)
        contraction = max(contraction, _norm(moved) / max(_norm(step), TINY))
        # By the estimate of the distance, the residual may be (1 − ρ)/ρ times the tolerance. It is not required to be
        # smaller than the tolerance, because the estimate of ρ then depends on round-off.
        excess = max(1.0, (1 - contraction) / max(contraction, TINY))
        if left == 0 or (taken >= SEEN and left <= tolerance * excess * _norm(whole)):
            return u, taken
        memory.append((change, moved))
    raise FixedPointError(f"the fixed-point iteration did not converge in {most} steps")


def _norm(w: Array) -> float:
    """Return the norm (w·M w)^½ of a vector w that is stored together with M w, (2, n)."""
    return float(np.sqrt(max(w[0] @ w[1], 0.0)))


def _finite(size: float, taken: int) -> float:
    if not np.isfinite(size):
        raise FixedPointError(f"the fixed-point iteration did not converge: image {taken} is not finite")
    return size


def _accelerated(residual: Array, memory: Sequence[tuple[Array, Array]]) -> Array:
    """Return the step of Anderson acceleration, residual − Σ γ_i Δu_i, where the γ_i minimise ‖residual − Σ γ_i Δf_i‖.

    Each vector w is stored together with M w, as an array (2, n).

    Args:
        residual: the last residual, (2, n).
        memory: pairs of the differences Δf_i of successive residuals and Δu_i of successive images, (2, n) each.
    """
    if not memory:
        return residual
    changes, of_images = (np.array(parts) for parts in zip(*memory, strict=True))
    gram = changes[:, 0] @ changes[:, 1].T
    # The differences become much smaller from step to step, so the system is scaled to avoid ill-conditioning.
    sizes = np.sqrt(np.maximum(gram.diagonal(), TINY))
    slopes = changes[:, 1] @ residual[0] / sizes
    gamma = np.linalg.lstsq(gram / np.outer(sizes, sizes), slopes, rcond=CUTOFF)[0] / sizes
    return np.asarray(residual - np.tensordot(gamma, of_images, axes=1))

"""The fixed point of a contraction, with some memory.

Inputs v_i and their images u_i show where a map that were affine between them would come nearest to a fixed point:
where the change u − v, affine as well, is smallest. The image there is the next input (D. G. Anderson, Iterative
procedures for nonlinear integral equations, J. ACM 12 (1965) 547–560). Two of them also show how much the map contracts
between them, which is at most ρ, its contraction everywhere; with ρ, the fixed point is no further from u than
ρ/(1 − ρ) ‖u − v‖. The largest of the quotients seen stands for ρ, and for ρ > 1/2 the change ‖u − v‖ itself is judged:
estimates, which is why whoever needs a bound has to measure what is left.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence

import numpy as np

from manufactured.tensors import Array

SEEN = 3
"""Images before an iteration may stop: two quotients."""
MEMORY = 3
"""Images before the last that an input is made of."""
CUTOFF = 1e-12
"""Of the eigenvalues of a Gram matrix, relative: what is smaller counts as zero."""
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

    def size(change: Array, taken: int) -> float:
        found = norm(change)
        if not np.isfinite(found):
            raise FixedPointError(f"the iteration did not settle: image {taken} is not finite")
        return found

    u = image(v)
    change, contraction = u - v, 0.0
    if size(change, 1) == 0:
        return u, 1
    memory: deque[tuple[Array, Array, Array]] = deque(maxlen=MEMORY)
    for taken in range(2, most + 1):
        old_v, old_u, old_change = v, u, change
        v = _input(u, change, memory)
        u = image(v)
        change = u - v
        left = size(change, taken)
        contraction = max(contraction, norm(u - old_u) / max(norm(v - old_v), TINY))
        # Quotients of what rounding leaves may be anything: a change of the size of the tolerance is enough.
        room = max(1.0, (1 - contraction) / max(contraction, TINY))
        settled = left <= tolerance * room * norm(u)
        # One quotient says too little; and a change of 0 needs none.
        if (settled and taken >= SEEN) or left == 0:
            return u, taken
        bent = change - old_change
        memory.append((bent, dual(bent), u - old_u))
    raise FixedPointError(f"the iteration did not settle in {most} steps")


def _input(u: Array, change: Array, memory: Sequence[tuple[Array, Array, Array]]) -> Array:
    """u − Σ γ_i followed_i with ‖change − Σ γ_i bent_i‖ least; the memory holds bent_i, M bent_i and followed_i."""
    if not memory:
        return u
    bent, duals, followed = (np.array(parts) for parts in zip(*memory, strict=True))
    gram = bent @ duals.T
    # Each step of a contraction is much smaller than the one before.
    sizes = np.sqrt(np.maximum(gram.diagonal(), TINY))
    gamma = np.linalg.lstsq(gram / np.outer(sizes, sizes), duals @ change / sizes, rcond=CUTOFF)[0] / sizes
    return np.asarray(u - gamma @ followed)

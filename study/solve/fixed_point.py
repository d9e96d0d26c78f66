"""The fixed point of a contraction, with one step of memory.

Two inputs v, v' and their images u, u' show where a map that were linear between them would have its fixed point; the
next input is the nearest to it (D. G. Anderson, Iterative procedures for nonlinear integral equations, J. ACM 12 (1965)
547–560, with depth 1). They also show how much the map contracts between them, which is at most ρ, its contraction
everywhere; with ρ, the fixed point is no further from u than ρ/(1 − ρ) ‖u − v‖. The largest of the quotients seen
stands for ρ, and for ρ > 1/2 the change ‖u − v‖ itself is judged: estimates, which is why whoever needs a bound has to
measure what is left.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from manufactured.tensors import Array

SEEN = 3
"""Images before an iteration may stop: two quotients."""
TINY = 1e-300
"""Stands for zero in denominators."""


class FixedPointError(RuntimeError):
    """The iteration did not settle."""


def fixed_point(
    image: Callable[[Array], Array], v: Array, product: Callable[[Array, Array], float], tolerance: float, most: int
) -> tuple[Array, int]:
    """u = image(v) at an estimated distance of tolerance · ‖u‖ from the fixed point, and how many images were taken.

    Args:
        image: a contraction.
        v: where to start.
        product: the inner product that belongs to the norm.
        tolerance: relative.
        most: images to be taken before it is given up.

    Raises:
        FixedPointError: it did not settle.
    """

    def norm(w: Array) -> float:
        return float(np.sqrt(product(w, w)))

    old_v, old_u = v, image(v)
    if norm(old_u - old_v) == 0:
        return old_u, 1
    v, contraction = old_u, 0.0
    for taken in range(2, most + 1):
        u = image(v)
        change, moved, followed = u - v, v - old_v, u - old_u
        contraction = max(contraction, norm(followed) / max(norm(moved), TINY))
        # Quotients of what rounding leaves may be anything: a change of the size of the tolerance is enough.
        room = max(1.0, (1 - contraction) / max(contraction, TINY))
        settled = norm(change) <= tolerance * room * norm(u)
        # One quotient says too little; and a change of 0 needs none.
        if (settled and taken >= SEEN) or norm(change) == 0:
            return u, taken
        bent = followed - moved
        old_v, old_u = v, u
        v = u - product(change, bent) / max(product(bent, bent), TINY) * followed
    raise FixedPointError(f"the iteration did not settle in {most} steps")

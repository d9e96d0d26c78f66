"""The fixed point of a contraction, with one step of memory.

Two inputs v, v' and their images u, u' show where a map that were linear between them would have its fixed point; the
next input is the nearest to it (D. G. Anderson, Iterative procedures for nonlinear integral equations, J. ACM 12 (1965)
547–560, with depth 1). They also show the contraction ρ, and how far u is from the fixed point: at most
ρ/(1 − ρ) ‖u − v‖.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from manufactured.tensors import Array


class FixedPointError(RuntimeError):
    """The iteration did not settle."""


def fixed_point(
    image: Callable[[Array], Array], v: Array, product: Callable[[Array, Array], float], tolerance: float, most: int
) -> tuple[Array, int]:
    """u = image(v) with ‖u − image(u)‖ of the size tolerance · ‖u‖ at most, and how many images were taken.

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
    if not norm(old_u - old_v) > 0:
        return old_u, 1
    v = old_u
    for taken in range(2, most + 1):
        u = image(v)
        change, moved, followed = u - v, v - old_v, u - old_u
        contraction = norm(followed) / norm(moved)
        if contraction * norm(change) <= tolerance * (1 - contraction) * norm(u):
            return u, taken
        bent = followed - moved
        old_v, old_u = v, u
        v = u - product(change, bent) / product(bent, bent) * followed
    raise FixedPointError(f"the iteration did not settle in {most} steps")

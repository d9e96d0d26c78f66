"""No exact solution: order from differences, extrapolated value, grid convergence index (Celik et al. 2008, V&V 20)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from .errors import OrderError

SAFETY = 1.25


@dataclass(frozen=True)
class GridConvergence:
    """A quantity on the three finest meshes.

    Attributes:
        kind: monotone, oscillating, diverging or equal values.
        order: apparent order.
        extrapolated: value for h → 0.
        index: grid convergence index of the finest mesh, relative.
    """

    kind: str
    order: float
    extrapolated: float
    index: float


def grid_convergence(h: ArrayLike, values: ArrayLike) -> GridConvergence:
    """Apparent order, extrapolated value and grid convergence index from the three finest of the meshes.

    Raises:
        OrderError: fewer than three meshes, or sizes that are not positive and distinct.
    """
    sizes, phi = (np.asarray(entries, dtype=float) for entries in (h, values))
    if sizes.shape != phi.shape or len(sizes) < 3:
        raise OrderError(
            f"{len(phi)} values on {len(sizes)} meshes: expected one value on each of three meshes or more"
        )
    fine_first = np.argsort(sizes)[:3]
    (h1, h2, h3), (f1, f2, f3) = sizes[fine_first], phi[fine_first]
    if not 0 < h1 < h2 < h3 or not np.isfinite(phi).all():
        raise OrderError("mesh sizes must be positive and distinct, and values finite")
    e21, e32, r21, r32 = f2 - f1, f3 - f2, h2 / h1, h3 / h2
    if e21 == 0 or e32 == 0:
        return GridConvergence("equal values", math.nan, float(f1), 0.0 if e21 == 0 else math.nan)
    sign = math.copysign(1.0, e32 / e21)
    p = abs(math.log(abs(e32 / e21))) / math.log(r21)
    for _ in range(200):
        q = math.log((r21**p - sign) / (r32**p - sign)) if p > 0 else 0.0
        p = 0.5 * p + 0.5 * abs(math.log(abs(e32 / e21)) + q) / math.log(r21)
    if abs(e21) >= abs(e32) * (h2 - h1) / (h3 - h2) and abs(e21) >= abs(e32):
        return GridConvergence("diverging", p, math.nan, math.nan)
    extrapolated = (r21**p * f1 - f2) / (r21**p - 1)
    index = SAFETY * abs(e21 / f1) / (r21**p - 1) if f1 else math.nan
    return GridConvergence("monotone" if sign > 0 else "oscillating", p, float(extrapolated), float(index))

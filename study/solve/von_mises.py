"""The von Mises stress, a measure of how much a stress distorts."""

from __future__ import annotations

import numpy as np

from manufactured.tensors import Array, Tensors, identity


def von_mises(stress: Tensors) -> Array:
    """√(3/2) |dev σ| with dev σ = σ − (tr σ/d) I, (D, ...) → (...).

    In the plane, where the problem has no σ_33, this takes it as (σ_11 + σ_22)/2: then the deviator is that of S²,
    as in the sets K of (3.3), and the value is (√3/2) ((σ_11 − σ_22)² + 4 σ_12²)^½, the smallest that any σ_33 gives.
    """
    dim = {3: 2, 6: 3}[len(stress)]
    unit = identity(dim)
    trace = np.tensordot(unit, stress, axes=1)
    deviator = stress - np.multiply.outer(unit / dim, trace)
    return np.asarray(np.sqrt(1.5 * np.sum(deviator**2, axis=0)))

"""Derivatives by the complex step: ∂_j f(x) = Im f(x + i δ e_j)/δ, which has no cancellation for small δ.

Source: J. N. Lyness, C. B. Moler, Numerical differentiation of analytic functions, SIAM J. Numer. Anal. 4 (1967)
202–210.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from manufactured.exact import ExactSolution, Fields
from manufactured.tensors import Array, Points

STEP = 1e-30


def shifted_fields(solution: ExactSolution, x: Points) -> list[Fields]:
    """Return the fields of the solution at the complex points x + i·STEP·e_j, one object for every direction j."""
    found = []
    for j in range(len(x)):
        shifted = x.astype(complex)
        shifted[j] += 1j * STEP
        found.append(solution.at(shifted))
    return found


def gradient(shifted: list[Fields], field: Callable[[Fields, Any], Array], time: Array | float) -> Array:
    """Return the derivatives ∂_j of a field at one time or several times, (components, d, ...).

    Args:
        shifted: the result of ``shifted_fields``.
        field: the field, as a function of ``Fields`` and the time.
        time: a time, or times (n,).
    """
    return np.stack([field(fields, time).imag / STEP for fields in shifted], axis=1)

"""How a bound of ‖e‖_V grows over a time interval, from a differential inequality.

With a residual r ≥ 0 and a contact term c ≥ 0,

    ½ d/dt ‖e‖_V² + m ‖e‖_V² ≤ r ‖e‖_V + c

gives, for m ≥ 0,

    ‖e(b)‖_V ≤ (e^{−2m(b−a)} ‖e(a)‖_V² + 2 ∫_a^b c)^{1/2} + ∫_a^b r,

and for m < 0 the right side with m = 0 times e^{|m|(b−a)}: d/dt of its square is at least what is needed. (Proof:
``paper/bound.tex``.)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Interval:
    """The bound y of ‖e‖_V between two knots.

    Attributes:
        a, b: the knots.
        at_a, at_b: y at the knots.
        inside: bound of ‖e(t)‖_V for all a ≤ t ≤ b.
        residual: ∫ of the norm of ρ.
        contact: ∫ c.
        oscillation: ∫ of the bound of f − P f.
        bending: ∫ of the norm of P f minus its parabola in time.

    The integrals are for the record: the bound combines residual and oscillation cell by cell.
    """

    a: float
    b: float
    at_a: float
    at_b: float
    inside: float
    residual: float
    contact: float
    oscillation: float
    bending: float


def grown(y: float, m: float, k: float, contact: float, added: float) -> tuple[float, float]:
    """Bounds of ‖e‖_V at the end of an interval and at any time of it.

    Args:
        y: bound at its start.
        m: constant of monotonicity.
        k: length.
        contact: ∫ c.
        added: ∫ r.
    """
    growth, decay = np.exp(max(-m, 0.0) * k), np.exp(-max(m, 0.0) * k)
    return (
        float(growth * (np.sqrt((decay * y) ** 2 + 2 * contact) + added)),
        float(growth * (np.sqrt(y**2 + 2 * contact) + added)),
    )

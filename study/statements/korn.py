"""Korn's inequality (2.17), and the equivalence (3.6) of the norms ‖·‖_V and ‖·‖_{H_1} that follows from it.

Both are tested on the P1 space V^h ⊂ V. The minimum over V^h is an upper bound of the square of the constant C_K in
(2.17):

    C_K² = inf_{v ∈ V} ‖ε(v)‖_Q² / ‖v‖_{H_1}² ≤ min_{v ∈ V^h} ‖ε(v)‖_Q² / ‖v‖_{H_1}².

The minimum is the smallest eigenvalue of (ε(·), ε(·))_Q with respect to the inner product of H_1. It falls under
refinement; for nested spaces it cannot rise. By (2.17) its limit for h → 0 is positive. With (3.1)

    m_A C_K² ‖v‖_{H_1}² ≤ ‖v‖_V² ≤ ‖A‖ ‖v‖_{H_1}²

on V^h. Here C_K is the constant of V^h, which is bounded below uniformly in h.
"""

import math

import pandas as pd

from study.ledger.check import ENOUGH, ROUNDING, identity, paper_claim
from study.ledger.quantities import ratios
from study.ledger.window import Window, at_most
from study.statements.shared.base import ListedNumbers, Numbers, Setting, with_h
from study.statements.shared.eigen import h1_product, smallest, strain_product
from study.statements.shared.meshes import body_of, first_with_each, place, space_of
from study.statements.shared.scope import REGULAR

VALUE = "smallest eigenvalue"
LIMIT = Window(0.7, 1.0, "of the value on the finest level")
"""Window of (limit of the eigenvalue for h → 0) / (value on the finest level).

Eigenvalues that tend to zero leave the window. Values like h^p extrapolate to 0. The slowest decay is 1/(c + |log h|),
which occurs if Γ1 is a point; it extrapolates to less than 0.7 of the last value."""
OVER = "eigenvalue, finest level / next coarser level"
SETTLED = Window(0.75, 1.25)
"""Window of the quotient of eigenvalues on neighbouring levels.

It excludes powers of h: even h^{1/2} would change by the factor 0.71 or 1.41."""


def extrapolated(table: pd.DataFrame) -> float:
    """Return the extrapolated limit of the eigenvalue for h → 0, divided by its value on the finest level.

    The limit is computed by Aitken's extrapolation of the last three values. It is −∞ if their differences do not
    shrink.
    """
    first, second, last = table[VALUE].to_numpy()[-3:]
    before = first - second
    drop = second - last
    return float((last - drop**2 / (before - drop)) / last if before > drop else -math.inf)


class Korn(ListedNumbers):
    """Measures the square of Korn's constant on V^h, min ‖ε(v)‖_Q² / ‖v‖_{H_1}², for each body."""

    label = "(2.17)"
    claim = "‖ε(v)‖_Q ≥ C_K ‖v‖_{H_1} on V, C_K > 0"
    checks = (
        identity(
            "falling",
            f"{VALUE} / value on the next coarser level",
            ratios(VALUE),
            at_most(1 + ROUNDING, "on every level"),
            levels=2,
        ),
        paper_claim("limit", f"limit of the {VALUE} for h → 0", extrapolated, LIMIT, levels=ENOUGH),
    )

    def places(self, full: bool) -> list[Setting]:
        bodies = first_with_each(body_of)
        return place(bodies, REGULAR, (8, 16, 32, 64), (2, 4, 8)) if full else place(bodies, REGULAR, (4, 8, 16))

    def measure(self, setting: Setting) -> Numbers:
        space = space_of(setting)
        return with_h(space.h, {VALUE: smallest(strain_product(space), h1_product(space))})

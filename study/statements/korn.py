"""Korn's inequality (2.17) on V^h ⊂ V.

    C_K² = inf_{v ∈ V} ‖ε(v)‖_Q² / ‖v‖_{H_1}² ≤ min_{v ∈ V^h} ‖ε(v)‖_Q² / ‖v‖_{H_1}²,

so the right side falls under refinement; with nested spaces it cannot rise. (2.17) says that its limit is positive.
"""

from __future__ import annotations

import math

import pandas as pd

from study.ledger.criterion import Criterion, Measured
from study.ledger.measures import ENOUGH, ROUNDING, exactly
from study.ledger.window import Window, at_most
from study.statements.shared.base import ListedNumbers, Setting, with_h
from study.statements.shared.eigen import h1_product, smallest, strain_product
from study.statements.shared.places import FIRST, different, place, shape, space_of

VALUE = "smallest eigenvalue"
LIMIT = Window(0.7, 1.0, "of the finest value")
"""Values that tend to zero leave the window: those like h^p extrapolate to 0, those like 1/(c + |log h|), the slowest
that come up (Γ1 a point), to m/(2m − 2) < 0.7 of the last one if that is 1/m times the unit of log 2."""


def ratio(table: pd.DataFrame) -> Measured:
    """The largest ratio of the values on consecutive levels."""
    values = table[VALUE].to_numpy()
    found = values[1:] / values[:-1]
    return float(found.max()), (float(found.min()), float(found.max()))


def extrapolated(table: pd.DataFrame) -> Measured:
    """Aitken's limit of the last three values over the last one; −∞ if their differences do not shrink."""
    first, second, last = table[VALUE].to_numpy()[-3:]
    before, drop = first - second, second - last
    limit = float((last - drop**2 / (before - drop)) / last) if before > drop else -math.inf
    return exactly(limit)


class Korn(ListedNumbers):
    """Smallest eigenvalue of (ε(·), ε(·))_Q against the product of H_1, once for each body."""

    label = "(2.17)"
    claim = "‖ε(v)‖_Q ≥ C_K ‖v‖_{H_1} on V, C_K > 0"
    rules = (
        Criterion("falling", f"{VALUE}, level over level", at_most(1 + ROUNDING, "on every level"), ratio, (VALUE,), 2),
        Criterion("limit", f"limit of the {VALUE} for h → 0", LIMIT, extrapolated, (VALUE,), ENOUGH),
    )

    def places(self, full: bool) -> list[Setting]:
        bodies = different(shape)
        return place(bodies, FIRST, (8, 16, 32, 64), (2, 4, 8)) if full else place(bodies, FIRST, (4, 8, 16))

    def measure(self, setting: Setting) -> dict[str, float]:
        space = space_of(setting)
        return with_h(space.h, {VALUE: smallest(strain_product(space), h1_product(space))})

"""‖·‖_V and ‖·‖_{H_1} are equivalent, (3.6): with (3.1) and (2.17)

    m_A C_K² ‖v‖_{H_1}² ≤ ‖v‖_V² ≤ ‖A‖ ‖v‖_{H_1}²,

on V^h with the constant C_K of V^h, which is bounded below uniformly in h.
"""

from __future__ import annotations

import pandas as pd

from study.fem.naming import resolve
from study.ledger.criterion import Criterion, Measured
from study.ledger.measures import BOUND, ENOUGH, exactly
from study.ledger.measures import largest as largest_of
from study.ledger.window import Window
from study.statements.shared.base import ListedNumbers, Setting, with_h
from study.statements.shared.eigen import h1_product, largest, smallest, strain_product, unloaded
from study.statements.shared.places import FIRST, different, place, shape, space_of

SETTLED = Window(0.75, 1.25)
"""From one level to the next a power h^{1/2} would change by the factor 0.71 or 1.41."""


def finest_ratio(column: str) -> Criterion:
    """An eigenvalue on the finest level over the one before."""

    def measure(table: pd.DataFrame) -> Measured:
        return exactly(table[column].iloc[-1] / table[column].iloc[-2])

    quantity = f"{column} eigenvalue, finest level over the one before"
    return Criterion(f"settled-{column}", quantity, SETTLED, measure, (column,), ENOUGH)


class Norms(ListedNumbers):
    """Extreme eigenvalues of (·,·)_V against the product of H_1, once for each body and viscosity."""

    label = "(3.6)"
    claim = "‖·‖_V and ‖·‖_{H_1} are equivalent, uniformly on V^h"
    rules = (
        largest_of("lower", "m_A C_K² / smallest eigenvalue", BOUND, "lower bound"),
        largest_of("upper", "largest eigenvalue / ‖A‖", BOUND, "upper bound"),
        finest_ratio("smallest"),
        finest_ratio("largest"),
    )

    def places(self, full: bool) -> list[Setting]:
        cases = different(shape, lambda case: repr(case.solution.law.A))
        return place(cases, FIRST, (8, 16, 32), (2, 4, 8)) if full else place(cases, FIRST, (4, 8, 16))

    def measure(self, setting: Setting) -> dict[str, float]:
        space, law = space_of(setting), resolve(setting.case).solution.law
        M, product = unloaded(space, law).M, h1_product(space)
        low, high, korn = smallest(M, product), largest(M, product), smallest(strain_product(space), product)
        bounds = {"lower bound": law.A.ellipticity * korn / low, "upper bound": high / law.A.lipschitz}
        return with_h(space.h, {"smallest": low, "largest": high, **bounds})

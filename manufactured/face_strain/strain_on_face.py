"""What the strain on a contact face is, as a function of place and time."""

from __future__ import annotations

from typing import Protocol

import sympy as sp

from manufactured.symbols import FormulaError, Values
from manufactured.tensors import Array

Components = tuple[Values, ...]
"""(q,) where there is no shear on the face, else (q, r_1, …, r_{d−1}), with derivatives along the face."""


class StrainAtPoints(Protocol):
    """(q, r), or its rate, at fixed points of the face, with derivatives along the face up to an order.

    Times (T,) give arrays with one axis more, the last one.
    """

    def __call__(self, time: Array | complex, rate: bool, order: int) -> Components: ...


class FaceStrain(Protocol):
    """(q, r)(s, t) on a face; ``at`` fixes the points s (d−1, ...) and keeps what time does not change.

    ``formula`` has the truncated powers that q, or the pressure it comes from, is made of.
    """

    @property
    def formula(self) -> sp.Expr: ...

    def at(self, points: Array) -> StrainAtPoints: ...


def relaxation_rate(elasticity: sp.Expr | float, viscosity: sp.Expr | float) -> float:
    """g/a, which has to be a number.

    Raises:
        FormulaError: it varies along the face.
    """
    ratio = sp.sympify(elasticity) / viscosity
    # For most factors it is enough to cancel; to simplify, SymPy loads its physical units first, a tenth of a second.
    for shortened in (sp.cancel, sp.simplify):
        ratio = shortened(ratio) if ratio.free_symbols else ratio
    if ratio.free_symbols:
        raise FormulaError(
            f"the relaxation rate g/a = {ratio} varies along the face; let the factors of A and G agree on the "
            "contact face up to a constant, and differ inside"
        )
    return float(ratio)

"""The interface of strains on a contact face, as functions of s and t."""

from __future__ import annotations

from typing import Protocol

import sympy as sp

from manufactured.symbols import FormulaError, Values
from manufactured.tensors import Array

Components = tuple[Values, ...]
"""(q,) where there is no shear on the face, else (q, r_1, …, r_{d−1}), with derivatives along the face."""


class StrainAtPoints(Protocol):
    """(q, r), or its rate, at fixed points of the face, with derivatives along the face up to an order.

    An array of times (T,) gives values with a last axis of length T.
    """

    def __call__(self, time: Array | complex, rate: bool, order: int) -> Components: ...


class FaceStrain(Protocol):
    """The strain (q, r)(s, t) on a face.

    ``at`` fixes the points s (d−1, ...) and computes the parts that do not depend on t.
    ``formula`` contains the truncated powers of q, or of the pressure that gives q.
    """

    @property
    def formula(self) -> sp.Expr: ...

    def at(self, points: Array) -> StrainAtPoints: ...


def relaxation_rate(elasticity: sp.Expr | float, viscosity: sp.Expr | float) -> float:
    """Return the relaxation rate g/a, which must be constant along the face.

    Raises:
        FormulaError: g/a varies along the face.
    """
    ratio = sp.sympify(elasticity) / viscosity
    # ``cancel`` is enough for most factors; ``simplify`` takes longer because SymPy loads its physical units.
    for shortened in (sp.cancel, sp.simplify):
        ratio = shortened(ratio) if ratio.free_symbols else ratio
    if ratio.free_symbols:
        raise FormulaError(
            f"the relaxation rate g/a = {ratio} varies along the face; let the factors of A and G agree on the "
            "contact face up to a constant, and differ inside"
        )
    return float(ratio)

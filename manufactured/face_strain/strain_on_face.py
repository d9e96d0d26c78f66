"""The interface of the strain on a contact face."""

from typing import Protocol

import sympy as sp

from manufactured.symbols import FormulaError, Values
from manufactured.tensors import Array

Components = tuple[Values, ...]
"""The strain on a contact face with its derivatives along the face.

It is (q,) with the normal strain q, or (q, r_1, …, r_{d−1}) if there is also shear.
"""


class StrainAtPoints(Protocol):
    """The interface of the strain at fixed points of a contact face, as a function of time.

    The arguments of a call are the time, a flag for time derivatives, and the highest order of derivatives along the
    face. For n times, (n,), the values have n as an additional last axis.
    """

    def __call__(self, time: Array | complex, rate: bool, order: int) -> Components: ...


class FaceStrain(Protocol):
    """The interface of the strain (q, r) on a contact face as a function of s and t.

    ``at`` prepares the evaluation at fixed points s, (d−1, ...). ``formula`` is a formula that contains the truncated
    powers of q, or of the pressure that determines q.
    """

    @property
    def formula(self) -> sp.Expr: ...

    def at(self, points: Array) -> StrainAtPoints: ...


def relaxation_rate(elasticity: sp.Expr | float, viscosity: sp.Expr | float) -> float:
    """Return the relaxation rate g/a, elasticity over viscosity, which must be constant along the face.

    Raises:
        FormulaError: g/a varies along the face.
    """
    ratio: sp.Expr = elasticity / viscosity
    # ``cancel`` is tried first: it is enough for most factors, and ``simplify`` takes longer because SymPy loads its
    # physical units.
    for shortened in (sp.cancel, sp.simplify):
        ratio = shortened(ratio) if ratio.free_symbols else ratio
    if ratio.free_symbols:
        raise FormulaError(
            f"the relaxation rate g/a = {ratio} varies along the face; let the factors of A and G agree on the "
            "contact face up to a constant, and differ inside"
        )
    return float(ratio)

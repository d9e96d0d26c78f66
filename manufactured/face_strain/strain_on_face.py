"""The interface of the strain on a contact face, and prescribed strains, from which the law gives the pressure."""

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
import sympy as sp

from manufactured.arguments import Size, checked
from manufactured.jet import Jet
from manufactured.symbols import FormulaError, Symbols, Values, s
from manufactured.tensors import Array, Time

Components = tuple[Values, ...]
"""The strain on a contact face with its derivatives along the face.

It is (q,) with the normal strain q, or (q, r_1, …, r_{d−1}) if there is also shear.
"""


class StrainAtPoints(Protocol):
    """The interface of the strain at fixed points of a contact face, as a function of time.

    The arguments of a call are the time, a flag for time derivatives, and the highest order of derivatives along the
    face. For n times, (n,), the values have n as an additional last axis.
    """

    def __call__(self, time: Time, rate: bool, order: int) -> Components: ...


class FaceStrain(Protocol):
    """The interface of the strain (q, r) on a contact face as a function of s and t.

    ``at`` prepares the evaluation at fixed points s, (d−1, ...). ``formula`` is a formula that contains the truncated
    powers of q, or of the pressure that determines q.
    """

    @property
    def formula(self) -> sp.Expr: ...

    def at(self, points: Array) -> StrainAtPoints: ...


def relaxation_rate(elasticity: sp.Expr, viscosity: sp.Expr) -> float:
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


@dataclass(frozen=True, eq=False)
@checked(FormulaError)
class Prescribed:
    """A prescribed normal strain q on a contact face; the pressure follows from q and q̇ by the law.

    Attributes:
        phases: pairs of the end of a time interval and the formula of q(s, t) in it, in the order of time. The last
            interval ends at T. Formulas of neighbouring intervals must agree where they meet; the self-proof checks
            this.
        variables: the coordinates along the face.
    """

    phases: tuple[tuple[Size, sp.Expr], ...]
    variables: Symbols = (s,)

    def __post_init__(self) -> None:
        ends = [end for end, _ in self.phases]
        if not ends or (np.diff(ends) <= 0).any():
            raise FormulaError(f"phases need one interval or more, and ends that increase, got the ends {ends}")

    @property
    def formula(self) -> sp.Expr:
        """The formula from which the smoothness of the strain is read off: the sum over all time intervals."""
        return sum((formula for _, formula in self.phases), sp.Integer(0))

    @cached_property
    def _jets(self) -> list[tuple[Jet, Jet]]:
        jets = [Jet(formula, self.variables) for _, formula in self.phases]
        return [(jet, jet.rate()) for jet in jets]

    def at(self, points: Array) -> StrainAtPoints:
        ends = [end for end, _ in self.phases]

        def strain(time: Time, rate: bool, order: int) -> Components:
            times, places = np.asarray(time), points.reshape(*points.shape, *(1,) * np.ndim(time))
            phase = np.minimum(np.searchsorted(ends, times.real), len(ends) - 1)
            found: Values = {}
            for number in np.unique(phase):
                # Every formula is evaluated only at times of its own interval, because it may have no value elsewhere.
                here = phase == number
                values = self._jets[number][rate](places, np.where(here, times, times[here][0]), order)
                found = {index: np.where(here, value, found.get(index, value)) for index, value in values.items()}
            return (found,)

        return strain

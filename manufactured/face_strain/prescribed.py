"""A prescribed strain on a contact face; the pressure follows from the law."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp

from manufactured.arguments import Size, checked
from manufactured.face_strain.strain_on_face import Components, StrainAtPoints
from manufactured.jet import Jet
from manufactured.symbols import FormulaError, Values, s
from manufactured.tensors import Array


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
    variables: tuple[sp.Symbol, ...] = (s,)

    def __post_init__(self) -> None:
        ends = [end for end, _ in self.phases]
        if not ends or (np.diff(ends) <= 0).any():
            raise FormulaError(f"phases need one interval or more, and ends that increase, got the ends {ends}")

    @property
    def formula(self) -> sp.Expr:
        """The formula from which the smoothness of the strain is read off: the sum over all time intervals."""
        return sum((formula for _, formula in self.phases), sp.Integer(0))

    @cached_property
    def _jets(self) -> tuple[tuple[float, Jet, Jet], ...]:
        jets = [(end, Jet(formula, self.variables)) for end, formula in self.phases]
        return tuple((end, jet, jet.rate()) for end, jet in jets)

    def at(self, points: Array) -> StrainAtPoints:
        ends = [end for end, _, _ in self._jets]

        def strain(time: Array | complex, rate: bool, order: int) -> Components:
            times = np.atleast_1d(time)
            phase = np.minimum(np.searchsorted(ends, times.real), len(ends) - 1)
            if (phase != phase[0]).any():
                # Times are grouped by their interval, because every interval has a different formula.
                return _joined([(phase == n, strain(times[phase == n], rate, order)) for n in np.unique(phase)])
            places = points.reshape(*points.shape, *(1,) * np.ndim(time))
            return (self._jets[phase[0]][1 + rate](places, time, order),)

        return strain


def _joined(pieces: list[tuple[Array, Components]]) -> Components:
    """Join strains at different times into arrays over all times.

    Each piece consists of a mask, which is true at its times, and of the strains at these times.
    """
    found: Values = {}
    for among, (values,) in pieces:
        for index, value in values.items():
            found.setdefault(index, np.empty((*value.shape[:-1], len(among)), value.dtype))[..., among] = value
    return (found,)

"""A strain on the face that is given, from which the pressure follows by the law."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp

from manufactured.face_strain.strain_on_face import Components, StrainAtPoints
from manufactured.symbols import Jet, s
from manufactured.tensors import Array


@dataclass(frozen=True, eq=False)
class Prescribed:
    """q given phase by phase in time: ``phases`` are pairs (end of the phase, formula of q(s, t)).

    The last phase ends at T. The formulas must agree at the ends, which the self-proof of a case
    checks; the pressure is what the law makes of q and q̇.
    """

    phases: tuple[tuple[float, sp.Expr], ...]
    variables: tuple[sp.Symbol, ...] = (s,)

    @property
    def formula(self) -> sp.Expr:
        """Every phase."""
        return sum((formula for _, formula in self.phases), sp.Integer(0))

    @cached_property
    def _jets(self) -> tuple[tuple[float, Jet, Jet], ...]:
        jets = [(end, Jet(formula, self.variables)) for end, formula in self.phases]
        return tuple((end, jet, jet.rate()) for end, jet in jets)

    def at(self, points: Array) -> StrainAtPoints:
        def strain(time: complex, order: int) -> tuple[Components, Components]:
            jet, rate = next(((jet, rate) for end, jet, rate in self._jets if np.real(time) <= end), self._jets[-1][1:])
            return (jet(points, time, order),), (rate(points, time, order),)

        return strain

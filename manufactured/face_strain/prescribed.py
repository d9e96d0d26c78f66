"""A strain on the face that is given, from which the pressure follows by the law."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp

from manufactured.face_strain.strain_on_face import Components, StrainAtPoints
from manufactured.symbols import Jet, Values, s
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
        ends = [end for end, _, _ in self._jets]

        def strain(time: Array | complex, order: int) -> tuple[Components, Components]:
            times = np.atleast_1d(time)
            phase = np.minimum(np.searchsorted(ends, times.real), len(ends) - 1)
            if (phase != phase[0]).any():
                # Every phase has formulas of its own.
                return _joined([(phase == n, strain(times[phase == n], order)) for n in np.unique(phase)])
            _, jet, rate = self._jets[phase[0]]
            places = points.reshape(*points.shape, *(1,) * np.ndim(time))
            return (jet(places, time, order),), (rate(places, time, order),)

        return strain


def _joined(pieces: list[tuple[Array, tuple[Components, Components]]]) -> tuple[Components, Components]:
    """(q,) and (q̇,) at all times from those at some of them, with the mask of these."""
    whole: list[Components] = []
    for i in (0, 1):
        found: Values = {}
        for among, parts in pieces:
            for index, value in parts[i][0].items():
                found.setdefault(index, np.empty((*value.shape[:-1], len(among)), value.dtype))[..., among] = value
        whole.append((found,))
    return whole[0], whole[1]

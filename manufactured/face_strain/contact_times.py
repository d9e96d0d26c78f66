"""Divides the pressure at a point of a face into intervals of contact, in each of which it is smooth in time."""

from dataclasses import dataclass

import numpy as np
import sympy as sp

from manufactured.face_formula import SMOOTH
from manufactured.face_strain.fronts import Front, between, within
from manufactured.face_strain.integrals import Convolution, Quadrature
from manufactured.symbols import FormulaError, Symbols, pos, t
from manufactured.tensors import Array


def smooth_branch(term: sp.Expr, variables: Symbols) -> tuple[tuple[sp.Expr, ...], sp.Expr]:
    """Return the moving fronts of a term of the pressure, and the formula of the term where there is contact.

    A moving front is given by a formula ψ that is positive where there is contact.

    Raises:
        FormulaError: the exponent of a moving front is not an integer ≥ 2, or the formula between the fronts contains
            functions of t that are not known to be smooth.
    """
    fronts = [p for p in term.atoms(pos) if p.args[0].has(t)]
    for power in fronts:
        # With the exponent 1, the second derivative of the strain along the face would contain a Dirac measure at the
        # front. If ψ depends on time only, there is no such measure.
        lowest = 2 if power.args[0].free_symbols & set(variables) else 0
        if not (power.args[1].is_integer and power.args[1] >= lowest):
            raise FormulaError(
                f"{power}: a moving front of the pressure needs pos(ψ, m) with an integer m ≥ 2; with a smaller m the "
                "strain that the pressure causes has no second derivative along the face"
            )
    smooth = term.subs({p: p.args[0] ** p.args[1] for p in fronts})
    strange = {str(type(f).__name__) for f in smooth.atoms(sp.Function) if f.has(t) and not isinstance(f, SMOOTH)}
    if strange:
        raise FormulaError(
            f"the pressure term {term} has {', '.join(sorted(strange))} of t, so that it is not known to be smooth "
            f"between its fronts; of functions use {', '.join(f.__name__ for f in SMOOTH)}"
        )
    return tuple(sorted({power.args[0] for power in fronts}, key=sp.default_sort_key)), smooth


@dataclass(frozen=True, eq=False)
class PressureTerm:
    """Terms of p/a (pressure divided by viscosity) that have the same moving fronts.

    Attributes:
        moving: the moving fronts.
        integral: computes integrals over time of the formula that holds where there is contact.
    """

    moving: tuple[Front, ...]
    integral: Convolution | Quadrature

    def intervals(self, points: Array, T: float) -> tuple[Array, Array]:
        """Return the times at which contact begins and ends at N points, (J, N) each.

        If both times of an interval are equal, there is no contact in this interval.
        """
        passes = [np.empty((0, points.shape[1]))]
        for moving in self.moving:
            passes.append(moving.passes(points, T))
        begin, end = between(np.vstack(passes), T)
        times = within(begin, end)
        inside = np.ones(times.shape, dtype=bool)
        for moving in self.moving:
            inside &= moving.beyond(points, times)
        return np.where(inside, begin, T), np.where(inside, end, T)

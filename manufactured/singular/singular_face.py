"""A part of the contact boundary where the displacement is a singular field."""

from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from manufactured.arguments import checked
from manufactured.body import Part
from manufactured.jet import Jet
from manufactured.singular.singular_field import SingularAtPoints, SingularField
from manufactured.singular.travelling_field import TravellingAtPoints, TravellingField
from manufactured.symbols import FormulaError, refuse_kinks, s
from manufactured.tensors import Points


@dataclass(frozen=True, eq=False)
@checked(FormulaError)
class SingularFace:
    """A part of the contact boundary where the displacement is a singular field, with the contact data of this field.

    Attributes:
        part: the part Γ3,i.
        gap: the formula of the gap w(s, t).
        pressure: the formula of the contact pressure p(s, t). It must be the pressure that the law gives; the
            self-proof checks this.
        level: the formula of ψ(s, t); the contact zone is {ψ ≥ 0}.
        field: the displacement field.
        rough: coordinates s of the singular points that do not move.

    Raises:
        FormulaError: a kink of a formula is not written with ``pos``.
    """

    part: Part
    gap: sp.Expr
    pressure: sp.Expr
    level: sp.Expr
    field: SingularField | TravellingField
    rough: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        refuse_kinks(self.gap, self.pressure, self.level)

    @property
    def initial_gap(self) -> sp.Expr:
        """The initial gap, which is 0 for such faces."""
        return sp.Integer(0)

    @cached_property
    def gap_jet(self) -> Jet:
        return Jet(self.gap, (s,))

    @cached_property
    def pressure_jet(self) -> Jet:
        return Jet(self.pressure, (s,))

    @cached_property
    def level_jet(self) -> Jet:
        return Jet(self.level, (s,))

    @property
    def variables(self) -> tuple[sp.Symbol, ...]:
        return (s,)

    @property
    def exponents_in(self) -> sp.Expr:
        """The contact pressure, from whose truncated powers the exponents of the strain at fronts are read off."""
        return self.pressure

    def at(self, x: Points) -> SingularAtPoints | TravellingAtPoints:
        """Return the displacement field at fixed points of the body, (2, ...)."""
        return self.field.at(x)

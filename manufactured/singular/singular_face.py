"""A piece of Γ3 on which a singular field makes contact."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from manufactured.body import Part
from manufactured.jet import Jet
from manufactured.singular.singular_field import SingularAtPoints, SingularField
from manufactured.singular.travelling_field import TravellingAtPoints, TravellingField
from manufactured.symbols import refuse_kinks, s
from manufactured.tensors import Points


@dataclass(frozen=True, eq=False)
class SingularFace:
    """A piece of Γ3 on which a singular field makes contact, with the gap, pressure and zone that belong to the field.

    Attributes:
        part: the piece Γ3,i.
        gap: w(s, t).
        pressure: p(s, t), the pressure that the law gives for the field; the self-proof checks this.
        level: ψ(s, t).
        field: the displacement.
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
        """g = 0, as in the paper."""
        return sp.Integer(0)

    @cached_property
    def gap_jet(self) -> Jet:
        return Jet(sp.sympify(self.gap), (s,))

    @cached_property
    def pressure_jet(self) -> Jet:
        return Jet(sp.sympify(self.pressure), (s,))

    @cached_property
    def level_jet(self) -> Jet:
        return Jet(sp.sympify(self.level), (s,))

    @property
    def variables(self) -> tuple[sp.Symbol, ...]:
        return (s,)

    @property
    def exponents_in(self) -> sp.Expr:
        """The formula with the truncated powers of the pressure side."""
        return self.pressure

    def at(self, x: Points) -> SingularAtPoints | TravellingAtPoints:
        """The field at fixed points of Ω̄, (2, ...)."""
        return self.field.at(x)

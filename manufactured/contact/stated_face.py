"""Contact faces in 2D on which all contact data are formulas, also the pressure."""

from dataclasses import dataclass
from functools import cached_property

import sympy as sp

from manufactured.body import Part
from manufactured.jet import Jet
from manufactured.symbols import refuse_kinks, s


@dataclass(frozen=True, eq=False)
class StatedFace:
    """The contact data of a part of the contact boundary in 2D. Derived classes add the displacement.

    Attributes:
        part: the part Γ3,i.
        gap: the formula of the gap w(s, t).
        pressure: the formula of the contact pressure p(s, t). It must be the pressure that the law gives; the
            self-proof checks this.
        level: the formula of ψ(s, t); the contact zone is {ψ ≥ 0}.

    Raises:
        FormulaError: a kink of a formula is not written with ``pos``.
    """

    part: Part
    gap: sp.Expr
    pressure: sp.Expr
    level: sp.Expr

    initial_gap = sp.Integer(0)
    variables = (s,)

    def __post_init__(self) -> None:
        refuse_kinks(*(value for value in vars(self).values() if isinstance(value, sp.Expr)))

    @cached_property
    def gap_jet(self) -> Jet:
        return Jet(self.gap)

    @cached_property
    def pressure_jet(self) -> Jet:
        return Jet(self.pressure)

    @cached_property
    def level_jet(self) -> Jet:
        return Jet(self.level)

    @property
    def exponents_in(self) -> sp.Expr:
        """The contact pressure, from whose truncated powers the exponents of the strain at fronts are read off."""
        return self.pressure

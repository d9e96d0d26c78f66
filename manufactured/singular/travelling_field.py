"""A singular displacement field whose singular point moves along a straight piece of the contact boundary.

A ``SingularFace`` is a part of the contact boundary where the displacement is a singular field.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
import sympy as sp

from manufactured.arguments import checked
from manufactured.contact import StatedFace
from manufactured.jet import Jet
from manufactured.modes import Modes, at_each, pointwise
from manufactured.singular.singular_field import Component, Monomial, SingularAtPoints, SingularField
from manufactured.symbols import FormulaError, s
from manufactured.tensors import Array, Points, Tensors, Time, Vectors, size

Of = Callable[[SingularAtPoints, complex, bool], Array]
"""The type of a method of ``SingularAtPoints``, as a function of the field, the time and ``rate``."""


@dataclass(frozen=True, eq=False)
@checked(FormulaError)
class TravellingField:
    """The displacement u = θ(t) χ(y) U(x − c(t), y), whose singular point x = c(t) moves.

    Its velocity is u̇ = θ̇ χ U(x − c, y) − θ ċ χ ∂_x U(x − c, y).

    Attributes:
        steady: the field θ(t) χ(y) U(x, y), whose cut-off χ depends on y only.
        place: the formula of c(t), measured along the local x-axis from the centre of ``steady``.

    Raises:
        ValueError: the cut-off depends on x.
    """

    steady: SingularField
    place: sp.Expr

    def __post_init__(self) -> None:
        if self.steady.radial is not None:
            raise ValueError(
                "the cut-off of a travelling field must depend on the distance from the face only: give `depth`, not "
                "`radial`"
            )

    @property
    def exponent(self) -> float:
        """The exponent λ of the field, which behaves like r^λ near the singular point."""
        return self.steady.exponent

    @cached_property
    def slope(self) -> SingularField:
        """The field θ(t) χ(y) ∂_x U(x, y), which the velocity contains."""
        return replace(self.steady, x=_along(self.steady.x), y=_along(self.steady.y))

    @cached_property
    def _place(self) -> tuple[Jet, Jet]:
        jet = Jet(self.place, (s,))
        return jet, jet.rate()

    def place_at(self, time: Any, rate: bool = False) -> Any:
        """Return the position c(t) of the singular point, or its velocity if ``rate`` is true."""
        return self._place[rate](np.zeros((1, 1)), time)[(0,)][0]

    def at(self, x: Points) -> TravellingAtPoints:
        """Return the displacement field at fixed points of the body, (2, ...)."""
        return TravellingAtPoints(self, x)


def _along(component: Component) -> Component:
    """Return the terms of the derivative ∂_x of a component."""
    return tuple(Monomial(*term) for monomial in component for term in monomial.terms(1, 0))


class TravellingAtPoints:
    """A field with a moving singular point, at fixed points of the body.

    The field is evaluated in coordinates that move with the singular point, so that the fixed points move relative to
    it.
    """

    def __init__(self, field: TravellingField, x: Points) -> None:
        self.field, self.x = field, x
        self._now = lru_cache(1)(self._moved)

    def _moved(self, time: complex) -> tuple[SingularAtPoints, SingularAtPoints]:
        """Return two fields at the points x − c(t): the field with U, and the field with its derivative ∂_x U."""
        along = self.field.steady.frame[:, 0] * self.field.place_at(time)
        x = (self.x.T - along).T
        own, slope = self.field.steady.at(x), self.field.slope.at(x)
        slope.powers = own.powers  # both consist of powers of the same z, which take most of the time
        return own, slope

    def _value(self, time: Time, rate: bool, of: Of) -> Array:
        def at_one(moment: complex) -> Array:
            own, slope = self._now(moment)
            if not rate:
                return of(own, moment, False)
            return of(own, moment, True) - self.field.place_at(moment, rate=True) * of(slope, moment, False)

        return at_each(time, at_one)

    def displacement(self, time: Time, rate: bool = False) -> Vectors:
        """Return the displacement u, or the velocity u̇ if ``rate`` is true, (2, ...)."""
        return self._value(time, rate, SingularAtPoints.displacement)

    def strain(self, time: Time, rate: bool = False) -> Tensors:
        """Return the strain ε(u), or its rate if ``rate`` is true, (3, ...)."""
        return self._value(time, rate, SingularAtPoints.strain)

    def strain_gradient(self, time: Time, rate: bool = False) -> Array:
        """Return the derivatives ∂_j of the strain, or of its rate if ``rate`` is true, (3, 2, ...)."""
        return self._value(time, rate, SingularAtPoints.strain_gradient)

    def modes(self) -> Modes:
        return pointwise(self.strain, size(2), self.x[0].size)


@dataclass(frozen=True, eq=False)
@checked(FormulaError)
class SingularFace(StatedFace):
    """A part of the contact boundary where the displacement is a singular field, with the contact data of this field.

    Attributes:
        part, gap, pressure, level: see ``StatedFace``.
        field: the displacement field.
        rough: coordinates s of the singular points that do not move.

    Raises:
        FormulaError: a kink of a formula is not written with ``pos``.
    """

    field: SingularField | TravellingField
    rough: tuple[float, ...] = ()

    def at(self, x: Points) -> SingularAtPoints | TravellingAtPoints:
        """Return the displacement field at fixed points of the body, (2, ...)."""
        return self.field.at(x)

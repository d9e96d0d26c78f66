"""Singular displacement fields at a corner, a junction of boundary conditions, or a natural contact front.

Every singular field of plane elasticity at such a point is a sum of terms y^m Re(c z^β) with m ∈ {0, 1}, where
z = x + iy in axes at the point. With Kolosov's potentials Φ = a z^λ and Ψ = b z^λ the displacement is given by

    2μ (u_x + i u_y) = κ Φ − z conj(Φ') − conj(Ψ),      z conj(z^{λ−1}) = conj(z^λ) + 2iy conj(z^{λ−1}),

where κ = (λ_L + 3μ)/(λ_L + μ) with the Lamé constants λ_L, μ in the plane.

Sources: M. L. Williams, Stress singularities resulting from various boundary conditions in angular corners of plates in
extension, J. Appl. Mech. 19 (1952) 526–528; N. I. Muskhelishvili, Some Basic Problems of the Mathematical Theory of
Elasticity, Noordhoff 1953, for the potentials.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import product
from typing import Any

import numpy as np
import sympy as sp

from manufactured.arguments import Degree, Size, checked
from manufactured.compiled import Jet
from manufactured.contact import StatedFace
from manufactured.modes import Modes, at_each, pointwise
from manufactured.profile import Piecewise
from manufactured.symbols import FormulaError, s
from manufactured.tensors import Array, Points, Tensors, Time, Vectors, mandel, mapped, rotation, size

# A singular displacement field that is multiplied by a cut-off function, and its values at fixed points.
#
# The field consists of terms y^m Re(c z^β) with z = x + iy.


@dataclass(frozen=True)
@checked(FormulaError)
class Monomial:
    """The function y^m Re(c z^β) of the complex coordinate z = x + iy, where m is 0 or 1."""

    m: Degree
    c: complex
    beta: float

    def terms(self, dx: int, dy: int) -> list[tuple[int, complex, float]]:
        """Return the derivative ∂_x^dx ∂_y^dy as a list of terms y^m Re(c z^β), each given by (m, c, β)."""
        found = [(self.m, self.c, self.beta)]
        for step in [1.0] * dx + [1j] * dy:
            slopes = [(m, c * beta * step, beta - 1) for m, c, beta in found]
            # By the product rule ∂_y (y g) = y ∂_y g + g, a term with m = 1 gives a further term with m = 0.
            drops = [(0, c, beta) for m, c, beta in found if m == 1 and step == 1j]
            found = slopes + drops
        return found


Component = tuple[Monomial, ...]
"""The type of a component of a displacement, as the terms whose sum it is."""


@checked(FormulaError)
def kolosov(kappa: Size, a: complex, b: complex, exponent: float) -> tuple[Component, Component]:
    """Return the displacement 2μ (u_x, u_y) of plane elasticity with the potentials Φ = a z^λ and Ψ = b z^λ.

    It is given by 2μ (u_x + i u_y) = κΦ − z conj(Φ') − conj(Ψ).

    Args:
        kappa: Kolosov's constant κ.
        a, b: the complex factors of the potentials.
        exponent: the exponent λ.

    Returns:
        The terms y^m Re(c z^β) whose sum is 2μ u_x, and the terms of 2μ u_y; μ is the shear modulus.
    """
    # The sum is κ a z^λ − conj((λ a + b) z^λ) − 2iyλ conj(a z^{λ−1}). It is written as terms Re(c z^β) with Im g =
    # Re(−i g) and conj(g) = Re g − i Im g.
    lam = exponent
    u_x = (Monomial(0, kappa * a - lam * a - b, lam), Monomial(1, 2j * lam * a, lam - 1))
    u_y = (Monomial(0, -1j * (kappa * a) - 1j * (lam * a + b), lam), Monomial(1, -2 * lam * a + 0j, lam - 1))
    return u_x, u_y


class Powers:
    """Evaluates functions Re(c (x + iy)^β) at fixed points (x, y); a call with c and β returns the values, (...).

    At the origin the values are 0.

    In polar coordinates r, θ the formula is r^β (c_r cos βθ − c_i sin βθ) for c = c_r + i c_i. It is analytic in x and
    y, as derivatives by the complex step need. r^β, cos βθ and sin βθ are computed once for each β.
    """

    def __init__(self, x: Array, y: Array) -> None:
        r2 = x * x + y * y
        self._there = np.real(r2) > 0
        self._r = np.sqrt(np.where(self._there, r2, 1.0))
        right = np.real(x) >= 0
        # The angle θ is 2 arctan(y/(r + x)) for x ≥ 0 and ±π − 2 arctan(y/(r − x)) for x < 0. Both formulas avoid
        # cancellation, and θ = π on the negative x-axis.
        half = np.arctan(y / np.where(right, self._r + x, self._r - x))
        self._theta = np.where(right, 2 * half, np.where(np.real(y) >= 0, np.pi, -np.pi) - 2 * half)
        self._known: dict[float, tuple[Array, Array, Array]] = {}

    def __call__(self, c: complex, beta: float) -> Array:
        if beta not in self._known:
            self._known[beta] = self._r**beta, np.cos(beta * self._theta), np.sin(beta * self._theta)
        size, cosine, sine = self._known[beta]
        return np.where(self._there, size * (c.real * cosine - c.imag * sine), 0.0)


@dataclass(frozen=True, eq=False)
@checked(FormulaError)
class SingularField:
    """The displacement u = θ(t) χ U(x, y) near a point, where U is singular and χ is a cut-off function.

    Attributes:
        centre: the point, (2,).
        frame: the axes of the local coordinates x, y around the point, as columns, (2, 2). The power z^β is
            discontinuous on the negative x-axis, which must lie outside the body or on its boundary.
        x, y: the terms y^m Re(c z^β), z = x + iy, of which the components U_x and U_y consist.
        theta: the formula of the factor θ(t), with the symbol t.
        radial: χ as a function of the distance r from the point, a piecewise polynomial.
        depth: χ as a function of the local coordinate y, a piecewise polynomial. If it is given, ``radial`` is not
            used. If neither is given, χ = 1.
    """

    centre: tuple[float, float]
    frame: Array
    x: Component
    y: Component
    theta: sp.Expr
    radial: Piecewise | None = None
    depth: Piecewise | None = None

    def __post_init__(self) -> None:
        if self.frame.shape != (2, 2) or not np.allclose(self.frame.T @ self.frame, np.eye(2)):
            raise FormulaError(f"frame has to have two orthogonal unit vectors as columns, got {self.frame.tolist()}")

    @property
    def exponent(self) -> float:
        """The exponent λ of the field, which behaves like r^λ near the point; infinity for the field 0."""
        return min((term.m + term.beta for term in (*self.x, *self.y) if term.c != 0), default=math.inf)

    @cached_property
    def amplitude(self) -> tuple[Jet, Jet]:
        """The factor θ(t) of the displacement and its time derivative, as formulas that can be evaluated."""
        jet = Jet(self.theta, (s,))
        return jet, jet.rate()

    def at_time(self, time: Time, rate: bool) -> Array:
        """Return the factor θ(t) of the displacement, or its time derivative if ``rate`` is true."""
        return self.amplitude[rate](np.zeros(1), time)[0,]

    def at(self, x: Points) -> SingularAtPoints:
        """Return the displacement field at fixed points, (2, ...)."""
        return SingularAtPoints(self, x)


class SingularAtPoints:
    """A singular displacement field at fixed points, which is a function of time θ(t) times a constant field.

    The displacement, strain and strain gradient without the factor θ are computed once.
    """

    def __init__(self, field: SingularField, x: Points) -> None:
        self.field = field
        self.local = mapped(field.frame.T, (x.T - field.centre).T)

    def displacement(self, time: Time, rate: bool = False) -> Vectors:
        """Return the displacement u, or the velocity u̇ if ``rate`` is true, (2, ...)."""
        return np.multiply.outer(self._displacement, self.field.at_time(time, rate))

    def strain(self, time: Time, rate: bool = False) -> Tensors:
        """Return the strain ε(u), or its rate if ``rate`` is true, (3, ...)."""
        return np.multiply.outer(self._strain, self.field.at_time(time, rate))

    def strain_gradient(self, time: Time, rate: bool = False) -> Array:
        """Return the derivatives ∂_j of the strain, or of its rate if ``rate`` is true, (3, 2, ...)."""
        return np.multiply.outer(self._strain_gradient, self.field.at_time(time, rate))

    def modes(self) -> Modes:
        """Return the strain ε(u) as a sum of products, one for each component of the strain.

        All products have the same function of time θ(t), by which the displacement is multiplied.
        """
        shapes = self._strain.reshape(len(self._strain), -1)
        field, count = self.field, len(shapes)

        def amplitudes(time: Time, rate: bool) -> Array:
            return np.broadcast_to(field.at_time(time, rate), (count, 1, *np.shape(time)))

        points = np.flatnonzero(shapes.any(axis=0))
        places = np.zeros(len(points), dtype=int)
        return Modes(np.eye(len(shapes)), points, shapes[:, points], places, 1, amplitudes)

    @cached_property
    def powers(self) -> Powers:
        """Evaluates powers of the complex local coordinate z = x + iy of the points."""
        return Powers(*self.local)

    @cached_property
    def _displacement(self) -> Array:
        return mapped(self.field.frame, self._derivative(0, 0))

    @cached_property
    def _strain(self) -> Array:
        gradient = np.stack([self._derivative(1, 0), self._derivative(0, 1)], axis=1)
        return mapped(rotation(self.field.frame), mandel(gradient))

    @cached_property
    def _strain_gradient(self) -> Array:
        xx, xy, yy = (self._derivative(*orders) for orders in ((2, 0), (1, 1), (0, 2)))
        local = np.array([mandel(np.stack(row, axis=1)) for row in ((xx, xy), (xy, yy))])
        frame = self.field.frame
        return np.einsum("ji,IJ,iJ...->Ij...", frame, rotation(frame), local)

    def _derivative(self, dx: int, dy: int) -> Array:
        """Return the derivative ∂_x^dx ∂_y^dy of the field χ U without its factor θ(t), in local axes, (2, ...)."""
        total = np.zeros(self.local.shape, dtype=self.local.dtype)
        for i, j in product(range(dx + 1), range(dy + 1)):
            chi = self._cutoff(i, j)
            if chi is not None:
                total = total + math.comb(dx, i) * math.comb(dy, j) * chi * self._singular(dx - i, dy - j)
        return total

    def _singular(self, dx: int, dy: int) -> Array:
        """Return the derivative ∂_x^dx ∂_y^dy of U, the field without cut-off, in local axes, (2, ...)."""
        y = self.local[1]
        return np.array(
            [
                sum(
                    y * self.powers(c, beta) if m else self.powers(c, beta)
                    for monomial in component
                    for m, c, beta in monomial.terms(dx, dy)
                    if c != 0
                )
                for component in (self.field.x, self.field.y)
            ]
        )

    def _cutoff(self, dx: int, dy: int) -> Array | float | None:
        """Return the derivative ∂_x^dx ∂_y^dy of the cut-off function χ; None if it is zero everywhere."""
        x, y = self.local
        if self.field.depth is not None:
            return None if dx else self.field.depth(y, dy)
        if self.field.radial is None:
            return None if dx or dy else 1.0
        r = np.sqrt(x * x + y * y)
        safe = np.where(r.real > 0, r, 1.0)
        # The gradient of r is the unit vector n = (x, y)/r, and ∂_i n_j = (δ_ij − n_i n_j)/r.
        slopes = math.prod([x / safe] * dx + [y / safe] * dy)
        chi = self.field.radial(r, dx + dy) * slopes
        return chi if dx + dy < 2 else chi + self.field.radial(r, 1) / safe * (float(dx != 1) - slopes)


# A singular displacement field whose singular point moves along a straight piece of the contact boundary.
#
# A ``SingularFace`` is a part of the contact boundary where the displacement is a singular field.

Of = Callable[[SingularAtPoints, complex, bool], Array]
"""The type of a method of ``SingularAtPoints``: a function of the field, the time, and whether the rate is wanted."""


@dataclass(frozen=True, eq=False)
@checked(FormulaError)
class TravellingField:
    """The displacement u = θ(t) χ(y) U(x − c(t), y), whose singular point x = c(t) moves.

    θ is a factor, χ a cut-off function, and U a singular displacement field in local coordinates. The velocity is u̇ =
    θ̇ χ U(x − c, y) − θ ċ χ ∂_x U(x − c, y).

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
        """The field θ(t) χ(y) ∂_x U(x, y), which the velocity of the travelling field θ χ U(x − c(t), y) contains."""
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

"""Singular fields at a point of the boundary: corners, junctions of conditions, and the natural contact front.

With z = x + iy in axes at the point, a term is y^m Re(c z^β), m ∈ {0, 1}; every eigenfunction of plane
elasticity at a corner is a sum of such terms. In Kolosov's form, with Φ = a z^λ and Ψ = b z^λ,

    2μ (u_x + i u_y) = κ Φ − z conj(Φ') − conj(Ψ),      z conj(z^{λ−1}) = conj(z^λ) + 2iy conj(z^{λ−1}),

κ = (λ_L + 3μ)/(λ_L + μ) with Lamé's constants λ_L, μ in the plane.

Sources: M. L. Williams, Stress singularities resulting from various boundary conditions in angular
corners of plates in extension, J. Appl. Mech. 19 (1952) 526–528; N. I. Muskhelishvili, Some Basic
Problems of the Mathematical Theory of Elasticity, Noordhoff 1953, for the potentials.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp

from manufactured.body import Part
from manufactured.modes import Modes
from manufactured.profile import Piecewise
from manufactured.symbols import Jet, s
from manufactured.tensors import Array, Points, Tensors, Vectors, mandel, rotation


@dataclass(frozen=True)
class Monomial:
    """y^m Re(c z^β) with its derivatives; m is 0 or 1."""

    m: int
    c: complex
    beta: float

    def terms(self, dx: int, dy: int) -> list[tuple[int, complex, float]]:
        """(m, c, β) of the terms of ∂_x^dx ∂_y^dy."""
        found = [(self.m, self.c, self.beta)]
        for step in [1.0] * dx + [1j] * dy:
            slopes = [(m, c * beta * step, beta - 1) for m, c, beta in found]
            # ∂_y (y g) = y ∂_y g + g.
            drops = [(0, c, beta) for m, c, beta in found if m == 1 and step == 1j]
            found = slopes + drops
        return found


@dataclass(frozen=True, eq=False)
class SingularField:
    """u = θ(t) χ(·) U(x, y), U_i a sum of monomials, in axes at a point, with a cut-off χ.

    Attributes:
        centre: the point, (2,).
        frame: columns are the local axes, (2, 2); the cut of z^β, the negative x-axis, must lie
            outside the body or on its boundary.
        x, y: the monomials of U_x and U_y.
        theta: θ(t), SymPy.
        radial: χ of the distance r to the point; or
        depth: χ of the local y; without either χ = 1.
    """

    centre: tuple[float, float]
    frame: Array
    x: tuple[Monomial, ...]
    y: tuple[Monomial, ...]
    theta: sp.Expr
    radial: Piecewise | None = None
    depth: Piecewise | None = None

    @cached_property
    def amplitude(self) -> tuple[Jet, Jet]:
        """The jets of θ and its rate."""
        jet = Jet(sp.sympify(self.theta), (s,))
        return jet, jet.rate()

    def at_time(self, time: complex, rate: bool) -> Array:
        """θ(t) or its rate."""
        return self.amplitude[rate](np.zeros((1, 1)), time)[0,][0]

    def at(self, x: Points) -> SingularAtPoints:
        """The field at fixed points, (2, ...)."""
        return SingularAtPoints(self, x)


class SingularAtPoints:
    """θ(t) times fields that time does not change; derivatives of U at most of order two."""

    def __init__(self, field: SingularField, x: Points) -> None:
        self.field = field
        offset = x - np.array(field.centre).reshape((-1,) + (1,) * (x.ndim - 1))
        self.local = np.tensordot(field.frame.T, offset, axes=1)

    def displacement(self, time: complex, rate: bool = False) -> Vectors:
        """u (or u̇), (2, ...)."""
        return self.field.at_time(time, rate) * self._displacement

    def strain(self, time: complex, rate: bool = False) -> Tensors:
        """ε(u) (or ε(u̇)), (3, ...)."""
        return self.field.at_time(time, rate) * self._strain

    def strain_gradient(self, time: complex, rate: bool = False) -> Array:
        """∂_j ε(u) (or of u̇), (3, 2, ...)."""
        return self.field.at_time(time, rate) * self._strain_gradient

    def modes(self) -> Modes:
        """ε(u) as θ(t) times one field for each component."""
        shapes = self._strain.reshape(len(self._strain), -1)
        field, count = self.field, len(shapes)

        def amplitudes(time: float, rate: bool) -> Array:
            return np.full((count, 1), field.at_time(time, rate))

        points = np.flatnonzero(shapes.any(axis=0))
        places = np.zeros(len(points), dtype=int)
        return Modes(np.eye(len(shapes)), points, shapes[:, points], places, 1, amplitudes)

    @cached_property
    def _displacement(self) -> Array:
        return np.tensordot(self.field.frame, self._derivative(0, 0), axes=1)

    @cached_property
    def _strain(self) -> Array:
        gradient = np.stack([self._derivative(1, 0), self._derivative(0, 1)], axis=1)
        return np.tensordot(rotation(self.field.frame), mandel(gradient), axes=1)

    @cached_property
    def _strain_gradient(self) -> Array:
        second = [[self._derivative(2, 0), self._derivative(1, 1)], [self._derivative(1, 1), self._derivative(0, 2)]]
        local = np.stack([mandel(np.stack(row, axis=1)) for row in second])
        turned = np.tensordot(
            self.field.frame, np.tensordot(rotation(self.field.frame), local, axes=([1], [1])), ((1,), (1,))
        )
        return np.moveaxis(turned, 0, 1)

    def _derivative(self, dx: int, dy: int) -> Array:
        """∂_x^dx ∂_y^dy of χ U, by Leibniz' rule, (2, ...)."""
        total = np.zeros(self.local.shape, dtype=self.local.dtype)
        for i in range(dx + 1):
            for j in range(dy + 1):
                chi = self._cutoff(i, j)
                if chi is not None:
                    ways = _binomial(dx, i) * _binomial(dy, j)
                    total = total + ways * chi * self._singular(dx - i, dy - j)
        return total

    def _singular(self, dx: int, dy: int) -> Array:
        """∂_x^dx ∂_y^dy of U, (2, ...)."""
        x, y = self.local
        return np.array(
            [
                sum(
                    y**m * _real_power(x, y, c, beta)
                    for monomial in component
                    for m, c, beta in monomial.terms(dx, dy)
                    if c != 0
                )
                for component in (self.field.x, self.field.y)
            ]
        )

    def _cutoff(self, dx: int, dy: int) -> Array | float | None:
        """∂_x^dx ∂_y^dy of χ, None where it vanishes identically."""
        x, y = self.local
        if self.field.depth is not None:
            return None if dx else self.field.depth(y, dy)
        if self.field.radial is None:
            return None if dx or dy else 1.0
        r = np.sqrt(x * x + y * y)
        safe = np.where(r.real > 0, r, 1.0)
        chi = [self.field.radial(r, k) for k in range(dx + dy + 1)]
        if dx + dy == 0:
            return chi[0]
        ux, uy = x / safe, y / safe
        if dx + dy == 1:
            return chi[1] * (ux if dx else uy)
        first, second = (ux if dx else uy), (uy if dy else ux)
        same = 1.0 if dx != 1 else 0.0
        return chi[2] * first * second + chi[1] / safe * (same - first * second)


def _binomial(n: int, k: int) -> int:
    return 1 if k in (0, n) else n


def _real_power(x: Array, y: Array, c: complex, beta: float) -> Array:
    """Re(c (x + iy)^β) by r^β (c_r cos βθ − c_i sin βθ), analytic in x and y for the complex step; 0 at r = 0."""
    r2 = x * x + y * y
    there = np.real(r2) > 0
    r = np.sqrt(np.where(there, r2, 1.0))
    right = np.real(x) >= 0
    # θ = 2 arctan(y/(r + x)), or ±π − 2 arctan(y/(r − x)) where x < 0: no cancellation, θ = π on the cut.
    half = np.arctan(y / np.where(right, r + x, r - x))
    theta = np.where(right, 2 * half, np.where(np.real(y) >= 0, np.pi, -np.pi) - 2 * half)
    value = r**beta * (c.real * np.cos(beta * theta) - c.imag * np.sin(beta * theta))
    return np.where(there, value, 0.0)


def kolosov(kappa: float, a: complex, b: complex, exponent: float) -> tuple[tuple[Monomial, ...], tuple[Monomial, ...]]:
    """The monomials of u_x and u_y of 2μ(u_x + iu_y) = κΦ − z conj(Φ') − conj(Ψ), Φ = a z^λ, Ψ = b z^λ."""
    # κ a z^λ − conj((λ a + b) z^λ) − 2iyλ conj(a z^{λ−1}), with Im g = Re(−i g) and conj(g) = Re g − i Im g.
    lam = exponent
    u_x = (Monomial(0, kappa * a - lam * a - b, lam), Monomial(1, 2j * lam * a, lam - 1))
    u_y = (Monomial(0, -1j * (kappa * a) - 1j * (lam * a + b), lam), Monomial(1, -2 * lam * a + 0j, lam - 1))
    return u_x, u_y


def least_exponent(fields: Iterable[SingularField]) -> float:
    """The least regular power of the distance in some fields, min(m + β); infinite without any."""
    return min((m.m + m.beta for field in fields for m in (*field.x, *field.y) if m.c != 0), default=math.inf)


@dataclass(frozen=True, eq=False)
class SingularFace:
    """A piece of Γ3 on which a singular field makes contact: gap, pressure and zone are stated beside the field.

    Attributes:
        part: the piece Γ3,i.
        gap: w(s, t).
        pressure: p(s, t), what the law makes of the field; the self-proof compares.
        level: ψ(s, t).
        field: the displacement.
        rough: coordinates s of the singular points.
    """

    part: Part
    gap: sp.Expr
    pressure: sp.Expr
    level: sp.Expr
    field: SingularField
    rough: tuple[float, ...] = ()

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

    def at(self, x: Points) -> SingularAtPoints:
        """The field at fixed points of Ω̄, (2, ...)."""
        return self.field.at(x)

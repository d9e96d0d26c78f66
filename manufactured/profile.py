"""Functions of the depth y that continue contact data from a face into the body (``manufactured.contact``)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.polynomial.polynomial import polyadd, polyder, polymul

from manufactured.tensors import Array

HERMITE = (1.0, 0.0, -3.0, 2.0)
"""φ(η) = (1 − η)²(1 + 2η), with φ(1) = φ'(1) = 0: the displacement may end inside the body; no traction on Γ1."""

QUARTIC = (1.0, 0.0, -6.0, 8.0, -3.0)
"""φ(η) = (1 − η)³(1 + 3η), with φ(1) = φ'(1) = φ''(1) = 0: strains have no kink where the displacement ends."""

PARABOLA = (1.0, 0.0, -1.0)
"""φ(η) = 1 − η², with φ(1) = 0 only: Γ1 must be at the depth where the displacement ends; its traction is not zero."""


class ProfileError(ValueError):
    """Raised if a profile violates a condition at y = 0, so that it would change the contact data."""


@lru_cache
def _derived(pieces: tuple[tuple[float, ...], ...], derivative: int) -> list[tuple[float, ...]]:
    """Return the coefficients of a derivative of the given polynomials."""
    return [tuple(map(float, polyder(piece, derivative))) for piece in pieces]


def _polynomial(coefficients: tuple[float, ...], y: Array) -> Array:
    """Evaluate a polynomial by Horner's rule without new arrays, which would take most of the time in ``polyval``."""
    value = np.full(np.shape(y), coefficients[-1], dtype=np.result_type(y, float))
    for coefficient in reversed(coefficients[:-1]):
        value *= y
        value += coefficient
    return value


@dataclass(frozen=True)
class Piecewise:
    """A continuous piecewise polynomial of y, zero beyond its last piece.

    Attributes:
        ends: the ends of the pieces, increasing; the first piece starts at 0 and is also used for y < 0.
        pieces: the coefficients of each piece in powers of y, lowest first.
    """

    ends: tuple[float, ...]
    pieces: tuple[tuple[float, ...], ...]

    def __call__(self, y: Array, derivative: int = 0) -> Array:
        """Return a derivative of the function at depths y, (...) → (...)."""
        total = np.zeros(np.shape(y), dtype=np.result_type(y, float))
        place, start = np.real(y), -np.inf
        for end, piece in zip(self.ends, _derived(self.pieces, derivative), strict=True):
            if any(piece):
                np.copyto(total, _polynomial(piece, y), where=(place >= start) & (place < end))
            start = end
        return total

    def jump(self, place: float, derivative: int) -> float:
        """Return the jump of a derivative at the depth ``place``."""
        sides = (place * (1 + side * 1e-12) for side in (-1, 1))
        below, above = (float(self(np.array(side), derivative)) for side in sides)
        return above - below


@dataclass(frozen=True)
class Profile:
    """The functions a, …, e of the depth y in the displacement of a contact face,

        u_s = ∇_s w·a(y) + ∇_s q·e(y) + r·c(y),      u_n = w·b(y) + q·d(y).

    At y = 0 they must satisfy a = c = d = e = 0, b = 1, a' = −1, c' = d' = 1 and b' = e' = 0. Then u_n = w, u_s = 0,
    ε_nn = q, 2ε_sn = r and ε_ss = 0 on the face.

    Attributes:
        a, b, c, d, e: the functions.
        kinks: the depths at which first derivatives jump, because layers of the body meet there.

    Raises:
        ProfileError: one of the conditions at y = 0 is violated.
    """

    a: Piecewise
    b: Piecewise
    c: Piecewise
    d: Piecewise
    e: Piecewise
    kinks: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        expected = {"a": (0, -1), "b": (1, 0), "c": (0, 1), "d": (0, 1), "e": (0, 0)}
        for name, values in expected.items():
            function = getattr(self, name)
            found = [float(function(np.array(0.0), k)) for k in range(2)]
            if not np.allclose(found, values, atol=1e-12):
                raise ProfileError(f"{name}(0), {name}'(0) must be {values} to carry Cauchy data, got {tuple(found)}")

    @property
    def depth(self) -> float:
        """The depth beyond which all functions are zero."""
        return max(function.ends[-1] for function in (self.a, self.b, self.c, self.d))

    @property
    def ends_with_kink(self) -> bool:
        """Whether a first derivative is not zero at ``depth``. Then the body must end at this depth."""
        return any(abs(f.jump(f.ends[-1], 1)) > 1e-9 for f in (self.a, self.b, self.c, self.d, self.e))


ZERO = Piecewise((1.0,), ((0.0,),))


def cutoff(depth: float = 1.0, phi: tuple[float, ...] = HERMITE) -> Profile:
    """Return the profile b = φ(y/ℓ), c = d = y φ(y/ℓ), a = −y φ(y/ℓ), e = 0.

    Args:
        depth: ℓ, the depth beyond which the displacement is zero.
        phi: the coefficients of a polynomial φ with φ(0) = 1, φ'(0) = 0, φ(1) = 0, lowest power first.
    """
    b = tuple(coefficient / depth**k for k, coefficient in enumerate(phi))
    d = (0.0, *b)
    ends = (depth,)
    return Profile(
        Piecewise(ends, (tuple(-x for x in d),)),
        Piecewise(ends, (b,)),
        Piecewise(ends, (d,)),
        Piecewise(ends, (d,)),
        ZERO,
    )


def slab(depth: float = 1.0, phi: tuple[float, ...] = HERMITE) -> Profile:
    """Return ``cutoff`` with b = 1 − y/ℓ + (y/ℓ) φ(y/ℓ): for q = −w/ℓ, a constant gap gives a uniform strain."""
    plain = cutoff(depth, phi)
    b = polyadd((1.0, -1 / depth), np.array(plain.d.pieces[0]) / depth)
    return replace(plain, b=Piecewise((depth,), (tuple(float(x) for x in b),)))


def layered(interface: float, ratio: float, depth: float = 1.0) -> Profile:
    """Two layers, the upper one ``ratio`` = κ times as stiff and viscous as the one at the face; Γ1 at y = ℓ.

    On the interface y = y_0 the tangential displacement vanishes, so ε = sym(β ⊗ n) there. If also ε⁺ = ε⁻/κ, where κ
    is the ratio of the layers, then the traction is continuous for any A and G and at all times. This requires

        ∂_y u_n⁺ = ∂_y u_n⁻/κ,      ∂_y u_s⁺ + ∇_s u_n = (∂_y u_s⁻ + ∇_s u_n)/κ.

    b and d are quadratic in the lower layer, b = 1 + γ y² and d = y + δ y², and linear in the upper one, with γ
    and δ such that they end with 0 at y = ℓ; c = −a = y(1 − y/y_0) and e = 0 in the lower layer, cubics
    with the slopes that follow in the upper one.
    """
    y0, rest = interface, depth - interface
    gamma = -ratio / (2 * y0 * rest + ratio * y0**2)
    delta = -(rest + ratio * y0) / (2 * y0 * rest + ratio * y0**2)
    b, d = 1 + gamma * y0**2, y0 + delta * y0**2
    a_slope, c_slope = 1.0, -1.0
    softer = 1 / ratio - 1

    def bulge(slope: float) -> tuple[float, ...]:
        """Return the coefficients of slope · (y − y_0)(ℓ − y)²/(ℓ − y_0)²."""
        return tuple(float(x) * slope / rest**2 for x in polymul((-y0, 1.0), polymul((depth, -1.0), (depth, -1.0))))

    def line(value: float) -> tuple[float, ...]:
        return (value * depth / rest, -value / rest)

    ends = (y0, depth)
    return Profile(
        a=Piecewise(ends, ((0.0, -1.0, 1 / y0), bulge(a_slope / ratio + softer * b))),
        b=Piecewise(ends, ((1.0, 0.0, gamma), line(b))),
        c=Piecewise(ends, ((0.0, 1.0, -1 / y0), bulge(c_slope / ratio))),
        d=Piecewise(ends, ((0.0, 1.0, delta), line(d))),
        e=Piecewise(ends, ((0.0,), bulge(softer * d))),
        kinks=(y0,),
    )

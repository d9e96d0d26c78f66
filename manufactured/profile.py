"""How Cauchy data on a contact face fade into the depth of the body: piecewise polynomials of y."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.polynomial.polynomial import polyadd, polyder, polymul, polyval

from manufactured.tensors import Array

HERMITE = (1.0, 0.0, -3.0, 2.0)
"""φ(η) = (1 − η)²(1 + 2η): φ(1) = φ'(1) = 0, so the lifting may end inside the body; no traction on Γ1."""

PARABOLA = (1.0, 0.0, -1.0)
"""φ(η) = 1 − η²: φ(1) = 0 only, for a Γ1 exactly at depth ℓ, which then carries a traction."""


class ProfileError(ValueError):
    """A profile does not carry Cauchy data into the body."""


@dataclass(frozen=True)
class Piecewise:
    """A continuous piecewise polynomial of y, zero beyond its last piece.

    Attributes:
        ends: where the pieces end, increasing; the first starts at 0 (and serves y < 0, too).
        pieces: their coefficients in powers of y, lowest first.
    """

    ends: tuple[float, ...]
    pieces: tuple[tuple[float, ...], ...]

    def __call__(self, y: Array, derivative: int = 0) -> Array:
        """The derivative of the given order at y, (...)."""
        total = np.zeros(np.shape(y), dtype=np.result_type(y, float))
        start = -np.inf
        for end, piece in zip(self.ends, self.pieces, strict=True):
            inside = (np.real(y) >= start) & (np.real(y) < end)
            total = np.where(inside, polyval(y, polyder(piece, derivative)), total)
            start = end
        return total

    def jump(self, place: float, derivative: int) -> float:
        """How much the derivative changes at a place."""
        sides = (place * (1 + side * 1e-12) for side in (-1, 1))
        below, above = (float(self(np.array(side), derivative)) for side in sides)
        return above - below


@dataclass(frozen=True)
class Profile:
    """The functions of y in

        u_s = ∇_s w·a(y) + ∇_s q·e(y) + r·c(y),      u_n = w·b(y) + q·d(y).

    They carry the data of a contact face if, at y = 0, a = c = d = e = 0, b = 1, a' = −1, c' = d' = 1
    and b' = e' = 0: then u_n = w, u_s = 0, ε_nn = q, 2ε_sn = r and ε_ss = 0 there.

    Attributes:
        a, b, c, d, e: the functions.
        kinks: depths at which first derivatives jump, where layers of the body meet.

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
        """Where everything ends."""
        return max(function.ends[-1] for function in (self.a, self.b, self.c, self.d))

    @property
    def ends_with_kink(self) -> bool:
        """Whether a first derivative is not zero at the end: the body must then end there, too."""
        return any(abs(f.jump(f.ends[-1], 1)) > 1e-9 for f in (self.a, self.b, self.c, self.d, self.e))


ZERO = Piecewise((1.0,), ((0.0,),))


def cutoff(depth: float = 1.0, phi: tuple[float, ...] = HERMITE) -> Profile:
    """b = φ(y/ℓ), c = d = y φ(y/ℓ), a = −y φ(y/ℓ), for φ(0) = 1, φ'(0) = 0, φ(1) = 0; coefficients lowest first."""
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
    """As ``cutoff`` but b = 1 − y/ℓ + (y/ℓ) φ(y/ℓ): with q = −w/ℓ the gap alone strains the whole depth evenly."""
    plain = cutoff(depth, phi)
    b = polyadd((1.0, -1 / depth), np.array(plain.d.pieces[0]) / depth)
    return replace(plain, b=Piecewise((depth,), (tuple(float(x) for x in b),)))


def layered(interface: float, ratio: float, depth: float = 1.0) -> Profile:
    """Two layers, the upper one ``ratio`` = κ times as stiff and viscous as the one at the face.

    On the interface y = y_0 the tangential displacement vanishes, so ε = sym(β ⊗ n) there, and with
    ε⁺ = ε⁻/κ the traction is continuous for any A and G, and at all times:

        ∂_y u_n⁺ = ∂_y u_n⁻/κ,      ∂_y u_s⁺ + ∇_s u_n = (∂_y u_s⁻ + ∇_s u_n)/κ.

    Lower layer: a = −y(1 − y/y_0), b = 1 − y²/(2ℓ²), c = −a, d = y(1 − y/(2ℓ)), e = 0; upper layer: cubics with
    these values and slopes at y_0 that end with value and slope 0 at y = ℓ.
    """
    y0 = interface
    a, c = (0.0, -1.0, 1 / y0), (0.0, 1.0, -1 / y0)
    b, d = (1.0, 0.0, -0.5 / depth**2), (0.0, 1.0, -0.5 / depth)

    def value(f: tuple[float, ...]) -> float:
        return float(polyval(y0, f))

    def slope(f: tuple[float, ...]) -> float:
        return float(polyval(y0, polyder(f)))

    def upper(start: float, rise: float) -> tuple[float, ...]:
        return _hermite(y0, depth, start, rise)

    ends = (y0, depth)
    softer = 1 / ratio - 1
    return Profile(
        a=Piecewise(ends, (a, upper(0.0, slope(a) / ratio + softer * value(b)))),
        b=Piecewise(ends, (b, upper(value(b), slope(b) / ratio))),
        c=Piecewise(ends, (c, upper(0.0, slope(c) / ratio))),
        d=Piecewise(ends, (d, upper(value(d), slope(d) / ratio))),
        e=Piecewise(ends, ((0.0,), upper(0.0, softer * value(d)))),
        kinks=(y0,),
    )


def _hermite(left: float, right: float, value: float, slope: float) -> tuple[float, ...]:
    """The cubic with a value and a slope at ``left`` and zeros of order two at ``right``."""
    # (right − y)² (α + β (y − left)), in powers of y.
    length = right - left
    alpha = value / length**2
    beta = slope / length**2 + 2 * value / length**3
    square = polymul((right, -1.0), (right, -1.0))
    return tuple(float(x) for x in polymul(square, (alpha - beta * left, beta)))

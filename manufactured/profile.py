"""Functions of the depth y that continue contact data from a face into the body (``manufactured.contact``)."""

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.polynomial.polynomial import polyadd, polyder, polymul

from manufactured.arguments import Size, checked
from manufactured.tensors import Array

HERMITE = (1.0, 0.0, -3.0, 2.0)
"""The polynomial φ(η) = (1 − η)²(1 + 2η) with φ(1) = φ'(1) = 0.

It is a cut-off function of the relative depth η. The displacement may end inside the body, and there is no traction on
the clamped boundary.
"""

QUARTIC = (1.0, 0.0, -6.0, 8.0, -3.0)
"""The polynomial φ(η) = (1 − η)³(1 + 3η) with φ(1) = φ'(1) = φ''(1) = 0.

It is a cut-off function of the relative depth η. Strains have no kink where the displacement ends.
"""

PARABOLA = (1.0, 0.0, -1.0)
"""The polynomial φ(η) = 1 − η² with φ(1) = 0 only.

It is a cut-off function of the relative depth η. The clamped boundary must be where the displacement ends, and its
traction is not zero.
"""


class ProfileError(ValueError):
    """Raised if the functions of the depth in a profile violate a condition at the face, y = 0.

    They would change the contact data there.
    """


def _require_increasing(*depths: float) -> None:
    """Raise ProfileError unless depths are positive and increase."""
    if not all(np.diff(depths, prepend=0.0) > 0):
        raise ProfileError(f"depths have to be positive and to increase, got {', '.join(map(str, depths))}")


@lru_cache
def _derived(pieces: tuple[tuple[float, ...], ...], derivative: int) -> list[tuple[float, ...]]:
    """Return the coefficients of a derivative of each of the given polynomials."""
    return [tuple(map(float, polyder(piece, derivative))) for piece in pieces]


def _polynomial(coefficients: tuple[float, ...], y: Array) -> Array:
    """Evaluate a polynomial by Horner's rule in one array; ``polyval`` would spend most of its time on new arrays."""
    value = np.full(np.shape(y), coefficients[-1], dtype=np.result_type(y, float))
    for coefficient in reversed(coefficients[:-1]):
        value *= y
        value += coefficient
    return value


@dataclass(frozen=True)
@checked(ProfileError)
class Piecewise:
    """A continuous piecewise polynomial of the depth y below a contact face, zero beyond its last piece.

    Attributes:
        ends: the depths at which the polynomial pieces end, increasing. The first piece starts at 0 and is also used
            for y < 0.
        pieces: the coefficients of each piece in powers of y, lowest first.
    """

    ends: tuple[Size, ...]
    pieces: tuple[tuple[float, ...], ...]

    def __post_init__(self) -> None:
        _require_increasing(*self.ends)
        if len(self.ends) != len(self.pieces):
            raise ProfileError(f"each piece needs an end, got {len(self.pieces)} pieces and the ends {self.ends}")

    def __call__(self, y: Array, derivative: int = 0) -> Array:
        """Return the function, or its derivative of the given order, at depths y, (...) → (...)."""
        total = np.zeros(np.shape(y), dtype=np.result_type(y, float))
        place, start = np.real(y), -np.inf
        for end, piece in zip(self.ends, _derived(self.pieces, derivative), strict=True):
            if any(piece):
                np.copyto(total, _polynomial(piece, y), where=(place >= start) & (place < end))
            start = end
        return total

    def jump(self, place: float, derivative: int) -> float:
        """Return the jump of a derivative: its value just beyond a depth minus its value just before this depth.

        Args:
            place: the depth, for example the end of a piece; it must be positive.
            derivative: the order of the derivative; 0 for the function itself.
        """
        sides = (place * (1 + side * 1e-12) for side in (-1, 1))
        below, above = (float(self(np.array(side), derivative)) for side in sides)
        return above - below


@dataclass(frozen=True)
@checked(ProfileError)
class Profile:
    """The functions a, …, f of the depth y by which the displacement of a contact face continues into the body.

    For the gap w (minus an initial gap), the normal strain q, the shear strain r and the slip z on the face, the
    displacement is

        u_s = ∇_s w·a(y) + ∇_s q·e(y) + r·c(y) + z·f(y),      u_n = w·b(y) + q·d(y).

    u_s and u_n are its components along the face and along the inward normal. At y = 0 the functions must satisfy a = c
    = d = e = 0, b = f = 1, a' = −1, c' = d' = 1 and b' = e' = f' = 0. Then u_n = w, u_s = z, ε_nn = q, 2ε_sn = r and
    ε_ss = sym ∇_s z on the face.

    Attributes:
        a, b, c, d, e, f: the functions.

    Raises:
        ProfileError: one of the conditions at y = 0 is violated.
    """

    a: Piecewise
    b: Piecewise
    c: Piecewise
    d: Piecewise
    e: Piecewise
    f: Piecewise

    def __post_init__(self) -> None:
        expected = {"a": (0, -1), "b": (1, 0), "c": (0, 1), "d": (0, 1), "e": (0, 0), "f": (1, 0)}
        for name, values in expected.items():
            function = getattr(self, name)
            found = [float(function(np.array(0.0), k)) for k in range(2)]
            if not np.allclose(found, values, atol=1e-12):
                raise ProfileError(f"{name}(0), {name}'(0) must be {values} to carry Cauchy data, got {tuple(found)}")

    @property
    def depth(self) -> float:
        """The depth beyond which the displacement is zero."""
        return max(function.ends[-1] for function in (self.a, self.b, self.c, self.d, self.f))

    @property
    def ends_with_kink(self) -> bool:
        """Whether a function has a kink where the displacement ends. The body must then end at this depth."""
        return any(abs(f.jump(f.ends[-1], 1)) > 1e-9 for f in (self.a, self.b, self.c, self.d, self.e, self.f))


ZERO = Piecewise((1.0,), ((0.0,),))


@checked(ProfileError)
def cutoff(depth: Size = 1.0, phi: tuple[float, ...] = HERMITE) -> Profile:
    """Return the profile of the standard construction: the displacement is multiplied by a cut-off φ(y/ℓ).

    The functions of ``Profile`` are b = f = φ(y/ℓ), c = d = y φ(y/ℓ), a = −y φ(y/ℓ), e = 0.

    Args:
        depth: ℓ, the depth beyond which the displacement is zero.
        phi: the coefficients of a polynomial φ with φ(0) = 1, φ'(0) = 0, φ(1) = 0, lowest power first.
    """
    phi_of_y = tuple(coefficient / depth**k for k, coefficient in enumerate(phi))
    ends = (depth,)
    constant, slope = Piecewise(ends, (phi_of_y,)), Piecewise(ends, ((0.0, *phi_of_y),))
    return Profile(
        a=Piecewise(ends, ((0.0, *(-x for x in phi_of_y)),)), b=constant, c=slope, d=slope, e=ZERO, f=constant
    )


@checked(ProfileError)
def slab(depth: Size = 1.0, phi: tuple[float, ...] = HERMITE) -> Profile:
    """Return a profile with which the strain in the body can be uniform.

    The strain is uniform for a constant gap w and the normal strain q = −w/ℓ on the face. The functions of ``Profile``
    are b = 1 − y/ℓ + (y/ℓ) φ(y/ℓ), c = d = y φ(y/ℓ), a = −y φ(y/ℓ), e = 0, f = φ(y/ℓ). Only b differs from ``cutoff``.

    Args:
        depth: ℓ, the depth beyond which the displacement is zero.
        phi: the coefficients of a polynomial φ with φ(0) = 1, φ'(0) = 0, φ(1) = 0, lowest power first.
    """
    plain = cutoff(depth, phi)
    b = polyadd((1.0, -1 / depth), np.array(plain.d.pieces[0]) / depth)
    return replace(plain, b=Piecewise((depth,), (tuple(b.tolist()),)))


@checked(ProfileError)
def layered(interface: Size, ratio: Size, depth: Size = 1.0) -> Profile:
    """Return a profile for a body of two layers that keeps the traction continuous at the interface.

    The clamped boundary must be at the depth ℓ. The superscripts ⁻ and ⁺ denote the lower layer, at the face, and the
    upper layer; u_s and u_n are the tangential and the normal displacement. On the interface y = y_0 the tangential
    displacement vanishes, so ε = sym(β ⊗ n) there, with some vector β and the normal n. If also ε⁺ = ε⁻/κ, where κ is
    the ratio of the layers, then the traction is continuous for any A and G and at all times. This requires

        ∂_y u_n⁺ = ∂_y u_n⁻/κ,      ∂_y u_s⁺ + ∇_s u_n = (∂_y u_s⁻ + ∇_s u_n)/κ.

    The functions of ``Profile`` are chosen as follows. In the lower layer b = 1 + γ y² and d = y + δ y² are quadratic,
    c = −a = y(1 − y/y_0) and e = 0. In the upper layer b and d are linear, with γ and δ such that b and d are 0 at y =
    ℓ. f = 1 − (y/y_0)² in the lower layer. The other functions are cubics whose slopes at y_0 follow from the
    conditions above.

    Args:
        interface: the depth y_0 of the interface.
        ratio: κ, how many times as stiff and viscous the upper layer is as the layer at the face.
        depth: ℓ.
    """
    _require_increasing(interface, depth)
    y0, rest = interface, depth - interface
    common = 2 * y0 * rest + ratio * y0**2
    gamma, delta = -ratio / common, -(rest + ratio * y0) / common
    b = 1 + gamma * y0**2
    d = y0 + delta * y0**2
    softer = 1 / ratio - 1
    # The cubic (y − y_0)(ℓ − y)²/(ℓ − y_0)² has the slope 1 at y_0.
    cubic = polymul((-y0, 1.0), polymul((depth, -1.0), (depth, -1.0))) / rest**2

    def bulge(slope: float) -> tuple[float, ...]:
        return tuple((slope * cubic).tolist())

    def line(value: float) -> tuple[float, ...]:
        return (value * depth / rest, -value / rest)

    ends = (y0, depth)
    return Profile(
        a=Piecewise(ends, ((0.0, -1.0, 1 / y0), bulge(1 / ratio + softer * b))),
        b=Piecewise(ends, ((1.0, 0.0, gamma), line(b))),
        c=Piecewise(ends, ((0.0, 1.0, -1 / y0), bulge(-1 / ratio))),
        d=Piecewise(ends, ((0.0, 1.0, delta), line(d))),
        e=Piecewise(ends, ((0.0,), bulge(softer * d))),
        f=Piecewise(ends, ((1.0, 0.0, -1 / y0**2), bulge(-2 / y0 / ratio))),
    )

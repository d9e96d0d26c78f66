"""The terms y^m Re(c z^β), z = x + iy, of which singular displacement fields consist."""

from dataclasses import dataclass

import numpy as np

from manufactured.arguments import Degree, Size, checked
from manufactured.symbols import FormulaError
from manufactured.tensors import Array


@dataclass(frozen=True)
@checked(FormulaError)
class Monomial:
    """The function y^m Re(c z^β) of z = x + iy, where m is 0 or 1."""

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
        a, b: the factors of the potentials.
        exponent: λ.

    Returns:
        The terms of 2μ u_x, and the terms of 2μ u_y.
    """
    # The sum is κ a z^λ − conj((λ a + b) z^λ) − 2iyλ conj(a z^{λ−1}). It is written as terms Re(c z^β) with Im g =
    # Re(−i g) and conj(g) = Re g − i Im g.
    lam = exponent
    u_x = (Monomial(0, kappa * a - lam * a - b, lam), Monomial(1, 2j * lam * a, lam - 1))
    u_y = (Monomial(0, -1j * (kappa * a) - 1j * (lam * a + b), lam), Monomial(1, -2 * lam * a + 0j, lam - 1))
    return u_x, u_y


class Powers:
    """Evaluates functions Re(c (x + iy)^β) at fixed points for given c and β; they are 0 at the origin.

    The formula r^β (c_r cos βθ − c_i sin βθ) is analytic in x and y, as derivatives by the complex step need. r^β, cos
    βθ and sin βθ are computed once for each β.
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

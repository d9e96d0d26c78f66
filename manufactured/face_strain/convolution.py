"""Integrals of polynomials against e^{−λ(t−r)}, by the φ-functions of exponential integrators."""

from __future__ import annotations

import math

import numpy as np
import sympy as sp

from manufactured.symbols import Jet, Values, t
from manufactured.tensors import Array


class Convolution:
    """∫_a^b e^{−λ(b−r)} ∂_s^i P(s, r) dr for a smooth branch P of p/a that is a polynomial of r, of degree m.

    With τ = b − a, by Taylor's formula at a,

        ∫_a^b e^{−λ(b−r)} P(r) dr = Σ_{j≤m} ∂_r^j P(a) τ^{j+1} φ_{j+1}(−λτ),    φ_k(z) = Σ_n z^n/(n + k)!,

    where only τ depends on b: what a point needs is found once, when contact begins.

    Source of the functions φ_k: M. Hochbruck, A. Ostermann, Exponential integrators, Acta Numer. 19 (2010) 209–286.
    """

    def __init__(self, smooth: sp.Poly, variables: tuple[sp.Symbol, ...], decay: float) -> None:
        self.decay = decay
        self.derivatives = []
        while True:
            self.derivatives.append(Jet(_nested(smooth), variables))
            if smooth.degree() <= 0:
                break
            smooth = smooth.diff(t)

    def taylor(self, points: Array, lower: Array, order: int) -> Values:
        """∂_s^i ∂_r^j P(s, a) for every |i| ≤ order: points (d−1, N) and a (N,) → (m + 1, N) each."""
        values = [jet(points, lower, order) for jet in self.derivatives]
        return {index: np.array([value[index] for value in values]) for index in values[0]}

    def weights(self, duration: Array) -> Array:
        """τ^{j+1} φ_{j+1}(−λτ), (m + 1, N)."""
        found = phi(-self.decay * duration, len(self.derivatives))
        power = duration
        for row in found:
            row *= power
            power = power * duration
        return found


SMALL = 12.0
"""|z| up to which φ_k is found from φ_K by recurrence downwards; an error grows to |z|^K/K! ε there."""
TERMS = 48
"""Terms of the series of φ_K: |z|^n/(n + K)! is below the rounding of its sum after them."""


def phi(z: Array, count: int) -> Array:
    """φ_1, …, φ_count at z with Re z ≤ 0, (count, N).

    φ_k = z φ_{k+1} + 1/k! downwards from the series of φ_count where |z| is small, upwards from (e^z − 1)/z elsewhere.
    """
    found = np.empty((count, *z.shape), dtype=np.result_type(z, float))
    large = abs(z) > SMALL
    near, far = np.where(large, 0.0, z), np.where(large, z, -1.0)
    term = np.full_like(found[0], 1 / math.factorial(count))
    total = term.copy()
    biggest = float(abs(near).max(initial=0.0))
    for n in range(1, TERMS):
        if biggest**n * math.factorial(count) < 1e-18 * math.factorial(n + count):
            break
        term = term * near / (n + count)
        total += term
    found[-1] = total
    for k in range(count - 1, 0, -1):
        found[k - 1] = near * found[k] + 1 / math.factorial(k)
    if large.any():
        value = np.expm1(far) / far
        for k in range(1, count + 1):
            found[k - 1] = np.where(large, value, found[k - 1])
            value = (value - 1 / math.factorial(k)) / far
    return found


def _nested(polynomial: sp.Poly) -> sp.Expr:
    """Horner's form in t."""
    nested = sp.Integer(0)
    for coefficient in polynomial.all_coeffs():
        nested = nested * t + coefficient
    return nested

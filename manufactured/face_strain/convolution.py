"""Integrals of polynomials against e^{−λ(t−r)}, by the φ-functions of exponential integrators."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import sympy as sp

from manufactured.compiled import coefficients_in_t
from manufactured.jet import Jet
from manufactured.symbols import Index, Values, t
from manufactured.tensors import Array


class Started(Protocol):
    """∫_a^b e^{−λ(b−r)} ∂_s^i P(s, r) dr at N points with their a, as a function of b."""

    def upto(self, upper: Array, chosen: Array) -> Values:
        """The integrals up to b (n,) at the points with these numbers (n,), which may repeat, for every i."""
        ...


class Integral(Protocol):
    """∫_a^b e^{−λ(b−r)} ∂_s^i P(s, r) dr of a smooth branch P of p/a."""

    def started(self, points: Array, lower: Array, upper: Array, order: int) -> Started:
        """For |i| ≤ order at points (d − 1, N) from a = ``lower`` (N,) on; b is ``upper`` (N,) at most."""
        ...


class Convolution:
    """∫_a^b e^{−λ(b−r)} ∂_s^i P(s, r) dr for a smooth branch P of p/a that is a polynomial of r, of degree m.

    With τ = b − a, by Taylor's formula at a,

        ∫_a^b e^{−λ(b−r)} P(r) dr = Σ_{j≤m} ∂_r^j P(a) τ^{j+1} φ_{j+1}(−λτ),    φ_k(z) = Σ_n z^n/(n + k)!,

    where only τ depends on b: what a point needs is found once, when contact begins.

    Source of the functions φ_k: M. Hochbruck, A. Ostermann, Exponential integrators, Acta Numer. 19 (2010) 209–286.
    """

    def __init__(self, smooth: sp.Expr, variables: tuple[sp.Symbol, ...], decay: float) -> None:
        self.decay = decay
        self.derivatives = []
        coefficients = coefficients_in_t(smooth)
        while coefficients:
            self.derivatives.append(Jet(_nested(coefficients), variables))
            coefficients = [n * c for n, c in zip(range(len(coefficients) - 1, 0, -1), coefficients, strict=False)]

    def started(self, points: Array, lower: Array, upper: Array, order: int) -> Started:
        """∂_s^i ∂_r^j P(s, a) for every |i| ≤ order and j, found once."""
        values = []
        for jet in self.derivatives:
            values.append(jet(points, lower, order))
        coefficients = {index: np.array([value[index] for value in values]) for index in values[0]}
        return _Taylor(self.decay, len(values) - 1, lower, coefficients)


@dataclass(frozen=True, eq=False)
class _Taylor:
    """λ, m, a and the Taylor coefficients at a, (m + 1, N) for each i."""

    decay: float
    degree: int
    lower: Array
    coefficients: dict[Index, Array]

    def upto(self, upper: Array, chosen: Array) -> Values:
        """As ``Started``."""
        found = {i: np.empty(upper.shape, np.result_type(upper, value)) for i, value in self.coefficients.items()}
        for first in range(0, len(upper), TOGETHER):
            here = slice(first, first + TOGETHER)
            duration = upper[here] - self.lower[chosen[here]]
            weights = phi(-self.decay * duration, self.degree + 1)
            weights *= duration ** np.arange(1, self.degree + 2)[:, None]
            for index, value in self.coefficients.items():
                found[index][here] = np.einsum("jn,jn->n", np.take(value, chosen[here], axis=1), weights)
        return found


TOGETHER = 1 << 12
"""Integrals that are found together, so that what each needs of all φ_k stays in the cache."""
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
    near = np.where(large, 0.0, z)
    size, terms, first = float(abs(near).max(initial=0.0)), 1, 1e18 * math.factorial(count)
    while terms < TERMS and size**terms * first >= math.factorial(terms + count):
        terms += 1
    # Horner's rule, in place: this is most of what the memory of a face costs.
    series = found[-1]
    series[:] = 0.0
    for n in reversed(range(terms)):
        series *= near
        series += 1 / math.factorial(n + count)
    for k in range(count - 1, 0, -1):
        found[k - 1] = near * found[k] + 1 / math.factorial(k)
    if large.any():
        far = np.where(large, z, -1.0)
        value = np.expm1(far) / far
        for k in range(1, count + 1):
            found[k - 1] = np.where(large, value, found[k - 1])
            value = (value - 1 / math.factorial(k)) / far
    return found


def _nested(coefficients: Sequence[sp.Expr]) -> sp.Expr:
    """Horner's form in t."""
    nested = sp.Integer(0)
    for coefficient in coefficients:
        nested = nested * t + coefficient
    return nested

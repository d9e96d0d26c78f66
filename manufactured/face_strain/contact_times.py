"""The pressure as a polynomial of t between the times at which contact begins and ends at a point."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import sympy as sp

from manufactured.face_strain.convolution import Convolution
from manufactured.symbols import FormulaError, function, pos, t
from manufactured.tensors import Array


def smooth_branch(term: sp.Expr, variables: tuple[sp.Symbol, ...]) -> tuple[tuple[sp.Expr, ...], sp.Expr]:
    """The moving fronts ψ of a term of p, and its formula where all ψ > 0.

    Raises:
        FormulaError: a ψ or the term between its fronts is not a polynomial of t.
    """
    fronts = [p for p in term.atoms(pos) if p.args[0].has(t)]
    for front in fronts:
        # With m = 1 the second derivative along the face would have a term at the front; a switch in
        # time alone has none.
        lowest = 2 if front.args[0].free_symbols & set(variables) else 0
        if not (front.args[0].is_polynomial(t) and front.args[1].is_integer and front.args[1] >= lowest):
            raise FormulaError(
                f"{front}: a front that moves needs pos(ψ, m) with ψ polynomial in t and an integer m ≥ 2; "
                "replace other motions by a polynomial, the contact zone is yours to choose"
            )
    smooth = term.subs({p: p.args[0] ** p.args[1] for p in fronts})
    if not smooth.is_polynomial(t):
        raise FormulaError(
            f"the pressure term {term} is not polynomial in t between its fronts, "
            "so its memory has no closed form; use a polynomial in t"
        )
    return tuple(sorted({front.args[0] for front in fronts}, key=sp.default_sort_key)), smooth


@dataclass(frozen=True, eq=False)
class PressureTerm:
    """The terms of p/a with the same moving fronts.

    Attributes:
        moving: coefficient functions (s) ↦ [ψ's coefficients in t, highest first] of each moving ψ.
        convolution: the hereditary integral of their smooth branch.
    """

    moving: tuple[Callable[..., list[Array]], ...]
    convolution: Convolution

    @classmethod
    def of(
        cls, fronts: tuple[sp.Expr, ...], branch: sp.Expr, variables: tuple[sp.Symbol, ...], decay: float
    ) -> PressureTerm:
        moving = tuple(function(variables, sp.Poly(front, t).all_coeffs()) for front in fronts)
        return cls(moving, Convolution(sp.Poly(branch, t), variables, decay))

    def intervals(self, points: Array, T: float) -> tuple[Array, Array]:
        """Times at which contact begins and ends at each point: two arrays (J, N), equal where unused."""
        count = points.shape[1]
        coefficients = [
            np.array([np.broadcast_to(c, count) for c in coefficient(*points)], dtype=float)
            for coefficient in self.moving
        ]
        times = [np.zeros((1, count)), np.full((1, count), T)]
        times += [real_roots(c, T) for c in coefficients]
        nodes = np.sort(np.vstack(times), axis=0)
        middle = (nodes[1:] + nodes[:-1]) / 2
        inside = np.ones(middle.shape, dtype=bool)
        for c in coefficients:
            inside &= np.polyval(c, middle) > 0
        return np.where(inside, nodes[:-1], T), np.where(inside, nodes[1:], T)


def real_roots(coefficients: Array, T: float) -> Array:
    """Roots in (0, T) of polynomials, coefficients (degree+1, N) highest first, as (degree, N).

    Places without a root hold T. Degrees up to 2 in closed form, higher ones by the eigenvalues of
    the companion matrix.
    """
    degree, count = coefficients.shape[0] - 1, coefficients.shape[1]
    if degree == 0:
        return np.empty((0, count))
    roots = np.full((degree, count), T)
    vanishing = abs(coefficients[0]) <= 1e-14 * abs(coefficients).max(axis=0)
    if vanishing.any():
        roots[1:, vanishing] = real_roots(coefficients[1:, vanishing], T)
    rest = np.flatnonzero(~vanishing)
    monic = coefficients[1:, rest] / coefficients[0, rest]
    if degree == 1:
        found = -monic.astype(complex)
    elif degree == 2:
        discriminant = np.sqrt((monic[0] ** 2 - 4 * monic[1]).astype(complex))
        # The larger root first, the other from the product: no cancellation.
        larger = -(monic[0] + np.where(monic[0] >= 0, 1, -1) * discriminant) / 2
        other = np.divide(monic[1], larger, out=np.zeros_like(larger), where=larger != 0)
        found = np.array([larger, other])
    else:
        companion = np.zeros((len(rest), degree, degree))
        companion[:, 0, :] = -monic.T
        companion[:, range(1, degree), range(degree - 1)] = 1
        found = np.linalg.eigvals(companion).T
    real = abs(found.imag) <= 1e-7 * (1 + abs(found.real))
    roots[:, rest] = np.where(real & (found.real > 0) & (found.real < T), found.real, T)
    return roots

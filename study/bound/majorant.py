"""A guaranteed bound of ‖u(t) − ũ(t)‖_V for any admissible trajectory ũ, without the exact solution u.

Let ũ(t) ∈ K, e = u − ũ, and σ̃(t) balance f̃(t) with σ̃_τ = 0, σ̃_ν ≤ 0 on Γ3. Put ρ = σ̃ − Aε(ũ̇) − Gε(ũ). Testing
(3.13) for u with ũ gives (Aε(u̇) + Gε(u), ε(e))_Q ≤ (f, e)_V, and Green's formula for σ̃, with u_ν ≤ 0 on Γ3,

    (σ̃, ε(e))_Q = (f̃, e)_V + ∫_{Γ3} σ̃_ν e_ν ≥ (f̃, e)_V − c,     c = ∫_{Γ3} σ̃_ν ũ_ν ≥ 0.

Subtracting, with r = ‖ρ‖_{A⁻¹}, the norm η of f − f̃ in the dual of V and m the least modulus of ``study.bound.moduli``,

    ½ d/dt ‖e‖_V² + m ‖e‖_V² ≤ (r + η) ‖e‖_V + c.

From knot to knot of the spline ũ (``study.bound.trajectory``) this bounds ‖e‖_V at the end of a piece by that at its
start (``study.bound.growth``; proof in ``paper/bound.tex``).

**Between the knots** everything is a parabola in t in Bernstein form. σ̃ is one with σ̃_ν ≤ 0 in all three
coefficients; it balances the parabola through P f at both ends and in the middle. For linear G so is ρ, and ∫ r ≤ (k ∫
‖ρ‖²)^{1/2} is exact up to the last step. For other G, Lipschitz with L, Gε(ũ) differs from its linear interpolation by
at most 2θ(1−θ) k L |ε̇|, and by nothing where the whole piece stays in the convex set of (3.3).

**Data.** f − P f is bounded cell by cell (``study.stresses.oscillation``) and added to ρ in the same cell; P f minus
its parabola, sampled once in each piece, is balanced by a stress of its own. Integrals of the data are quadratures;
what these samples miss is bounded by ranges of the formulas and added, or the bound is estimated
(``study.bound.sampling``).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import islice, pairwise

import numpy as np

from manufactured.law import Linear, Yield
from manufactured.tensors import Array, Tensors
from study.bound.discretisation import Discretisation
from study.bound.equilibration import Equilibration, Knot, LawResidual
from study.bound.growth import Added, Sizes, grown, largest_square, mean_square
from study.bound.moduli import BoundError
from study.bound.sampling import Missed
from study.bound.shares import Shares, part_that_changes, proportional
from study.bound.trajectory import Parabola
from study.stresses.loads import Loads, Snapshot, together

QUADRATIC = np.array([[6.0, 3.0, 1.0], [3.0, 4.0, 3.0], [1.0, 3.0, 6.0]]) / 30
"""∫_0^1 B_i B_j for the Bernstein polynomials of degree 2."""
CURVED, BENT = 1.5, 1.027
"""How much larger θ(1 − θ) is than its mean, and |θ(θ − ½)(θ − 1)| than at θ = ¼, for 0 ≤ θ ≤ 1."""
LEAST, MOST, VALUES = 4, 16, 1 << 20
"""The least and the largest number of pieces that are taken together, and how many values of a stress at all points of
as many of them there are in between."""
ROUNDING = 1e-6
"""Jump of ũ̇ at a knot, relative to ũ̇, that counts as none."""


@dataclass(frozen=True)
class Interval:
    """The bound y of ‖e‖_V between two knots.

    Attributes:
        a, b: the knots.
        at_a, at_b: y at the knots.
        inside: bound of ‖e(t)‖_V for all a ≤ t ≤ b.
        residual: ∫ of the norm of ρ.
        contact: ∫ c.
        oscillation: ∫ of the bound of f − P f.
        bending: ∫ of the norm of P f minus its parabola in time.
        unseen: ∫ of the bound of what samples of the data miss everywhere.
        shares: of what the piece adds, ``at_b`` less what is left of ``at_a``.

    The integrals are for the record: the bound combines residual and oscillation cell by cell.
    """

    a: float
    b: float
    at_a: float
    at_b: float
    inside: float
    residual: float
    contact: float
    oscillation: float
    bending: float
    unseen: float
    shares: Shares


@dataclass(frozen=True, eq=False)
class _Span:
    """A piece of ũ with its knots and the data in its middle."""

    piece: Parabola
    left: Knot
    middle: Snapshot
    right: Knot

    @cached_property
    def loads(self) -> Loads:
        """The middle Bernstein coefficient of the parabola through P f at both ends and in the middle."""
        return 2.0 * self.middle.loads + (-0.5) * (self.left.snapshot.loads + self.right.snapshot.loads)


@dataclass(frozen=True, eq=False)
class _Known:
    """What is known of a piece before the bound at its start.

    Attributes:
        residuals: the coefficients of ρ as a parabola in time.
        products: of any two of them, (3, 3, directions, cells).
        curvature: the mean of ‖Gε(ũ) − its parabola‖_{A⁻¹}.
        bending: the norm in the dual of V of P f minus its parabola.
    """

    span: _Span
    residuals: tuple[LawResidual, ...]
    products: Array
    curvature: float
    bending: float


class Majorant:
    """The bound along a trajectory on one mesh; pieces are taken together, as far as caches have room for them."""

    def __init__(self, discretisation: Discretisation) -> None:
        self.discretisation, self.equilibration = discretisation, Equilibration(discretisation)
        values = 3 * discretisation.stresses.weights.size
        self._together = max(LEAST, min(MOST, VALUES // values))

    def __call__(self, pieces: Iterable[Parabola], start: float) -> Iterator[tuple[Parabola, Interval]]:
        """The bound on every piece of ũ, from a bound of ‖u_0 − ũ(0)‖_V; BoundError if ũ̇ jumps at a knot."""
        y, left, joined = start, None, _joined(pieces)
        while block := list(islice(joined, self._together)):
            if left is None:
                first = block[0]
                (left,) = self.equilibration.knots([first.a], first.start[None], first.rate(end=False)[None])
            known = self._known(block, left)
            for one in known:
                interval = self._interval(one, y)
                yield one.span.piece, interval
                y = interval.at_b
            left = known[-1].span.right

    def _known(self, pieces: list[Parabola], left: Knot) -> list[_Known]:
        """What is known of pieces, one after the other, from what is known of the first knot."""
        equilibration, snapshot = self.equilibration, self.discretisation.snapshot
        ends, rates = (np.array(each) for each in zip(*((p.end, p.rate(end=True)) for p in pieces), strict=True))
        knots = [left, *equilibration.knots([piece.b for piece in pieces], ends, rates)]
        spans = [
            _Span(piece, a, snapshot((piece.a + piece.b) / 2), b)
            for piece, (a, b) in zip(pieces, pairwise(knots), strict=True)
        ]
        elastic = [self._elastic(span.piece, span.left, span.right) for span in spans]
        targets = [
            (span.left.viscous + span.right.viscous) / 2 + control
            for span, (control, _) in zip(spans, elastic, strict=True)
        ]
        loads, control = together([span.loads for span in spans]), np.array([piece.control for piece in pieces])
        controls = equilibration.residual(loads, np.stack(targets, axis=1), control).each
        bending = equilibration.unbalanced(together([self._bent(span) for span in spans])).tolist()
        found = []
        for span, middle, (_, curvature), bent in zip(spans, controls, elastic, bending, strict=True):
            every = span.left.residual, middle, span.right.residual
            products = equilibration.products([one.parts for one in every])
            found.append(_Known(span, every, products, curvature, bent))
        return found

    def _interval(self, known: _Known, y: float) -> Interval:
        discretisation, span, residual = self.discretisation, known.span, known.products
        piece, curvature, bending = span.piece, known.curvature, known.bending
        k = piece.b - piece.a
        squares = np.tensordot(QUADRATIC, residual, axes=2)
        missed = discretisation.sampling.missed(discretisation.oscillation, piece.a, piece.b)
        snapshots = span.left.snapshot, span.middle, span.right.snapshot
        left_out = [discretisation.oscillation(at.left_out) + missed.cells for at in snapshots]
        unseen = missed.everywhere
        contact, largest_contact = self._contact(piece, known.residuals)
        mean = Sizes(squares, mean_square(*left_out), float(contact.sum()), curvature + bending + unseen)
        largest = Sizes(
            np.max([residual[i, i] for i in range(3)], axis=0),
            largest_square(*left_out),
            largest_contact,
            CURVED * curvature + BENT * bending + unseen,
        )
        at_b, inside = grown(y, discretisation.moduli.values, Added(k, mean, largest))
        of_law, of_data = float(np.sqrt(squares.sum())) + curvature, float(np.linalg.norm(np.sqrt(mean.oscillation)))
        shares = self._shares(k, y, residual, mean, contact, missed)
        shares = shares.of(at_b - discretisation.moduli.decay(k) * y)
        parts = k * of_law, k * mean.contact, k * of_data, k * bending, k * unseen
        return Interval(piece.a, piece.b, y, at_b, inside, *parts, shares)

    def _contact(self, piece: Parabola, residuals: tuple[LawResidual, ...]) -> tuple[Array, float]:
        """The mean of c on the edges of Γ3, (edges of Γ3,), and a bound of c at all times."""
        moments = self.discretisation.normal_moments(np.array([piece.start, piece.control, piece.end]))
        # Complementary up to rounding, they may come out as −0.
        normal = np.array([one.normal for one in residuals])
        products = np.maximum(np.einsum("ien,jen->ije", normal, moments), 0.0)
        return np.tensordot(QUADRATIC, products, axes=2), float(products.sum(axis=2).max())

    def _shares(self, k: float, y: float, products: Array, mean: Sizes, contact: Array, missed: Missed) -> Shares:
        """What adds to y where, before it is damped (``study.bound.shares``)."""
        discretisation = self.discretisation
        weights = discretisation.moduli.weights(discretisation.data.body.T)
        squares = weights @ mean.residual
        changing = part_that_changes(weights @ products, squares)
        joined = (np.sqrt(squares) + np.sqrt(mean.oscillation)) ** 2
        own = k * proportional(joined)
        cells = own * (1 - changing) + k * missed.in_cells
        added = np.hypot(y, np.sqrt(2 * k * mean.contact)) - y
        np.add.at(cells, discretisation.cells_at_contact, added * contact / max(mean.contact, np.finfo(float).tiny))
        return Shares(cells, float(own @ changing) + k * (mean.rest - float(missed.in_cells.sum())))

    def _bent(self, span: _Span) -> Loads:
        """P f minus its parabola a quarter into the piece.

        The remainder of a cubic, θ(θ − ½)(θ − 1), is ``BENT`` times as large at most, and its mean absolute value less.
        """
        piece, a, b = span.piece, span.left.snapshot.loads, span.right.snapshot.loads
        quarter = self.discretisation.snapshot(piece.a + (piece.b - piece.a) / 4).loads
        return quarter + (-1.0) * (9 / 16 * a + 6 / 16 * span.loads + 1 / 16 * b)

    def _elastic(self, piece: Parabola, left: Knot, right: Knot) -> tuple[Tensors, float]:
        """The middle coefficient of Gε(ũ) as a parabola in time, and the mean of ‖Gε(ũ) − parabola‖_{A⁻¹}."""
        discretisation = self.discretisation
        G, k = discretisation.data.law.G, piece.b - piece.a
        if isinstance(G, Linear):
            return self.equilibration.elastic(piece.control), 0.0
        rates = [np.linalg.norm(discretisation.strain(piece.rate(end)), axis=0) for end in (False, True)]
        change = G.lipschitz * k * np.maximum(*rates) / 3
        if isinstance(G, Yield):
            held = [left.elastic, self.equilibration.elastic(piece.control), right.elastic]
            change[np.all([abs(g).max(axis=0) == 0 for g in held], axis=0)] = 0.0
        weights, A = discretisation.stresses.weights, discretisation.data.law.A
        return (left.elastic + right.elastic) / 2, float(np.sqrt(np.vdot(weights, change**2) / A.ellipticity))


def _joined(pieces: Iterable[Parabola]) -> Iterator[Parabola]:
    """The pieces, as long as ũ̇ does not jump where they meet.

    Raises:
        BoundError: it does.
    """
    before: Array | None = None
    for piece in pieces:
        rate = piece.rate(end=False)
        if before is not None and abs(rate - before).max() > ROUNDING * abs(rate).max():
            raise BoundError(
                f"ũ̇ jumps at t = {piece.a:.6g}: the nodes of a trajectory have to be equally spaced in time"
            )
        before = piece.rate(end=True)
        yield piece

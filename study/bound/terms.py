"""Each term of the bound of ‖u(t) − ũ(t)‖_V for any admissible displacement ũ, without the exact solution u.

Let ũ(t) ∈ K, e = u − ũ, and let the stress σ̃(t) balance the loads f̃(t) with σ̃_τ = 0 and σ̃_ν ≤ 0 on Γ3. The residual
of the law is ρ = σ̃ − Aε(ũ̇) − Gε(ũ). Testing (3.13) for u with ũ gives (Aε(u̇) + Gε(u), ε(e))_Q ≤ (f, e)_V. Green's
formula for σ̃, with u_ν ≤ 0 on Γ3, gives

    (σ̃, ε(e))_Q = (f̃, e)_V + ∫_{Γ3} σ̃_ν e_ν ≥ (f̃, e)_V − c,     c = ∫_{Γ3} σ̃_ν ũ_ν ≥ 0.

Subtract. With r = ‖ρ‖_{A⁻¹}, the norm η of f − f̃ in the dual of V and the least modulus m of ``study.bound.problem``,

    ½ d/dt ‖e‖_V² + m ‖e‖_V² ≤ (r + η) ‖e‖_V + c.

From knot to knot of the spline ũ (``study.bound.trajectory``) this bounds ‖e‖_V at the end of a piece by its bound at
the start (``study.bound.growth``; proof in ``paper/bound.tex``). The class ``Terms`` has all terms of one piece:

=============  ===========================================================  =========================================
attribute      term                                                         computed in
=============  ===========================================================  =========================================
residual       products of the coefficients in time of ρ, for r             ``Majorant._block``
curvature      Gε(ũ) minus its parabola in time, 0 for linear G             ``Majorant._elastic``
contact        products of the coefficients of σ̃_ν and ũ_ν, for c           ``Majorant._block``
oscillation    η_T: f − P f on cells, plus remainders of f on cells         ``study.stresses.oscillation``
bending        P f minus its parabola in time, in the dual norm             ``Majorant._block``
missed         remainders of f in the dual norm                             ``study.bound.remainders``
=============  ===========================================================  =========================================

**Between the knots** every quantity is a parabola in t in Bernstein form. σ̃ is a parabola with σ̃_ν ≤ 0 in all three
coefficients. It balances the parabola through P f at both ends and in the middle of the piece. For linear G, ρ is a
parabola, too, and only the last step of ∫ r ≤ (k ∫ ‖ρ‖²)^{1/2} is not exact. For other G, Lipschitz with L, Gε(ũ)
differs from its linear interpolation by at most 2θ(1−θ) k L |ε̇|. The difference is 0 if the whole piece stays in the
convex set of (3.3).

**Data.** f − P f is bounded on each cell and added to ρ in the same cell. P f minus its parabola is sampled once in
each piece and balanced by another stress. Integrals of the data are quadratures. Ranges of the formulas bound the
remainder between the samples; without formulas the bound is only estimated.

**Shares.** The increase of the bound on each piece is divided among the cells and time, to decide what to refine:

* the share of a cell T has three summands: a part proportional to k (‖ρ‖_T + η_T)²/(Σ …)^{1/2}, without the part of ρ
  that changes within the piece; the contact term on the sides of T on Γ3; and the remainder of the data in T;
* the share of time is the part of ρ that changes, the bending, and the remainder of the data between times.

ρ is measured in the norm in which stresses are balanced (``Moduli.weights``). The shares add up to the bound. Their
division is a heuristic that does not affect the bound.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement, islice

import numpy as np

from manufactured.law import Linear, Yield
from manufactured.tensors import Array, Tensors, mapped
from study.bound.discretisation import Discretisation
from study.bound.growth import Sizes, Step, grow, largest_square, mean_square
from study.bound.problem import BoundError
from study.bound.remainders import Missed, proportional
from study.bound.trajectory import Parabola
from study.stresses.loads import Loads, Snapshot, together

QUADRATIC = np.array([[6.0, 3.0, 1.0], [3.0, 4.0, 3.0], [1.0, 3.0, 6.0]]) / 30
"""Integrals ∫_0^1 B_i B_j of the Bernstein polynomials of degree 2."""
CURVED, BENT = 1.5, 1.027
"""Ratio of max θ(1 − θ) to its mean, and of max |θ(θ − ½)(θ − 1)| to its value at θ = ¼, for 0 ≤ θ ≤ 1."""
LEAST, MOST, VALUES = 4, 16, 1 << 20
"""The least and the largest number of pieces in a block, and the number of stress values to aim at in between."""
ROUNDING = 1e-6
"""Jump of ũ̇ at a knot, relative to ũ̇, up to which it counts as round-off."""


@dataclass(frozen=True, eq=False)
class Shares:
    """Non-negative shares of a bound: one for each cell, (cells,), and one for time."""

    cells: Array
    time: float

    @property
    def total(self) -> float:
        """The sum of all shares."""
        return float(self.cells.sum()) + self.time

    def __add__(self, other: Shares) -> Shares:
        return Shares(self.cells + other.cells, self.time + other.time)

    def __rmul__(self, factor: float) -> Shares:
        return Shares(factor * self.cells, factor * self.time)

    def scaled_to(self, total: float) -> Shares:
        """Return shares in the same proportions with another total; if all are 0, time gets the whole total."""
        return total / self.total * self if self.total > 0 else Shares(0 * self.cells, total)


@dataclass(frozen=True, eq=False)
class Terms:
    """The terms of the bound on one piece of ũ.

    Attributes:
        piece: ũ.
        residual: Σ ∫_T (v_i·ρ_a)(v_i·ρ_b)/α over points, for two Bernstein coefficients of ρ in time and each direction
            v_i of ``study.bound.problem``, (3, 3, directions, cells); the sum over directions is ∫_T A⁻¹ρ_a·ρ_b.
        curvature: the mean of ‖Gε(ũ) − parabola‖_{A⁻¹}.
        contact: ∫_e σ̃_ν ũ_ν for two Bernstein coefficients, (3, 3, edges of Γ3).
        oscillation: η_T at both ends and in the middle, (3, cells).
        bending: the dual norm of P f minus its parabola at a quarter of the piece.
        missed: bounds of the remainder of the data.
    """

    piece: Parabola
    residual: Array
    curvature: float
    contact: Array
    oscillation: Array
    bending: float
    missed: Missed

    @property
    def contact_on_edges(self) -> Array:
        """The mean of c over the piece on the edges of Γ3, (edges of Γ3,)."""
        return np.tensordot(QUADRATIC, self.contact, axes=2)

    def step(self) -> Step:
        """Return means of the terms over the piece and bounds of them at all times."""
        rest = self.missed.everywhere
        mean = Sizes(
            np.tensordot(QUADRATIC, self.residual, axes=2),
            mean_square(*self.oscillation),
            float(self.contact_on_edges.sum()),
            self.curvature + self.bending + rest,
        )
        largest = Sizes(
            np.max([self.residual[i, i] for i in range(3)], axis=0),
            largest_square(*self.oscillation),
            float(self.contact.sum(axis=2).max()),
            # The remainder of a cubic, θ(θ − ½)(θ − 1), is at most BENT times its value at ¼, and smaller in the mean.
            CURVED * self.curvature + BENT * self.bending + rest,
        )
        return Step(self.piece.b - self.piece.a, mean, largest)


@dataclass(frozen=True)
class Interval:
    """The bound y of ‖e‖_V on one piece of ũ.

    Attributes:
        a, b: the knots at its ends.
        at_a, at_b: y at the knots.
        inside: bound of ‖e(t)‖_V for all a ≤ t ≤ b.
        residual: ∫ of the norm of ρ.
        contact: ∫ c.
        oscillation: ∫ of the bound of f − P f.
        bending: ∫ of the norm of P f minus its parabola in time.
        missed: ∫ of the bound of the remainder of the data in the dual norm.
        shares: shares of the increase: ``at_b`` minus the decayed ``at_a``.

    The integrals are reported only: the bound combines residual and oscillation on each cell.
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
    missed: float
    shares: Shares


@dataclass(frozen=True, eq=False)
class Knots:
    """Stresses and data at consecutive knots of ũ, stored because two pieces share each knot.

    All arrays have one axis for the knots.

    Attributes:
        snapshots: the data.
        viscous, elastic: Aε(ũ̇) and Gε(ũ) at the quadrature points of the stresses, (3, knots, cells, Q).
        residual: v_i·ρ times root weights, (directions, knots, cells, Q).
        normal: Bernstein coefficients of σ̃_ν on Γ3, (knots, edges of Γ3, n).
    """

    snapshots: list[Snapshot]
    viscous: Tensors
    elastic: Tensors
    residual: Array
    normal: Array

    def __add__(self, later: Knots) -> Knots:
        return Knots(
            self.snapshots + later.snapshots,
            np.concatenate([self.viscous, later.viscous], axis=1),
            np.concatenate([self.elastic, later.elastic], axis=1),
            np.concatenate([self.residual, later.residual], axis=1),
            np.concatenate([self.normal, later.normal]),
        )


class Majorant:
    """Computes the bound y of ‖u − ũ‖_V from the start of a displacement ũ to its end, on one mesh.

    Pieces of ũ are computed in blocks that fit into the processor's cache.
    """

    def __init__(self, discretisation: Discretisation) -> None:
        self.discretisation = discretisation
        space = discretisation.stresses
        self._directions = discretisation.moduli.directions.T
        self._roots = np.sqrt(space.weights * discretisation.inverse_viscosity)
        self._together = max(LEAST, min(MOST, VALUES // (3 * space.weights.size)))

    def __call__(self, pieces: Iterable[Parabola], start: float) -> Iterator[tuple[Parabola, Interval]]:
        """Yield every piece of ũ with the bound on it.

        Args:
            start: a bound of ‖u_0 − ũ(0)‖_V.

        Raises:
            BoundError: ũ̇ jumps at a knot.
        """
        y = start
        for terms in self.terms(pieces):
            interval = self._interval(terms, y)
            yield terms.piece, interval
            y = interval.at_b

    def terms(self, pieces: Iterable[Parabola]) -> Iterator[Terms]:
        """Yield the terms of the bound on every piece of ũ.

        Raises:
            BoundError: ũ̇ jumps at a knot.
        """
        smooth, last = _without_jumps(pieces), None
        while block := list(islice(smooth, self._together)):
            if last is None:
                first = block[0]
                last = self.knots([first.a], first.start[None], first.rate(end=False)[None])
            ends, rates = (np.array(each) for each in zip(*((p.end, p.rate(end=True)) for p in block), strict=True))
            knots = last + self.knots([piece.b for piece in block], ends, rates)
            yield from self._block(block, knots)
            viscous, elastic, residual = (each[:, -1:] for each in (knots.viscous, knots.elastic, knots.residual))
            last = Knots(knots.snapshots[-1:], viscous, elastic, residual, knots.normal[-1:])

    def knots(self, times: Sequence[float], u: Array, rates: Array) -> Knots:
        """Return the knots at given times with ũ = u and ũ̇ = rate, (times, dofs) both."""
        d = self.discretisation
        snapshots = [d.snapshot(time) for time in times]
        viscous, elastic = d.viscous(rates), d.elastic(u)
        residual, normal = self._residual(together([at.loads for at in snapshots]), viscous + elastic, u)
        return Knots(snapshots, viscous, elastic, residual, normal)

    def _block(self, pieces: list[Parabola], knots: Knots) -> Iterator[Terms]:
        """Yield the terms of consecutive pieces of ũ, whose knots are given."""
        d, control = self.discretisation, np.array([piece.control for piece in pieces])
        middle = [d.snapshot((piece.a + piece.b) / 2) for piece in pieces]
        a, m, b = (together([at.loads for at in some]) for some in (knots.snapshots[:-1], middle, knots.snapshots[1:]))
        # The middle Bernstein coefficient of the parabola through P f at both ends and in the middle.
        loads = 2.0 * m + (-0.5) * (a + b)
        elastic, curvature = self._elastic(pieces, control, knots)
        viscous = (knots.viscous[:, :-1] + knots.viscous[:, 1:]) / 2
        residual, normal = self._residual(loads, viscous + elastic, control)
        products = self.products([knots.residual[:, :-1], residual, knots.residual[:, 1:]])
        # The least stress with τν = 0 on Γ3 that balances P f minus the parabola at a quarter of the piece.
        quarter = together([d.snapshot(piece.a + (piece.b - piece.a) / 4).loads for piece in pieces])
        parabola = (9 / 16) * a + (6 / 16) * loads + (1 / 16) * b
        balancing = self._in_directions(d.equilibrium.balance(quarter + (-1.0) * parabola).values)
        bending = np.sqrt(self.products([balancing])[0, 0].sum(axis=(0, -1)))
        moments = d.normal_moments(np.array([[piece.start, piece.control, piece.end] for piece in pieces]))
        # Complementarity makes these products 0, but rounding can make them slightly negative.
        pressures = np.array([knots.normal[:-1], normal, knots.normal[1:]])
        contact = np.maximum(np.einsum("ipen,pjen->pije", pressures, moments), 0.0)
        for n, piece in enumerate(pieces):
            missed = d.sampling.missed(d.oscillation, piece.a, piece.b)
            at = knots.snapshots[n], middle[n], knots.snapshots[n + 1]
            oscillation = np.array([d.oscillation(one.left_out) + missed.cells for one in at])
            yield Terms(
                piece, products[..., n, :], float(curvature[n]), contact[n], oscillation, float(bending[n]), missed
            )

    def _residual(self, loads: Loads, target: Tensors, u: Array) -> tuple[Array, Array]:
        """Return v_i·ρ times root weights, (directions, times, cells, Q), and σ̃_ν on Γ3, (times, edges of Γ3, n)."""
        d = self.discretisation
        nearest = d.nearest_stress(loads, target, u)
        return self._in_directions(nearest.values), -d.equilibrium.pressure(nearest)

    def _in_directions(self, stress: Tensors) -> Array:
        """Return v_i·τ times root weights, so that sums of products over points are ∫_T (v_i·σ)(v_i·τ)/α."""
        found = mapped(self._directions, stress)
        found *= self._roots
        return found

    def products(self, stresses: Sequence[Array]) -> Array:
        """Return products of all pairs of n stresses, summed over quadrature points, (n, n, directions, ..., cells)."""
        n = len(stresses)
        found = np.empty((n, n, *stresses[0].shape[:-1]))
        for a, b in combinations_with_replacement(range(n), 2):
            found[a, b] = found[b, a] = np.einsum("...q,...q->...", stresses[a], stresses[b])
        return found

    def _elastic(self, pieces: list[Parabola], control: Array, knots: Knots) -> tuple[Tensors, Array]:
        """Return the middle coefficient of the parabola through Gε(ũ), and the means of ‖Gε(ũ) − parabola‖_{A⁻¹}."""
        d, elastic = self.discretisation, self.discretisation.elastic(control)
        A, G = d.data.law.A, d.data.law.G
        if isinstance(G, Linear):
            return elastic, np.zeros(len(pieces))
        rates = [np.array([piece.rate(end) for piece in pieces]) for end in (False, True)]
        k = np.array([piece.b - piece.a for piece in pieces])[:, None, None]
        change = G.lipschitz * k * np.maximum(*(np.linalg.norm(d.strain(rate), axis=0) for rate in rates)) / 3
        left, right = knots.elastic[:, :-1], knots.elastic[:, 1:]
        if isinstance(G, Yield):
            change[np.all([abs(g).max(axis=0) == 0 for g in (left, elastic, right)], axis=0)] = 0.0
        squares = np.einsum("cq,pcq->p", d.stresses.weights, change**2)
        return (left + right) / 2, np.sqrt(squares / A.ellipticity)

    def _interval(self, terms: Terms, y: float) -> Interval:
        """Return the bound on one piece of ũ from its terms and the bound y at the start of the piece."""
        moduli, piece, step = self.discretisation.moduli, terms.piece, terms.step()
        k, mean = step.k, step.mean
        at_b, inside = grow(y, moduli.values, step)
        return Interval(
            piece.a,
            piece.b,
            y,
            at_b,
            inside,
            residual=k * (float(np.sqrt(mean.residual.sum())) + terms.curvature),
            contact=k * mean.contact,
            oscillation=k * float(np.linalg.norm(np.sqrt(mean.oscillation))),
            bending=k * terms.bending,
            missed=k * terms.missed.everywhere,
            shares=self._shares(terms, step, y).scaled_to(at_b - moduli.decay(k) * y),
        )

    def _shares(self, terms: Terms, step: Step, y: float) -> Shares:
        """Return the contributions of the cells and of time to the increase of the bound y on one piece of ũ.

        Only their proportions matter: ``_interval`` scales them so that their sum is the increase.
        """
        d, k, mean, missed = self.discretisation, step.k, step.mean, terms.missed
        weights = d.moduli.weights(d.data.body.T)
        squares = weights @ mean.residual
        changing = part_that_changes(weights @ terms.residual, squares)
        added = k * proportional((np.sqrt(squares) + np.sqrt(mean.oscillation)) ** 2)
        cells = added * (1 - changing) + k * missed.in_cells
        by_contact = np.hypot(y, np.sqrt(2 * k * mean.contact)) - y
        of_edges = terms.contact_on_edges / max(mean.contact, np.finfo(float).tiny)
        np.add.at(cells, d.cells_at_contact, by_contact * of_edges)
        return Shares(cells, float(added @ changing) + k * (mean.rest - float(missed.in_cells.sum())))


def part_that_changes(products: Array, squares: Array) -> Array:
    """Return the fraction of the mean squares of parabolas in time that is not due to their means, between 0 and 1.

    Args:
        products: of each pair of Bernstein coefficients, (3, 3, n).
        squares: the mean squares that follow from the products, (n,).
    """
    # Every Bernstein polynomial of degree 2 has the mean 1/3.
    means = products.sum(axis=(0, 1)) / 9
    return np.clip(1 - np.divide(means, squares, out=np.ones_like(squares), where=squares > 0), 0.0, 1.0)


def _without_jumps(pieces: Iterable[Parabola]) -> Iterator[Parabola]:
    """Yield the pieces; raise BoundError if ũ̇ jumps at a knot."""
    before: Array | None = None
    for piece in pieces:
        rate = piece.rate(end=False)
        if before is not None and abs(rate - before).max() > ROUNDING * abs(rate).max():
            raise BoundError(
                f"ũ̇ jumps at t = {piece.a:.6g}: the nodes of a trajectory have to be equally spaced in time"
            )
        before = piece.rate(end=True)
        yield piece

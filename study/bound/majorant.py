"""A guaranteed bound of ‖u(t) − ũ(t)‖_V for any admissible trajectory ũ, without the exact solution u.

Let ũ(t) ∈ K, e = u − ũ, and σ̃(t) balance f̃(t) with σ̃_τ = 0, σ̃_ν ≤ 0 on Γ3. Put ρ = σ̃ − Aε(ũ̇) − Gε(ũ). Testing
(3.13) for u with ũ gives (Aε(u̇) + Gε(u), ε(e))_Q ≤ (f, e)_V, and Green's formula for σ̃, with u_ν ≤ 0 on Γ3,

    (σ̃, ε(e))_Q = (f̃, e)_V + ∫_{Γ3} σ̃_ν e_ν ≥ (f̃, e)_V − c,     c = ∫_{Γ3} σ̃_ν ũ_ν ≥ 0.

Subtracting, with r = ‖ρ‖_{A⁻¹} and the norm η of f − f̃ in the dual of V,

    ½ d/dt ‖e‖_V² + (Gε(u) − Gε(ũ), ε(e))_Q ≤ (r + η) ‖e‖_V + c,

so with the constant m of monotonicity (``Setting.monotonicity``)

    ‖e(b)‖_V ≤ (e^{−2m(b−a)} ‖e(a)‖_V² + 2 ∫_a^b c)^{1/2} + ∫_a^b (r + η)     for m ≥ 0,

the right side times e^{|m|(b−a)} for m < 0: d/dt of its square is at least what is needed.

**Trajectory.** The nodes d_0, …, d_N ∈ K of any time scheme are the control points of a quadratic B-spline with knots
at the middles of the steps,

    ũ(t_{j−1/2}) = (d_{j−1} + d_j)/2,    ũ̇(t_{j−1/2}) = (d_j − d_{j−1})/k,    ũ̇ linear in between,

and the straight line on the first and the last half step. All its points are convex combinations of nodes: ũ(t) ∈ K for
every t, for an exact or wrong d alike. At the knots the residual is that of the midpoint scheme, with no error in time.

**Between the knots** everything is a parabola in t in Bernstein form. σ̃ is one with σ̃_ν ≤ 0 in all three
coefficients; it balances the parabola through P f at both ends and in the middle. For linear G so is ρ, and ∫ r ≤ (k ∫
‖ρ‖²)^{1/2} is exact up to the last step. For other G, Lipschitz with L, Gε(ũ) differs from its linear interpolation by
at most 2θ(1−θ) k L |ε̇|, and by nothing where the whole piece stays in the convex set of (3.3).

**Data.** f − P f is bounded cell by cell with the constants of ``study.stresses.oscillation`` and joined to ρ in
the same cell; P f minus its parabola, sampled once in each piece, is balanced by a stress of its own. Integrals of the
data are quadratures; constants are computed.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import product

import numpy as np

from manufactured.law import Linear, Yield
from manufactured.tensors import Array, Tensors
from study.bound.discretisation import BoundError, Setting
from study.stresses.loads import Loads, Snapshot

QUADRATIC = np.array([[6.0, 3.0, 1.0], [3.0, 4.0, 3.0], [1.0, 3.0, 6.0]]) / 30
"""∫_0^1 B_i B_j for the Bernstein polynomials of degree 2."""
ROUNDING = 1e-6
PAIRS = tuple(product(range(3), repeat=2))


@dataclass(frozen=True, eq=False)
class Piece:
    """ũ between two knots a < b: Bernstein coefficients (start, control, end) in time.

    Attributes:
        a, b: the knots.
        start, control, end: coefficients of ũ, (dofs,) each.
    """

    a: float
    b: float
    start: Array
    control: Array
    end: Array

    def at(self, time: float) -> Array:
        """ũ(t) for a ≤ t ≤ b."""
        x = (time - self.a) / (self.b - self.a)
        return (1 - x) ** 2 * self.start + 2 * x * (1 - x) * self.control + x**2 * self.end

    def rate(self, end: bool) -> Array:
        """ũ̇ at a or b."""
        difference = self.end - self.control if end else self.control - self.start
        return 2 * difference / (self.b - self.a)


def spline(nodes: Iterable[tuple[float, Array]]) -> Iterator[Piece]:
    """The pieces of the quadratic B-spline with nodes (t_j, d_j), equally spaced in time, as control points."""
    iterator = iter(nodes)
    before, old = next(iterator)
    knot, point = before, old
    for time, new in iterator:
        middle, here = (before + time) / 2, (old + new) / 2
        # The first half step is a straight line: its control point lies between its ends.
        control = (point + here) / 2 if knot == before else old
        yield Piece(knot, middle, point, control, here)
        before, old, knot, point = time, new, middle, here
    yield Piece(knot, before, point, (point + old) / 2, old)


@dataclass(frozen=True, eq=False)
class Balance:
    """σ̃ and what it leaves: at a knot, or as the middle coefficient of a piece.

    Attributes:
        residual: ρ at the points of the stresses, (3, cells, Q).
        normal: Bernstein coefficients of σ̃_ν on Γ3, (edges of Γ3, 3).
    """

    residual: Tensors
    normal: Array


@dataclass(frozen=True, eq=False)
class Knot:
    """What two pieces share: the data, Aε(ũ̇), Gε(ũ) and their balance."""

    snapshot: Snapshot
    viscous: Tensors
    elastic: Tensors
    balance: Balance


@dataclass(frozen=True)
class Interval:
    """The bound between two knots.

    Attributes:
        a, b: the knots.
        at_a, at_b: y at the knots.
        inside: bound of ‖e(t)‖_V for all a ≤ t ≤ b.
        residual, contact, oscillation, bending: ∫ r, ∫ c, ∫ of what P leaves out, ∫ of what a parabola in time
            leaves out; for the record, the bound combines the first and the third cell by cell.
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


class Majorant:
    """The bound along a trajectory on one mesh."""

    def __init__(self, setting: Setting) -> None:
        self.setting = setting
        self._A, self._G = (law.at(setting.stresses.points) for law in (setting.data.law.A, setting.data.law.G))
        self._compliance = np.linalg.inv(setting.data.law.A.matrix)
        self._weights = setting.stresses.weights * setting.inverse_viscosity

    def products(self, stress: Tensors, other: Tensors) -> Array:
        """∫_T A⁻¹ρ·ρ' on the cells, (cells,)."""
        return np.einsum("IJ,Jcq,Icq,cq->c", self._compliance, stress, other, self._weights, optimize=True)

    def balance(self, loads: Loads, target: Tensors, u: Array) -> Balance:
        """σ̃ with the least ‖σ̃ − target‖² + 2 ∫_{Γ3} σ̃_ν u_ν in A⁻¹ among those that balance the loads."""
        setting = self.setting
        strain = -setting.inverse_viscosity * np.tensordot(self._compliance, target, axes=1)
        stress = setting.equilibrium(loads, strain, setting.normal_moments(u))
        return Balance(stress.values - target, -setting.equilibrium.pressure(stress))

    def knot(self, time: float, u: Array, rate: Array) -> Knot:
        """The knot with ũ = u and ũ̇ = rate."""
        setting = self.setting
        snapshot = setting.snapshot(time)
        viscous, elastic = self._A(setting.strain(rate)), self._G(setting.strain(u))
        return Knot(snapshot, viscous, elastic, self.balance(snapshot.loads, viscous + elastic, u))

    def __call__(self, pieces: Iterable[Piece], start: float) -> Iterator[tuple[Piece, Interval]]:
        """The bound on every piece, from a bound of ‖u_0 − ũ(0)‖_V."""
        y, left, before = start, None, None
        for piece in pieces:
            rate = piece.rate(end=False)
            if left is None:
                left = self.knot(piece.a, piece.start, rate)
            elif abs(rate - before).max() > ROUNDING * abs(rate).max():
                raise BoundError(
                    f"ũ̇ jumps at t = {piece.a:.6g}: the nodes of a trajectory have to be equally spaced in time"
                )
            before = piece.rate(end=True)
            right = self.knot(piece.b, piece.end, before)
            interval = self._interval(piece, left, right, y)
            yield piece, interval
            y, left = interval.at_b, right

    def _interval(self, piece: Piece, left: Knot, right: Knot, y: float) -> Interval:
        setting, k = self.setting, piece.b - piece.a
        middle = setting.snapshot((piece.a + piece.b) / 2)
        # The parabola through three times has the middle Bernstein coefficient 2 f(m) − (f(a) + f(b))/2.
        loads = 2.0 * middle.loads + (-0.5) * (left.snapshot.loads + right.snapshot.loads)
        elastic, curvature = self._elastic(piece, left, right)
        control = self.balance(loads, (left.viscous + right.viscous) / 2 + elastic, piece.control)
        every = (left.balance, control, right.balance)
        squares = sum(QUADRATIC[i, j] * self.products(every[i].residual, every[j].residual) for i, j in PAIRS)
        left_out = [setting.oscillation(snapshot) for snapshot in (left.snapshot, middle, right.snapshot)]
        unbalanced = (left_out[0] ** 2 + 4 * left_out[1] ** 2 + left_out[2] ** 2) / 6
        bending = k * self._bending(piece, left.snapshot.loads, loads, right.snapshot.loads)
        added = k * (float(np.linalg.norm(np.sqrt(squares) + np.sqrt(unbalanced))) + curvature) + bending
        moments = [setting.normal_moments(v) for v in (piece.start, piece.control, piece.end)]
        contact = k * sum(QUADRATIC[i, j] * float(np.vdot(every[i].normal, moments[j])) for i, j in PAIRS)
        # Complementary up to rounding, it may come out as −0.
        contact = max(contact, 0.0)
        m = setting.monotonicity
        growth, decay = np.exp(max(-m, 0.0) * k), np.exp(-max(m, 0.0) * k)
        return Interval(
            a=piece.a,
            b=piece.b,
            at_a=y,
            at_b=float(growth * (np.sqrt((decay * y) ** 2 + 2 * contact) + added)),
            inside=float(growth * (np.sqrt(y**2 + 2 * contact) + added)),
            residual=k * (float(np.sqrt(squares.sum())) + curvature),
            contact=contact,
            oscillation=k * float(np.sqrt(unbalanced.sum())),
            bending=bending,
        )

    def _bending(self, piece: Piece, *loads: Loads) -> float:
        """What P f differs from its parabola by a quarter into the piece, in the dual of V.

        The remainder of a cubic, θ(θ − ½)(θ − 1), is largest at θ = 0.21, and so is its mean absolute value less.
        """
        setting = self.setting
        quarter = setting.snapshot(piece.a + (piece.b - piece.a) / 4).loads
        parabola = 9 / 16 * loads[0] + 6 / 16 * loads[1] + 1 / 16 * loads[2]
        stress = setting.equilibrium.balance(quarter + (-1.0) * parabola).values
        return float(np.sqrt(self.products(stress, stress).sum()))

    def _elastic(self, piece: Piece, left: Knot, right: Knot) -> tuple[Tensors, float]:
        """The middle coefficient of Gε(ũ) as a parabola in time, and the mean of ‖Gε(ũ) − parabola‖_{A⁻¹}."""
        setting = self.setting
        G, k = setting.data.law.G, piece.b - piece.a
        if isinstance(G, Linear):
            return self._G(setting.strain(piece.control)), 0.0
        rates = [np.linalg.norm(setting.strain(piece.rate(end)), axis=0) for end in (False, True)]
        change = G.lipschitz * k * np.maximum(*rates) / 3
        if isinstance(G, Yield):
            held = [left.elastic, self._G(setting.strain(piece.control)), right.elastic]
            change[np.all([abs(g).max(axis=0) == 0 for g in held], axis=0)] = 0.0
        size = float(np.sqrt(np.vdot(setting.stresses.weights, change**2) / setting.data.law.A.ellipticity))
        return (left.elastic + right.elastic) / 2, size

"""The normal strain q(s, t) = ε_nn on a contact face, from the pressure p(s, t) = −σ_ν.

Linear law: on the face only ε_nn is not zero, so σ_ν = a q̇ + g q with a = A_nnnn, g = G_nnnn, and

    a q̇ + g q = −p,   q(s, 0) = q_0(s)
    q(s, t) = e^{−λt} q_0(s) − ∫_0^t e^{−λ(t−r)} p(s, r)/a dr,   λ = g/a.

The pressure must be chosen first: a strain prescribed under a receding front would pull (σ_ν > 0).
After release p = 0 and q decays like e^{−λt}: the material remembers the contact.

Law (3.3): the strain is prescribed phase by phase and the pressure follows from the law.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from manufactured.symbols import Index, Jet, Values, differentiate, function, pos, s, t
from manufactured.tensors import Array


class FormulaError(ValueError):
    """A formula of a case lies outside the class that can be integrated exactly."""


class StrainAtPoints(Protocol):
    """q and q̇ at fixed points of the face, with derivatives along the face up to an order."""

    def __call__(self, time: complex, order: int) -> tuple[Values, Values]: ...


class NormalStrain(Protocol):
    """q(s, t) on a face; ``at`` fixes the points s (d−1, ...) and keeps what time does not change."""

    def at(self, points: Array) -> StrainAtPoints: ...


@dataclass(frozen=True, eq=False)
class Memory:
    """q of a linear law, in closed form for a pressure that is piecewise polynomial in t.

    Every term of the expanded pressure is θ(s, t)·∏ pos(ψ_i(s, t), m_i) with θ and the ψ_i that
    move polynomial in t and, for these, integer m_i ≥ 1. At each s the roots of the ψ_i split
    [0, T] into intervals of contact, on which p is a polynomial P(s, ·). There

        ∫ e^{λr} P(s, r)/a dr = e^{λr} R(s, r),   R = Σ_j (−1)^j ∂_r^j P / (a λ^{j+1}),

    and since p vanishes where a moving contact begins and ends, derivatives along the face pass
    under the integral: ∂_s^i q is the same expression with ∂_s^i R.

    Attributes:
        pressure: p(s, t).
        viscosity, elasticity: a and g, positive.
        T: final time.
        initial: q_0(s); without it −p(s, 0)/g, the elastic equilibrium.

    Raises:
        FormulaError: the pressure is not of this form.
    """

    pressure: sp.Expr
    viscosity: float
    elasticity: float
    T: float
    initial: sp.Expr | None = None
    variables: tuple[sp.Symbol, ...] = (s,)

    @property
    def decay(self) -> float:
        """λ = g/a."""
        return self.elasticity / self.viscosity

    @cached_property
    def start(self) -> Jet:
        """The jet of q_0."""
        elastic = -self.pressure.subs(t, 0) / self.elasticity
        return Jet(elastic if self.initial is None else self.initial, self.variables)

    @cached_property
    def pressure_jet(self) -> Jet:
        return Jet(self.pressure, self.variables)

    @cached_property
    def terms(self) -> tuple[Term, ...]:
        expanded = sp.expand(self.pressure)
        return tuple(
            Term.of(term, self.variables, self.viscosity, self.decay)
            for term in sp.Add.make_args(expanded)
            if term != 0
        )

    def at(self, points: Array) -> StrainAtPoints:
        return _MemoryAtPoints(self, points)


@dataclass(frozen=True, eq=False)
class Term:
    """One additive term of the pressure with its antiderivative.

    Attributes:
        moving: coefficient functions (s) ↦ [ψ's coefficients in t, highest first] of each moving ψ.
        antiderivative: R(s, r).
    """

    moving: tuple[Callable[..., list[Array]], ...]
    antiderivative: sp.Expr
    variables: tuple[sp.Symbol, ...]
    _compiled: dict[Index, Callable[..., list[Array]]] = field(default_factory=dict, init=False, repr=False)

    @classmethod
    def of(cls, term: sp.Expr, variables: tuple[sp.Symbol, ...], viscosity: float, decay: float) -> Term:
        fronts = [p for p in term.atoms(pos) if p.args[0].has(t)]
        smooth = term.subs({p: p.args[0] ** p.args[1] for p in fronts})
        for front in fronts:
            if not (front.args[0].is_polynomial(t) and front.args[1].is_integer and front.args[1] >= 1):
                raise FormulaError(
                    f"{front}: a front that moves needs pos(ψ, m) with ψ polynomial in t and an integer m ≥ 1; "
                    "replace other motions by a polynomial, the contact zone is yours to choose"
                )
        if not smooth.is_polynomial(t):
            raise FormulaError(
                f"the pressure term {term} is not polynomial in t between its fronts, "
                "so its memory has no closed form; use a polynomial in t"
            )
        power, sign = 1 / sp.Float(decay), 1
        total, derivative = sp.Integer(0), sp.Poly(smooth, t)
        while not derivative.is_zero:
            total += sign * power * derivative.as_expr()
            derivative, sign, power = derivative.diff(t), -sign, power / decay
        moving = tuple(function(variables, sp.Poly(front.args[0], t).all_coeffs()) for front in fronts)
        nested = sp.Integer(0)
        for coefficient in sp.Poly(total / viscosity, t).all_coeffs():
            nested = nested * t + coefficient
        return cls(moving, nested, variables)

    def integral(self, points: Array, time: Array | complex, index: Index) -> Array:
        """∂_s^index R(s, r) at r = time."""
        if index not in self._compiled:
            formula = differentiate(self.antiderivative, self.variables, index)
            self._compiled[index] = function([*self.variables, t], [formula])
        return np.broadcast_to(self._compiled[index](*points, time)[0], points.shape[1:])

    def intervals(self, points: Array, T: float) -> tuple[Array, Array]:
        """Entry and exit times of contact at each point: two arrays (J, N), equal where unused."""
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


class _MemoryAtPoints:
    """q and q̇ at fixed points: entry and exit times and what they contribute are computed once."""

    def __init__(self, memory: Memory, points: Array) -> None:
        self.memory = memory
        self.points = points
        self.flat = points.reshape(points.shape[0], -1)
        self.contacts = [
            _Contact(term, self.flat, entry, exit_, memory.decay)
            for term in memory.terms
            for entry, exit_ in zip(*term.intervals(self.flat.real, memory.T), strict=True)
            if (entry < exit_).any()
        ]
        self._start: dict[int, Values] = {}
        self._last: tuple[complex, int, tuple[Values, Values]] | None = None

    def __call__(self, time: complex, order: int) -> tuple[Values, Values]:
        # A stress asks for strain and strain rate at the same time, which are found together.
        if self._last is None or self._last[:2] != (time, order):
            self._last = time, order, self._evaluate(time, order)
        return self._last[2]

    def _evaluate(self, time: complex, order: int) -> tuple[Values, Values]:
        memory, shape = self.memory, self.points.shape[1:]
        if order not in self._start:
            self._start[order] = memory.start(self.flat, 0.0, order)
        pressure = memory.pressure_jet(self.points, time, order)
        strain, rate = {}, {}
        fading = np.exp(-memory.decay * time)
        for index, start in self._start[order].items():
            total = (fading * start).astype(np.result_type(self.flat, time))
            for contact in self.contacts:
                contact.add(total, -fading, time, index)
            strain[index] = total.reshape(shape)
            rate[index] = (pressure[index] + memory.elasticity * strain[index]) / -memory.viscosity
        return strain, rate


class _Contact:
    """∫ e^{λr} ∂^i P/a dr over one interval of contact per point, from its entry to now or its exit."""

    def __init__(self, term: Term, points: Array, entry: Array, exit_: Array, decay: float) -> None:
        self.term, self.decay = term, decay
        self.touched = np.flatnonzero(entry < exit_)
        self.points = points[:, self.touched]
        self.entry, self.exit = entry[self.touched], exit_[self.touched]
        self._ends: dict[Index, tuple[Array, Array]] = {}

    def antiderivative(self, which: NDArray[np.intp] | slice, time: Array | complex, index: Index) -> Array:
        return np.exp(self.decay * time) * self.term.integral(self.points[:, which], time, index)

    def add(self, total: Array, factor: complex, time: complex, index: Index) -> None:
        """total += factor · integral up to ``time``, at the points that are ever touched."""
        if index not in self._ends:
            first, last = (self.antiderivative(slice(None), end, index) for end in (self.entry, self.exit))
            self._ends[index] = first, last - first
        first, whole = self._ends[index]
        now = np.real(time)
        over = self.exit <= now
        now_touching = np.flatnonzero((self.entry < now) & ~over)
        value = np.where(over, whole, 0.0).astype(np.result_type(whole, time))
        if now_touching.size:
            value[now_touching] = self.antiderivative(now_touching, time, index) - first[now_touching]
        total[self.touched] += factor * value


@dataclass(frozen=True, eq=False)
class Prescribed:
    """q given phase by phase in time: ``phases`` are pairs (end of the phase, formula of q(s, t)).

    The last phase ends at T. The formulas must agree at the ends, which the self-proof of a case
    checks; the pressure is what the law makes of q and q̇.
    """

    phases: tuple[tuple[float, sp.Expr], ...]
    variables: tuple[sp.Symbol, ...] = (s,)

    @cached_property
    def _jets(self) -> tuple[tuple[float, Jet, Jet], ...]:
        jets = [(end, Jet(formula, self.variables)) for end, formula in self.phases]
        return tuple((end, jet, jet.rate()) for end, jet in jets)

    def at(self, points: Array) -> StrainAtPoints:
        def strain(time: complex, order: int) -> tuple[Values, Values]:
            jet, rate = next(((jet, rate) for end, jet, rate in self._jets if np.real(time) <= end), self._jets[-1][1:])
            return jet(points, time, order), rate(points, time, order)

        return strain

"""The strain (q, r) on a contact face, q = ε_nn and r = 2ε_sn, from the pressure p(s, t) = −σ_ν.

Linear law: where it does not couple nn with sn, only ε_nn is not zero on the face, so
σ_ν = a q̇ + g q with a = A_nnnn, g = G_nnnn, and

    a q̇ + g q = −p,   q(s, 0) = q_0(s)
    q(s, t) = e^{−λt} q_0(s) − ∫_0^t e^{−λ(t−r)} p(s, r)/a dr,   λ = g/a.

In a heterogeneous body a and g are formulas of s with a constant ratio λ. A law that couples nn
with sn needs a shear r that keeps σ_τ = 0: with y = (q, r) and the blocks of moduli 𝒜, 𝒢,
𝒜 ẏ + 𝒢 y = (−p, 0), which falls apart into d such equations in the basis of its modes.

The pressure must be chosen first: a strain prescribed under a receding front would pull (σ_ν > 0).
After release p = 0 and q decays like e^{−λt}: the material remembers the contact.

Law (3.3): the strain is prescribed phase by phase and the pressure follows from the law.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
import sympy as sp

from manufactured.symbols import FormulaError, Jet, Values, function, pos, s, t
from manufactured.tensors import Array

Components = tuple[Values, ...]
"""(q,) where there is no shear on the face, else (q, r_1, …, r_{d−1}), with derivatives along the face."""


class StrainAtPoints(Protocol):
    """(q, r) and its rate at fixed points of the face, with derivatives along the face up to an order."""

    def __call__(self, time: complex, order: int) -> tuple[Components, Components]: ...


class FaceStrain(Protocol):
    """(q, r)(s, t) on a face; ``at`` fixes the points s (d−1, ...) and keeps what time does not change.

    ``formula`` has the truncated powers that q, or the pressure it comes from, is made of.
    """

    @property
    def formula(self) -> sp.Expr: ...

    def at(self, points: Array) -> StrainAtPoints: ...


def rate(elasticity: sp.Expr | float, viscosity: sp.Expr | float) -> float:
    """g/a, which has to be a number.

    Raises:
        FormulaError: it varies along the face.
    """
    ratio = sp.simplify(sp.sympify(elasticity) / viscosity)
    if ratio.free_symbols:
        raise FormulaError(
            f"the relaxation rate g/a = {ratio} varies along the face; let the factors of A and G agree on the "
            "contact face up to a constant, and differ inside"
        )
    return float(ratio)


@dataclass(frozen=True, eq=False)
class Memory:
    """q of a linear law, to round-off for a pressure that is piecewise polynomial in t.

    Every term of the expanded pressure is θ(s, t)·∏ pos(ψ_i(s, t), m_i) with θ and the ψ_i that
    move polynomial in t and, for these, integer m_i ≥ 2. At each s the roots of the ψ_i split
    [0, T] into intervals of contact, on which p is a polynomial P(s, ·). There

        ∫ e^{λr} P(s, r)/a dr = e^{λr} R(s, r),   R = Σ_j (−1)^j ∂_r^j P / (a λ^{j+1}),

    or by quadrature, to the same accuracy, where λT is so small that the terms of R cancel. Since p
    vanishes where a moving contact begins and ends, derivatives along the face pass
    under the integral: ∂_s^i q is the same expression with ∂_s^i P.

    Attributes:
        pressure: p(s, t).
        viscosity, elasticity: a and g, positive numbers, or formulas of s with a constant ratio.
        T: final time.
        initial: q_0(s); without it −p(s, 0)/g, the elastic equilibrium.

    Raises:
        FormulaError: the pressure is not of this form.
    """

    pressure: sp.Expr
    viscosity: sp.Expr | float
    elasticity: sp.Expr | float
    T: float
    initial: sp.Expr | None = None
    variables: tuple[sp.Symbol, ...] = (s,)

    def __post_init__(self) -> None:
        self.decay  # refused where it is written, not where it is used  # noqa: B018

    @property
    def formula(self) -> sp.Expr:
        """The pressure and the initial strain: what q is made of."""
        return self.pressure + (0 if self.initial is None else self.initial)

    @cached_property
    def decay(self) -> float:
        """λ = g/a."""
        return rate(self.elasticity, self.viscosity)

    @property
    def source(self) -> sp.Expr:
        """p/a."""
        return self.pressure / self.viscosity

    @cached_property
    def start(self) -> Jet:
        """The jet of q_0."""
        elastic = -self.pressure.subs(t, 0) / self.elasticity
        return Jet(elastic if self.initial is None else self.initial, self.variables)

    @cached_property
    def source_jet(self) -> Jet:
        return Jet(self.source, self.variables)

    @cached_property
    def terms(self) -> tuple[Term, ...]:
        branches: dict[tuple[sp.Expr, ...], sp.Expr] = {}
        for term in sp.Add.make_args(sp.expand(self.pressure)):
            fronts, branch = smooth_branch(term, self.variables)
            branches[fronts] = branches.get(fronts, sp.Integer(0)) + branch / self.viscosity
        return tuple(
            Term.of(fronts, branch, self.variables, self.decay) for fronts, branch in branches.items() if branch != 0
        )

    def at(self, points: Array) -> StrainAtPoints:
        return _MemoryAtPoints(self, points)


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


def smooth_branch(term: sp.Expr, variables: tuple[sp.Symbol, ...]) -> tuple[tuple[sp.Expr, ...], sp.Expr]:
    """A term of p as its moving fronts ψ and what it is where all ψ > 0.

    Raises:
        FormulaError: a front whose ψ is not a polynomial of t, or a term that is none between its fronts.
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
class Term:
    """The terms of p/a with the same moving fronts.

    Attributes:
        moving: coefficient functions (s) ↦ [ψ's coefficients in t, highest first] of each moving ψ.
        convolution: the memory of their smooth branch.
    """

    moving: tuple[Callable[..., list[Array]], ...]
    convolution: Convolution

    @classmethod
    def of(cls, fronts: tuple[sp.Expr, ...], branch: sp.Expr, variables: tuple[sp.Symbol, ...], decay: float) -> Term:
        moving = tuple(function(variables, sp.Poly(front, t).all_coeffs()) for front in fronts)
        return cls(moving, Convolution(sp.Poly(branch, t), variables, decay))

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
        self.contacts = [_Contact(term, self.flat, memory) for term in memory.terms]
        self._start: dict[int, Values] = {}
        self._last: tuple[complex, int, tuple[Components, Components]] | None = None

    def __call__(self, time: complex, order: int) -> tuple[Components, Components]:
        # A stress asks for strain and strain rate at the same time, which are found together.
        if self._last is None or self._last[:2] != (time, order):
            self._last = time, order, self._evaluate(time, order)
        return self._last[2]

    def _evaluate(self, time: complex, order: int) -> tuple[Components, Components]:
        memory, shape = self.memory, self.points.shape[1:]
        if order not in self._start:
            self._start[order] = memory.start(self.flat, 0.0, order)
        source = memory.source_jet(self.points, time, order)
        fading = np.exp(-memory.decay * time)
        totals = {
            index: (fading * start).astype(np.result_type(self.flat, time))
            for index, start in self._start[order].items()
        }
        for contact in self.contacts:
            contact.subtract(totals, time, order)
        strain = {index: total.reshape(shape) for index, total in totals.items()}
        rate = {index: -source[index] - memory.decay * value for index, value in strain.items()}
        return (strain,), (rate,)


class _Contact:
    """∫ e^{−λ(t−r)} ∂^i P dr of one term over all intervals of contact, from entry to now or exit.

    Attributes:
        touched: the point of each interval, (M,); a point may have several.
        entry, exit: (M,).
    """

    def __init__(self, term: Term, points: Array, memory: Memory) -> None:
        self.convolution, self.decay = term.convolution, memory.decay
        entry, exit_ = term.intervals(points.real, memory.T)
        used = entry < exit_
        self.touched = np.nonzero(used)[1]
        self.points = points[:, self.touched]
        self.entry, self.exit = entry[used], exit_[used]
        self._found: dict[int, tuple[Values, Values]] = {}

    def subtract(self, totals: Values, time: complex, order: int) -> None:
        """totals[i] −= the integral up to ``time`` for ∂^i, at the points that are ever touched."""
        taylor, whole = self._at_entry(order)
        now = np.real(time)
        over = np.flatnonzero(self.exit <= now)
        if over.size:
            since = np.exp(-self.decay * (time - self.exit[over]))
            for index, total in totals.items():
                np.subtract.at(total, self.touched[over], since * whole[index][over])
        touching = np.flatnonzero((self.entry < now) & (self.exit > now))
        if touching.size:
            weights = self.convolution.weights(time - self.entry[touching])
            every = touching.size == self.entry.size
            for index, total in totals.items():
                mine = taylor[index] if every else taylor[index][:, touching]
                # A point touches in one interval at a time.
                total[self.touched[touching]] -= np.einsum("jn,jn->n", mine, weights)

    def _at_entry(self, order: int) -> tuple[Values, Values]:
        """Taylor coefficients at the entry, and the integral up to the exit."""
        if order not in self._found:
            taylor = self.convolution.taylor(self.points, self.entry, order)
            weights = self.convolution.weights(self.exit - self.entry)
            whole = {index: np.einsum("jn,jn->n", value, weights) for index, value in taylor.items()}
            self._found[order] = taylor, whole
        return self._found[order]


@dataclass(frozen=True, eq=False)
class Coupled:
    """(q, r) of a linear law that couples nn with sn: y = Σ_i x_i η_i over the modes of 𝒜 ẏ + 𝒢 y = (−p, 0).

    With XᵀAX = I and 𝒢 x_i = λ_i 𝒜 x_i, η̇_i + λ_i η_i = −(x_i)_0 p is a ``Memory`` of its own.

    Attributes:
        pressure: p(s, t).
        modes: the memories of the η_i.
        vectors: the x_i as columns, (d, d).
    """

    pressure: sp.Expr
    modes: tuple[Memory, ...]
    vectors: Array

    @classmethod
    def of(
        cls,
        pressure: sp.Expr,
        viscous: Array,
        elastic: Array,
        scale: sp.Expr,
        T: float,
        variables: tuple[sp.Symbol, ...],
    ) -> Coupled:
        """From the blocks 𝒜 and 𝒢, (d, d), both times a formula of s; in elastic equilibrium at t = 0."""
        inverse = np.linalg.inv(np.linalg.cholesky(viscous))
        rates, basis = np.linalg.eigh(inverse @ elastic @ inverse.T)
        vectors = inverse.T @ basis
        modes = tuple(
            Memory(sp.Float(x) * pressure, scale, float(rate) * scale, T, variables=variables)
            for rate, x in zip(rates, vectors[0], strict=True)
        )
        return cls(pressure, modes, vectors)

    @property
    def formula(self) -> sp.Expr:
        """The pressure."""
        return self.pressure

    def at(self, points: Array) -> StrainAtPoints:
        modes = [mode.at(points) for mode in self.modes]

        def combine(values: list[Values]) -> Components:
            return tuple(
                {index: sum(x * v[index] for x, v in zip(row, values, strict=True)) for index in values[0]}
                for row in self.vectors
            )

        def strain(time: complex, order: int) -> tuple[Components, Components]:
            found = [mode(time, order) for mode in modes]
            return combine([s for (s,), _ in found]), combine([r for _, (r,) in found])

        return strain


@dataclass(frozen=True, eq=False)
class Prescribed:
    """q given phase by phase in time: ``phases`` are pairs (end of the phase, formula of q(s, t)).

    The last phase ends at T. The formulas must agree at the ends, which the self-proof of a case
    checks; the pressure is what the law makes of q and q̇.
    """

    phases: tuple[tuple[float, sp.Expr], ...]
    variables: tuple[sp.Symbol, ...] = (s,)

    @property
    def formula(self) -> sp.Expr:
        """Every phase."""
        return sum((formula for _, formula in self.phases), sp.Integer(0))

    @cached_property
    def _jets(self) -> tuple[tuple[float, Jet, Jet], ...]:
        jets = [(end, Jet(formula, self.variables)) for end, formula in self.phases]
        return tuple((end, jet, jet.rate()) for end, jet in jets)

    def at(self, points: Array) -> StrainAtPoints:
        def strain(time: complex, order: int) -> tuple[Components, Components]:
            jet, rate = next(((jet, rate) for end, jet, rate in self._jets if np.real(time) <= end), self._jets[-1][1:])
            return (jet(points, time, order),), (rate(points, time, order),)

        return strain

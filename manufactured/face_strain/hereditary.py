"""The strain on a contact face for a linear law, which depends on the history of the pressure."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache, partial

import numpy as np
import sympy as sp

from manufactured.arguments import Size, checked
from manufactured.face_strain.contact_times import PressureTerm, smooth_branch
from manufactured.face_strain.fronts import front
from manufactured.face_strain.integrals import Started, integral
from manufactured.face_strain.strain_on_face import Components, StrainAtPoints, relaxation_rate
from manufactured.jet import Jet
from manufactured.symbols import FormulaError, Symbols, Values, s, t
from manufactured.tensors import Array, Time

NO_STRESS = sp.Integer(0)
RECENT = 3
"""Number of times for which computed values of the strain are cached."""


@dataclass(frozen=True, eq=False)
@checked(FormulaError)
class Memory:
    """The normal strain q on a contact face for a linear law, computed from the history of the contact pressure p.

    q is the solution of a q̇ + g q = −(p + l), exact up to rounding; l is the normal stress that a slip of the face
    causes, 0 without slip. p + l must be a sum of terms θ(s, t)·∏ pos(ψ_i(s, t), m_i), where moving ψ_i are contact
    fronts. θ and the moving ψ_i must be smooth in t, and the m_i of moving ψ_i must be integers ≥ 2. At each s, the
    roots of the ψ_i divide [0, T] into intervals of contact (``fronts``), on which (p + l)/a is a smooth function
    P(s, ·). The integral of e^{−λ(t−r)} P is known in closed form if P is a polynomial of t; otherwise Gauss's rule is
    used (``integrals``). Since p vanishes where a moving contact begins and ends, ∂_s^i q is the same expression with
    ∂_s^i P.

    Attributes:
        pressure: the formula of p(s, t).
        viscosity, elasticity: the normal moduli a and g, positive numbers, or formulas of s with a constant ratio.
        T: the final time.
        initial: the formula of q(s, 0). By default q starts at rest, q = −(p + l)/g: without slip, the body starts in
            elastic equilibrium.
        variables: the coordinates along the face.
        slip_stress: the formula of l(s, t).

    Raises:
        FormulaError: the pressure is not of this form.
    """

    pressure: sp.Expr
    viscosity: sp.Expr
    elasticity: sp.Expr
    T: Size
    initial: sp.Expr | None = None
    variables: Symbols = (s,)
    slip_stress: sp.Expr = NO_STRESS

    def __post_init__(self) -> None:
        self.decay  # refuse a wrong ratio when the face is made, not when it is used  # noqa: B018

    @property
    def formula(self) -> sp.Expr:
        """The formula from which the smoothness of the strain is read off: p + l plus the initial strain."""
        return self.load + (0 if self.initial is None else self.initial)

    @property
    def load(self) -> sp.Expr:
        """The formula of p + l, which drives the strain."""
        return self.pressure + self.slip_stress

    @cached_property
    def decay(self) -> float:
        """The relaxation rate λ = g/a, elasticity over viscosity."""
        return relaxation_rate(self.elasticity, self.viscosity)

    @cached_property
    def start(self) -> Jet:
        """The initial strain q(s, 0) as a formula with its derivatives."""
        elastic = -self.load.subs(t, 0) / self.elasticity
        return Jet(elastic if self.initial is None else self.initial, self.variables)

    @cached_property
    def source_jet(self) -> Jet:
        """(p + l)/a, load over viscosity, as a formula with its derivatives."""
        return Jet(self.load / self.viscosity, self.variables)

    @cached_property
    def terms(self) -> tuple[PressureTerm, ...]:
        """The terms of (p + l)/a, load over viscosity; terms with the same moving fronts are added up."""
        branches: dict[tuple[sp.Expr, ...], sp.Expr] = {}
        for term in sp.Add.make_args(sp.expand(self.load)):
            fronts, branch = smooth_branch(term, self.variables)
            branches[fronts] = branches.get(fronts, sp.Integer(0)) + branch / self.viscosity
        return tuple(
            PressureTerm(
                tuple(front(formula, self.variables) for formula in fronts),
                integral(branch, self.variables, self.decay),
            )
            for fronts, branch in branches.items()
            if branch != 0
        )

    def at(self, points: Array) -> StrainAtPoints:
        return MemoryAtPoints(self, points)


class MemoryAtPoints:
    """Evaluates the normal strain q and its rate q̇ at fixed points of a face.

    The intervals of contact, and integrals over past intervals, are computed once.
    """

    def __init__(self, memory: Memory, points: Array) -> None:
        self.memory = memory
        self.points = points
        self.flat = points.reshape(points.shape[0], -1)
        self.contacts = [_ContactIntervals(term, self.flat, memory) for term in memory.terms]
        self._start = lru_cache(partial(memory.start, self.flat, 0.0))
        # Strains are cached, because a stress needs strain and strain rate at one time, and several computations need
        # the same times.
        self._found = lru_cache(RECENT)(self._strain)

    def __call__(self, time: Time, rate: bool, order: int) -> Components:
        strain = self._found(tuple(time) if isinstance(time, np.ndarray) else time, order)
        if not rate:
            return (strain,)
        places = self.points.reshape(*self.points.shape, *(1,) * np.ndim(time))
        source = self.memory.source_jet(places, time, order)
        return ({index: -source[index] - self.memory.decay * value for index, value in strain.items()},)

    def _strain(self, when: tuple[float, ...] | complex, order: int) -> Values:
        """Return the strain q at one or several times, with its derivatives along the face up to an order."""
        time = np.array(when) if isinstance(when, tuple) else when
        memory, shape = self.memory, (*self.points.shape[1:], *np.shape(time))
        fading = np.exp(-memory.decay * time)
        kind = np.result_type(self.flat, time)
        totals = {
            index: np.multiply.outer(start, fading).astype(kind, copy=False)
            for index, start in self._start(order).items()
        }
        for contact in self.contacts:
            contact.subtract(totals, time, order)
        return {index: total.reshape(shape) for index, total in totals.items()}


class _ContactIntervals:
    """Computes the integrals ∫ e^{−λ(t−r)} ∂_s^i P dr of a term of the pressure over all intervals of contact before
    t.

    Attributes:
        touched: for each of the M intervals, the number of its point, (M,). A point may have several intervals.
        entry, exit: the times at which contact begins and ends, (M,) each.
    """

    def __init__(self, term: PressureTerm, points: Array, memory: Memory) -> None:
        self.integral, self.decay = term.integral, memory.decay
        entry, exit_ = term.intervals(points.real, memory.T)
        used = entry < exit_
        self.touched = np.nonzero(used)[1]
        self.points = points[:, self.touched]
        self.entry, self.exit = entry[used], exit_[used]
        self._integrals = lru_cache(self._start)

    def _start(self, order: int) -> tuple[Started, Values]:
        """Return the integrals from the entry into contact as functions of time, and their values at the exit."""
        started = self.integral.started(self.points, self.entry, self.exit, order)
        return started, started.upto(self.exit, np.arange(self.exit.size))

    def subtract(self, totals: Values, time: Time, order: int) -> None:
        """Subtract the integrals up to one or several times from the strains ``totals``, for every derivative."""
        started, whole = self._integrals(order)
        times, entry, exit_ = np.atleast_1d(time), self.entry[:, None], self.exit[:, None]
        now = times.real
        over, when = np.nonzero(exit_ <= now)
        if over.size:
            since = np.exp(-self.decay * (times[when] - self.exit[over]))
            places = self.touched[over] * len(times) + when
            for index, total in totals.items():
                np.subtract.at(total.reshape(-1), places, since * whole[index][over])
        touching, when = np.nonzero((entry < now) & (exit_ > now))
        if touching.size:
            found = started.upto(times[when], touching)
            # No index occurs twice, because at any time a point belongs to at most one interval of contact. So ``-=``
            # is safe.
            places = self.touched[touching] * len(times) + when
            for index, total in totals.items():
                total.reshape(-1)[places] -= found[index]


@dataclass(frozen=True, eq=False)
@checked(FormulaError)
class Coupled:
    """The strain on a contact face for a linear law that couples the normal strain q with the shear strain r.

    y = (q, r) satisfies 𝒜 ẏ + 𝒢 y = −(p, 0) − l with the contact pressure p, the stress l that a slip of the face
    causes, and matrices 𝒜, 𝒢 of moduli. The solution is y = Σ_i x_i η_i with the eigenvectors x_i, for which
    𝒢 x_i = λ_i 𝒜 x_i and Xᵀ𝒜X = I. Each η_i is the solution of η̇_i + λ_i η_i = −x_i·((p, 0) + l), a scalar equation
    that ``Memory`` solves.

    Attributes:
        pressure: the formula of p(s, t).
        modes: the solutions η_i.
        vectors: the eigenvectors x_i as columns, (d, d).
    """

    pressure: sp.Expr
    modes: tuple[Memory, ...]
    vectors: Array

    @classmethod
    @checked(FormulaError)
    def of(
        cls,
        pressure: sp.Expr,
        slip_stress: tuple[sp.Expr, ...],
        viscous: Array,
        elastic: Array,
        scale: sp.Expr,
        T: float,
        initial: sp.Expr | None,
        variables: Symbols,
    ) -> Coupled:
        """Return the strain on a face.

        Args:
            pressure: the formula of the contact pressure p(s, t).
            slip_stress: the formulas of the d components of l(s, t).
            viscous, elastic: the matrices 𝒜 and 𝒢 of moduli without a common factor, (d, d) each.
            scale: the formula of the common factor.
            T: the final time.
            initial: the formula of q(s, 0), with r(s, 0) = 0; None for a start at rest, q̇ = ṙ = 0.
            variables: the coordinates along the face.
        """
        inverse = np.linalg.inv(np.linalg.cholesky(viscous))
        rates, basis = np.linalg.eigh(inverse @ elastic @ inverse.T)
        vectors = inverse.T @ basis
        modes = tuple(
            Memory(
                sp.Float(x[0]) * pressure,
                scale,
                float(rate) * scale,
                T,
                None if initial is None else float(viscous[0] @ x) * initial,
                variables,
                x @ np.array(slip_stress, dtype=object),
            )
            for rate, x in zip(rates, vectors.T, strict=True)
        )
        return cls(pressure, modes, vectors)

    @property
    def formula(self) -> sp.Expr:
        """The formula from whose truncated powers the smoothness of the strain is read off."""
        return self.pressure + sum(mode.formula for mode in self.modes)

    def at(self, points: Array) -> StrainAtPoints:
        modes = [mode.at(points) for mode in self.modes]

        def strain(time: Time, rate: bool, order: int) -> Components:
            found = [mode(time, rate, order) for mode in modes]
            return tuple(
                {index: sum(x * v[index] for x, (v,) in zip(row, found, strict=True)) for index in found[0][0]}
                for row in self.vectors
            )

        return strain

"""The normal strain q on the face for a linear law: the hereditary integral of the pressure."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import sympy as sp

from manufactured.face_strain.contact_times import PressureTerm, smooth_branch
from manufactured.face_strain.convolution import Started
from manufactured.face_strain.strain_on_face import Components, StrainAtPoints, relaxation_rate
from manufactured.jet import Jet
from manufactured.symbols import Values, s, t
from manufactured.tensors import Array

RECENT = 3
"""Number of times for which values of q are stored."""


@dataclass(frozen=True, eq=False)
class Memory:
    """The normal strain q on the face for a linear law, exact up to rounding.

    Every term of the expanded pressure is θ(s, t)·∏ pos(ψ_i(s, t), m_i) with θ and the ψ_i that move smooth in t and,
    for these, integer m_i ≥ 2. At each s the roots of the ψ_i split [0, T] into intervals of contact (``fronts``), on
    which p is a smooth P(s, ·). Its hereditary integral is known in closed form where P is a polynomial of t
    (``convolution``); otherwise Gauss's rule is used (``quadrature``). Since p vanishes where a moving contact begins
    and ends, derivatives along the face pass under the integral: ∂_s^i q is the same expression with ∂_s^i P.

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
        """The pressure and the initial strain, from which q is computed."""
        return self.pressure + (0 if self.initial is None else self.initial)

    @cached_property
    def decay(self) -> float:
        """λ = g/a."""
        return relaxation_rate(self.elasticity, self.viscosity)

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
        """The jet of p/a."""
        return Jet(self.source, self.variables)

    @cached_property
    def terms(self) -> tuple[PressureTerm, ...]:
        """p/a, terms with the same moving fronts together."""
        branches: dict[tuple[sp.Expr, ...], sp.Expr] = {}
        for term in sp.Add.make_args(sp.expand(self.pressure)):
            fronts, branch = smooth_branch(term, self.variables)
            branches[fronts] = branches.get(fronts, sp.Integer(0)) + branch / self.viscosity
        return tuple(
            PressureTerm.of(fronts, branch, self.variables, self.decay)
            for fronts, branch in branches.items()
            if branch != 0
        )

    def at(self, points: Array) -> StrainAtPoints:
        return MemoryAtPoints(self, points)


class MemoryAtPoints:
    """q and q̇ at fixed points. Intervals of contact, and integrals over past intervals, are computed once."""

    def __init__(self, memory: Memory, points: Array) -> None:
        self.memory = memory
        self.points = points
        self.flat = points.reshape(points.shape[0], -1)
        self.contacts = [_ContactIntervals(term, self.flat, memory) for term in memory.terms]
        self._start: dict[int, Values] = {}
        # A stress needs strain and strain rate at the same time, and several trajectories need the same times.
        self._found = lru_cache(RECENT)(self._strain)

    def __call__(self, time: Array | complex, rate: bool, order: int) -> Components:
        strain = self._found(tuple(time) if isinstance(time, np.ndarray) else time, order)
        if not rate:
            return (strain,)
        places = self.points.reshape(*self.points.shape, *(1,) * np.ndim(time))
        source = self.memory.source_jet(places, time, order)
        return ({index: -source[index] - self.memory.decay * value for index, value in strain.items()},)

    def _strain(self, when: tuple[float, ...] | complex, order: int) -> Values:
        """q."""
        time = np.array(when) if isinstance(when, tuple) else when
        memory, shape = self.memory, (*self.points.shape[1:], *np.shape(time))
        if order not in self._start:
            self._start[order] = memory.start(self.flat, 0.0, order)
        fading = np.exp(-memory.decay * time)
        kind = np.result_type(self.flat, time)
        totals = {
            index: np.multiply.outer(start, fading).astype(kind, copy=False)
            for index, start in self._start[order].items()
        }
        for contact in self.contacts:
            contact.subtract(totals, time, order)
        return {index: total.reshape(shape) for index, total in totals.items()}


class _ContactIntervals:
    """∫ e^{−λ(t−r)} ∂^i P dr of one term over all intervals of contact, from entry to exit or to the present time.

    Attributes:
        touched: the point of each interval, (M,); a point may have several.
        entry, exit: (M,).
    """

    def __init__(self, term: PressureTerm, points: Array, memory: Memory) -> None:
        self.integral, self.decay = term.integral, memory.decay
        entry, exit_ = term.intervals(points.real, memory.T)
        used = entry < exit_
        self.touched = np.nonzero(used)[1]
        self.points = points[:, self.touched]
        self.entry, self.exit = entry[used], exit_[used]
        self._found: dict[int, tuple[Started, Values]] = {}

    def subtract(self, totals: Values, time: Array | complex, order: int) -> None:
        """Subtract the integral up to ``time`` for ∂^i from totals[i], at the points that are ever in contact."""
        started, whole = self._started(order)
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
            # At any time, a point belongs to at most one interval of contact.
            places = self.touched[touching] * len(times) + when
            for index, total in totals.items():
                total.reshape(-1)[places] -= found[index]

    def _started(self, order: int) -> tuple[Started, Values]:
        """Return the integrals that start at the entries, and their values at the exits."""
        if order not in self._found:
            started = self.integral.started(self.points, self.entry, self.exit, order)
            self._found[order] = started, started.upto(self.exit, np.arange(self.exit.size))
        return self._found[order]

"""Contact data on a straight piece of Γ3 that are lifted to a depth D(s, t), which varies along it and in time.

    u_s = −y ∂_s w φ(y/D),   u_n = (w + y q) φ(y/D),   φ(η) = (1 − η)²(1 + 2η) for η < 1, zero beyond,

y the distance into the body, n = −ν. As φ'(0) = 0, the variation of D along the face has no effect at y = 0: there
u_n = w, u_s = 0, ε_ss = ε_sn = 0 and ε_nn = q, as for a constant depth (``manufactured.contact``).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np
import sympy as sp

from manufactured.body import Part
from manufactured.compiled import function
from manufactured.contact.contact_face import distinct
from manufactured.jet import Jet
from manufactured.modes import Modes, at_each
from manufactured.symbols import Index, Values, indices, refuse_kinks, s, t
from manufactured.tensors import Array, Points, Tensors, Vectors, mandel, rotation

y = sp.Symbol("y", real=True)
"""The distance from the face."""


@lru_cache
def _lifting(rate: bool, order: int) -> Callable[..., list[Array]]:
    """Return formulas of ∂^i u_s and then of ∂^i u_n, |i| ≤ order, in y and in ∂_s^j of w, q and D, and of their rates.

    All faces share these long formulas. j goes up to order + 1 for w and up to order for q and D.
    """
    w, q, D = (sp.Function(name)(s, t) for name in "wqD")
    eta = y / D
    phi = 1 - (3 - 2 * eta) * eta**2
    fields = -y * w.diff(s) * phi, (w + y * q) * phi
    formulas = [field.diff(t, int(rate), s, i, y, j) for field in fields for i, j in indices(2, order)]
    values = [
        trace.diff(t, times, s, i)
        for times in range(rate + 1)
        for trace, more in ((w, 1), (q, 0), (D, 0))
        for i in range(order + more + 1)
    ]
    symbols = sp.symbols(f"v0:{len(values)}", real=True)
    # Higher derivatives first: they contain the lower ones.
    stated = dict(reversed([*zip(values, symbols, strict=True)]))
    return function((y, *symbols), [formula.doit().subs(stated) for formula in formulas])


@dataclass(frozen=True, eq=False)
class FadingFace:
    """A piece of Γ3 with its contact data and the depth of their lifting, as formulas of s and t.

    Attributes:
        part: the piece Γ3,i.
        gap: w(s, t), three times differentiable along the face almost everywhere.
        strain: q(s, t), the normal strain on the face.
        pressure: p(s, t), the pressure that the law gives for q; the self-proof checks this.
        level: ψ(s, t); the contact zone is stated to be {ψ ≥ 0}.
        depth: D(s, t) > 0.
        least_depth: the least value of D; quadrature meshes are refined in a strip of this depth.
        rough: coordinates s at which strains are singular for all times; there are none.

    Raises:
        FormulaError: a kink of a formula is not written with ``pos``.
    """

    part: Part
    gap: sp.Expr
    strain: sp.Expr
    pressure: sp.Expr
    level: sp.Expr
    depth: sp.Expr
    least_depth: float
    rough: tuple[float, ...] = field(default=(), init=False)

    def __post_init__(self) -> None:
        refuse_kinks(self.gap, self.strain, self.pressure, self.level, self.depth)

    @property
    def initial_gap(self) -> sp.Expr:
        """g = 0, as in the paper."""
        return sp.Integer(0)

    @cached_property
    def gap_jet(self) -> Jet:
        return Jet(self.gap)

    @cached_property
    def pressure_jet(self) -> Jet:
        return Jet(self.pressure)

    @cached_property
    def level_jet(self) -> Jet:
        return Jet(self.level)

    @cached_property
    def depth_jet(self) -> Jet:
        """The jet of D."""
        return Jet(self.depth)

    @cached_property
    def traces(self) -> tuple[Jet, Jet, Jet]:
        """The jets of w, q and D, which determine the lifting."""
        return self.gap_jet, Jet(self.strain), self.depth_jet

    @cached_property
    def trace_rates(self) -> tuple[Jet, Jet, Jet]:
        """The rates of the jets of w, q and D."""
        w, q, D = self.traces
        return w.rate(), q.rate(), D.rate()

    def traced(self, s: Array, time: complex, rate: bool, order: int) -> list[Array]:
        """Return the derivatives of w, q and D, and of their rates, that ``lifted`` needs, at coordinates s (1, n)."""
        jets = (*self.traces, *self.trace_rates) if rate else self.traces
        traces = [jet(s, time, order + more) for jet, more in zip(jets, (1, 0, 0) * 2, strict=False)]
        return [trace[i,] for trace in traces for i in range(len(trace))]

    def lifted(self, traced: Sequence[Array], into: Array, rate: bool, order: int) -> tuple[Values, Values]:
        """The derivatives of u_s and u_n, or of their rates, in (s, y) up to an order, at y < D, (n,)."""
        values = _lifting(rate, order)(into, *traced)
        values, keys = [np.broadcast_to(value, into.shape) for value in values], indices(2, order)
        tangential, normal = values[: len(keys)], values[len(keys) :]
        return dict(zip(keys, tangential, strict=True)), dict(zip(keys, normal, strict=True))

    @property
    def variables(self) -> tuple[sp.Symbol, ...]:
        return (s,)

    @property
    def exponents_in(self) -> sp.Expr:
        """The formula with the truncated powers of the pressure side."""
        return self.pressure

    def at(self, x: Points) -> Fading:
        """The lifted fields at fixed points of Ω̄, (2, ...)."""
        return Fading(self, x)


class Fading:
    """The fields of a ``FadingFace`` at fixed points; formulas are evaluated only at points within the depth D."""

    def __init__(self, face: FadingFace, x: Points) -> None:
        self.face, self.frame = face, face.part.frame
        self.turned = rotation(self.frame)
        places, into = face.part.coordinates(x)
        self.shape, self.y = into.shape, into.ravel()
        self.s, self.where = distinct(places.reshape(1, -1))

    def displacement(self, time: Array | complex, rate: bool = False) -> Vectors:
        """u (or u̇), (2, ...)."""
        return self._everywhere(lambda values: self.frame @ np.array([of[0, 0] for of in values]), time, rate, 0)

    def strain(self, time: Array | complex, rate: bool = False) -> Tensors:
        """ε(u) (or ε(u̇)), Mandel (3, ...)."""
        return self._everywhere(lambda values: self.turned @ _strain(values, (0, 0)), time, rate, 1)

    def strain_gradient(self, time: Array | complex, rate: bool = False) -> Array:
        """∂_j ε(u) (or of u̇), (3, 2, ...)."""

        def gradient(values: tuple[Values, Values]) -> Array:
            local = np.array([self.turned @ _strain(values, along) for along in ((1, 0), (0, 1))])
            return np.einsum("ji,iI...->Ij...", self.frame, local)

        return self._everywhere(gradient, time, rate, 2)

    def modes(self) -> Modes:
        """ε(u) as one product for each component and point, because this lifting is no sum of fewer products."""
        count = len(self.y)

        def amplitudes(time: Array | float, rate: bool) -> Array:
            return self.strain(time, rate).reshape(3, count, *np.shape(time))

        return Modes(np.eye(3), np.arange(count), np.ones((3, count)), np.arange(count), count, amplitudes)

    def _everywhere(
        self, of: Callable[[tuple[Values, Values]], Array], time: Array | complex, rate: bool, order: int
    ) -> Array:
        """Return, at all points, the function ``of`` the derivatives of (u_s, u_n), or of their rates, in (s, y)."""
        # The set of points within the depth changes with time.
        return at_each(time, lambda moment: self._at_one(of, moment, rate, order))

    def _at_one(self, of: Callable[[tuple[Values, Values]], Array], time: complex, rate: bool, order: int) -> Array:
        depth = np.real(self.face.depth_jet(self.s, time)[(0,)])
        inside = np.flatnonzero(np.real(self.y) < (depth if self.where is None else depth[self.where]))
        traced = self._traced(time, rate, order)
        values = of(self.face.lifted(traced(inside), self.y[inside], rate, order))
        found = np.zeros((*values.shape[:-1], len(self.y)), dtype=values.dtype)
        found[..., inside] = values
        return found.reshape(*found.shape[:-1], *self.shape)

    def _traced(self, time: complex, rate: bool, order: int) -> Callable[[Array], Sequence[Array]]:
        """Return a function from point indices to ``FadingFace.traced``, computed once for points with the same s."""
        where = self.where
        if where is None:
            return lambda chosen: self.face.traced(self.s[:, chosen], time, rate, order)
        found = self.face.traced(self.s, time, rate, order)
        return lambda chosen: [values[where[chosen]] for values in found]


def _strain(values: tuple[Values, Values], more: Index) -> Tensors:
    """∂^more of the Mandel strain in the axes (s, n), (3, n)."""
    gradient = [[of[i + more[0], j + more[1]] for i, j in ((1, 0), (0, 1))] for of in values]
    return mandel(np.array(gradient))

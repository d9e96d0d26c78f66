"""A contact face whose displacement reaches to a depth D(s, t) that varies along the face and in time.

For the gap w and the normal strain q on the face, the displacement is

    u_s = −y ∂_s w φ(y/D),   u_n = (w + y q) φ(y/D),   φ(η) = (1 − η)²(1 + 2η) for η < 1, zero beyond,

where y is the distance into the body and n = −ν. Since φ'(0) = 0, the variation of D has no effect at y = 0. There
u_n = w, u_s = 0, ε_ss = ε_sn = 0 and ε_nn = q, as for a constant depth (``manufactured.contact``).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
import sympy as sp

from manufactured.arguments import Size, checked
from manufactured.compiled import function
from manufactured.contact import StatedFace
from manufactured.contact.contact_face import distinct
from manufactured.jet import Jet
from manufactured.modes import Modes, at_each, pointwise
from manufactured.symbols import FormulaError, Function, Index, Values, indices, s, t
from manufactured.tensors import Array, Points, Tensors, Time, Vectors, mandel, rotation, size

y = sp.Symbol("y", real=True)
"""The symbol of the distance from the face into the body."""


@lru_cache
def _lifting(rate: bool, order: int) -> Function:
    """Return a function that computes the derivatives of u_s and u_n up to an order, or of their rates.

    Its arguments are y and the derivatives along the face of w (up to order + 1), q and D (up to the order). For rates,
    the time derivatives of these follow. All faces share these long formulas.
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
    # Higher derivatives are substituted first, because they contain the lower ones.
    stated = dict(reversed([*zip(values, symbols, strict=True)]))
    return function((y, *symbols), [formula.doit().subs(stated) for formula in formulas])


@dataclass(frozen=True, eq=False)
@checked(FormulaError)
class FadingFace(StatedFace):
    """A contact face whose displacement reaches to a variable depth; all data are formulas of s and t.

    Attributes:
        part, gap, pressure, level: see ``StatedFace``. The gap is three times differentiable along the face almost
            everywhere.
        strain: the normal strain q(s, t) on the face, which causes the pressure.
        depth: the depth D(s, t) > 0.
        least_depth: the smallest value of D; quadrature meshes are refined in a strip of this depth.

    Raises:
        FormulaError: a kink of a formula is not written with ``pos``.
    """

    strain: sp.Expr
    depth: sp.Expr
    least_depth: Size

    rough = ()

    @cached_property
    def traces(self) -> tuple[Jet, Jet, Jet]:
        """Gap w, strain q and depth D, which determine the displacement, as formulas with their derivatives."""
        return self.gap_jet, Jet(self.strain), Jet(self.depth)

    @cached_property
    def trace_rates(self) -> tuple[Jet, ...]:
        """The time derivatives of w, q and D as formulas with their derivatives."""
        return tuple(jet.rate() for jet in self.traces)

    def traced(self, s: Array, time: complex, rate: bool, order: int) -> list[Array]:
        """Return the derivatives of w, q and D along the face that ``lifted`` needs, at points s, (1, n).

        If ``rate`` is true, the derivatives of their rates follow.
        """
        jets = (*self.traces, *self.trace_rates) if rate else self.traces
        traces = [jet(s, time, order + more) for jet, more in zip(jets, (1, 0, 0) * 2, strict=False)]
        return [trace[i,] for trace in traces for i in range(len(trace))]

    def lifted(self, traced: Sequence[Array], into: Array, rate: bool, order: int) -> tuple[Values, Values]:
        """Return the derivatives of the displacements u_s and u_n in (s, y) up to an order, at points with y < D.

        Args:
            traced: the result of ``traced`` at the coordinates s of the points.
            into: the distances y of the points from the face, (n,).
            rate: whether to return the derivatives of the velocities instead.
            order: the highest order.
        """
        keys, values = indices(2, order), _lifting(rate, order)(into, *traced)
        both = np.array([np.broadcast_to(value, into.shape) for value in values]).reshape(2, len(keys), -1)
        u_s, u_n = (dict(zip(keys, component, strict=True)) for component in both)
        return u_s, u_n

    def at(self, x: Points) -> Fading:
        """Return the displacement field at fixed points of the body, (2, ...)."""
        return Fading(self, x)


class Fading:
    """The displacement field of a ``FadingFace`` at fixed points.

    Formulas are evaluated only at points within the depth of the face.
    """

    def __init__(self, face: FadingFace, x: Points) -> None:
        self.face, self.frame = face, face.part.frame
        self.turned = rotation(self.frame)
        places, into = face.part.coordinates(x)
        self.shape, self.y = into.shape, into.ravel()
        self.s, where = distinct(places.reshape(1, -1))
        self.where = np.arange(len(self.y)) if where is None else where

    def displacement(self, time: Time, rate: bool = False) -> Vectors:
        """Return the displacement u, or the velocity u̇ if ``rate`` is true, (2, ...)."""
        return self._everywhere(lambda values: self.frame @ np.array([of[0, 0] for of in values]), time, rate, 0)

    def strain(self, time: Time, rate: bool = False) -> Tensors:
        """Return the strain ε(u), or its rate if ``rate`` is true, in Mandel form, (3, ...)."""
        return self._everywhere(lambda values: self.turned @ _strain(values, (0, 0)), time, rate, 1)

    def strain_gradient(self, time: Time, rate: bool = False) -> Array:
        """Return the derivatives ∂_j of the strain, or of its rate if ``rate`` is true, (3, 2, ...)."""

        def gradient(values: tuple[Values, Values]) -> Array:
            local = np.array([self.turned @ _strain(values, along) for along in ((1, 0), (0, 1))])
            return np.einsum("ji,iI...->Ij...", self.frame, local)

        return self._everywhere(gradient, time, rate, 2)

    def modes(self) -> Modes:
        # There is no shorter sum of products, because the depth changes with time.
        return pointwise(self.strain, size(2), len(self.y))

    def _everywhere(self, of: Callable[[tuple[Values, Values]], Array], time: Time, rate: bool, order: int) -> Array:
        """Return a quantity, such as the strain, at all points; it is 0 at points deeper than D.

        Args:
            of: computes the quantity from the derivatives of (u_s, u_n), or of their rates if ``rate`` is true.
            time: one time or several times.
            rate: whether rates are needed.
            order: the highest order of derivatives that is needed.
        """

        def at_one(moment: complex) -> Array:
            depth = np.real(self.face.traces[-1](self.s, moment)[(0,)])
            inside = np.flatnonzero(np.real(self.y) < depth[self.where])
            # Formulas of s and t are evaluated once for points with the same s.
            used, place = np.unique(self.where[inside], return_inverse=True)
            traced = [values[place] for values in self.face.traced(self.s[:, used], moment, rate, order)]
            values = of(self.face.lifted(traced, self.y[inside], rate, order))
            found = np.zeros((*values.shape[:-1], len(self.y)), dtype=values.dtype)
            found[..., inside] = values
            return found.reshape(*found.shape[:-1], *self.shape)

        # Times are treated one by one, because the set of points within the depth changes with time.
        return at_each(time, at_one)


def _strain(values: tuple[Values, Values], more: Index) -> Tensors:
    """Return a derivative of the strain in the axes (s, n), in Mandel form, (3, n).

    Args:
        values: the derivatives of u_s and of u_n.
        more: the multi-index of the derivative.
    """
    gradient = [[of[i + more[0], j + more[1]] for i, j in ((1, 0), (0, 1))] for of in values]
    return mandel(np.array(gradient))

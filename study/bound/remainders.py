"""What samples of the data cannot see: bounds of f_0, f_2 and ε(u_0) less polynomials, from ranges of derivatives.

The majorant knows the data at quadrature points and at four times of each piece [a, b] of ũ, k = b − a. On a cell T
with centre z and half widths r let F be the Taylor polynomial of f(·, t) at z of degree j − 1 ≤ 3. Then

    |f − F| ≤ Σ_{|α| = j} r^α sup_{T×[a,b]} |∂^α f|/α!  =: e_T,    or  e_T = half the range of f for j = 0,

and the least of these counts, which is that of a low order where f has kinks. Every step of the computation is exact
for F, whose place f takes: the rules integrate products of degree 6, and their weights are positive. So for each norm
of the samples a term |T|^{1/2} e_T makes up for the difference, and (f − F) − P(f − F), which has no reason to be
orthogonal to rigid motions, is bounded by 2 C_Ω |T|^{1/2} e_T with C_Ω of ``study.bound.load_constants``. In time

    |f − (parabola through a, a + k/2 and b)|       ≤ (1 + Λ₃) min_j (k/2)^j |∂_t^j f|/j! =: p_T,   j ≤ 3,
    |f − (cubic through a, a + k/4, a + k/2 and b)| ≤ (1 + Λ₄) min_j (k/2)^j |∂_t^j f|/j! =: q_T,   j ≤ 4,

Λ the Lebesgue constants of these points, and half the range for j = 0. On edges of Γ2 the same holds with the arc
length in place of x, on each of the parts with a rule of their own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import sympy as sp

from manufactured.body import Kind, Part
from manufactured.data import Data, Expressions
from manufactured.factor import x1, x2
from manufactured.symbols import t
from manufactured.tensors import Array
from study.bound.ranges import Boxes, Series
from study.bound.univariate import Pair, require_known
from study.stresses.loads import EDGE_PARTS
from study.stresses.stress_space import StressSpace

ORDER = 4
"""One more than the degree of F."""
ARC = sp.Symbol("arc", real=True)
"""Arc length along a part."""


def lebesgue(nodes: Array) -> float:
    """The Lebesgue constant of some nodes on [0, 1], from a fine grid and rounded up by more than the grid misses."""
    x = np.linspace(0, 1, 4001)
    basis = [np.prod([(x - b) / (a - b) for b in np.delete(nodes, i)], axis=0) for i, a in enumerate(nodes)]
    return float(abs(np.array(basis)).sum(axis=0).max()) * 1.001


PARABOLA, CUBIC = (1 + lebesgue(np.array(nodes)) for nodes in ([0, 0.5, 1], [0, 0.25, 0.5, 1]))
"""1 + Λ for the relative times of the samples of a piece."""


@dataclass(frozen=True, eq=False)
class Remainders:
    """e, p and q on the cells or on the edges of Γ2, Euclidean over components, (boxes,) each."""

    space: Array
    parabola: Array
    cubic: Array

    def times(self, roots: Array) -> Remainders:
        """Those of the L² norms, from the roots of the sizes of cells or edges."""
        return Remainders(roots * self.space, roots * self.parabola, roots * self.cubic)


@dataclass(frozen=True, eq=False)
class Regions:
    """Cells, or the edges of a part: the sides of their boxes and the coordinates in which they are expanded."""

    sides: Mapping[sp.Symbol, Pair]

    @property
    def variables(self) -> tuple[sp.Symbol, ...]:
        return tuple(self.sides)

    @property
    def radii(self) -> Array:
        """Half the widths, (variables, boxes)."""
        return np.array([(high - low) / 2 for low, high in self.sides.values()])

    def in_space(self, formulas: Sequence[sp.Expr], a: float, b: float) -> Array:
        """e for a ≤ t ≤ b, (boxes,)."""
        boxes = self._boxes(a, b, self.variables)
        powers = [np.prod(self.radii ** np.array(key)[:, None], axis=0) for key in boxes.keys]

        def least(series: Series) -> Array:
            found = [(series.high[0] - series.low[0]) / 2]
            for order in range(1, ORDER + 1):
                terms = [i for i, key in enumerate(boxes.keys) if sum(key) == order]
                found.append(sum(_size(series, i) * powers[i] for i in terms))
            return np.minimum.reduce(found)

        return _norm(boxes, formulas, least)

    def in_time(self, formulas: Sequence[sp.Expr], a: float, b: float) -> tuple[Array, Array]:
        """p and q, (boxes,) each."""
        boxes, k = self._boxes(a, b, (t,)), b - a

        def through(points: int, factor: float) -> Callable[[Series], Array]:
            def bound(series: Series) -> Array:
                half = (series.high[0] - series.low[0]) / 2
                found = [half, *((k / 2) ** j * _size(series, j) for j in range(1, points + 1))]
                return factor * np.minimum.reduce(found)

            return bound

        return _norm(boxes, formulas, through(3, PARABOLA)), _norm(boxes, formulas, through(4, CUBIC))

    def _boxes(self, a: float, b: float, variables: tuple[sp.Symbol, ...]) -> Boxes:
        count = self.radii.shape[1]
        return Boxes({**self.sides, t: (np.full(count, a), np.full(count, b))}, variables, ORDER)


def _size(series: Series, term: int) -> Array:
    return np.maximum(abs(series.low[term]), abs(series.high[term]))


def _norm(boxes: Boxes, formulas: Sequence[sp.Expr], bound: Callable[[Series], Array]) -> Array:
    """The Euclidean norm of the bounds of all components; formulas that are 0 cost nothing."""
    found = np.zeros(boxes.count)
    for formula in formulas:
        if formula != 0:
            found = np.hypot(found, bound(boxes(formula)))
    return found


class Unseen:
    """The remainders of the data of a problem on one mesh.

    Raises:
        RangeError: a formula has a function whose derivatives have no ranges.
    """

    def __init__(self, data: Data, space: StressSpace, expressions: Expressions) -> None:
        self.expressions = expressions
        corners = space.mesh.p[:, space.mesh.t]
        self.cells = Regions({x: (c.min(axis=0), c.max(axis=0)) for x, c in zip((x1, x2), corners, strict=True)})
        loads = dict(expressions.loads)
        self.parts = []
        for part, edges in space.on(Kind.LOADED):
            formulas = [_along(part, formula) for formula in loads.get(data.body.parts.index(part), ())]
            self.parts.append((edges, _pieces(space, part, edges), formulas))
        self._edges = len(space.lengths)

    def force(self, a: float, b: float) -> Remainders:
        """Those of f_0 for a ≤ t ≤ b on the cells."""
        formulas = self.expressions.force
        return Remainders(self.cells.in_space(formulas, a, b), *self.cells.in_time(formulas, a, b))

    def surface(self, a: float, b: float) -> Remainders:
        """Those of f_2 on all edges, 0 off Γ2."""
        found = np.zeros((3, self._edges))
        for edges, region, formulas in self.parts:
            every = np.array([region.in_space(formulas, a, b), *region.in_time(formulas, a, b)])
            # The norms on the parts of an edge, to be multiplied by the root of its length.
            found[:, edges] = np.sqrt(np.mean(every.reshape(3, EDGE_PARTS, -1) ** 2, axis=1))
        return Remainders(*found)

    @cached_property
    def start(self) -> Array:
        """e of ε(u_0), (cells,)."""
        return self.cells.in_space(_strain(self.expressions), 0.0, 0.0)


def require_ranges(expressions: Expressions) -> None:
    """Refuse data some of which have no ranges, before time is spent.

    Raises:
        RangeError: names the part of a formula that has none.
    """
    for formula in (*expressions.force, *(f for _, load in expressions.loads for f in load), *_strain(expressions)):
        require_known(formula)


def _strain(expressions: Expressions) -> tuple[sp.Expr, ...]:
    """ε(u_0) in Mandel's components."""
    u = expressions.start
    return sp.diff(u[0], x1), sp.diff(u[1], x2), (sp.diff(u[0], x2) + sp.diff(u[1], x1)) / sp.sqrt(2)


def _pieces(space: StressSpace, part: Part, edges: Array) -> Regions:
    """The parts of edges, which have rules of their own: all first ones, all second ones, …"""
    corners = space.mesh.p[:, space.mesh.facets[:, edges]]
    low, high = np.sort(np.einsum("d,den->en", part.tangent, corners - part.start[:, None, None]), axis=0)
    cuts = low + np.linspace(0, 1, EDGE_PARTS + 1)[:, None] * (high - low)
    return Regions({ARC: (cuts[:-1].ravel(), cuts[1:].ravel())})


def _along(part: Part, formula: sp.Expr) -> sp.Expr:
    """A formula on a part, by the arc length."""
    place = [sp.Float(float(c)) + sp.Float(float(d)) * ARC for c, d in zip(part.start, part.tangent, strict=True)]
    return formula.subs(dict(zip((x1, x2), place, strict=True)), simultaneous=True)

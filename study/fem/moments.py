"""Integrals of an exact strain over cells, facets and the body, as matrices that act on its amplitudes.

With ε(x, t) = Σ_k E_k φ_k(x) T_k(s_j, t) (``manufactured.modes``) and a quadrature with points x_p and weights w_p,

    ∫_T ε dx = Σ_k E_k Σ_j B_k[T, j] T_k(s_j, t),      B_k[T, j] = Σ {w_p φ_k(x_p) : x_p ∈ T, j(p) = j},

so that formulas are evaluated once for each place along a face, not once for each point of a cell. On facets the
weights are those of the rule times the shape function of a vertex, and sums belong to vertices.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import scipy.sparse as sps
from skfem import Mesh

from manufactured.body import Part
from manufactured.modes import Modes
from manufactured.tensors import Array, Tensors
from study.fem.quadrature import CellRule, FacetRule

Amplitudes = Sequence[Array]
"""T_k(s_j, t) of each contribution at one time, (K, J)."""


@dataclass(frozen=True, eq=False)
class Points:
    """The points of a quadrature, one after the other, and the sums to which they belong.

    Attributes:
        x: (d, n).
        sums: the sum of each point, (n,).
        weights: (n,).
        count: the number of sums.
    """

    x: Array
    sums: Array
    weights: Array
    count: int

    @classmethod
    def on_cells(cls, rules: Sequence[CellRule]) -> Points:
        """One sum for each cell: rules that cover every cell once."""
        return cls(
            np.concatenate([rule.points.reshape(len(rule.points), -1) for rule in rules], axis=1),
            np.concatenate([np.repeat(rule.cells, rule.weights.shape[1]) for rule in rules]),
            np.concatenate([rule.weights.ravel() for rule in rules]),
            sum(len(rule.cells) for rule in rules),
        )

    @classmethod
    def on_facets(cls, rule: FacetRule, part: Part, mesh: Mesh) -> tuple[Points, Array]:
        """One sum for each vertex of the facets, weighted with its shape function; and these vertices."""
        vertices, sums = np.unique(mesh.facets[:, rule.facets], return_inverse=True)
        x, weights = part.point(rule.s), rule.shapes * rule.weights
        copies = np.repeat(x[:, None], len(weights), axis=1).reshape(len(x), -1)
        sums = np.repeat(sums.reshape(weights.shape[:2])[..., None], weights.shape[2], axis=2)
        return cls(copies, sums.ravel(), weights.ravel(), len(vertices)), vertices

    def totals(self, values: Array) -> Array:
        """Sums of values (n,), (sums,)."""
        return np.bincount(self.sums, values, self.count)


def strain_at_points(modes: Sequence[Modes], amplitudes: Amplitudes, count: int) -> Tensors:
    """ε at all points, (D, count)."""
    strain = np.zeros((modes[0].tensors.shape[1], count))
    for part, values in zip(modes, amplitudes, strict=True):
        for tensor, shape, value in zip(part.tensors, part.shapes, values, strict=True):
            spread = shape * value[part.places]
            for row in np.flatnonzero(tensor):
                strain[row, part.points] += tensor[row] * spread
    return strain


class StrainSums:
    """Σ w_p ε(x_p, t), (D, sums).

    Args:
        modes: the contributions to ε at the points.
        points: the quadrature.
        weights: w, which may be the rule's times a coefficient, (n,).
    """

    def __init__(self, modes: Sequence[Modes], points: Points, weights: Array) -> None:
        self._parts = [list(_by_tensor(part, points, weights)) for part in modes]

    def __call__(self, amplitudes: Amplitudes) -> Tensors:
        """(D, sums) from the amplitudes at one time."""
        return sum(
            np.multiply.outer(tensor, matrix @ part[rows].ravel())
            for part, groups in zip(amplitudes, self._parts, strict=True)
            for tensor, rows, matrix in groups
        )


def _by_tensor(modes: Modes, points: Points, weights: Array) -> Iterator[tuple[Array, Array, sps.csr_array]]:
    """(E, the modes with E_k = E, their B_k side by side) for each different tensor."""
    distinct, group = np.unique(modes.tensors, axis=0, return_inverse=True)
    sums, weights = points.sums[modes.points], weights[modes.points]
    for i, tensor in enumerate(distinct):
        rows = np.flatnonzero(group == i)
        data = np.concatenate([weights * modes.shapes[k] for k in rows])
        columns = np.concatenate([modes.places + n * modes.count for n in range(len(rows))])
        shape = (points.count, len(rows) * modes.count)
        yield tensor, rows, sps.csr_array((data, (np.tile(sums, len(rows)), columns)), shape=shape)


MANY = 4
"""Times what the modes hold: as much may matrices of the energy."""


def energy(modes: Sequence[Modes], weights: Array, C: Array) -> Callable[[Amplitudes], float]:
    """∫_Ω α C ε·ε dx.

    Where points share places, matrices act on the amplitudes. Where hardly any do, these matrices would hold many times
    what the modes do, and the strain is summed point by point.

    Args:
        modes: the contributions to ε at the points.
        weights: quadrature weights times α, (n,).
        C: symmetric, Mandel (D, D).
    """
    held = sum(len(part.tensors) ** 2 * part.count for part in modes)
    by_place = held <= MANY * sum(part.shapes.size for part in modes)
    return (_ByPlace if by_place else _ByPoint)(modes, weights, C)


class _ByPoint:
    """Σ_p w_p C ε·ε."""

    def __init__(self, modes: Sequence[Modes], weights: Array, C: Array) -> None:
        self.modes, self.weights, self.C = modes, weights, C

    def __call__(self, amplitudes: Amplitudes) -> float:
        strain = strain_at_points(self.modes, amplitudes, len(self.weights))
        return float(np.einsum("In,In,n->", self.C @ strain, strain, self.weights))


class _ByPlace:
    """Quadratic forms in the amplitudes of one contribution, bilinear ones in those of two."""

    def __init__(self, modes: Sequence[Modes], weights: Array, C: Array) -> None:
        self._own = [_own(part, weights, C) for part in modes]
        self._mixed = [(i, j, _mixed(modes[i], modes[j], weights, C)) for i, j in combinations(range(len(modes)), 2)]

    def __call__(self, amplitudes: Amplitudes) -> float:
        own = sum(np.einsum("kj,klj,lj->", T, C, T) for T, C in zip(amplitudes, self._own, strict=True))
        mixed = sum(amplitudes[i].ravel() @ (C @ amplitudes[j].ravel()) for i, j, C in self._mixed)
        return float(own + 2 * mixed)


def _own(modes: Modes, weights: Array, C: Array) -> Array:
    """Σ_p w_p C E_k·E_l φ_k φ_l over the points of each place, (K, K, J): points of two places never meet."""
    found = np.zeros((len(modes.tensors), len(modes.tensors), modes.count))
    weights = weights[modes.points]
    for (k, l), product in np.ndenumerate(modes.tensors @ C @ modes.tensors.T):
        if product and k <= l:
            found[k, l] = np.bincount(modes.places, product * weights * modes.shapes[k] * modes.shapes[l], modes.count)
            found[l, k] = found[k, l]
    return found


def _mixed(one: Modes, other: Modes, weights: Array, C: Array) -> sps.csr_array:
    """The same for two contributions at the points that both reach, (K J, K' J')."""
    common, mine, others = np.intersect1d(one.points, other.points, assume_unique=True, return_indices=True)
    weights, j, jj = weights[common], one.places[mine], other.places[others]
    data, rows, columns = [np.empty(0)], [np.empty(0, dtype=int)], [np.empty(0, dtype=int)]
    for (k, l), product in np.ndenumerate(one.tensors @ C @ other.tensors.T):
        if product:
            data.append(product * weights * one.shapes[k, mine] * other.shapes[l, others])
            rows.append(j + k * one.count)
            columns.append(jj + l * other.count)
    shape = (len(one.tensors) * one.count, len(other.tensors) * other.count)
    return sps.csr_array((np.concatenate(data), (np.concatenate(rows), np.concatenate(columns))), shape=shape)

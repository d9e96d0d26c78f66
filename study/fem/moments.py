"""Integrals of an exact strain over cells and facets, as matrices that act on its amplitudes.

With ε(x, t) = Σ_k E_k φ_k(x) T_k(s_j, t) (``manufactured.modes``) and a quadrature with points x_p and weights w_p,

    ∫_T ε dx = Σ_k E_k Σ_j B_k[T, j] T_k(s_j, t),      B_k[T, j] = Σ {w_p φ_k(x_p) : x_p ∈ T, j(p) = j},

so that formulas are evaluated once for each place along a face, not once for each point of a cell. On facets there is
one sum for each vertex, with the weights of the rule times the shape function of the vertex.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

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
class QuadraturePoints:
    """The points of a quadrature, one after the other, and the cell or vertex to whose sum each contributes.

    Attributes:
        x: (d, n).
        sums: the number of the sum that a point belongs to, (n,).
        weights: (n,).
        count: how many sums there are.
    """

    x: Array
    sums: Array
    weights: Array
    count: int

    @classmethod
    def on_cells(cls, rules: Sequence[CellRule]) -> QuadraturePoints:
        """One sum for each cell: rules that cover every cell once."""
        return cls(
            np.concatenate([rule.points.reshape(len(rule.points), -1) for rule in rules], axis=1),
            np.concatenate([np.repeat(rule.cells, rule.weights.shape[1]) for rule in rules]),
            np.concatenate([rule.weights.ravel() for rule in rules]),
            sum(len(rule.cells) for rule in rules),
        )

    @classmethod
    def on_facets(cls, rule: FacetRule, part: Part, mesh: Mesh) -> tuple[QuadraturePoints, Array]:
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

    def __init__(self, modes: Sequence[Modes], points: QuadraturePoints, weights: Array) -> None:
        self._parts = [list(_by_tensor(part, points, weights)) for part in modes]

    def __call__(self, amplitudes: Amplitudes) -> Tensors:
        """(D, sums) from the amplitudes at one time."""
        return sum(
            np.multiply.outer(tensor, matrix @ part[rows].ravel())
            for part, groups in zip(amplitudes, self._parts, strict=True)
            for tensor, rows, matrix in groups
        )


def _by_tensor(modes: Modes, points: QuadraturePoints, weights: Array) -> Iterator[tuple[Array, Array, sps.csr_array]]:
    """(E, the modes with E_k = E, their B_k side by side) for each different tensor."""
    distinct, group = np.unique(modes.tensors, axis=0, return_inverse=True)
    sums, weights = points.sums[modes.points], weights[modes.points]
    for i, tensor in enumerate(distinct):
        rows = np.flatnonzero(group == i)
        data = np.concatenate([weights * modes.shapes[k] for k in rows])
        columns = np.concatenate([modes.places + n * modes.count for n in range(len(rows))])
        shape = (points.count, len(rows) * modes.count)
        yield tensor, rows, sps.csr_array((data, (np.tile(sums, len(rows)), columns)), shape=shape)

"""Integrals of an exact strain, of its stress and of its energy, as matrices that act on its amplitudes.

With ε(x, t) = Σ_k E_k φ_k(x) T_k(s_j, t) (``manufactured.modes``) and a quadrature with points x_p and weights w_p,

    ∫_T ε dx = Σ_k E_k Σ_j B_k[T, j] T_k(s_j, t),      B_k[T, j] = Σ {w_p φ_k(x_p) : x_p ∈ T, j(p) = j},

so that formulas are evaluated once for each place along a face, not once for each point of a cell. On facets there is
one sum for each vertex, with the weights of the rule times the shape function of the vertex.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
import scipy.sparse as sps
from skfem import Mesh

from manufactured.body import Part
from manufactured.law import KelvinVoigt, Linear
from manufactured.modes import Modes
from manufactured.tensors import Array, Tensors
from study.fem.quadrature import CellRule, FacetRule

Amplitudes = Sequence[Array]
"""T_k(s_j, t) of each contribution to ε at one time, (K, J)."""
MANY = 4
"""Matrices for the energy may take this many times the storage of the modes."""


@dataclass(frozen=True, eq=False)
class QuadraturePoints:
    """The points x of a quadrature, one after the other, (d, n), with their weights (n,).

    Each contributes to the sum of a cell or a vertex: ``sums`` has the numbers of these sums, (n,), of which there are
    ``count``.
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
    """Σ w_p ε(x_p, t), (D, sums), from the amplitudes at one time; w may be the rule's times a coefficient, (n,)."""

    def __init__(self, modes: Sequence[Modes], points: QuadraturePoints, weights: Array) -> None:
        width = sum(len(part.tensors) * part.count for part in modes)
        tensors, blocks, before = [], [], 0
        for part in modes:
            distinct, group = np.unique(part.tensors, axis=0, return_inverse=True)
            same = [np.flatnonzero(group == i) for i in range(len(distinct))]
            blocks += _blocks(part, same, points, weights, before, width)
            tensors.append(distinct)
            before += len(part.tensors) * part.count
        # The B_k of each different tensor side by side, these below each other: one product for all.
        self._matrix = sps.vstack(blocks, format="csr")
        self._tensors = np.concatenate(tensors).T

    def __call__(self, amplitudes: Amplitudes) -> Tensors:
        sums = self._matrix @ np.concatenate([part.ravel() for part in amplitudes])
        return self._tensors @ sums.reshape(self._tensors.shape[1], -1)


def _blocks(
    part: Modes, groups: Sequence[Array], points: QuadraturePoints, weights: Array, before: int, width: int
) -> list[sps.csr_array]:
    """The B_k of each group of modes of a part side by side, (sums, width), from the column ``before`` of the part on.

    Their rows are written as they are stored: lists of all entries with their rows would take most of the memory of a
    level.
    """
    sums = points.sums[part.points]
    order = np.argsort(sums, kind="stable")
    starts = np.cumsum([0, *np.bincount(sums, minlength=points.count)])
    index = sps.get_index_dtype(maxval=max(width, part.shapes.size))
    places, weighed = part.places[order, None].astype(index), weights[part.points]
    blocks = []
    for chosen in groups:
        columns = places + (before + part.count * chosen).astype(index)
        values = (weighed * part.shapes[chosen])[:, order].T
        rows = (len(chosen) * starts).astype(index)
        block = sps.csr_array((values.ravel(), columns.ravel(), rows), shape=(points.count, width))
        block.sum_duplicates()
        blocks.append(block)
    return blocks


class StressSums:
    """Σ w_p σ(x_p, t), (D, sums), for σ = A ε(u̇) + G ε(u), (2.1), from the amplitudes of ε and ε̇ at one time.

    Attributes:
        viscous: Σ w_p α for A = α C.
        strains: Σ w_p α ε.
    """

    def __init__(self, law: KelvinVoigt, modes: Sequence[Modes], points: QuadraturePoints) -> None:
        self._A, G = law.A, law.G
        viscous, elastic = (points.weights * tensor.factor(points.x) for tensor in (law.A, G))
        self.viscous = points.totals(viscous)
        self.strains = StrainSums(modes, points, viscous)
        self._elastic: Callable[[Amplitudes], Tensors]
        if isinstance(G, Linear):
            sums = self.strains if np.array_equal(viscous, elastic) else StrainSums(modes, points, elastic)
            self._elastic = lambda strains: G.matrix @ sums(strains)
        else:
            self._elastic = lambda strains: np.array(
                [points.totals(row * elastic) for row in G(strain_at_points(modes, strains, len(elastic)))]
            )

    def __call__(self, strains: Amplitudes, rates: Amplitudes) -> Tensors:
        return self._A.matrix @ self.strains(rates) + self._elastic(strains)


def energy(modes: Sequence[Modes], weights: Array, C: Array) -> Callable[[Amplitudes], float]:
    """∫_Ω α C ε·ε dx from the amplitudes at one time.

    Where many points share a place along the face, this is a quadratic form in the amplitudes of one contribution, a
    bilinear one in those of two. Where hardly any do, the matrices of these forms would be many times as large as the
    modes, and the strain is summed point by point.

    Args:
        modes: the contributions to ε at the points.
        weights: quadrature weights times α, (n,).
        C: symmetric, Mandel (D, D).
    """

    def by_point(amplitudes: Amplitudes) -> float:
        strain = strain_at_points(modes, amplitudes, len(weights))
        return float(np.einsum("In,In,n->", C @ strain, strain, weights))

    if sum(len(part.tensors) ** 2 * part.count for part in modes) > MANY * sum(part.shapes.size for part in modes):
        return by_point
    squares = [_square(part, weights, C) for part in modes]
    products = [(i, j, _product(modes[i], modes[j], weights, C)) for i, j in combinations(range(len(modes)), 2)]

    def by_place(amplitudes: Amplitudes) -> float:
        own = sum(np.einsum("kj,klj,lj->", T, Q, T) for T, Q in zip(amplitudes, squares, strict=True))
        mixed = sum(amplitudes[i].ravel() @ (B @ amplitudes[j].ravel()) for i, j, B in products)
        return float(own + 2 * mixed)

    return by_place


def _square(modes: Modes, weights: Array, C: Array) -> Array:
    """Σ_p w_p C E_k·E_l φ_k φ_l over the points of each place, (K, K, J): points of two places never meet."""
    found = np.zeros((len(modes.tensors), len(modes.tensors), modes.count))
    weights = weights[modes.points]
    for (k, l), product in np.ndenumerate(modes.tensors @ C @ modes.tensors.T):
        if product and k <= l:
            found[k, l] = np.bincount(modes.places, product * weights * modes.shapes[k] * modes.shapes[l], modes.count)
            found[l, k] = found[k, l]
    return found


def _product(one: Modes, other: Modes, weights: Array, C: Array) -> sps.csr_array:
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

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
from manufactured.tensors import Array, Tensors, mapped
from study.fem.quadrature import CellRule, FacetRule

Amplitudes = Array
"""T_k(s_j, t) of all contributions to ε at one time, one after the other, (Σ K J,)."""
MANY = 4
"""The matrix for the energy may take this many times the storage of the modes."""
POINTS = 1 << 11
"""Points that are treated together, so that what a law leaves half-done at them stays in a cache."""


def amplitudes_of(modes: Sequence[Modes]) -> Callable[[float, bool], Amplitudes]:
    """Return the function of a time and of whether the rate is asked for that gives the amplitudes of all modes."""
    # The function refers to no other part of the modes, which are large.
    each = [part.amplitudes for part in modes]
    return lambda time, rate: np.concatenate([of(time, rate).ravel() for of in each])


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


class StrainSums:
    """The sums Σ w_p ε(x_p, t), (D, sums), from the amplitudes; w may have a coefficient beside the rule's weights."""

    def __init__(self, modes: Sequence[Modes], points: QuadraturePoints, weights: Array) -> None:
        width = sum(len(part.tensors) * part.count for part in modes)
        tensors, blocks, before = [], [], 0
        for part in modes:
            distinct, group = np.unique(part.tensors, axis=0, return_inverse=True)
            # Backwards: in the axes of the face they are the unit vectors in their order.
            same = [np.flatnonzero(group == i) for i in reversed(range(len(distinct)))]
            blocks += _blocks(part, same, points, weights, before, width)
            tensors.append(distinct[::-1])
            before += len(part.tensors) * part.count
        # The B_k of each different tensor side by side, these below each other: one product for all.
        self._matrix = sps.vstack(blocks, format="csr")
        self._tensors = np.concatenate(tensors).T
        self._plain = np.array_equal(self._tensors, np.eye(len(self._tensors)))

    @classmethod
    def at_points(cls, modes: Sequence[Modes], count: int) -> StrainSums:
        """ε at so many points: each is a sum of its own, with the weight 1."""
        ones = np.ones(count)
        return cls(modes, QuadraturePoints(np.empty((0, count)), np.arange(count), ones, count), ones)

    def __call__(self, amplitudes: Amplitudes, C: Array | None = None) -> Tensors:
        """The sums, or those of C ε for a tensor C, Mandel (D, D)."""
        sums = (self._matrix @ amplitudes).reshape(self._tensors.shape[1], -1)
        if C is None and self._plain:
            return sums
        return mapped(self._tensors if C is None else C @ self._tensors, sums)


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


class PointwiseSums:
    """The sums Σ w_p S(ε(x_p, t)), (m, sums), for a function S from strains (D, p) to (m, p), from the amplitudes.

    Args:
        modes: the contributions to ε at the points.
        sums: to which of ``count`` sums a point contributes, (p,).
        weights: w_p, (p,).
    """

    def __init__(self, modes: Sequence[Modes], sums: Array, weights: Array, count: int) -> None:
        self._count = count
        starts = range(0, len(sums), POINTS)
        self._pieces = [
            _Piece.of([part.among(i, i + POINTS) for part in modes], sums[i : i + POINTS], weights[i : i + POINTS])
            for i in starts
        ]

    def __call__(self, amplitudes: Amplitudes, S: Callable[[Tensors], Array]) -> Array:
        found = [(piece.sums, piece.of_points(S(piece.strains(amplitudes)))) for piece in self._pieces]
        total = np.zeros((len(found[0][1]), self._count))
        for sums, values in found:
            # The numbers of the sums of one piece are unique, so += adds each value.
            total[:, sums] += values
        return total


@dataclass(frozen=True, eq=False)
class _Piece:
    """Some points: strains at them, and which sums they contribute to with which weights, (sums, p)."""

    strains: StrainSums
    sums: Array
    weights: sps.csr_array

    @classmethod
    def of(cls, modes: Sequence[Modes], sums: Array, weights: Array) -> _Piece:
        met, which = np.unique(sums, return_inverse=True)
        incidence = sps.csr_array((weights, (which, np.arange(len(sums)))), shape=(len(met), len(sums)))
        return cls(StrainSums.at_points(modes, len(sums)), met, incidence)

    def of_points(self, values: Array) -> Array:
        """Return the weighted sums, (m, sums), of values (m, p)."""
        return np.asarray((self.weights @ values.T).T)


class StressSums:
    """The sums Σ w_p σ(x_p, t), (D, sums), for σ = A ε(u̇) + G ε(u), (2.1), from the amplitudes of ε and ε̇.

    Attributes:
        viscous: Σ w_p α for A = α C.
        strains: Σ w_p α ε.
    """

    def __init__(self, law: KelvinVoigt, modes: Sequence[Modes], points: QuadraturePoints) -> None:
        self._A, G = law.A, law.G
        viscous, elastic = (points.weights * tensor.factor(points.x) for tensor in (law.A, G))
        self.viscous = np.bincount(points.sums, viscous, points.count)
        self.strains = StrainSums(modes, points, viscous)
        self._elastic: Callable[[Amplitudes], Tensors]
        if isinstance(G, Linear):
            linear = self.strains if np.array_equal(viscous, elastic) else StrainSums(modes, points, elastic)
            self._elastic = lambda strains: linear(strains, G.matrix)
        else:
            pointwise = PointwiseSums(modes, points.sums, elastic, points.count)
            self._elastic = lambda strains: pointwise(strains, G)

    def __call__(self, strains: Amplitudes, rates: Amplitudes) -> Tensors:
        return self.strains(rates, self._A.matrix) + self._elastic(strains)


def energy(modes: Sequence[Modes], weights: Array, C: Array) -> Callable[[Amplitudes], float]:
    """Return the function that gives the energy ∫_Ω α C ε·ε dx from the amplitudes.

    Where many points share a place along the face, this is a quadratic form of the amplitudes. Where hardly any do, its
    matrix would be many times as large as the modes, and the density is summed point by point.

    Args:
        modes: the contributions to ε at the points.
        weights: quadrature weights times α, (n,).
        C: symmetric, Mandel (D, D).
    """
    if sum(len(part.tensors) ** 2 * part.count for part in modes) > MANY * sum(part.shapes.size for part in modes):
        total = PointwiseSums(modes, np.zeros(len(weights), dtype=int), weights, 1)
        return lambda amplitudes: float(total(amplitudes, lambda strain: _density(C, strain))[0, 0])
    form = _form(modes, weights, C)
    return lambda amplitudes: float(amplitudes @ (form @ amplitudes))


def _density(C: Array, strain: Tensors) -> Array:
    """C ε·ε, (1, ...)."""
    return np.einsum("I...,I...->...", mapped(C, strain), strain)[None]


def _form(modes: Sequence[Modes], weights: Array, C: Array) -> sps.csr_array:
    """The matrix of the quadratic form of all amplitudes, (Σ K J, Σ K J), what lies below its diagonal added above."""
    blocks: list[list[sps.csr_array | None]] = [[None] * len(modes) for _ in modes]
    for i, part in enumerate(modes):
        blocks[i][i] = _square(part, weights, C)
    for i, j in combinations(range(len(modes)), 2):
        blocks[i][j] = 2 * _product(modes[i], modes[j], weights, C)
    return sps.csr_array(sps.block_array(blocks))


def _square(modes: Modes, weights: Array, C: Array) -> sps.csr_array:
    """Σ_p w_p C E_k·E_l φ_k φ_l over the points of each place, (K J, K J): points of two places never meet."""
    weights, J, products = weights[modes.points], np.arange(modes.count), np.triu(modes.tensors @ C @ modes.tensors.T)
    products += np.triu(products, 1)
    blocks = []
    for shape, row in zip(modes.shapes, products, strict=True):
        chosen = np.flatnonzero(row)
        sums = [np.bincount(modes.places, row[l] * weights * shape * modes.shapes[l], modes.count) for l in chosen]
        values = np.array(sums).reshape(len(chosen), -1).T
        columns = J[:, None] + modes.count * chosen
        blocks.append(_by_rows(values, columns, np.arange(modes.count + 1), len(products) * modes.count))
    return sps.vstack(blocks, format="csr")


def _product(one: Modes, other: Modes, weights: Array, C: Array) -> sps.csr_array:
    """Σ_p w_p C E_k·E'_l φ_k φ'_l over the points that both reach, by their places, (K J, K' J')."""
    common, mine, others = np.intersect1d(one.points, other.points, assume_unique=True, return_indices=True)
    order = np.argsort(one.places[mine], kind="stable")
    starts = np.cumsum([0, *np.bincount(one.places[mine], minlength=one.count)])
    mine, others, weights = mine[order], others[order], weights[common[order]]
    shapes, places, blocks = other.shapes[:, others].T, other.places[others], []
    for shape, row in zip(one.shapes[:, mine], one.tensors @ C @ other.tensors.T, strict=True):
        chosen = np.flatnonzero(row)
        values = (weights * shape)[:, None] * (shapes[:, chosen] * row[chosen])
        columns = places[:, None] + other.count * chosen
        blocks.append(_by_rows(values, columns, starts, len(other.tensors) * other.count))
    return sps.vstack(blocks, format="csr")


def _by_rows(values: Array, columns: Array, starts: Array, width: int) -> sps.csr_array:
    """The matrix with values (n, k) in some columns (n, k), the rows of which begin at ``starts``.

    Rows are written as they are stored: to sort entries by rows would take longer than anything else.
    """
    index = sps.get_index_dtype(maxval=max(width, values.size))
    rows = (values.shape[1] * starts).astype(index)
    found = sps.csr_array((values.ravel(), columns.astype(index).ravel(), rows), shape=(len(starts) - 1, width))
    found.sum_duplicates()
    return found

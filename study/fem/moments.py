"""Integrals of an exact strain, of its stress and of its energy over the cells of a mesh, for many times.

An exact strain is a sum of products of a function φ_k of the point and a function T_k of the coordinate s along a
contact face and of time (``manufactured.modes``):

    ε(x, t) = Σ_k E_k φ_k(x) T_k(s_j, t).

Only the T_k, called amplitudes here, change with time. So the integral over a cell T, by a quadrature rule with points
x_p and weights w_p, is a fixed sparse matrix B_k times the amplitudes:

    ∫_T ε dx = Σ_k E_k Σ_j B_k[T, j] T_k(s_j, t),      B_k[T, j] = Σ {w_p φ_k(x_p) : x_p ∈ T, j(p) = j}.

Many points have the same coordinate s_j, so few formulas are evaluated at each time. On facets there is one sum for
each vertex instead of each cell, and the weights contain the shape function of the vertex.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sps
from skfem import Mesh

from manufactured.body import Part
from manufactured.law import KelvinVoigt, Linear
from manufactured.modes import Modes
from manufactured.tensors import Array, Tensors, mapped
from study.fem.quadrature import CellRule, FacetRule

Amplitudes = Array
"""The values T_k(s_j, t) at n times of the functions that describe how a strain changes with time.

The J values of each of the K terms follow one after the other, (Σ K J, n).
"""
MOST_TIMES, MOST_VALUES = 32, 1 << 19
"""Largest number of times that are evaluated together, and of values that belong to them.

Formulas are called less often for blocks of times. Larger blocks would leave the processor's cache.
"""
MANY = 4
"""The energy is stored as a matrix if it needs at most this many times the memory of the terms of the strain."""


def blocks(times: Array | float, size: int) -> list[Array]:
    """Divide times, (n,), into blocks that are evaluated together; ``size`` values belong to each time."""
    most = max(1, min(MOST_TIMES, MOST_VALUES // size))
    return np.split(np.atleast_1d(times), range(most, np.size(times), most))


def amplitudes_of(modes: Sequence[Modes]) -> Callable[[Array, bool], Amplitudes]:
    """Return the function (times, rate) ↦ amplitudes of the strain ε, or of its rate ε̇ if ``rate`` is true."""
    # The returned function stores only these references. A reference to the modes would keep their large arrays in
    # memory.
    each = [part.amplitudes for part in modes]

    def at(times: Array, rate: bool) -> Amplitudes:
        # A loop, because a comprehension is one more call in Python 3.11, and the depth of calls is limited.
        found = []
        for of in each:
            found.append(of(times, rate).reshape(-1, len(times)))
        return np.concatenate(found)

    return at


@dataclass(frozen=True, eq=False)
class QuadraturePoints:
    """Quadrature points with the weighted sums to which they contribute, one sum for each cell or for each vertex.

    Attributes:
        x: the points, (d, n).
        sums: for each point, the index of the sum to which it contributes, (n,).
        weights: the quadrature weights, (n,).
        count: the number of sums.
    """

    x: Array
    sums: Array
    weights: Array
    count: int

    @classmethod
    def on_cells(cls, rules: Sequence[CellRule]) -> QuadraturePoints:
        """Return the points of quadrature rules that together cover every cell once; there is one sum for each cell."""
        return cls(
            np.concatenate([rule.points.reshape(len(rule.points), -1) for rule in rules], axis=1),
            np.concatenate([np.repeat(rule.cells, rule.weights.shape[1]) for rule in rules]),
            np.concatenate([rule.weights.ravel() for rule in rules]),
            sum(len(rule.cells) for rule in rules),
        )

    @classmethod
    def on_facets(cls, rule: FacetRule, part: Part, mesh: Mesh) -> tuple[QuadraturePoints, Array]:
        """Return the points of a quadrature rule on facets, with one sum for each vertex, and these vertices.

        The weights contain the shape function of the vertex, so a point of a facet occurs once for each of its d
        vertices.
        """
        vertices, sums = np.unique(mesh.facets[:, rule.facets], return_inverse=True)
        x = part.point(rule.s)
        weights = rule.shapes * rule.weights
        copies = np.repeat(x[:, None], len(weights), axis=1).reshape(len(x), -1)
        sums = np.repeat(sums.reshape(weights.shape[:2])[..., None], weights.shape[2], axis=2)
        return cls(copies, sums.ravel(), weights.ravel(), len(vertices)), vertices

    def adding(self, weights: Array) -> sps.csr_array:
        """Return the matrix from values at the points to their sums with given weights (n,), (count, n)."""
        return sps.csr_array((weights, (self.sums, np.arange(len(weights)))), shape=(self.count, len(weights)))


def shapes_at_points(modes: Sequence[Modes], count: int) -> Iterator[sps.csr_array]:
    """Yield for each term k of the strain the matrix that maps its amplitudes to its values at the quadrature points.

    The matrix maps T_k(s_j, t), (J,), to φ_k(x_p) T_k(s_{j(p)}, t), (count,).
    """
    for part in modes:
        # Each row belongs to a point and has one entry, so the arrays of the CSR format can be filled without sorting.
        rows = np.searchsorted(part.points, np.arange(count + 1)).astype(np.int32)
        places = part.places.astype(np.int32)
        for shape in part.shapes:
            yield sps.csr_array((shape, places, rows), shape=(count, part.count))


def strain_matrix(modes: Sequence[Modes], count: int) -> sps.csr_array:
    """Return the matrix from amplitudes to the strain at ``count`` points, component by component.

    The shape is (D · count, Σ K J).
    """
    tensors = np.concatenate([part.tensors for part in modes])
    shapes = shapes_at_points(modes, count)
    columns = [sps.kron(sps.csr_array(E[:, None]), shape) for E, shape in zip(tensors, shapes, strict=True)]
    return sps.csr_array(sps.hstack(columns))


class StrainSums:
    """Computes weighted sums Σ w_p ε(x_p, t) of a strain over points, (D, sums, n), from its amplitudes at n times.

    Args:
        modes: the terms of the strain ε at the points x_p.
        points: the points, with the sums to which they contribute.
        weights: the weights w_p, (n,), which are quadrature weights, possibly times material factors.
    """

    def __init__(self, modes: Sequence[Modes], points: QuadraturePoints, weights: Array) -> None:
        add = points.adding(weights)
        count = len(weights)
        blocks = []
        first = 0
        width = sum(len(part.tensors) * part.count for part in modes)
        for shape in shapes_at_points(modes, count):
            sums = add @ shape
            blocks.append(sps.csr_array((sums.data, sums.indices + first, sums.indptr), shape=(points.count, width)))
            first += shape.shape[1]
        # ``block_diag`` would need twice the memory.
        self._matrix = sps.vstack(blocks, format="csr")
        self._tensors = np.concatenate([part.tensors for part in modes]).T

    def __call__(self, amplitudes: Amplitudes, C: Array | None = None) -> Tensors:
        """Return the sums of the strain ε, or of the stress C ε if a tensor C is given in Mandel form, (D, D)."""
        sums = (self._matrix @ amplitudes).reshape(self._tensors.shape[1], -1, amplitudes.shape[1])
        return mapped(self._tensors if C is None else C @ self._tensors, sums)


class StressSums:
    """Computes weighted sums Σ w_p σ(x_p, t) of the stress σ = A ε(u̇) + G ε(u) at n times, (D, sums, n).

    A call needs the amplitudes of the strain ε and of its rate ε̇ at these times.

    Attributes:
        viscous: the sums Σ w_p α of the material factor α of A, (sums,).
        strains: computes the sums Σ w_p α ε of the strain from its amplitudes.
    """

    def __init__(self, law: KelvinVoigt, modes: Sequence[Modes], points: QuadraturePoints) -> None:
        self._A = law.A
        G = law.G
        viscous, elastic = (points.weights * tensor.factor(points.x) for tensor in (law.A, G))
        self.viscous = np.bincount(points.sums, viscous, points.count)
        self.strains = StrainSums(modes, points, viscous)
        self._elastic: Callable[[Amplitudes], Tensors]
        if isinstance(G, Linear):
            linear = self.strains if np.array_equal(viscous, elastic) else StrainSums(modes, points, elastic)
            self._elastic = lambda strains: linear(strains, G.matrix)
        else:
            strain = strain_matrix(modes, len(elastic))
            add = points.adding(elastic)

            def nonlinear(strains: Amplitudes) -> Tensors:
                stress = G((strain @ strains).reshape(-1, len(elastic), strains.shape[1]))
                return np.array([add @ component for component in stress])

            self._elastic = nonlinear

    def __call__(self, strains: Amplitudes, rates: Amplitudes) -> Tensors:
        return self.strains(rates, self._A.matrix) + self._elastic(strains)


class StrainEnergy:
    """Computes the energies ∫_Ω α C ε·ε dx of a strain at several times, (times,), from its amplitudes.

    If many points have the same coordinate along the contact face, the strain has few amplitudes, and the energy is
    stored as a quadratic form of them. Otherwise the matrix of this form would be too large, and the strain at the
    points is computed first.

    Args:
        modes: the terms of the strain ε at the quadrature points.
        weights: quadrature weights times the material factor α, (points,).
        C: a symmetric tensor in Mandel form, (D, D).
    """

    def __init__(self, modes: Sequence[Modes], weights: Array, C: Array) -> None:
        strain = strain_matrix(modes, len(weights))
        form = sps.csr_array(sps.kron(C, sps.diags_array(weights)))
        self._strain: sps.csr_array | None = None
        if sum(len(part.tensors) ** 2 * part.count for part in modes) > MANY * sum(part.shapes.size for part in modes):
            self._strain = strain
            self._form = form
        else:
            self._form = sps.csr_array(strain.T @ form @ strain)

    def __call__(self, amplitudes: Amplitudes) -> Array:
        v = amplitudes if self._strain is None else self._strain @ amplitudes
        return np.einsum("in,in->n", v, self._form @ v)

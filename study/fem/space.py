"""Displacements on a mesh that vanish on Γ1: the common base of degrees 1 and 2, and V^h, K^h, Π^h of degree 1.

A function is the vector of its free coefficients (dofs,): d for every scalar basis function that vanishes on Γ1. Its
strains are stored at the points of a quadrature rule that integrates products of two strains exactly. So one sparse
matrix E of Mandel strains is the whole discretisation: with the weights w of the points

    ε(v) = E v,   (C ε(u), ε(v))_Q = uᵀ Eᵀ diag(w C) E v,   (σ, ε(v))_Q = Eᵀ(w σ)·v.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sps
from skfem import Mesh

from manufactured.body import Body, Kind, Part
from manufactured.tensors import Array, Points, Tensors, Vectors, basis
from study.fem.mesh import MeshedBody, barycentric_gradients
from study.fem.mesh import size as mesh_size


class Displacements(MeshedBody, ABC):
    """Base class of displacements of degree 1 (``Space``) and degree 2 (``Quadratic``)."""

    @property
    @abstractmethod
    def numbers(self) -> Array:
        """The numbers of the scalar basis functions of the cells, (k, cells)."""

    @abstractmethod
    def numbers_on(self, part: Part) -> Array:
        """Return the numbers of the scalar basis functions that do not vanish on a closed part, (n,)."""

    @property
    @abstractmethod
    def weights(self) -> Array:
        """The quadrature weights w, (cells,) or (cells, points)."""

    @property
    @abstractmethod
    def E(self) -> sps.csr_array:
        """The strains of the basis functions, component by component, (D · cells · points, dofs)."""

    @property
    def dim(self) -> int:
        return int(self.mesh.dim())

    @cached_property
    def count(self) -> int:
        """The number of scalar basis functions."""
        return int(self.numbers.max()) + 1

    @cached_property
    def free(self) -> Array:
        """Positions of the free coefficients in the vector of all coefficients, d for each basis function."""
        fixed = np.zeros(self.count, dtype=bool)
        for part in self.body.of(Kind.CLAMPED):
            fixed[self.numbers_on(part)] = True
        return np.flatnonzero(np.repeat(~fixed, self.dim))

    @property
    def dofs(self) -> int:
        return len(self.free)

    @property
    def nodes(self) -> Points:
        """The nodes of the scalar basis functions, (d, count)."""
        return self.mesh.p

    @property
    def free_points(self) -> Points:
        """The nodes of the free basis functions, in the order of the unknowns, (d, dofs/d)."""
        return self.nodes[:, self.free[:: self.dim] // self.dim]

    def coefficients(self, v: Array) -> Array:
        """Return all coefficients of a function, including the zeros on Γ1: (dofs,) → (count, d)."""
        full = np.zeros(self.dim * self.count)
        full[self.free] = v
        return full.reshape(-1, self.dim)

    def strain(self, v: Array) -> Tensors:
        """Return ε(v), (D, cells) or (D, cells, points); several functions (dofs, n) give n as last axis."""
        return (self.E @ v).reshape(-1, *self.weights.shape, *v.shape[1:])

    def functional(self, stress: Tensors) -> Array:
        """Return the functional (σ, ε(·))_Q for the cell means of a stress, or its values at the points, → (dofs,).

        Stresses (D, cells, n), or (D, cells, points, n), give (dofs, n).
        """
        inner = self.weights.ndim
        return self.tested(self.weights.reshape(*self.weights.shape, *(1,) * (stress.ndim - inner - 1)) * stress)

    def tested(self, integrals: Tensors) -> Array:
        """Return (σ, ε(·))_Q from the integrals of a stress over the cells, or from its values times w."""
        return self._transposed @ integrals.reshape(self.E.shape[0], *integrals.shape[self.weights.ndim + 1 :])

    @cached_property
    def _transposed(self) -> sps.csr_array:
        """The matrix Eᵀ by rows, stored because every load uses it."""
        return sps.csr_array(self.E.T)

    def form(self, C: Array, factor: Array | float = 1.0) -> sps.csc_array:
        """Return the matrix of (α C ε(u), ε(v))_Q for a tensor C, Mandel (D, D), and α as in ``weights``."""
        weighted = sps.kron(C, sps.diags_array((self.weights * factor).ravel()), format="csr")
        matrix = sps.csc_array(self._transposed @ (weighted @ self.E))
        return sps.csc_array((matrix + matrix.T) / 2)

    @cached_property
    def contact(self) -> list[tuple[Part, Array]]:
        """Each part Γ3,i with its basis functions outside Γ1, in the order of the rows of ``N``.

        A function on two parts with the same normal belongs to the first part, so that ``N`` has no equal rows.
        """
        fixed = np.setdiff1d(np.arange(self.count), self.free[:: self.dim] // self.dim)
        found: list[tuple[Part, Array]] = []
        for part in self.body.of(Kind.CONTACT):
            same = [numbers for other, numbers in found if np.allclose(other.normal, part.normal)]
            found.append((part, np.setdiff1d(self.numbers_on(part), np.concatenate([fixed, *same]))))
        return found

    @cached_property
    def N(self) -> sps.csr_array:
        """The matrix from v to ν·c for the coefficients on Γ3, (m, dofs); functions with N v ≤ 0 are admissible.

        There is one row for each part and function: a function on two parts has both constraints.
        """
        return self.normal_components(self.contact)

    def normal_components(self, on: Sequence[tuple[Part, Array]]) -> sps.csr_array:
        """Return the matrix from v to ν·c for coefficients of functions (n,) on given parts, (Σ n, dofs)."""
        # The empty arrays serve bodies without contact.
        normals = [np.empty((0, self.dim)), *(np.tile(part.normal, (len(numbers), 1)) for part, numbers in on)]
        numbers = np.concatenate([np.empty(0, dtype=np.int64), *(numbers for _, numbers in on)])
        return sps.csr_array(self._rows(np.concatenate(normals)[:, None], numbers[:, None])[:, self.free])

    def _matrix(self, values: Array, numbers: Array) -> sps.csr_array:
        """Return the matrix of ``_rows``, restricted to the free coefficients."""
        full = self._rows(values, numbers)
        full.eliminate_zeros()
        return sps.csr_array(full[:, self.free])

    def _rows(self, values: Array, numbers: Array) -> sps.csr_array:
        """Return the matrix on all coefficients whose rows have the values (..., k, d) at k functions (..., k)."""
        # Matrix products read as many indices as values, so 32-bit indices are used if they suffice.
        index = sps.get_index_dtype(maxval=max(values.size, self.dim * self.count))
        columns = np.broadcast_to(self.dim * numbers[..., None] + np.arange(self.dim), values.shape).astype(index)
        width = values.shape[-2] * values.shape[-1]
        starts = np.arange(0, values.size + 1, width, dtype=index)
        return sps.csr_array((values.ravel(), columns.ravel(), starts), shape=(len(starts) - 1, self.dim * self.count))


@dataclass(frozen=True, eq=False)
class Space(Displacements):
    """The space V^h of Problem 5.1: continuous P1 displacements, given by d values at every vertex; K^h = {v : N v ≤
    0}.

    Strains are constant on every cell, so (σ, ε(v))_Q needs only cell means of σ, and (α C ε(u), ε(v))_Q cell means of
    α.

    Raises:
        MeshError: the mesh does not fit the parts of the body (from ``boundary_parts``).
    """

    mesh: Mesh
    body: Body

    def __post_init__(self) -> None:
        self.parts  # refuse a mesh that does not fit before it is used  # noqa: B018

    @cached_property
    def h(self) -> float:
        return mesh_size(self.mesh)

    @property
    def numbers(self) -> Array:
        return self.mesh.t

    def numbers_on(self, part: Part) -> Array:
        return self.vertices(part)

    def vertices(self, part: Part) -> Array:
        """Return the vertices on a closed part."""
        return np.unique(self.mesh.facets[:, self.facets(part)])

    @property
    def weights(self) -> Array:
        return self.volumes

    @cached_property
    def E(self) -> sps.csr_array:
        """The Mandel strains of the nodal basis, (D·cells, n_dofs): ε(φ e_j)_I = E_I : sym(e_j ⊗ ∇φ)."""
        gradients = barycentric_gradients(self.mesh)
        return self._matrix(np.einsum("Ijk,cik->Icij", basis(self.dim), gradients, optimize=True), self.numbers.T)

    def scatter(self, vertices: Array, values: Vectors) -> Vectors:
        """Sum local vectors into nodal vectors: indices (k, n) and values (d, k, n) → (d, vertices)."""
        return np.array([np.bincount(vertices.ravel(), component.ravel(), self.count) for component in values])

    def interpolate(self, values: Vectors) -> Array:
        """Return Π^h: nodal values (d, vertices) → free values (n_dofs,), or (d, vertices, n) → (n_dofs, n)."""
        return np.moveaxis(values, 0, 1).reshape(-1, *values.shape[2:])[self.free]

    def nodal(self, v: Array) -> Vectors:
        """Return nodal values (d, vertices), zero on Γ1, for free values."""
        return self.coefficients(v).T

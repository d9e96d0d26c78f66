"""Displacements on a mesh that vanish on Γ1: what those of degree 1 and 2 have in common, and V^h, K^h, Π^h of P1.

A function is the vector of its free coefficients (dofs,): d for every scalar basis function that vanishes on Γ1. Its
strains are stored at some points of every cell, at which products of two are integrated exactly, so that one sparse
matrix E of Mandel strains carries the whole discretisation: with the weights w of the points

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
    """What displacements of degree 1 (``Space``) and of degree 2 (``Quadratic``) have in common."""

    @property
    @abstractmethod
    def numbers(self) -> Array:
        """The numbers of the scalar basis functions of the cells, (k, cells)."""

    @abstractmethod
    def numbers_on(self, part: Part) -> Array:
        """Those of the functions that do not vanish on a closed part, (n,)."""

    @property
    @abstractmethod
    def weights(self) -> Array:
        """w, (cells,) or (cells, points)."""

    @property
    @abstractmethod
    def E(self) -> sps.csr_array:
        """Strains of the basis functions, component by component, (D · cells · points, dofs)."""

    @property
    def dim(self) -> int:
        return int(self.mesh.dim())

    @cached_property
    def count(self) -> int:
        """The number of scalar basis functions."""
        return int(self.numbers.max()) + 1

    @cached_property
    def free(self) -> Array:
        """Positions of the free coefficients in the vector of all, d for each basis function."""
        fixed = np.zeros(self.count, dtype=bool)
        for part in self.body.of(Kind.CLAMPED):
            fixed[self.numbers_on(part)] = True
        return np.flatnonzero(np.repeat(~fixed, self.dim))

    @property
    def dofs(self) -> int:
        return len(self.free)

    @property
    def nodes(self) -> Points:
        """The points of the scalar basis functions, (d, count)."""
        return self.mesh.p

    @property
    def free_points(self) -> Points:
        """The points of the free basis functions, in the order of the unknowns, (d, dofs/d)."""
        return self.nodes[:, self.free[:: self.dim] // self.dim]

    def coefficients(self, v: Array) -> Array:
        """All coefficients of a function, zero on Γ1: (dofs,) → (count, d)."""
        full = np.zeros(self.dim * self.count)
        full[self.free] = v
        return full.reshape(-1, self.dim)

    def strain(self, v: Array) -> Tensors:
        """ε(v), (D, cells) or (D, cells, points); for functions (dofs, n) with an axis more, the last one."""
        return (self.E @ v).reshape(-1, *self.weights.shape, *v.shape[1:])

    def functional(self, stress: Tensors) -> Array:
        """(σ, ε(·))_Q for the means of a stress on the cells, or its values at the points, → (dofs,).

        Stresses (D, cells, n), or (D, cells, points, n), give (dofs, n).
        """
        inner = self.weights.ndim
        return self.tested(self.weights.reshape(*self.weights.shape, *(1,) * (stress.ndim - inner - 1)) * stress)

    def tested(self, integrals: Tensors) -> Array:
        """The same from the integrals of a stress over the cells, or its values times w."""
        return self._transposed @ integrals.reshape(self.E.shape[0], *integrals.shape[self.weights.ndim + 1 :])

    @cached_property
    def _transposed(self) -> sps.csr_array:
        """Eᵀ by its rows, made once: every load asks for it."""
        return sps.csr_array(self.E.T)

    def form(self, C: Array, factor: Array | float = 1.0) -> sps.csc_array:
        """The matrix of (α C ε(u), ε(v))_Q for a tensor C, Mandel (D, D), and α as in ``weights``."""
        weighted = sps.kron(C, sps.diags_array((self.weights * factor).ravel()), format="csr")
        matrix = sps.csc_array(self._transposed @ (weighted @ self.E))
        return sps.csc_array((matrix + matrix.T) / 2)

    @cached_property
    def contact(self) -> list[tuple[Part, Array]]:
        """Each piece Γ3,i with its basis functions off Γ1, in the order of the rows of ``N``.

        A function on two pieces of the same normal belongs to the first: one constraint is one row.
        """
        fixed = np.setdiff1d(np.arange(self.count), self.free[:: self.dim] // self.dim)
        found: list[tuple[Part, Array]] = []
        for part in self.body.of(Kind.CONTACT):
            same = [numbers for other, numbers in found if np.allclose(other.normal, part.normal)]
            found.append((part, np.setdiff1d(self.numbers_on(part), np.concatenate([fixed, *same]))))
        return found

    @cached_property
    def N(self) -> sps.csr_array:
        """v ↦ ν·c for the coefficients on Γ3, (m, dofs): admissible are the v with N v ≤ 0.

        One row per piece and function: a function on two pieces has both constraints.
        """
        return self.normal_components(self.contact)

    def normal_components(self, on: Sequence[tuple[Part, Array]]) -> sps.csr_array:
        """v ↦ ν·c for the coefficients of functions (n,) on some parts, one part after the other, (Σ n, dofs)."""
        normals = np.concatenate([np.tile(part.normal, (len(numbers), 1)) for part, numbers in on])
        numbers = np.concatenate([numbers for _, numbers in on])
        return sps.csr_array(self._rows(normals[:, None], numbers[:, None])[:, self.free])

    def _matrix(self, values: Array, numbers: Array) -> sps.csr_array:
        """The matrix on the free coefficients with the rows of ``_rows``."""
        full = self._rows(values, numbers)
        full.eliminate_zeros()
        return sps.csr_array(full[:, self.free])

    def _rows(self, values: Array, numbers: Array) -> sps.csr_array:
        """The matrix on all coefficients, with rows of the values (..., k, d) at those of k functions (..., k)."""
        # Products read indices as often as values: 32 bits where they suffice.
        index = sps.get_index_dtype(maxval=max(values.size, self.dim * self.count))
        columns = np.broadcast_to(self.dim * numbers[..., None] + np.arange(self.dim), values.shape).astype(index)
        width = values.shape[-2] * values.shape[-1]
        starts = np.arange(0, values.size + 1, width, dtype=index)
        return sps.csr_array((values.ravel(), columns.ravel(), starts), shape=(len(starts) - 1, self.dim * self.count))


@dataclass(frozen=True, eq=False)
class Space(Displacements):
    """V^h of Problem 5.1: continuous P1 displacements, given by d values at every vertex; K^h = {v : N v ≤ 0}.

    Strains are constant on every cell, so (σ, ε(v))_Q needs the means of σ alone and (α C ε(u), ε(v))_Q those of α.

    Raises:
        MeshError: the mesh does not fit the parts of the body (from ``boundary_parts``).
    """

    mesh: Mesh
    body: Body

    def __post_init__(self) -> None:
        self.parts  # refuse a mesh that does not fit before anything is built on it  # noqa: B018

    @cached_property
    def h(self) -> float:
        return mesh_size(self.mesh)

    @property
    def numbers(self) -> Array:
        return self.mesh.t

    def numbers_on(self, part: Part) -> Array:
        return self.vertices(part)

    def vertices(self, part: Part) -> Array:
        """Vertices on a closed part."""
        return np.unique(self.mesh.facets[:, self.facets(part)])

    @property
    def weights(self) -> Array:
        return self.volumes

    @cached_property
    def E(self) -> sps.csr_array:
        """Mandel strains of the nodal basis, (D·cells, n_dofs): ε(φ e_j)_I = E_I : sym(e_j ⊗ ∇φ)."""
        gradients = barycentric_gradients(self.mesh)
        return self._matrix(np.einsum("Ijk,cik->Icij", basis(self.dim), gradients, optimize=True), self.numbers.T)

    def scatter(self, vertices: Array, values: Vectors) -> Vectors:
        """Sum local vectors into nodal ones: indices (k, n) and values (d, k, n) → (d, vertices)."""
        return np.array([np.bincount(vertices.ravel(), component.ravel(), self.count) for component in values])

    def interpolate(self, values: Vectors) -> Array:
        """Π^h: nodal values (d, vertices) → free values (n_dofs,); (d, vertices, n) → (n_dofs, n)."""
        return np.moveaxis(values, 0, 1).reshape(-1, *values.shape[2:])[self.free]

    def nodal(self, v: Array) -> Vectors:
        """Free values → nodal values (d, vertices), zero on Γ1."""
        return self.coefficients(v).T

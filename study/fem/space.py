"""V^h, K^h, Π^h: continuous P1 displacements that vanish on Γ1, with v_ν ≤ 0 at the vertices of Γ3.

A function v ∈ V^h is its vector of free nodal values (n_dofs,). Its strain is constant on every
cell, so one sparse matrix E of Mandel strains carries the whole discretisation:

    ε(v)|_T = (E v)_T,   (C ε(u), ε(v))_Q = uᵀ Eᵀ diag(|T| C) E v,   (σ, ε(v))_Q = Eᵀ(|T| mean_T σ)·v.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sps
from skfem import Mesh

from manufactured.body import Body, Kind, Part
from manufactured.tensors import Array, Tensors, Vectors, basis
from manufactured.tensors import size as tensor_size
from study.fem.mesh import barycentric_gradients, boundary_parts, cell_volumes
from study.fem.mesh import size as mesh_size


@dataclass(frozen=True, eq=False)
class Space:
    """The finite element space of Problem 5.1 on one mesh.

    Raises:
        MeshError: the mesh does not fit the parts of the body (from ``boundary_parts``).
    """

    mesh: Mesh
    body: Body

    def __post_init__(self) -> None:
        self.parts  # refuse a mesh that does not fit before anything is built on it  # noqa: B018

    @property
    def dim(self) -> int:
        return self.body.dim

    @cached_property
    def h(self) -> float:
        return mesh_size(self.mesh)

    @cached_property
    def parts(self) -> list[Array]:
        """Facets of each part of the body."""
        return boundary_parts(self.mesh, self.body)

    @cached_property
    def volumes(self) -> Array:
        """|T|, (cells,)."""
        return cell_volumes(self.mesh)

    def facets(self, part: Part) -> Array:
        return self.parts[self.body.parts.index(part)]

    def vertices(self, part: Part) -> Array:
        """Vertices on a closed part."""
        return np.unique(self.mesh.facets[:, self.facets(part)])

    @cached_property
    def free(self) -> Array:
        """Positions of the free values in the nodal vector (vertex-major: d values a vertex)."""
        fixed = np.zeros(self.mesh.p.shape[1], dtype=bool)
        for part in self.body.of(Kind.CLAMPED):
            fixed[self.vertices(part)] = True
        return np.flatnonzero(np.repeat(~fixed, self.dim))

    @property
    def dofs(self) -> int:
        return len(self.free)

    @cached_property
    def E(self) -> sps.csr_array:
        """Mandel strains of the nodal basis, (D·cells, n_dofs), cell-major."""
        D, dim, cells = tensor_size(self.dim), self.dim, self.mesh.t.shape[1]
        # ε(φ e_j)_I = E_I : sym(e_j ⊗ ∇φ) = (E_I ∇φ)_j.
        values = np.einsum("Ijk,cik->cIij", basis(dim), barycentric_gradients(self.mesh), optimize=True)
        columns = np.broadcast_to(dim * self.mesh.t.T[:, None, :, None] + np.arange(dim), values.shape)
        starts = (dim + 1) * dim * np.arange(D * cells + 1)
        full = sps.csr_array((values.ravel(), columns.ravel(), starts), shape=(D * cells, dim * self.mesh.p.shape[1]))
        full.eliminate_zeros()
        return sps.csr_array(full[:, self.free])

    def form(self, C: Array, factor: Array | float = 1.0) -> sps.csc_array:
        """The matrix of (α C ε(u), ε(v))_Q for a tensor C, Mandel (D, D), and the means of α on the cells."""
        weighted = sps.kron(sps.diags_array(self.volumes * factor), C, format="csr")
        matrix = sps.csc_array(self.E.T @ (weighted @ self.E))
        return sps.csc_array((matrix + matrix.T) / 2)

    def strain(self, v: Array) -> Tensors:
        """ε(v) on every cell, (D, cells)."""
        return (self.E @ v).reshape(-1, tensor_size(self.dim)).T

    def functional(self, stress: Tensors) -> Array:
        """(σ, ε(·))_Q for the cell means of a stress, (D, cells) → (n_dofs,)."""
        return self.E.T @ (self.volumes * stress).T.ravel()

    def scatter(self, vertices: Array, values: Vectors) -> Vectors:
        """Sum local vectors into nodal ones: indices (k, n) and values (d, k, n) → (d, vertices)."""
        count = self.mesh.p.shape[1]
        return np.array([np.bincount(vertices.ravel(), component.ravel(), count) for component in values])

    def interpolate(self, values: Vectors) -> Array:
        """Π^h: nodal values (d, vertices) → free values (n_dofs,)."""
        return values.T.ravel()[self.free]

    def nodal(self, v: Array) -> Vectors:
        """Free values → nodal values (d, vertices), zero on Γ1."""
        nodal = np.zeros(self.dim * self.mesh.p.shape[1])
        nodal[self.free] = v
        return nodal.reshape(-1, self.dim).T

    @cached_property
    def contact(self) -> list[tuple[Part, Array]]:
        """Each piece Γ3,i with its vertices off Γ1, in the order of the rows of ``N``.

        A vertex between two pieces of the same normal belongs to the first: one constraint is one row.
        """
        fixed = np.setdiff1d(np.arange(self.mesh.p.shape[1]), self.free[:: self.dim] // self.dim)
        found: list[tuple[Part, Array]] = []
        for part in self.body.of(Kind.CONTACT):
            same = [vertices for other, vertices in found if np.allclose(other.normal, part.normal)]
            found.append((part, np.setdiff1d(self.vertices(part), np.concatenate([fixed, *same]))))
        return found

    @cached_property
    def N(self) -> sps.csr_array:
        """v ↦ v_ν at the vertices of Γ3, (m, n_dofs), so that K^h = {v : N v ≤ 0}.

        One row per piece and vertex: a vertex between two pieces has both constraints.
        """
        rows = []
        for part, vertices in self.contact:
            columns = (self.dim * vertices[:, None] + np.arange(self.dim)).ravel()
            block = sps.coo_array(
                (
                    np.tile(part.normal, len(vertices)),
                    (np.repeat(np.arange(len(vertices)), self.dim), columns),
                ),
                shape=(len(vertices), self.dim * self.mesh.p.shape[1]),
            )
            rows.append(block)
        return sps.csr_array(sps.csr_array(sps.vstack(rows))[:, self.free])

"""V^h, K^h, Π^h: continuous P1 displacements that vanish on Γ1, with v_ν ≤ 0 at the vertices of Γ3.

A function v ∈ V^h is its vector of free nodal values (n_dofs,). Its strain is constant on every cell, with the weight
|T|: (σ, ε(v))_Q needs the means of σ alone, and (α C ε(u), ε(v))_Q those of α.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sps
from skfem import Mesh

from manufactured.body import Body, Part
from manufactured.tensors import Array, Vectors, basis
from study.fem.displacements import Displacements
from study.fem.mesh import barycentric_gradients
from study.fem.mesh import size as mesh_size


@dataclass(frozen=True, eq=False)
class Space(Displacements):
    """The finite element space of Problem 5.1 on one mesh.

    K^h = {v : N v ≤ 0}; nodal vectors have d values a vertex.

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
    def count(self) -> int:
        return int(self.mesh.p.shape[1])

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
        """Mandel strains of the nodal basis, (D·cells, n_dofs), cell-major: ε(φ e_j)_I = E_I : sym(e_j ⊗ ∇φ)."""
        gradients = barycentric_gradients(self.mesh)
        return self._matrix(np.einsum("Ijk,cik->cIij", basis(self.dim), gradients, optimize=True))

    def scatter(self, vertices: Array, values: Vectors) -> Vectors:
        """Sum local vectors into nodal ones: indices (k, n) and values (d, k, n) → (d, vertices)."""
        return np.array([np.bincount(vertices.ravel(), component.ravel(), self.count) for component in values])

    def interpolate(self, values: Vectors) -> Array:
        """Π^h: nodal values (d, vertices) → free values (n_dofs,)."""
        return values.T.ravel()[self.free]

    def nodal(self, v: Array) -> Vectors:
        """Free values → nodal values (d, vertices), zero on Γ1."""
        return self.coefficients(v).T

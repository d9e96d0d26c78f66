"""A body cut into triangles: their affine maps, their edges and the axes in which tractions are written."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from skfem import Mesh

from manufactured.body import Body, Kind, Part
from manufactured.tensors import Array
from study.fem.mesh import MeshError, boundary_parts, cell_volumes

FACETS = (1, 2, 0)
"""Facet i of a cell, in the order of the mesh, joins its vertices i and i + 1 modulo 3; side i is opposite vertex i."""


@dataclass(frozen=True, eq=False)
class TriangulatedBody:
    """A body with a mesh of triangles x = F x̂ + b.

    Raises:
        MeshError: the mesh is not one of triangles, or does not fit the parts of the body.
    """

    mesh: Mesh
    body: Body

    def __post_init__(self) -> None:
        if self.mesh.dim() != 2:
            raise MeshError(f"composite stresses are made for triangles, got a mesh of dimension {self.mesh.dim()}")
        self.parts  # refuse a mesh that does not fit before anything is built on it  # noqa: B018

    @cached_property
    def parts(self) -> list[Array]:
        """Edges of each part of the body."""
        return boundary_parts(self.mesh, self.body)

    def on(self, kind: Kind) -> list[tuple[Part, Array]]:
        """The parts of one kind with their edges."""
        return [(part, edges) for part, edges in zip(self.body.parts, self.parts, strict=True) if part.kind is kind]

    @property
    def cells(self) -> int:
        return int(self.mesh.t.shape[1])

    @cached_property
    def volumes(self) -> Array:
        """|T|, (cells,)."""
        return cell_volumes(self.mesh)

    @cached_property
    def map(self) -> Array:
        """F, (cells, 2, 2)."""
        corners = self.mesh.p[:, self.mesh.t]
        return np.moveaxis(np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=1), 2, 0)

    @cached_property
    def determinant(self) -> Array:
        """det F, negative for a reflected cell, (cells,)."""
        return np.linalg.det(self.map)

    @cached_property
    def edges(self) -> Array:
        """The edge on each side of the cells, (cells, 3)."""
        return self.mesh.t2f[list(FACETS)].T

    @cached_property
    def lengths(self) -> Array:
        """|e|, (edges,)."""
        ends = self.mesh.p[:, self.mesh.facets]
        return np.linalg.norm(ends[:, 1] - ends[:, 0], axis=0)

    @cached_property
    def frames(self) -> Array:
        """Rows: the axes of tractions, (ν, τ) on Γ3, Cartesian elsewhere, (edges, 2, 2)."""
        found = np.tile(np.eye(2), (self.mesh.facets.shape[1], 1, 1))
        for part, edges in self.on(Kind.CONTACT):
            found[edges] = np.array([part.normal, part.tangent])
        return found

    def boundary_tractions(self, edges: Array, tractions: Array) -> Array:
        """Tractions on edges of the boundary, with the outward normal: (cells, 3, n, 2) → (edges, n, 2)."""
        found = np.empty((len(self.lengths), *tractions.shape[2:]))
        found[self.edges] = tractions
        return found[edges]
